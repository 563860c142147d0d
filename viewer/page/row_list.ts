// All rows of a frame: which pass the filters, their order, and their groups. A row is a collision.
import {compareWorst} from './collision.ts';
import {pathBefore} from './dom.ts';
import type {DetailName, SceneModel} from './scene_model.ts';
import type {Collision} from './types.ts';

export const filterDetails = ['type', 'level', 'material'] as const;
export const changes = ['new', 'same', 'gone'] as const;
export const groupings = ['none', 'type', 'parent', 'level', 'material', 'object'] as const;
export type Grouping = typeof groupings[number];
export type Order = 'worst' | 'deepest' | 'name' | 'pair' | 'began';

// What rows must have. Empty sets and texts, and null, admit all rows. Without a chosen change, rows that are gone are left out.
export interface Filter {
  words: string;
  classes: ReadonlySet<string>;
  changes: ReadonlySet<string>;
  details: Readonly<Record<typeof filterDetails[number], string>>;
  from: number | null;
  to: number | null;
  object: number | null;
}

export interface Group {
  key: string;
  title: string;
  rows: Collision[];
}

const sides = ['a', 'b'] as const;
const collator = new Intl.Collator('en', {numeric: true});

export class RowList {
  private readonly texts = new Map<number, string>();

  constructor(private readonly model: SceneModel, readonly all: readonly Collision[]) {}

  select(filter: Filter, order: Order): Collision[] {
    const words = filter.words.toLowerCase().split(/\s+/).filter(word => word);
    const kept = this.all.filter(row => this.passes(row, filter) && this.hasWords(row, words));
    const byPair = (p: Collision, q: Collision): number => p.a - q.a || p.b - q.b;
    if (order === 'worst') return kept.sort((p, q) => Number(isGone(p)) - Number(isGone(q)) || compareWorst(p, q));
    if (order === 'deepest') return kept.sort((p, q) => (q.depth ?? -1) - (p.depth ?? -1) || byPair(p, q));
    if (order === 'name') return this.byName(kept);
    if (order === 'began') return kept.sort((p, q) => Number(q.change === 'began') - Number(p.change === 'began') || byPair(p, q));
    return kept.sort(byPair);
  }

  // The groups in the order of their first rows.
  group(rows: readonly Collision[], by: Grouping): Group[] {
    const found = new Map<string, Group>();
    for (const row of rows) {
      for (const [key, title] of this.keys(row, by)) {
        const group = found.get(key);
        if (group) group.rows.push(row);
        else found.set(key, {key, title, rows: [row]});
      }
    }
    return [...found.values()];
  }

  // The texts of a detail that objects of rows have.
  choices(detail: DetailName): string[] {
    const found = new Set(this.all.flatMap(row => sides.map(side => this.detail(row, side, detail))));
    found.delete('');
    return [...found].sort(collator.compare);
  }

  private passes(row: Collision, filter: Filter): boolean {
    if (filter.object !== null && row.a !== filter.object && row.b !== filter.object) return false;
    if (filter.classes.size && !filter.classes.has(row.class ?? '')) return false;
    if (filter.changes.size ? !filter.changes.has(row.change ?? '') : isGone(row)) return false;
    if (filter.from !== null && !(row.depth !== undefined && row.depth >= filter.from)) return false;
    if (filter.to !== null && !(row.depth !== undefined && row.depth <= filter.to)) return false;
    return filterDetails.every(detail => !filter.details[detail] || sides.some(side => this.detail(row, side, detail) === filter.details[detail]));
  }

  // Each word is part of a text about one of the two objects.
  private hasWords(row: Collision, words: readonly string[]): boolean {
    if (!words.length) return true;
    const texts = sides.map(side => this.textOf(row, side));
    return words.every(word => texts.some(text => text.includes(word)));
  }

  private textOf(row: Collision, side: 'a' | 'b'): string {
    const known = row[side] < 0 ? undefined : this.texts.get(row[side]);
    if (known !== undefined) return known;
    const details = (['label', 'type', 'id', 'parent', 'level', 'material'] as const).map(detail => this.detail(row, side, detail));
    const text = [this.nameOf(row, side), ...details, `#${this.model.numberOf(row[side])}`].join('\n').toLowerCase();
    if (row[side] >= 0) this.texts.set(row[side], text);
    return text;
  }

  private nameOf(row: Collision, side: 'a' | 'b'): string {
    return row[`name_${side}`] ?? this.model.nameOf(row[side]);
  }

  private detail(row: Collision, side: 'a' | 'b', detail: DetailName): string {
    if (row[side] >= 0) return this.model.detailOf(row[side], detail);
    return detail === 'label' || detail === 'type' || detail === 'id' ? row[`${detail}_${side}`] ?? '' : '';
  }

  private byName(rows: Collision[]): Collision[] {
    const labels = new Map(rows.map(row => [row, sides.map(side => this.model.sideLabel(row, side)).join('\n')]));
    return rows.sort((p, q) => collator.compare(labels.get(p)!, labels.get(q)!));
  }

  private keys(row: Collision, by: Grouping): [string, string][] {
    if (by === 'none') return [['', '']];
    if (by === 'object') return sides.map(side => [row[side] < 0 ? this.nameOf(row, side) : String(row[side]), this.model.sideLabel(row, side)]);
    const text = (side: 'a' | 'b'): string => this.detail(row, side, by) || (by === 'parent' ? pathBefore(this.nameOf(row, side)) : '') || `no ${by}`;
    const pair = sides.map(text).sort(collator.compare);
    const title = pair[0] === pair[1] && by !== 'type' ? pair[0]! : pair.join(' × ');
    return [[title, title]];
  }
}

export function isGone(row: Collision): boolean {
  return row.a < 0;
}
