// Connects the parts of the page: a change of the frame, the selection or a setting reaches all that show it.
import * as THREE from 'three';
import {legend, type LegendEntry, type Look, opacityOf, paint, type Palette, paletteOf} from './colours.ts';
import {toneOf} from './collision.ts';
import {counted, isAbort, messageOf} from './dom.ts';
import {contactColour} from './contact_layer.ts';
import {glassOpacity, Pass, passOf} from './draw_pass.ts';
import {bestView, type Focus, focusOf, leastArrow, sectionOf} from './focus.ts';
import {hideLabel, octantText, placeDepths, showLabel, showScale} from './hover.ts';
import {isDark} from './layout.ts';
import {Link} from './link.ts';
import {Near} from './near.ts';
import {Options} from './options.ts';
import {Overview, type Place} from './overview.ts';
import {pairLimit} from './pair_layer.ts';
import {say, showLegend, showNotices, showSummary, showTitle} from './panel.ts';
import {Picker} from './picker.ts';
import {Pointer} from './pointer.ts';
import {isGone} from './row_list.ts';
import type {Frame, SceneModel} from './scene_model.ts';
import {Search} from './search.ts';
import {Selection} from './selection.ts';
import type {Name, Settings} from './settings.ts';
import type {Source} from './source.ts';
import type {Stage} from './stage.ts';
import {computeStates, State} from './states.ts';
import {Table} from './table.ts';
import type {Timeline} from './timeline.ts';
import type {Collision, Collisions, Point} from './types.ts';

// More ghosts than this are boxes, which are drawn faster than shapes.
const ghostShapes = 20_000;
// More marks would cover the small picture.
const markedPlaces = 200;

export class App {
  readonly selection: Selection;
  readonly table: Table;
  readonly search: Search;
  options: Options | null = null;
  readonly link: Link;
  readonly near: Near;
  readonly overview: Overview;
  timeline: Timeline | null = null;
  private readonly picker: Picker;
  private states: Uint8Array = new Uint8Array(0);
  private colours: Uint8Array = new Uint8Array(0);
  private nearColours: Uint8Array = new Uint8Array(0);
  private octantRequest = new AbortController();
  private contactRequest = new AbortController();
  private contactsNow = '';
  private contactRows: readonly Collision[] | null = null;
  private ghostBoxes = false;
  private look: Look = {ghosts: false, glass: -1};
  // The camera was placed to see the selection.
  private framed = false;
  // Where the selected pair is, and the angles from which it is seen best, once they are needed.
  private focus: Focus | null = null;
  private view: {focus: Focus; yaw: number; pitch: number} | null = null;
  // The page shall select the worst collision as soon as there is one.
  private waitsForWorst = false;
  private readonly notes: string[] = [];
  private low: Point;
  private high: Point;

  constructor(readonly source: Source, readonly model: SceneModel, readonly settings: Settings, readonly stage: Stage, camera: string | null) {
    const failed = (error: unknown): void => this.fail(error);
    this.selection = new Selection(source, model, {
      changed: () => this.selectionChanged(), clear: () => void this.clearSelection(), zoom: () => this.zoomToSelection(),
      onlySelection: () => this.toggleOnlySelection(), section: () => this.toggleSection(), copyLink: () => void this.copyLink(),
      place: () => this.place(),
    });
    this.table = new Table(source, model, {selected: () => this.selection.objects, open: row => void this.openCollision(row), failed});
    this.search = new Search(source, model, object => void this.openObject(object), failed);
    this.near = new Near(source, model, this.stage, () => this.recolour(), failed);
    this.picker = new Picker(this);
    this.overview = new Overview(this.stage, () => this.placeInScene(), () => this.zoomAll());
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

  // The pass in which a row is drawn, or -1 if it is hidden.
  passOf(row: number): number {
    return passOf(this.colours[4 * row + 3]!);
  }

  nearPassOf(row: number): number {
    return passOf(this.nearColours[4 * row + 3]!);
  }

  fail(error: unknown): void {
    if (!isAbort(error)) say(messageOf(error));
  }

  // Reads and shows a frame of a scene, or shows one that is being read.
  async showFrame(frame: number, reading: Promise<Frame> = this.model.readFrame(this.source, frame)): Promise<void> {
    this.model.frame = await reading;
    this.frameChanged(false);
    this.frameShown(frame);
  }

  // Shows the first frame, with its worst collision selected. `rows` are those of the table, the worst first.
  async showWorst(reading: Promise<Frame>, rows: Promise<Collisions>): Promise<void> {
    this.model.frame = await reading;
    const answer = await rows.catch((error: unknown) => this.fail(error));
    const worst = answer ? this.table.use(answer, 0) : null;
    if (worst) this.selection.begin(worst);
    this.frameChanged(false);
    if (worst) this.markSelection();
    if (this.focus) this.zoomToContact(this.focus);
    this.frameShown(this.model.frame.info.frame);
  }

  private frameShown(frame: number): void {
    this.timeline?.show(frame);
    if (this.options) this.followFrame().catch((error: unknown) => this.fail(error));
  }

  // The panel of settings, which the first picture does not need.
  startOptions(): void {
    this.options = new Options(this.settings, this.model);
  }

  async copyLink(): Promise<void> {
    say(await this.link.copy() ? 'Link copied' : 'The link is in the address bar');
  }

  // Names and details have come: what shows them shows them now.
  async namesArrived(): Promise<void> {
    this.selection.namesArrived();
    this.recolour();
    await this.table.namesArrived();
  }

  // A running scene may have no collision yet.
  selectWorstSoon(): void {
    this.waitsForWorst = true;
    this.selectWorst();
  }

  selectWorst(): void {
    const {worst} = this.table;
    if (!this.waitsForWorst || !worst) return;
    void this.selection.select([worst.a, worst.b], worst);
  }

  // Reads what the picture of a frame did not need: the table and the selection, unless they were read with it, octants and pairs.
  async followFrame(withTable = true): Promise<void> {
    const {model, source, settings} = this;
    const {frame} = model;
    const live = model.view.kind === 'live';
    const levels = settings.values.colour === 'level' || (source.exported && model.view.has.octants);
    await Promise.all([withTable ? this.table.load(0) : null, this.showOctants(), live ? null : model.readPairs(source, frame),
      levels ? model.readLevels(source) : null]);
    if (frame !== model.frame && !live) return;
    if (withTable) await this.selection.refresh();
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
    this.selection.frameChanged();
    if (this.selection.objects.length === 1) this.selection.partners = model.partnersOf(this.selection.objects[0]!);
    this.updateFocus();
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
    const look = this.look = this.lookOf();
    this.states = computeStates(model, this.selection);
    if (this.colours.length !== 4 * model.rows) this.colours = new Uint8Array(4 * model.rows);
    paint(model, this.states, {values: settings.values, palette, look}, this.colours);
    stage.ghosts = look.ghosts;
    stage.glass = look.glass >= 0;
    this.ghostBoxes = look.ghosts && settings.values.style === 'shapes' && stage.shapes.instances > ghostShapes;
    stage.boxes.setColours(this.boxColours());
    stage.shapes.setColours(this.ghostBoxes ? this.withoutGhosts() : this.colours);
    this.colourNear(palette);
    this.outline(palette);
    stage.pairs.show(model, settings.values.lines, objects, partners, palette);
    this.restyle();
    this.showLegend();
    void this.showContacts();
    this.showNotices();
    this.overview.changed();
  }

  // While something is selected, the rest are ghosts. In a pair, an object that encloses the other one is glass, if no section opens it.
  private lookOf(): Look {
    const {objects} = this.selection;
    const {ghosts, section} = this.settings.values;
    const glass = this.focus && this.focus.glass >= 0 && section === 'none' ? objects[this.focus.glass]! : -1;
    return {ghosts: objects.length > 0 && ghosts, glass};
  }

  private updateFocus(): void {
    const {objects, collision, isPair} = this.selection;
    const [first, second] = isPair ? objects.map(object => this.picker.part(object)) : [];
    const known = first && second && !first.box.isEmpty() && !second.box.isEmpty();
    this.focus = known ? focusOf(collision, [first, second], point => this.model.toRelative(point), this.stage.camera.radius()) : null;
  }

  private place(): Point | null {
    this.updateFocus();
    return this.focus && this.model.toAbsolute(this.focus.mark.toArray());
  }

  // Returns what the small picture of the scene shows. The picture is hidden (null) if the large one shows the whole scene, or if the others are hidden.
  private placeInScene(): Place | null {
    const {focus} = this;
    const seesAll = this.stage.camera.unmoved && !this.framed;
    if (!focus || seesAll || this.settings.values.show === 'selection') return null;
    return {focus, view: this.viewOf(focus), others: this.worstPlaces(), colour: contactColour(this.selection.collision, this.palette())};
  }

  // The places of the worst collisions: those in which objects overlap, as far as the table has them.
  private worstPlaces(): THREE.Vector3[] {
    const worst = this.table.known.filter(row => toneOf(row.class ?? '') === 'bad' && row.contacts?.length).slice(0, markedPlaces);
    return worst.map(row => new THREE.Vector3(...this.model.toRelative(row.contacts![0]!.point)));
  }

  private viewOf(focus: Focus): {yaw: number; pitch: number} {
    if (this.view?.focus !== focus) this.view = {focus, ...bestView(focus, this.stage.camera)};
    return this.view;
  }

  // Shapes have come: a contact may be seen better from another side.
  shapesArrived(): void {
    const framed = this.focus && this.stage.camera.unmoved && this.framed;
    this.updateFocus();
    this.recolour();
    if (framed) this.zoomToSelection();
  }

  selectionChanged(): void {
    this.waitsForWorst = false;
    this.updateFocus();
    this.recolour();
    this.markSelection();
  }

  private markSelection(): void {
    document.documentElement.dataset.selected = this.selection.objects.join(',');
    this.table.selectionChanged();
    this.link.changed();
  }

  // A setting changed that only concerns how layers are drawn.
  restyle(): void {
    const {focus, stage} = this;
    const wanted = focus && this.settings.values.section === 'contact';
    const view = wanted ? this.viewOf(focus) : null;
    stage.contactCut = view ? sectionOf(focus!, stage.camera.direction(view.yaw, view.pitch)) : null;
    stage.apply(this.settings.values, this.low, this.high);
    const cut = focus && stage.section();
    const {states, contact} = this.palette();
    if (cut) stage.caps.show(focus!.parts, cut, [states[State.selected]!, states[State.second]!, contact]);
    else stage.caps.clear();
  }

  zoomAll(): void {
    this.framed = false;
    this.stage.camera.fitScene();
    this.stage.moved();
  }

  // Zooms to the contact of a pair, or to the selected object.
  zoomToSelection(): void {
    if (this.focus) return this.zoomToContact(this.focus);
    const box = new THREE.Box3();
    for (const object of this.selection.objects) this.picker.addBox(box, object);
    if (box.isEmpty()) return;
    const size = box.getSize(new THREE.Vector3()).length();
    box.expandByScalar(Math.max(0.6 * size, 1e-4 * this.stage.camera.radius()));
    this.stage.camera.fit(box.min.toArray(), box.max.toArray());
    this.framed = true;
    this.stage.moved();
  }

  private zoomToContact(focus: Focus): void {
    const {camera} = this.stage;
    const {yaw, pitch} = this.viewOf(focus);
    camera.look(yaw, pitch);
    const half = new THREE.Vector3().setScalar(0.65 * focus.reach);
    camera.fit(focus.middle.clone().sub(half).toArray(), focus.middle.clone().add(half).toArray());
    this.framed = true;
    this.stage.moved();
  }

  // Shows the whole scene again, if the camera still shows the selection alone.
  async clearSelection(): Promise<void> {
    const back = this.framed && this.stage.camera.unmoved;
    const cleared = this.selection.select([]);
    if (back) this.zoomAll();
    return cleared;
  }

  toggleOnlySelection(): void {
    this.settings.set('show', this.settings.values.show === 'selection' ? 'all' : 'selection');
  }

  toggleSection(): void {
    this.settings.set('section', this.settings.values.section === 'contact' ? 'none' : 'contact');
  }

  // Whether the selection has a contact for a section.
  hasContact(): boolean {
    return this.focus !== null;
  }

  async openObject(object: number): Promise<void> {
    return this.openAll([object]);
  }

  async openCollision(row: Collision): Promise<void> {
    if (isGone(row)) return this.selection.showGone(row);
    return this.openAll([row.a, row.b], row);
  }

  // Selects objects and zooms to them. The places of objects that are not drawn, and the contacts of a pair, must be read first.
  async openAll(objects: number[], row: Collision | null = null): Promise<void> {
    const reading = this.selection.select(objects, row).catch((error: unknown) => this.fail(error));
    const known = row !== null || (objects.length < 2 && objects.every(object => this.model.rowOf(object) >= 0));
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
      this.overview.changed();
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
    if (['colour', 'style', 'show', 'others', 'ghosts', 'lines', 'contacts', 'section'].includes(name)) return this.recolour();
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
    const {model} = this;
    const about = (['type', 'level'] as const).map(detail => model.detailOf(object, detail)).filter(text => text).join(' · ');
    return showLabel(this.stage, [model.labelOf(object), about, `#${model.numberOf(object)}`].filter(text => text).join('\n'), x, y);
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
    showScale(stage, model.view.unit);
  }

  // The colours of the boxes: a row whose shape is drawn instead has no box.
  private boxColours(): Uint8Array {
    const {model, stage, settings} = this;
    if (settings.values.style !== 'shapes' || !model.geometry || stage.shapes.shapes.size === 0) return this.colours;
    const colours = this.colours.slice();
    for (let row = 0; row < model.rows; ++row) {
      const isShape = stage.shapes.shapes.has(model.geometry[row]!) && !(this.ghostBoxes && this.passOf(row) === Pass.ghost);
      if (isShape) colours[4 * row + 3] = 0;
    }
    return colours;
  }

  private withoutGhosts(): Uint8Array {
    const colours = this.colours.slice();
    for (let row = 0; row < this.model.rows; ++row) if (this.passOf(row) === Pass.ghost) colours[4 * row + 3] = 0;
    return colours;
  }

  private colourNear(palette: Palette): void {
    const near = this.near.shown;
    if (!near) return;
    const colours = this.nearColours = new Uint8Array(4 * near.objects.length);
    const {objects, partners} = this.selection;
    const others = new Set(partners);
    const {ghosts, glass} = this.look;
    near.objects.forEach((object, k) => {
      const state = object === objects[0] ? State.selected : object === objects[1] ? State.second : others.has(object) ? State.partner :
        near.partners[k] ? State.colliding : State.free;
      const opacity = object === glass ? glassOpacity : opacityOf(state, {...this.settings.values, others: 1}, ghosts);
      colours.set([...(ghosts && state < State.partner ? palette.ghost : palette.states[state]!), opacity], 4 * k);
    });
    this.stage.near.setColours(colours);
  }

  private outline(palette: Palette): void {
    const {objects, isPair} = this.selection;
    // The shapes of a pair are seen better without boxes around them.
    const marked = objects.map((object, k) => ({part: this.picker.part(object), colour: palette.states[k === 0 ? State.selected : State.second]!}))
      .filter(({part}) => !part.box.isEmpty() && !(isPair && part.shape));
    const bounds = new Float32Array(6 * marked.length);
    marked.forEach(({part: {box}}, k) => bounds.set([...box.min.toArray(), ...box.max.toArray()], 6 * k));
    this.stage.outlines.set(bounds, marked.length, k => marked[k]!.colour);
  }

  // Shows the contacts of the selection or of all collisions. Those of a pair are known already.
  private async showContacts(): Promise<void> {
    const {view, frame} = this.model;
    const {contacts} = this.settings.values;
    const {objects, isPair} = this.selection;
    const wanted = view.has.contacts && (contacts === 'all' || (contacts === 'selection' && objects.length === 1));
    if (!wanted) return this.drawContacts([]);
    const object = contacts === 'all' ? undefined : objects[0];
    const now = `${frame.info.frame} ${object ?? ''}`;
    if (now === this.contactsNow && this.contactRows) return this.drawContacts(this.contactRows);
    if (isPair) this.drawContacts([]);
    if (now === this.contactsNow) return;
    this.contactsNow = now;
    this.contactRows = null;
    this.contactRequest.abort();
    this.contactRequest = new AbortController();
    const {signal} = this.contactRequest;
    try {
      const {rows} = await this.source.collisions(frame.info.frame, {from: 0, count: 1000, sort: 'worst', object}, signal);
      if (signal.aborted) return;
      this.contactRows = rows;
      this.drawContacts(rows);
    } catch (error) {
      this.fail(error);
    }
  }

  private drawContacts(rows: readonly Collision[]): void {
    const {focus, stage} = this;
    const {collision} = this.selection;
    const pair = focus && collision && this.settings.values.contacts !== 'none' ? {row: collision, focus} : null;
    const others = pair ? rows.filter(row => row.a !== collision!.a || row.b !== collision!.b) : rows;
    stage.contacts.show(this.model, pair ? [...others, collision!] : others, pair,
      {palette: this.palette(), least: focus ? leastArrow(focus) : 0.02 * stage.camera.radius()});
    stage.invalidate();
  }

  private showLegend(): void {
    const {objects, isPair} = this.selection;
    const names = isPair ? objects.map((_, k) => this.selection.labelOf(k)) : null;
    const boxes = legend(this.model, this.states, {values: this.settings.values, palette: this.palette(), look: this.look}, names);
    const common = this.stage.caps.hasCommon ? [{text: 'in both', colour: this.palette().contact}] : [];
    showLegend([...boxes.slice(0, 2), ...common, ...boxes.slice(2), ...this.contactLegend(), ...this.stage.octants.legend()]);
  }

  // What the marks of the selected collision mean.
  private contactLegend(): LegendEntry[] {
    const {collision} = this.selection;
    const first = collision?.contacts?.[0];
    if (!this.focus || !first || this.settings.values.contacts === 'none') return [];
    const colour = contactColour(collision, this.palette());
    const contacts = {text: 'contacts, with the deepest labelled', colour, mark: '●'};
    if (!first.normal || first.depth === undefined) return [contacts];
    const object = this.selection.objects[0] === collision!.a ? 'second' : 'first';
    const stretched = Math.abs(first.depth) < leastArrow(this.focus) ? ', longer than the depth' : '';
    return [contacts, {text: `the way out of it for the ${object} object${stretched}`, colour, mark: '→'}];
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
    if (stage.shapes.leftOut > 0) texts.push(`${counted(stage.shapes.leftOut, 'shape is', 'shapes are')} left out.`);
    showNotices(texts);
  }
}
