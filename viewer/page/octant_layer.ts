// The octants of one level, or all leaves, as lines coloured by their number of entries; finds the octant under the pointer.
import * as THREE from 'three';
import type {SharedUniforms} from './box_material.ts';
import {type LegendEntry, rampColour} from './colours.ts';
import {EdgeLayer} from './edge_layer.ts';
import type {Source} from './source.ts';
import type {OctantLevel} from './types.ts';

const wordsPerOctant = 11;
// A picture of more lines shows nothing.
const octantLimit = 100_000;

export interface Octant {
  bounds: Float32Array;
  code: string;
  level: number;
  entries: number;
  begins: number;
  leaf: boolean;
}

interface Row {
  level: number;
  at: number;
  words: Uint32Array;
}

export class OctantLayer {
  readonly edges: EdgeLayer;
  levels: OctantLevel[] = [];
  // All octants that were asked for; not all may be listed.
  total = 0;
  private most = 1;
  private rows: Row[] = [];
  private bounds = new Float32Array(0);

  constructor(shared: SharedUniforms) {
    this.edges = new EdgeLayer(shared);
  }

  // Shows the octants of a level of a frame, or with level -1 all leaves.
  async show(source: Source, frame: number, level: number, signal: AbortSignal): Promise<void> {
    const {levels} = await source.json<{levels: OctantLevel[]}>(`octants/${frame}.json`, signal);
    const wanted = levels.map((_, k) => k).filter(k => levels[k]!.listed > 0 && (level < 0 ? levels[k]!.leaves > 0 : k === level));
    const answers = await Promise.all(wanted.map(k => source.bytes(`octants/${frame}/${k}.bin`, signal)));
    if (signal.aborted) return;
    this.levels = levels;
    this.rows = [];
    this.total = level < 0 ? levels.reduce((sum, one) => sum + one.leaves, 0) : levels[level]?.octants ?? 0;
    answers.forEach((answer, k) => this.append(new Uint32Array(answer), wanted[k]!, level < 0));
    this.upload();
  }

  legend(): LegendEntry[] {
    const {most} = this;
    const steps = [...new Set([1, Math.round(Math.sqrt(most)), most])];
    const text = (count: number): string => count === 1 ? 'octant, 1 entry' : `octant, ${count.toLocaleString('en-US')} entries`;
    return this.edges.count ? steps.map(count => ({text: text(count), colour: rampColour(Math.log1p(count) / Math.log1p(most))})) : [];
  }

  clear(): void {
    this.rows = [];
    this.edges.clear();
  }

  octant(k: number): Octant {
    const {words, at, level} = this.rows[k]!;
    return {
      bounds: this.bounds.subarray(6 * k, 6 * k + 6), level, code: codeText(words[at + 9]!, words[at + 10]!, level),
      entries: words[at + 6]!, begins: words[at + 7]!, leaf: (words[at + 8]! & 1) === 1,
    };
  }

  // The octant whose wall the ray enters first; of octants with the same wall, the smallest.
  find(ray: THREE.Ray): Octant | null {
    let best = -1;
    let bestAt = Infinity;
    const box = new THREE.Box3();
    const hit = new THREE.Vector3();
    for (let k = 0; k < this.edges.count; ++k) {
      const b = this.bounds.subarray(6 * k, 6 * k + 6);
      box.min.set(b[0]!, b[1]!, b[2]!);
      box.max.set(b[3]!, b[4]!, b[5]!);
      if (box.containsPoint(ray.origin) || !ray.intersectBox(box, hit)) continue;
      const at = hit.distanceTo(ray.origin);
      if (at > bestAt) continue;
      bestAt = at;
      best = k;
    }
    return best < 0 ? null : this.octant(best);
  }

  private append(words: Uint32Array, level: number, leavesOnly: boolean): void {
    for (let at = 0; at + wordsPerOctant <= words.length; at += wordsPerOctant) {
      if (leavesOnly && !(words[at + 8]! & 1)) continue;
      if (this.rows.length < octantLimit) this.rows.push({level, at, words});
    }
  }

  private upload(): void {
    this.bounds = new Float32Array(6 * this.rows.length);
    this.most = 1;
    this.rows.forEach(({words, at}, k) => {
      this.bounds.set(new Float32Array(words.buffer, 4 * at, 6), 6 * k);
      this.most = Math.max(this.most, words[at + 6]!);
    });
    const part = (k: number): number => Math.log1p(this.rows[k]!.words[this.rows[k]!.at + 6]!) / Math.log1p(this.most);
    this.edges.set(this.bounds, this.rows.length, k => rampColour(part(k)));
  }
}

// The digits of the key, from 1 to 8, three bits for each level from bit 62 down.
export function codeText(high: number, low: number, level: number): string {
  const key = (BigInt(high) << 32n) | BigInt(low);
  const digits = Array.from({length: level}, (_, k) => Number((key >> BigInt(60 - 3 * k)) & 7n) + 1);
  return `{${digits.join(',')}}`;
}
