// Start of the page: waits for the scene, reads it and hands it to the parts that show it.
import * as THREE from 'three';
import {App} from './app.ts';
import {commands, copyLink, openHelp} from './commands.ts';
import {byId, count, messageOf} from './dom.ts';
import {Keyboard} from './keyboard.ts';
import {applyTheme, startLayout, startTheme, switchTheme} from './layout.ts';
import {readLink} from './link.ts';
import {LiveFeed, type LiveFrame} from './live_feed.ts';
import {LiveScene} from './live_scene.ts';
import {startWithin, tellReport} from './within_report.ts';
import {hideProgress, say, showFailure, showProgress} from './panel.ts';
import {SceneModel} from './scene_model.ts';
import {showServer} from './server_page.ts';
import {Settings} from './settings.ts';
import {findSource, Missing, type Source, StillLoading} from './source.ts';
import {Timeline} from './timeline.ts';
import {completeView, type SocketEvent, type Timeline as Numbers, type View} from './types.ts';

const settings = new Settings();

class Page {
  private readonly source: Source = findSource((address, got, total) => this.reading(address, got, total));
  private feed: LiveFeed | null = null;
  private app: App | null = null;
  private timeline: Timeline | null = null;
  private live: LiveScene | null = null;
  private wake: () => void = () => undefined;
  private lastTable = 0;
  private selected: number[] = [];

  async start(): Promise<void> {
    startTheme(settings);
    settings.listen(name => name === 'theme' && applyTheme(settings));
    byId('theme').addEventListener('click', () => switchTheme(settings));
    byId('open-help').addEventListener('click', openHelp);
    if (!this.source.exported) this.connect();
    const view = await this.waitForView();
    if (view.kind === 'server') return this.startServer(view);
    return this.startScene(view);
  }

  private connect(): void {
    this.feed = new LiveFeed({event: event => this.receive(event), frame: frame => this.receiveFrame(frame),
      lost: () => this.note('The connection to the program is lost. The page keeps what it has.')});
  }

  private async waitForView(): Promise<View> {
    for (;;) {
      try {
        return completeView(await this.source.json<Partial<View>>('view.json'));
      } catch (error) {
        if (!(error instanceof StillLoading)) throw error;
        await new Promise<void>(done => {
          this.wake = done;
          setTimeout(done, 2000);
        });
        if (document.documentElement.dataset.failed) return new Promise(() => undefined);
      }
    }
  }

  private startServer(view: View): void {
    hideProgress();
    byId('title').textContent = view.title || 'octopair server';
    document.title = view.title ? `${view.title} – octopair` : 'octopair server';
    for (const id of ['zoom-all', 'toggle-options', 'toggle-side', 'copy-link', 'open-help']) byId(id).hidden = true;
    showServer([], []);
  }

  private async startScene(view: View): Promise<void> {
    startLayout(() => this.app?.stage.resize());
    const model = new SceneModel(view);
    settings.begin('up', view.up === 'y' ? 'y' : 'z');
    if (view.has.shapes) settings.begin('style', 'shapes');
    const link = readLink(settings);
    const first = Math.min(link.frame ?? 0, Math.max(view.frames - 1, 0));
    // The data come while the graphics start.
    const rows = early(model.load(this.source));
    const frame = view.kind === 'live' ? null : early(model.readFrame(this.source, first));
    const app = this.app = new App(this.source, model, settings, byId<HTMLCanvasElement>('view'), link.camera);
    this.selected = link.selected;
    this.prepare(app, link.camera !== null);
    await rows;
    if (!frame) return this.startLive(app);
    await this.startTimeline(app);
    // A link may name a frame that is not computed yet.
    await app.showFrame(first, frame).catch(error => first > 0 ? app.showFrame(0) : Promise.reject(error));
    this.firstPicture(app);
    if (view.has.shapes) await this.readShapes(app);
    return undefined;
  }

  private prepare(app: App, keepCamera: boolean): void {
    app.stage.setTheme(app.palette());
    new Keyboard(commands(app));
    byId('zoom-all').addEventListener('click', () => app.zoomAll());
    byId('copy-link').addEventListener('click', () => void copyLink(app));
    app.stage.resize();
    if (!keepCamera) app.zoomAll();
    offerHooks(app);
  }

  private startLive(app: App): void {
    this.live = new LiveScene(app.model);
    this.timeline = app.timeline = new Timeline(true, 0, {go: async () => undefined, pause: paused => this.feed?.pause(paused)});
    showProgress('Waiting for the first frame', null);
    this.feed?.start();
  }

  private async startTimeline(app: App): Promise<void> {
    const {frames, has} = app.model.view;
    if (frames < 2 && !has.events) return;
    this.timeline = app.timeline = new Timeline(false, frames, {go: frame => app.showFrame(frame).catch(error => app.fail(error)),
      pause: () => undefined});
    await this.readTimeline();
  }

  private async readTimeline(): Promise<void> {
    const frames = this.app?.model.view.frames ?? 1;
    // Frames can be shown without their numbers.
    const numbers = await this.source.json<Numbers>('timeline.json').catch((error: unknown): Numbers => {
      if (error instanceof Missing) return {frames, done: frames, pairs: [], began: [], ended: []};
      throw error;
    });
    this.timeline?.setNumbers(numbers);
  }

  private async readShapes(app: App): Promise<void> {
    await app.stage.shapes.load(this.source, app.model, () => app.recolour());
    app.recolour();
    document.documentElement.dataset.shapes = String(app.stage.shapes.shapes.size);
  }

  // The first picture is drawn: all that waited for it.
  private firstPicture(app: App): void {
    hideProgress();
    requestAnimationFrame(() => {
      app.stage.drawNow();
      document.documentElement.dataset.firstPicture = String(Math.round(performance.now()));
      document.documentElement.dataset.ready = 'true';
    });
    app.selection.select(this.selected).catch(error => app.fail(error));
    if (this.source.exported) startWithin(app);
  }

  private receive(event: SocketEvent): void {
    if (event.event === 'progress' && !this.app) showProgress(event.what || 'Loading', event.done ?? null);
    if (event.event === 'ready') this.wake();
    if (event.event === 'failed') {
      showFailure(event.message ?? 'unknown error');
      this.wake();
    }
    if (event.event === 'timeline') this.readTimeline().catch(error => say(messageOf(error)));
    if (event.event === 'closed') this.note('The program has ended. The page keeps its last frame.');
    if (event.event === 'jobs') showServer(event.jobs ?? [], event.scenes ?? []);
  }

  private note(text: string): void {
    if (this.app) this.app.note(text);
    else say(text);
  }

  private receiveFrame(frame: LiveFrame): void {
    const {app, live} = this;
    if (!app || !live) return;
    const first = !document.documentElement.dataset.ready;
    const rowsChanged = live.apply(frame);
    if (rowsChanged && !first) this.readRows(app);
    app.frameChanged(rowsChanged);
    this.timeline?.append(frame.frame, frame.pairs, frame.began, frame.ended, frame.stepSeconds);
    const now = performance.now();
    if (first || now - this.lastTable > 1000) this.refreshSlowly(app, now);
    if (first) this.firstPicture(app);
    // The next frame is asked for when this one is drawn.
    requestAnimationFrame(() => requestAnimationFrame(() => this.feed?.want()));
  }

  // Other objects may be shown: their names and groups are read again.
  private readRows(app: App): void {
    const {has} = app.model.view;
    if (has.names || has.groups) app.model.loadRows(this.source).then(() => app.recolour()).catch(error => app.fail(error));
  }

  // Answers that the server computes on request are not asked for with each live frame.
  private refreshSlowly(app: App, now: number): void {
    this.lastTable = now;
    void app.table.load();
    app.selection.refresh().catch(error => app.fail(error));
    if (settings.values.octants) void app.showOctants();
  }

  private reading(address: string, got: number, total: number): void {
    if (!document.documentElement.dataset.ready) showProgress(`Reading ${address}: ${count(got / 1e6)} of ${count(total / 1e6)} MB`, got / total);
  }
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
  }});
}

new Page().start().catch(error => {
  // A message of the server is more exact.
  if (!document.documentElement.dataset.failed) showFailure(messageOf(error));
  tellReport('failed');
});
