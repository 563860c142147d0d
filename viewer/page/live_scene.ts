// Applies live frames to the model: boxes, pairs and numbers of partners.
import type {LiveFrame} from './live_feed.ts';
import type {SceneModel} from './scene_model.ts';

export class LiveScene {
  private pairs = new Map<string | number, readonly [number, number]>();
  private partial = false;
  // A whole frame has come.
  private whole = false;

  constructor(private readonly model: SceneModel) {}

  // Returns whether the rows changed, and not only their boxes.
  apply(live: LiveFrame): boolean {
    const rowsChanged = live.whole && !(this.whole && live.shown === this.model.rows && same(live.shownObjects, this.model.objects));
    const {frame} = this.model;
    frame.began = live.beganList;
    frame.ended = live.endedList;
    let [began, ended] = [live.began, live.ended];
    if (!live.whole) this.change(live);
    else if (this.whole && !this.partial && live.listed === live.pairs) [began, ended] = this.compare(live);
    else this.replace(live);
    this.whole = true;
    frame.info = {
      frame: live.frame, objects: live.existing, pairs: live.pairs, pairs_listed: this.pairs.size, began, ended, seconds: {step: live.stepSeconds},
    };
    frame.pairs = this.list();
    this.countPartners();
    return rowsChanged;
  }

  // Finds the pairs that began or ended before a whole frame, which comes if it is shorter than the difference. Returns both numbers.
  private compare(live: LiveFrame): [number, number] {
    const {frame} = this.model;
    const old = this.pairs;
    this.pairs = new Map();
    this.replace(live);
    const missing = (from: Map<string | number, readonly [number, number]>, other: Map<string | number, unknown>): Uint32Array =>
      Uint32Array.from([...from].filter(([name]) => !other.has(name)).flatMap(([, pair]) => pair));
    frame.began = missing(this.pairs, old);
    frame.ended = missing(old, this.pairs);
    return [frame.began.length / 2, frame.ended.length / 2];
  }

  private replace(live: LiveFrame): void {
    const {model} = this;
    model.rows = live.shown;
    model.view.objects = live.objects;
    model.view.shown = live.shown;
    model.setShown(live.shownObjects);
    model.frame.boxes = live.boxes;
    model.frame.levels = null;
    this.partial = live.listed < live.pairs;
    this.pairs.clear();
    this.add(live.pairList);
  }

  private change(live: LiveFrame): void {
    const {boxes} = this.model.frame;
    live.movedRows.forEach((row, k) => boxes.set(live.boxes.subarray(6 * k, 6 * k + 6), 6 * row));
    if (this.partial) return;
    for (let k = 0; k + 1 < live.endedList.length; k += 2) this.pairs.delete(key(live.endedList[k]!, live.endedList[k + 1]!));
    this.add(live.beganList);
  }

  private add(list: Uint32Array): void {
    for (let k = 0; k + 1 < list.length; k += 2) this.pairs.set(key(list[k]!, list[k + 1]!), [list[k]!, list[k + 1]!]);
  }

  private list(): Uint32Array {
    const list = new Uint32Array(2 * this.pairs.size);
    let at = 0;
    for (const pair of this.pairs.values()) {
      list[at++] = pair[0];
      list[at++] = pair[1];
    }
    return list;
  }

  private countPartners(): void {
    const {model} = this;
    const partners = new Uint32Array(model.rows);
    for (const object of model.frame.pairs) {
      const row = model.rowOf(object);
      if (row >= 0) partners[row]! += 1;
    }
    model.frame.partners = partners;
  }
}

function same(a: Uint32Array | null, b: Uint32Array | null): boolean {
  return a === b || (a !== null && b !== null && a.length === b.length && a.every((value, k) => value === b[k]));
}

// Numbers are faster than texts, and exact for all but very large indices.
function key(a: number, b: number): string | number {
  return a < 2097152 ? a * 4294967296 + b : `${a} ${b}`;
}
