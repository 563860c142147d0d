// The words for a collision: its class, its depth with what is known of it, and what these mean.
import {significant} from './dom.ts';
import type {Collision} from './types.ts';

// In the order of the numbers of the classes (protocol.md).
export const classWords: readonly string[] = ['unknown', 'clearance', 'collision', 'touching', 'penetrating', 'contained', 'duplicate', 'undecided'];
const severities: readonly number[] = [3, 1, 4, 2, 7, 6, 5, 0];

const meanings: Record<string, string> = {
  clearance: 'The objects are apart, but nearer than the margin.',
  collision: 'The two objects meet. The search did not determine how.',
  touching: 'The objects share only surface, or a motion of at most the tolerance separates them.',
  penetrating: 'The insides of the objects share space.',
  contained: 'One object lies wholly inside the other.',
  duplicate: 'The objects have the same geometry at the same place.',
  undecided: 'One object lies within the bounds of the other, which has no inside. Their surfaces do not meet.',
};

const openMeanings: Record<string, string> = {a: 'The first object is not closed', b: 'The second object is not closed', ab: 'Neither object is closed'};

function severity(row: Collision): number {
  return severityOf(row.class ?? 'unknown');
}

export function severityOf(word: string): number {
  return severities[classWords.indexOf(word)] ?? 3;
}

// The number by which collisions of the same class are sorted.
function measure(row: Collision): number {
  return row.class === 'clearance' ? -(row.distance ?? 0) : row.depth ?? row.overlap ?? 0;
}

// Compares two collisions: the worse one is first.
export function compareWorst(p: Collision, q: Collision): number {
  return severity(q) - severity(p) || measure(q) - measure(p) || p.a - q.a || p.b - q.b;
}

// The colour of a class in lists: those that overlap stand out.
export function toneOf(word: string): 'bad' | 'calm' | 'plain' {
  const value = severityOf(word);
  return value >= 5 ? 'bad' : value === 2 ? 'calm' : 'plain';
}

// What a class means, and what the search could not know.
export function explanations(row: Collision): string[] {
  const texts = [meanings[row.class ?? ''] ?? ''];
  if (row.open) texts.push(`${openMeanings[row.open]}, so the pair was judged without an inside.`);
  if (row.depth_kind === 'at_least' && row.depth !== row.depth_at_most) {
    texts.push('Shapes that are not convex have only bounds of their depth. No shorter motion separates the objects; a motion of the upper bound does.');
  }
  return texts.filter(text => text);
}

export interface Measure {
  // "depth", "gap" or "overlap".
  kind: string;
  // For a cell of a table, and as words.
  short: string;
  long: string;
}

// Returns how deep a collision is: the depth of the pair, the gap of objects that are apart, or the overlap of their boxes. Null: unknown.
export function measureOf(row: Collision, unit = ''): Measure | null {
  const withUnit = (value: number): string => unit ? `${significant(value)} ${unit}` : significant(value);
  if (row.class === 'clearance' && row.distance !== undefined) {
    return {kind: 'gap', short: significant(row.distance), long: withUnit(row.distance)};
  }
  if (row.depth !== undefined) {
    // A bound of 0 says nothing.
    if (row.depth_kind !== 'at_least') return {kind: 'depth', short: significant(row.depth), long: withUnit(row.depth)};
    if (row.depth === 0) return null;
    const most = row.depth_at_most === undefined ? '' : `, at most ${withUnit(row.depth_at_most)}`;
    return {kind: 'depth', short: `≥ ${significant(row.depth)}`, long: `at least ${withUnit(row.depth)}${most}`};
  }
  if (row.overlap === undefined) return null;
  return row.overlap < 0 ? {kind: 'gap', short: significant(-row.overlap), long: `${withUnit(-row.overlap)} between the boxes`} :
    {kind: 'overlap', short: significant(row.overlap), long: `${withUnit(row.overlap)}, of the boxes`};
}

// The thickness of the overlap, as a cell of a table.
export function thicknessOf(row: Collision): string {
  if (row.thickness === undefined) return row.thickness_kind === 'undecided' ? '?' : '';
  return `${row.thickness_kind === 'at_most' ? '≤ ' : row.thickness_kind === 'at_least' ? '≥ ' : ''}${significant(row.thickness)}`;
}

// How many contacts a row has, in words.
export function contactsText(row: Collision): string {
  const listed = row.contacts?.length ?? 0;
  const all = row.contact_count ?? listed;
  if (all > listed || row.more_contacts) {
    const of = all > listed ? ` of ${row.more_contacts ? 'more than ' : ''}${all}` : '';
    return listed === 1 ? `The deepest contact${of}` : `The ${listed} deepest contacts${of || '; more exist'}`;
  }
  return listed === 1 ? '1 contact' : `${listed} contacts, the deepest first`;
}
