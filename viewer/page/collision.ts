// The words for a collision: its class, and its depth with what is known of it.
import {significant} from './dom.ts';
import type {Collision} from './types.ts';

// In the order of the numbers of the classes (protocol.md).
export const classWords: readonly string[] = ['unknown', 'clearance', 'collision', 'touching', 'penetrating', 'contained', 'duplicate'];
const severities: readonly number[] = [2, 0, 3, 1, 6, 5, 4];

function severity(row: Collision): number {
  return severities[classWords.indexOf(row.class ?? 'unknown')] ?? 2;
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
export function classTone(row: Collision): 'bad' | 'calm' | 'plain' {
  const value = severity(row);
  return value >= 4 ? 'bad' : value === 1 ? 'calm' : 'plain';
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
