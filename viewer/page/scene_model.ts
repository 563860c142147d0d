// The arrays of the shown objects and of one frame, as they came from the source.
import {Missing, type Source} from './source.ts';
import {tail} from './dom.ts';
import type {Collision, DetailColumns, Found, FrameInfo, ObjectInfo, Point, View} from './types.ts';

export const noPairs = new Uint32Array(0);

export interface Frame {
  info: FrameInfo;
  boxes: Float32Array;
  poses: Float32Array | null;
  partners: Uint32Array;
  // The class of the worst pair of each row's object, if exact tests found classes.
  classes: Uint8Array | null;
  levels: Uint8Array | null;
  pairs: Uint32Array;
  began: Uint32Array;
  ended: Uint32Array;
}

// The details that a file may give of an object, in the order in which the page shows them.
export const detailNames = ['label', 'type', 'id', 'parent', 'level', 'material'] as const;
export type DetailName = typeof detailNames[number];

export class SceneModel {
  rows = 0;
  objects: Uint32Array | null = null;
  groups: Uint32Array | null = null;
  geometry: Uint32Array | null = null;
  names: string[] | null = null;
  details: DetailColumns | null = null;
  frame: Frame = {
    info: {frame: 0, pairs: 0}, boxes: new Float32Array(0), poses: null, partners: noPairs, classes: null, levels: null, pairs: noPairs, began: noPairs,
    ended: noPairs,
  };
  private rowsByObject: Map<number, number> | null = null;
  // The number of objects of each label.
  private labels: Map<string, number> | null = null;

  constructor(readonly view: View) {
    this.rows = view.shown;
  }

  setShown(objects: Uint32Array | null): void {
    this.objects = objects;
    this.rowsByObject = null;
    if (!objects) return;
    this.rowsByObject = new Map();
    objects.forEach((object, row) => this.rowsByObject!.set(object, row));
  }

  objectOf(row: number): number {
    return this.objects ? this.objects[row]! : row;
  }

  rowOf(object: number): number {
    if (this.rowsByObject) return this.rowsByObject.get(object) ?? -1;
    return object < this.rows ? object : -1;
  }

  nameOf(object: number): string {
    const row = this.rowOf(object);
    return row >= 0 ? this.names?.[row] ?? '' : '';
  }

  // A detail of an object; empty if it is not known.
  detailOf(object: number, detail: DetailName): string {
    const column = this.details?.[detail] as readonly number[] | undefined;
    return column ? this.details!.words[column[this.rowOf(object)] ?? 0]! : '';
  }

  hasDetail(detail: DetailName): boolean {
    return this.details?.[detail] !== undefined;
  }

  // What people call an object: its label, or the end of its name, or its number. Labels that several objects have get more of the path, or
  // the number.
  labelOf(object: number, name = this.nameOf(object)): string {
    const label = this.detailOf(object, 'label') || tail(name);
    if (!label) return `object ${this.numberOf(object)}`;
    if (!this.isShared(label)) return label;
    const longer = this.detailOf(object, 'label') ? label : tail(name, 2);
    return longer === label || this.isShared(longer) ? `${label} #${this.numberOf(object)}` : longer;
  }

  // Whether several objects have this label, or this end of their name.
  private isShared(label: string): boolean {
    if (!this.labels) {
      this.labels = new Map();
      for (let row = 0; row < this.rows; ++row) {
        const own = this.detailOf(this.objectOf(row), 'label');
        const name = this.names?.[row] ?? '';
        for (const text of new Set(own ? [own] : [tail(name), tail(name, 2)])) this.labels.set(text, (this.labels.get(text) ?? 0) + 1);
      }
    }
    return (this.labels.get(label) ?? 0) > 1;
  }

  // The label of an object of a collision, which may be gone or not be drawn.
  sideLabel(row: Collision, side: 'a' | 'b'): string {
    return row[`label_${side}`] || (row[side] < 0 ? tail(row[`name_${side}`] ?? '') : this.labelOf(row[side], row[`name_${side}`] ?? this.nameOf(row[side])));
  }

  // The number of an object in results, which number the second set of a search from 0.
  numberOf(object: number): number {
    const second = this.view.second_set ?? Infinity;
    return object < second ? object : object - second;
  }

  // The file of an object, if there are several.
  fileOf(object: number): string {
    return this.view.files.filter(file => file.first <= object).pop()?.name ?? '';
  }

  exists(row: number): boolean {
    return !Number.isNaN(this.frame.boxes[6 * row]!);
  }

  // The middle of a row's box, relative to the origin.
  middle(row: number): Point {
    const boxes = this.frame.boxes;
    const axis = (k: number): number => 0.5 * (boxes[6 * row + k]! + boxes[6 * row + k + 3]!);
    return [axis(0), axis(1), axis(2)];
  }

  toRelative(point: Point): Point {
    const o = this.view.origin;
    return [point[0] - o[0], point[1] - o[1], point[2] - o[2]];
  }

  toAbsolute(point: Point): Point {
    const o = this.view.origin;
    return [point[0] + o[0], point[1] + o[1], point[2] + o[2]];
  }

  partnersOf(object: number, limit = 1000): number[] {
    const found: number[] = [];
    const pairs = this.frame.pairs;
    for (let k = 0; k + 1 < pairs.length && found.length < limit; k += 2) {
      if (pairs[k] === object) found.push(pairs[k + 1]!);
      else if (pairs[k + 1] === object) found.push(pairs[k]!);
    }
    return found.sort((a, b) => a - b);
  }

  // Objects whose name has the text, for pages whose source cannot search.
  search(text: string, limit: number): Found {
    const lower = text.toLowerCase();
    const result: Found = {total: 0, found: []};
    for (let row = 0; row < this.rows; ++row) {
      const object = this.objectOf(row);
      if (![this.names?.[row] ?? '', ...detailNames.map(detail => this.detailOf(object, detail))].some(word => word.toLowerCase().includes(lower))) continue;
      result.total += 1;
      if (result.found.length < limit) result.found.push({index: object, name: this.nameOf(object)});
    }
    return result;
  }

  // All that the arrays say of an object, for pages without the address object/F/I.json.
  describe(object: number): ObjectInfo {
    const row = this.rowOf(object);
    const partners = this.partnersOf(object);
    const info: ObjectInfo = {index: object, row, name: this.nameOf(object), partners, partner_count: partners.length};
    if (row < 0) return info;
    const details = detailNames.map(detail => [detail, this.detailOf(object, detail)] as const).filter(([, text]) => text);
    if (details.length) info.details = Object.fromEntries(details);
    info.partner_count = Math.max(this.frame.partners[row] ?? 0, partners.length);
    if (this.frame.levels) info.level = this.frame.levels[row];
    if (this.groups) info.groups = this.groups[row];
    const b = this.frame.boxes.subarray(6 * row, 6 * row + 6);
    if (this.exists(row)) {
      info.box = {min: this.toAbsolute([b[0]!, b[1]!, b[2]!]), max: this.toAbsolute([b[3]!, b[4]!, b[5]!])};
    }
    return info;
  }

  // Reads what the first picture needs and does not depend on the frame. The first whole frame of a live scene says which objects are shown.
  async load(source: Source): Promise<void> {
    const {has} = this.view;
    const [shown, geometry] = await Promise.all([words(source, 'shown.u32', has.rows), words(source, 'geometry.u32', has.shapes)]);
    this.setShown(shown);
    this.geometry = geometry;
  }

  async loadRows(source: Source): Promise<void> {
    const {has} = this.view;
    [this.groups, this.names, this.details] = await Promise.all([
      words(source, 'groups.u32', has.groups), has.names ? orNull(source.json<string[]>('names.json')) : null,
      has.details ? orNull(source.json<DetailColumns>('details.json')) : null,
    ]);
    this.labels = null;
  }

  // Reads what the picture of a frame needs. Pairs and levels come later.
  async readFrame(source: Source, frame: number): Promise<Frame> {
    const {has} = this.view;
    const events = (name: string): Promise<ArrayBuffer | null> =>
      has.events ? orNull(source.bytes(`${name}/${frame}.u32`)) : Promise.resolve(null);
    const [info, boxes, partners, poses, classes, began, ended] = await Promise.all([
      source.json<FrameInfo>(`frame/${frame}.json`), source.bytes(`frame/${frame}.f32`), orNull(source.bytes(`partners/${frame}.u32`)),
      has.shapes ? orNull(source.bytes(`poses/${frame}.f32`)) : null,
      has.classes ? orNull(source.bytes(`classes/${frame}.u8`)) : null, events('began'), events('ended'),
    ]);
    return {
      info, boxes: new Float32Array(boxes), poses: poses && new Float32Array(poses), levels: null,
      classes: classes && new Uint8Array(classes),
      partners: partners ? list(partners) : new Uint32Array(this.rows), pairs: noPairs, began: list(began), ended: list(ended),
    };
  }

  // Reads the pairs of a frame.
  async readPairs(source: Source, frame: Frame): Promise<void> {
    frame.pairs = list(await orNull(source.bytes(`pairs/${frame.info.frame}.u32`)));
  }

  // Reads the levels of the present frame, for which the program may have to build an octree.
  async readLevels(source: Source): Promise<void> {
    const {frame} = this;
    if (frame.levels || this.view.kind === 'live') return;
    const levels = await orNull(source.bytes(`levels/${frame.info.frame}.u8`));
    frame.levels = levels && new Uint8Array(levels);
  }
}

function list(bytes: ArrayBuffer | null): Uint32Array {
  return bytes ? new Uint32Array(bytes) : noPairs;
}

async function words(source: Source, address: string, wanted: boolean): Promise<Uint32Array | null> {
  const bytes = wanted ? await orNull(source.bytes(address)) : null;
  return bytes && new Uint32Array(bytes);
}

async function orNull<T>(answer: Promise<T>): Promise<T | null> {
  try {
    return await answer;
  } catch (error) {
    if (error instanceof Missing) return null;
    throw error;
  }
}
