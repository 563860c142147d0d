// Start of the page: waits for the scene, reads it and hands it to the parts that show it.
// Start here to change the page of the viewer.
import * as THREE from 'three';
import {App} from './app.ts';
import {commands, openHelp} from './commands.ts';
import {byId, messageOf} from './dom.ts';
import {Keyboard} from './keyboard.ts';
import {applyTheme, startLayout, startTheme, switchTheme} from './layout.ts';
import {type LinkState, readLink} from './link.ts';
import {LiveFeed, type LiveFrame} from './live_feed.ts';
import {LiveScene} from './live_scene.ts';
import {hideProgress, say, showBanner, showFailure, showProgress} from './panel.ts';
import {startPrinting} from './print.ts';
import {SceneModel} from './scene_model.ts';
import {showServer} from './server_page.ts';
import {Settings} from './settings.ts';
import {findSource, Missing, type Source, StillLoading} from './source.ts';
import {Stage} from './stage.ts';
import {firstQuery} from './table.ts';
import {Timeline} from './timeline.ts';
import {completeView, type SocketEvent, type Timeline as Numbers, type View} from './types.ts';

const settings = new Settings();

class Page {
  private readonly source: Source = findSource((address, got, total) => this.reading(address, got, total));
  private feed: LiveFeed | null = null;
  private app: App | null = null;
  private timeline: Timeline | null = null;
  private live: LiveScene | null = null;
  private readable = false;
  private listed = false;  // jobs and scenes of a server have come, perhaps before view.json
  private wake: () => void = () => undefined;
  private lastTable = 0;
  private tableTimer = 0;
  private firstFrame: (() => void) | null = null;

  async start(): Promise<void> {
    startTheme(settings);
    if (!this.source.exported) this.connect();
    // The graphics start while the program answers.
    const view = early(this.waitForView());
    settings.listen(name => name === 'theme' && applyTheme(settings));
    byId('theme').addEventListener('click', () => switchTheme(settings));
    // A link that is pasted over another one.
    window.addEventListener('hashchange', () => location.reload());
    byId('open-help').addEventListener('click', openHelp);
    const stage = early(startStage());
    return this.show(await view, stage);
  }

  private async show(view: View, stage: Promise<Stage>): Promise<void> {
    if (view.kind === 'server') return this.startServer(view);
    return this.startScene(view, stage);
  }

  private connect(): void {
    this.feed = new LiveFeed({event: event => this.receive(event), frame: frame => this.receiveFrame(frame),
      lost: () => this.noteEnd('The connection to the program is lost. The page keeps what it has.')});
  }

  // Asks for the scene when the server says that it can be read. Without a WebSocket, the page asks again and again.
  private async waitForView(): Promise<View> {
    for (;;) {
      while (!this.readable && this.feed?.connects()) await this.pause();
      if (document.documentElement.dataset.failed) return new Promise(() => undefined);
      try {
        return completeView(await this.source.json<Partial<View>>('view.json'));
      } catch (error) {
        if (!(error instanceof StillLoading)) throw error;
        await this.pause();
      }
    }
  }

  // Waits until an event of the server wakes the page, at most two seconds.
  private pause(): Promise<void> {
    return new Promise(done => {
      this.wake = done;
      setTimeout(done, 2000);
    });
  }

  private startServer(view: View): void {
    hideProgress();
    byId('title').textContent = view.title || 'octopair server';
    document.title = view.title ? `${view.title} – octopair` : 'octopair server';
    for (const id of ['zoom-all', 'toggle-options', 'toggle-side', 'copy-link', 'open-help']) byId(id).hidden = true;
    if (!this.listed) showServer([], []);
  }

  private async startScene(view: View, stage: Promise<Stage>): Promise<void> {
    startLayout(() => this.app?.stage.resize());
    const model = new SceneModel(view);
    beginSettings(view);
    const link = readLink(settings);
    const first = Math.min(link.frame ?? 0, Math.max(view.frames - 1, 0));
    // The data come while the parts of the page start.
    const rows = early(Promise.all([model.load(this.source), this.source.exported ? model.loadRows(this.source) : null]));
    const frame = view.kind === 'live' ? null : early(model.readFrame(this.source, first));
    const worst = frame && link.empty ? early(this.source.collisions(first, firstQuery)) : null;
    this.startTimeline(view);
    const app = this.app = new App(this.source, model, settings, await stage, link.camera);
    app.timeline = this.timeline;
    this.prepare(app, link.camera !== null);
    await rows;
    if (!frame) return this.startLive(app, link);
    // A link may name a frame that is not computed yet.
    const shown = worst ? app.showWorst(frame, worst) : app.showFrame(first, frame);
    await shown.catch(error => first > 0 ? app.showFrame(0) : Promise.reject(error));
    await firstPicture(app);
    const rest = this.readRest(app, link);
    // The picture stays if the rest cannot be read.
    return rest.catch((error: unknown) => app.fail(error));
  }

  private prepare(app: App, keepCamera: boolean): void {
    app.stage.setTheme(app.palette());
    new Keyboard(commands(app));
    byId('zoom-all').addEventListener('click', () => app.zoomAll());
    byId('copy-link').addEventListener('click', () => void app.copyLink());
    startPrinting(app);
    app.stage.resize();
    if (!keepCamera) app.zoomAll();
    offerHooks(app);
  }

  private startLive(app: App, link: LinkState): Promise<void> {
    this.live = new LiveScene(app.model);
    showProgress('Waiting for the first frame', null);
    this.feed?.start();
    return new Promise(done => this.firstFrame = () => done(firstPicture(app).then(() => this.readRest(app, link))));
  }

  // The timeline takes its part of the page before the camera is placed.
  private startTimeline(view: View): void {
    const live = view.kind === 'live';
    if (!live && view.frames < 2 && !view.has.events) return;
    this.timeline = new Timeline(live, live ? 0 : view.frames, {
      go: frame => live ? Promise.resolve() : this.app!.showFrame(frame),
      failed: error => this.app?.fail(error),
      pause: paused => this.feed?.pause(paused),
    });
  }

  // Reads and starts what the first picture does not need.
  private async readRest(app: App, link: LinkState): Promise<void> {
    const {view} = app.model;
    app.startOptions();
    const live = view.kind === 'live';
    await Promise.all([app.followFrame(!app.table.rows.length), live || !this.timeline ? null : this.readTimeline(),
      view.has.shapes ? this.readShapes(app) : null, app.model.loadRows(this.source).then(() => app.namesArrived())]);
    app.recolour();
    if (link.selected.length) await (link.camera === null ? app.openAll(link.selected) : app.selection.select(link.selected));
    if (live && link.empty) app.selectWorstSoon();
    await app.near.update();
    app.overview.draw();
    app.stage.drawNow();
    document.documentElement.dataset.complete = 'true';
  }

  private async readTimeline(): Promise<void> {
    const frames = this.app?.model.view.frames ?? 1;
    // Frames can be shown without their numbers.
    const numbers = await this.source.json<Numbers>('timeline.json').catch((error: unknown): Numbers => {
      if (error instanceof Missing) return {frames, done: frames, pairs: [], began: [], ended: []};
      throw error;
    });
    this.timeline?.setNumbers(numbers);
    if (numbers.failed) this.app?.note(`Later frames are missing. ${sentence(numbers.failed)}`);
  }

  private async readShapes(app: App): Promise<void> {
    await app.stage.shapes.load(this.source, app.model, () => app.recolour());
    app.shapesArrived();
    document.documentElement.dataset.shapes = String(app.stage.shapes.shapes.size);
  }

  private receive(event: SocketEvent): void {
    if (event.event === 'progress' && !this.app) showProgress(sentence(event.what || 'loading'), event.done ?? null);
    if (event.event === 'ready') {
      showBanner('');
      this.readable = true;
      this.wake();
    }
    if (event.event === 'failed') {
      showFailure(event.message ?? 'unknown error');
      this.readable = true;
      this.wake();
    }
    if (event.event === 'timeline') this.readTimeline().catch(error => say(messageOf(error)));
    if (event.event === 'closed') this.noteEnd(`The ${this.live ? 'simulation' : 'program'} has ended. The page keeps its last frame.`);
    if (event.event === 'waiting') showBanner(event.message ?? 'The server does not answer.');
    if (event.event === 'jobs') {
      this.listed = true;
      showBanner('');
      showServer(event.jobs ?? [], event.scenes ?? []);
    }
  }

  // Nothing comes any more.
  private noteEnd(text: string): void {
    showBanner(this.app ? '' : text);
    this.app?.note(text);
  }

  private receiveFrame(frame: LiveFrame): void {
    const {app, live} = this;
    if (!app || !live) return;
    showBanner('');
    const first = this.firstFrame;
    const rowsChanged = live.apply(frame);
    if (rowsChanged && !first) this.readRows(app);
    if (rowsChanged || first) this.readPlace(app);
    app.frameChanged(rowsChanged);
    const {began = 0, ended = 0} = app.model.frame.info;
    this.timeline?.append(frame.frame, frame.pairs, began, ended, frame.stepSeconds);
    if (!first) this.refreshSlowly(app);
    this.firstFrame = null;
    first?.();
    // The next frame is asked for when this one is drawn.
    requestAnimationFrame(() => requestAnimationFrame(() => this.feed?.want()));
  }

  // The origin is known when the first objects are there, which may be after the page was opened.
  private readPlace(app: App): void {
    this.source.json<View>('view.json').then(({origin, bounds, notices}) => Object.assign(app.model.view, {origin, bounds, notices})).catch(error => app.fail(error));
  }

  // Other objects may be shown: their names and groups are read again.
  private readRows(app: App): void {
    const {has} = app.model.view;
    if (has.names || has.groups) app.model.loadRows(this.source).then(() => app.namesArrived()).catch(error => app.fail(error));
  }

  // Answers that the server computes on request are asked for once a second, and after the last frame.
  private refreshSlowly(app: App): void {
    const wait = this.lastTable + 1000 - performance.now();
    clearTimeout(this.tableTimer);
    if (wait > 0) {
      this.tableTimer = window.setTimeout(() => this.refreshSlowly(app), wait);
      return;
    }
    this.lastTable = performance.now();
    void app.table.load().then(() => app.selectWorst());
    app.selection.refresh().catch(error => app.fail(error));
    if (settings.values.octants) void app.showOctants();
  }

  private reading(address: string, got: number, total: number): void {
    if (!document.documentElement.dataset.ready) showProgress(`Reading ${contentOf(address)}: ${megabytes(got)} of ${megabytes(total)} MB`, got / total);
  }
}

async function startStage(): Promise<Stage> {
  return new Stage(byId<HTMLCanvasElement>('view'));
}

// The values that this scene begins with.
function beginSettings(view: View): void {
  // A running scene shows where collisions begin.
  if (view.kind === 'live') settings.begin('ghosts', false);
  settings.begin('up', view.up === 'y' ? 'y' : 'z');
  if (view.has.shapes) settings.begin('style', 'shapes');
  if (view.has.boxes) return;
  settings.begin('others', 0.15);
  settings.begin('contacts', 'all');
}

// Draws the first picture, and waits until it is done.
function firstPicture(app: App): Promise<void> {
  hideProgress();
  app.stage.drawNow();
  document.documentElement.dataset.firstPicture = String(Math.round(performance.now()));
  document.documentElement.dataset.ready = 'true';
  // The browser shows the picture before the rest begins.
  return new Promise(done => setTimeout(done, 20));
}

function sentence(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

function megabytes(bytes: number): string {
  return (bytes / 1e6).toFixed(1);
}

// Returns the content of an address in words.
function contentOf(address: string): string {
  const names: Record<string, string> = {frame: 'boxes', poses: 'poses', partners: 'numbers of pairs', shown: 'objects', geometry: 'shapes', shape: 'shapes'};
  return names[/^[a-z]+/.exec(address)?.[0] ?? ''] ?? 'data';
}

// Something that is waited for later: until then its failure is no error.
function early<T>(promise: Promise<T>): Promise<T> {
  promise.catch(() => undefined);
  return promise;
}

// Functions for tests of the page.
function offerHooks(app: App): void {
  Object.assign(window, {octopairView: {
    project: (x: number, y: number, z: number) => app.stage.project(new THREE.Vector3(...app.model.toRelative([x, y, z]))),
    select: (object: number) => app.selection.select([object]),
    pixel: (x: number, y: number) => app.stage.pixel(x, y),
    camera: () => app.stage.camera.toText(),
    settings: () => ({...settings.values}),
    frame: () => ({...app.model.frame.info}),
    plot: () => app.timeline?.ranges(),
  }});
}

new Page().start().catch(error => {
  // A message of the server is more exact.
  if (!document.documentElement.dataset.failed) showFailure(messageOf(error));
});
