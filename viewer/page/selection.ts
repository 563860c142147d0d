// The selected objects: one, or the two of a pair.
import {counted, isAbort} from './dom.ts';
import {isOpen} from './layout.ts';
import {say, speak} from './panel.ts';
import type {SceneModel} from './scene_model.ts';
import {type PairView, SelectionPanel} from './selection_panel.ts';
import {Missing, type Source, Unreachable} from './source.ts';
import type {Collision, ObjectInfo, Point} from './types.ts';

export interface SelectionActions {
  changed(): void;
  clear(): void;
  zoom(): void;
  onlySelection(): void;
  section(): void;
  copyLink(): void;
  place(): Point | null;
}

export class Selection {
  objects: number[] = [];
  partners: number[] = [];
  // The answer about a single object, and the collision of a pair.
  info: ObjectInfo | null = null;
  collision: Collision | null = null;
  private readonly panel: SelectionPanel;
  private request = 0;
  // The frame that `collision` was read for, and whether the page could find it.
  private frame = 0;
  private listed = true;

  constructor(private readonly source: Source, private readonly model: SceneModel, private readonly actions: SelectionActions) {
    this.panel = new SelectionPanel(model, {...actions, select: objects => void this.select(objects)});
  }

  get isPair(): boolean {
    return this.objects.length === 2;
  }

  // Shows a collision of an older result. Its objects may no longer exist, so nothing is selected.
  showGone(row: Collision): void {
    this.objects = [];
    this.partners = [];
    this.collision = null;
    this.request += 1;
    this.panel.showPair({objects: [-1, -1], row, listed: true});
    this.actions.changed();
  }

  // Shows the panel again, with names that have come.
  namesArrived(): void {
    if (this.isPair) this.panel.showPair(this.pairView());
    else if (this.info) this.panel.showObject(this.info);
  }

  // Selects a pair before anything is drawn: nothing changes on the page yet but the panel.
  begin(row: Collision): void {
    this.objects = [row.a, row.b];
    this.collision = row;
    this.frame = this.model.frame.info.frame;
    this.panel.showPair(this.pairView());
  }

  // Forgets the collision of another frame: its contacts and its depth are not those of this frame, which are read later. The frames of a
  // running scene follow each other faster than they can be asked about.
  frameChanged(): void {
    if (this.model.view.kind !== 'live' && this.frame !== this.model.frame.info.frame) this.collision = null;
  }

  // Selects objects. `row` is the collision of a pair, if it is known.
  async select(objects: number[], row: Collision | null = null): Promise<void> {
    const chosen = this.objects = [...new Set(objects)].filter(k => Number.isInteger(k) && k >= 0 && k < this.model.view.objects).slice(0, 2);
    this.request += 1;
    this.info = null;
    this.collision = this.isPair ? row : null;
    this.frame = this.model.frame.info.frame;
    this.partners = this.objects.length === 1 ? this.model.partnersOf(this.objects[0]!) : [];
    if (this.objects.length === 0) this.panel.clear();
    if (this.collision) this.panel.showPair(this.pairView());
    this.actions.changed();
    if (!this.collision) await this.refresh();
    if (chosen.length && chosen === this.objects) this.tell();
  }

  // Reads the selection again, for another frame or another selection.
  async refresh(): Promise<void> {
    if (this.objects.length === 0) return;
    const request = ++this.request;
    const {objects} = this;
    const {frame} = this.model.frame.info;
    const read = this.isPair ? this.readPair(objects) : this.readObject(objects[0]!);
    const found = await read;
    if (request !== this.request) return;
    if (this.isPair) {
      this.collision = found as Collision | null;
      this.frame = frame;
      this.panel.showPair(this.pairView());
    } else {
      this.info = found as ObjectInfo;
      this.partners = this.info.partners;
      this.panel.showObject(this.info);
    }
    this.actions.changed();
  }

  private async readPair([object, other]: number[]): Promise<Collision | null> {
    try {
      const answer = await this.source.collisions(this.model.frame.info.frame, {from: 0, count: 1, sort: 'worst', object, with: other});
      this.listed = !answer.partial;
      return answer.rows[0] ?? null;
    } catch (error) {
      if (error instanceof Missing || error instanceof Unreachable || isAbort(error)) return this.collision;
      throw error;
    }
  }

  private async readObject(object: number): Promise<ObjectInfo> {
    if (this.source.exported) return this.model.describe(object);
    try {
      return await this.source.json<ObjectInfo>(`object/${this.model.frame.info.frame}/${object}.json`);
    } catch (error) {
      if (error instanceof Missing || error instanceof Unreachable) return this.model.describe(object);
      throw error;
    }
  }

  private pairView(): PairView {
    const {listed} = this;
    return {objects: [this.objects[0]!, this.objects[1]!], row: this.collision, listed};
  }

  // The label of a selected object. Objects that are not drawn have their names in the row.
  labelOf(which: number): string {
    const object = this.objects[which]!;
    const row = this.collision;
    if (row && (row.a === object || row.b === object)) return this.model.sideLabel(row, row.a === object ? 'a' : 'b');
    return this.model.labelOf(object);
  }

  // Says what is selected. With a closed panel nothing else names the selection.
  private tell(): void {
    const names = this.objects.map((_, k) => this.labelOf(k)).join(' and ');
    const word = this.collision?.class ? `, ${this.collision.class}` : '';
    const more = this.info ? `, ${counted(this.info.partner_count, 'partner', 'partners')}` : word;
    (isOpen('side') ? speak : say)(`${names} selected${more}`);
  }
}
