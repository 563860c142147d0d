// Connects the parts of the page: a change of the frame, the selection or a setting reaches all that show it.
import * as THREE from 'three';
import {legend, paint, type Palette, paletteOf} from './colours.ts';
import {isAbort, messageOf} from './dom.ts';
import {hideLabel, octantText, placeDepths, showLabel} from './hover.ts';
import {isDark} from './layout.ts';
import {Link} from './link.ts';
import {Near} from './near.ts';
import {Options} from './options.ts';
import {pairLimit} from './pair_layer.ts';
import {say, showLegend, showNotices, showSummary, showTitle} from './panel.ts';
import {Picker} from './picker.ts';
import {Pointer} from './pointer.ts';
import type {Frame, SceneModel} from './scene_model.ts';
import {Search} from './search.ts';
import {Selection} from './selection.ts';
import type {Name, Settings} from './settings.ts';
import type {Source} from './source.ts';
import type {Stage} from './stage.ts';
import {computeStates, State} from './states.ts';
import {Table} from './table.ts';
import type {Timeline} from './timeline.ts';
import type {Collision, Point} from './types.ts';

export class App {
  readonly selection: Selection;
  readonly table: Table;
  readonly search: Search;
  options: Options | null = null;
  readonly link: Link;
  readonly near: Near;
  timeline: Timeline | null = null;
  private readonly picker: Picker;
  private states: Uint8Array = new Uint8Array(0);
  private colours: Uint8Array = new Uint8Array(0);
  private nearColours: Uint8Array = new Uint8Array(0);
  private octantRequest = new AbortController();
  private contactRequest = new AbortController();
  private contactsNow = '';
  private readonly notes: string[] = [];
  private low: Point;
  private high: Point;

  constructor(readonly source: Source, readonly model: SceneModel, readonly settings: Settings, readonly stage: Stage, camera: string | null) {
    const failed = (error: unknown): void => this.fail(error);
    this.selection = new Selection(source, model, {changed: () => this.selectionChanged(), zoom: () => this.zoomToSelection()});
    this.table = new Table(source, {
      frame: () => model.frame.info.frame, selected: () => this.selection.objects, open: row => void this.openCollision(row), failed,
    }, {contacts: model.view.has.contacts, events: model.view.has.events || model.view.kind === 'live'});
    this.search = new Search(source, model, object => void this.openObject(object), failed);
    this.near = new Near(source, model, this.stage, () => this.recolour(), failed);
    this.picker = new Picker(this);
    this.low = model.toRelative(model.view.bounds.min);
    this.high = model.toRelative(model.view.bounds.max);
    this.stage.hollow = !model.view.has.boxes;
    this.stage.camera.setScene(this.low, this.high);
    this.stage.camera.up = settings.values.up;
    this.stage.camera.fitScene();
    this.link = new Link(settings, () => ({
      camera: this.stage.camera.toText(), frame: model.view.kind === 'live' ? 0 : model.frame.info.frame, selected: this.selection.objects,
    }));
    this.listen();
    if (camera) this.stage.camera.fromText(camera);
  }

  palette(): Palette {
    return paletteOf(isDark(this.settings));
  }

  visible(row: number): boolean {
    return this.colours[4 * row + 3] !== 0;
  }

  nearVisible(row: number): boolean {
    return this.nearColours[4 * row + 3] !== 0;
  }

  fail(error: unknown): void {
    if (!isAbort(error)) say(messageOf(error));
  }

  // Reads and shows a frame of a scene, or shows one that is being read.
  async showFrame(frame: number, reading: Promise<Frame> = this.model.readFrame(this.source, frame)): Promise<void> {
    this.model.frame = await reading;
    this.frameChanged(false);
    this.timeline?.show(frame);
    if (this.options) this.followFrame().catch((error: unknown) => this.fail(error));
  }

  // The panel of settings, which the first picture does not need.
  startOptions(): void {
    this.options = new Options(this.settings, this.model);
  }

  // Reads what the picture of a frame did not need: the table, octants, pairs and the selected object.
  async followFrame(): Promise<void> {
    const {model, source, settings} = this;
    const {frame} = model;
    const live = model.view.kind === 'live';
    const levels = settings.values.colour === 'level' || source.exported;
    await Promise.all([this.table.load(0), this.showOctants(), live ? null : model.readPairs(source, frame), levels ? model.readLevels(source) : null]);
    if (frame !== model.frame && !live) return;
    await this.selection.refresh();
    if (levels || settings.values.lines === 'all') this.recolour();
  }

  // Boxes may have left the bounds that the scene began with, or it had none. Returns whether it had none.
  private growBounds(): boolean {
    const box = new THREE.Box3();
    for (const block of this.stage.boxes.blocks) box.union(block.box);
    const known = new THREE.Box3(new THREE.Vector3(...this.low), new THREE.Vector3(...this.high));
    if (box.isEmpty() || known.containsBox(box)) return false;
    const had = known.getSize(new THREE.Vector3()).length() > 0;
    if (had) box.union(known);
    this.low = box.min.toArray();
    this.high = box.max.toArray();
    this.stage.camera.setScene(this.low, this.high);
    return !had;
  }

  // The arrays of the model have another frame. `sort` is false if only boxes moved.
  frameChanged(sort: boolean): void {
    const {model, stage} = this;
    stage.boxes.setBoxes(model.frame.boxes, model.rows, sort);
    stage.shapes.setPoses(model.frame.poses);
    if (this.growBounds() && !location.hash.includes('at=')) this.zoomAll();
    this.near.forget();
    if (this.selection.objects.length) this.selection.partners = model.partnersOf(this.selection.objects[0]!);
    this.recolour();
    showTitle(model);
    showSummary(model);
    this.link.changed();
    void this.near.update();
  }

  // Computes states and colours again, and all layers that depend on them.
  recolour(): void {
    const {model, stage, settings} = this;
    const {objects, partners} = this.selection;
    const palette = this.palette();
    this.states = computeStates(model, objects, [...partners, ...objects]);
    if (this.colours.length !== 4 * model.rows) this.colours = new Uint8Array(4 * model.rows);
    paint(model, this.states, settings.values, palette, this.colours);
    stage.boxes.setColours(this.boxColours());
    stage.shapes.setColours(this.colours);
    this.colourNear(palette);
    this.outline(palette);
    stage.pairs.show(model, settings.values.lines, objects, partners, palette);
    this.showLegend();
    void this.showContacts();
    this.showNotices();
    stage.apply(settings.values, this.low, this.high);
  }

  selectionChanged(): void {
    document.documentElement.dataset.selected = this.selection.objects.join(',');
    this.recolour();
    this.table.selectionChanged();
    this.link.changed();
  }

  // A setting changed that only concerns how layers are drawn.
  restyle(): void {
    this.stage.apply(this.settings.values, this.low, this.high);
  }

  zoomAll(): void {
    this.stage.camera.fitScene();
    this.stage.moved();
  }

  zoomToSelection(): void {
    const box = new THREE.Box3();
    for (const object of this.selection.objects) this.picker.addBox(box, object);
    if (box.isEmpty()) return;
    const size = box.getSize(new THREE.Vector3()).length();
    box.expandByScalar(Math.max(0.6 * size, 1e-4 * this.stage.camera.radius()));
    this.stage.camera.fit(box.min.toArray(), box.max.toArray());
    this.stage.moved();
  }

  async openObject(object: number): Promise<void> {
    return this.openAll([object]);
  }

  async openCollision(row: Collision): Promise<void> {
    return this.openAll([row.a, row.b]);
  }

  // Selects objects and zooms to them. The places of objects that are not drawn must be read first.
  private async openAll(objects: number[]): Promise<void> {
    const reading = this.selection.select(objects).catch((error: unknown) => this.fail(error));
    const known = objects.every(object => this.model.rowOf(object) >= 0);
    if (known) this.zoomToSelection();
    await reading;
    if (!known) this.zoomToSelection();
  }

  async showOctants(): Promise<void> {
    const {octants, level} = this.settings.values;
    this.octantRequest.abort();
    this.octantRequest = new AbortController();
    const {signal} = this.octantRequest;
    try {
      if (octants) {
        await this.stage.octants.show(this.source, this.model.frame.info.frame, level, signal);
        this.options?.setLevels(this.stage.octants.levels.length);
      } else this.stage.octants.clear();
    } catch (error) {
      this.fail(error);
    }
    if (signal.aborted) return;
    this.showNotices();
    this.showLegend();
    this.stage.invalidate();
  }

  // The deepest level that the present frame has.
  deepest(): number {
    return Math.max(0, this.stage.octants.levels.length - 1);
  }

  private listen(): void {
    const {stage} = this;
    this.settings.listen(name => this.settingChanged(name));
    stage.onDraw(() => this.drawn());
    stage.onRest(() => {
      void this.near.update();
      this.link.changed();
    });
    new Pointer(stage, {
      click: (x, y, add) => this.click(x, y, add), doubleClick: () => this.zoomToSelection(),
      hover: (x, y) => this.hover(x, y), leave: hideLabel,
    });
  }

  private settingChanged(name: Name): void {
    this.link.changed();
    if (name === 'octants' || name === 'level') return void this.showOctants();
    if (name === 'theme') return this.themeChanged();
    if (name === 'colour' && this.settings.values.colour === 'level') return void this.colourByLevel();
    if (['colour', 'style', 'show', 'others', 'lines', 'contacts'].includes(name)) return this.recolour();
    return this.restyle();
  }

  private async colourByLevel(): Promise<void> {
    await this.model.readLevels(this.source).catch((error: unknown) => this.fail(error));
    this.recolour();
  }

  themeChanged(): void {
    this.stage.setTheme(this.palette());
    this.recolour();
    this.timeline?.setTheme();
  }

  private click(x: number, y: number, add: boolean): void {
    const object = this.picker.pick(x, y);
    const first = this.selection.objects[0];
    const objects = object < 0 ? [] : add && first !== undefined && first !== object ? [first, object] : [object];
    this.selection.select(objects).catch((error: unknown) => this.fail(error));
  }

  private hover(x: number, y: number): void {
    const ray = this.stage.ray(x, y);
    const octant = this.settings.values.octants ? this.stage.octants.find(ray) : null;
    if (octant) return showLabel(this.stage, octantText(octant), x, y);
    const object = this.picker.pick(x, y);
    if (object < 0) return hideLabel();
    const name = this.model.nameOf(object);
    return showLabel(this.stage, name ? `${object} ${name}` : `object ${object}`, x, y);
  }

  private drawn(): void {
    const {dataset} = document.documentElement;
    const {stage, model} = this;
    dataset.frame = String(model.frame.info.frame);
    dataset.drawn = String(stage.drawn);
    dataset.pairs = String(model.frame.info.pairs);
    dataset.octants = String(stage.octants.edges.count);
    dataset.lines = String(stage.pairs.count);
    dataset.contacts = String(stage.contacts.count);
    placeDepths(stage);
  }

  // The colours of the boxes: a row whose shape is drawn instead has no box.
  private boxColours(): Uint8Array {
    const {model, stage, settings} = this;
    if (settings.values.style !== 'shapes' || !model.geometry || stage.shapes.shapes.size === 0) return this.colours;
    const colours = this.colours.slice();
    for (let row = 0; row < model.rows; ++row) if (stage.shapes.shapes.has(model.geometry[row]!)) colours[4 * row + 3] = 0;
    return colours;
  }

  private colourNear(palette: Palette): void {
    const near = this.near.shown;
    if (!near) return;
    const colours = this.nearColours = new Uint8Array(4 * near.objects.length);
    const {objects, partners} = this.selection;
    const others = new Set(partners);
    const {show} = this.settings.values;
    near.objects.forEach((object, k) => {
      const state = objects.includes(object) ? State.selected : others.has(object) ? State.partner :
        near.partners[k] ? State.colliding : State.free;
      const hidden = state < State.partner && (show === 'selection' || (show === 'colliding' && state === State.free));
      colours.set([...palette.states[state]!, hidden ? 0 : 255], 4 * k);
    });
    this.stage.near.setColours(colours);
  }

  private outline(palette: Palette): void {
    const boxes = this.selection.objects.map(object => this.picker.addBox(new THREE.Box3(), object)).filter(box => !box.isEmpty());
    const bounds = new Float32Array(6 * boxes.length);
    boxes.forEach((box, k) => bounds.set([...box.min.toArray(), ...box.max.toArray()], 6 * k));
    this.stage.outlines.set(bounds, boxes.length, () => palette.states[State.selected]!);
  }

  private async showContacts(): Promise<void> {
    const {view, frame} = this.model;
    const {contacts} = this.settings.values;
    const [first, second] = this.selection.objects;
    const wanted = view.has.contacts && (contacts === 'all' || (contacts === 'selection' && first !== undefined));
    const now = wanted ? `${frame.info.frame} ${contacts} ${contacts === 'all' ? '' : `${first},${second ?? ''}`} ${isDark(this.settings)}` : '';
    if (now === this.contactsNow) return;
    this.contactsNow = now;
    this.contactRequest.abort();
    this.contactRequest = new AbortController();
    const {signal} = this.contactRequest;
    try {
      const object = contacts === 'all' ? undefined : first;
      const answer = wanted ? await this.source.collisions(frame.info.frame, {from: 0, count: 1000, sort: 'depth', object}, signal) : {rows: []};
      if (signal.aborted) return;
      const rows = object === undefined || second === undefined ? answer.rows :
        answer.rows.filter(row => row.a === second || row.b === second);
      this.stage.contacts.show(this.model, rows, this.palette().contact, 0.02 * this.stage.camera.radius());
      this.stage.invalidate();
    } catch (error) {
      this.fail(error);
    }
  }

  private showLegend(): void {
    const boxes = legend(this.model, this.states, this.settings.values, this.palette());
    showLegend([...boxes, ...this.stage.octants.legend()]);
  }

  // A notice that stays, such as the end of the program.
  note(text: string): void {
    if (!this.notes.includes(text)) this.notes.push(text);
    this.showNotices();
  }

  private showNotices(): void {
    const {stage, model} = this;
    const near = this.near.shown;
    const texts = [...this.notes, ...(near ? [] : model.view.notices)];
    const number = (value: number): string => value.toLocaleString('en-US');
    if (near) texts.push(`${number(near.objects.length)} of ${number(near.total)} more boxes near the target are drawn.`);
    const {octants, lines} = this.settings.values;
    const {edges, total} = stage.octants;
    if (octants && total > edges.count) texts.push(`${number(edges.count)} of ${number(total)} octants are drawn.`);
    const withLines = Math.min(pairLimit, model.frame.pairs.length / 2);
    const {pairs} = model.frame.info;
    if (lines === 'all' && withLines < pairs) texts.push(`The first ${number(withLines)} of ${number(pairs)} pairs have lines.`);
    if (stage.shapes.leftOut > 0) texts.push(`${number(stage.shapes.leftOut)} shapes are left out.`);
    showNotices(texts);
  }
}
