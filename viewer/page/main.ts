// Start of the page: waits for the scene, reads it and hands it to the parts that show it.
import * as THREE from 'three';
import {App} from './app.ts';
import {commands, copyLink, openHelp} from './commands.ts';
import {byId, count, messageOf} from './dom.ts';
import {Keyboard} from './keyboard.ts';
import {applyTheme, startLayout, startTheme, switchTheme} from './layout.ts';
import {LiveFeed, type LiveFrame} from './live_feed.ts';
import {LiveScene} from './live_scene.ts';
import {hideProgress, say, showFailure, showProgress} from './panel.ts';
import {SceneModel} from './scene_model.ts';
import {showServer} from './server_page.ts';
import {Settings} from './settings.ts';
import {findSource, type Source, StillLoading} from './source.ts';
import {Timeline} from './timeline.ts';
import {completeView, type Point, type SocketEvent, type Timeline as Numbers, type View} from './types.ts';

const settings = new Settings();

class Page {
  private readonly source: Source = findSource((address, got, total) => this.reading(address, got, total));
  private feed: LiveFeed | null = null;
  private app: App | null = null;
  private timeline: Timeline | null = null;
  private live: LiveScene | null = null;
  private wake: () => void = () => undefined;
  private lastTable = 0;

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
      lost: () => say('The connection to the program is lost. The page keeps what it has.')});
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
    startLayout();
    const model = new SceneModel(view);
    settings.begin('up', view.up === 'y' ? 'y' : 'z');
    if (view.has.shapes) settings.begin('style', 'shapes');
    const app = this.app = new App(this.source, model, settings, byId<HTMLCanvasElement>('view'));
    app.stage.setTheme(app.palette());
    new Keyboard(commands(app));
    byId('zoom-all').addEventListener('click', () => app.zoomAll());
    byId('copy-link').addEventListener('click', () => void copyLink(app));
    offerHooks(app);
    await model.load(this.source);
    if (view.kind === 'live') return this.startLive(app);
    await this.startTimeline(app);
    await app.showFrame(app.firstFrame);
    this.firstPicture(app);
    if (view.has.shapes) await this.readShapes(app);
    return undefined;
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
    const numbers = await this.source.json<Numbers>('timeline.json');
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
    app.stage.invalidate();
    requestAnimationFrame(() => requestAnimationFrame(() => {
      app.stage.finish();
      document.documentElement.dataset.firstPicture = String(Math.round(performance.now()));
      document.documentElement.dataset.ready = 'true';
    }));
    app.selection.select(app.firstSelection).catch(error => app.fail(error));
  }

  private receive(event: SocketEvent): void {
    if (event.event === 'progress' && !this.app) showProgress(event.what || 'Loading', event.done ?? null);
    if (event.event === 'ready') this.wake();
    if (event.event === 'failed') {
      showFailure(event.message ?? 'unknown error');
      this.wake();
    }
    if (event.event === 'timeline') this.readTimeline().catch(error => say(messageOf(error)));
    if (event.event === 'closed') say('The program has ended. The page keeps its last frame.');
    if (event.event === 'jobs') showServer(event.jobs ?? [], event.scenes ?? []);
  }

  private receiveFrame(frame: LiveFrame): void {
    const {app, live} = this;
    if (!app || !live) return;
    const first = !document.documentElement.dataset.ready;
    const rowsChanged = live.apply(frame);
    if (first) this.adoptBounds(app);
    app.frameChanged(rowsChanged);
    this.timeline?.append(frame.frame, frame.pairs, frame.began, frame.ended, frame.stepSeconds);
    const now = performance.now();
    if (first || now - this.lastTable > 1000) this.refreshSlowly(app, now);
    if (first) this.firstPicture(app);
    // The next frame is asked for when this one is drawn.
    requestAnimationFrame(() => requestAnimationFrame(() => this.feed?.want()));
  }

  // What the server computes on request is not asked for with each live frame.
  private refreshSlowly(app: App, now: number): void {
    this.lastTable = now;
    void app.table.load();
    app.selection.refresh().catch(error => app.fail(error));
    if (settings.values.octants) void app.showOctants();
  }

  // A live scene may have had no boxes when the page began.
  private adoptBounds(app: App): void {
    const {bounds} = app.model.view;
    if (bounds.max[0] > bounds.min[0] || location.hash.includes('at=')) return;
    const box = new THREE.Box3();
    for (const block of app.stage.boxes.blocks) box.union(block.box);
    if (!box.isEmpty()) app.stage.camera.setScene(box.min.toArray() as Point, box.max.toArray() as Point);
    app.zoomAll();
  }

  private reading(address: string, got: number, total: number): void {
    if (!document.documentElement.dataset.ready) showProgress(`Reading ${address}: ${count(got / 1e6)} of ${count(total / 1e6)} MB`, got / total);
  }
}

// Functions for tests of the page.
function offerHooks(app: App): void {
  Object.assign(window, {octopairView: {
    project: (x: number, y: number, z: number) => app.stage.project(new THREE.Vector3(...app.model.toRelative([x, y, z]))),
    select: (object: number) => app.selection.select([object]),
    pixel: (x: number, y: number) => app.stage.pixel(x, y),
    camera: () => app.stage.camera.toText(),
    settings: () => ({...settings.values}),
  }});
}

new Page().start().catch(error => showFailure(messageOf(error)));
