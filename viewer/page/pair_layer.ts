// Lines between the middles of the boxes of a pair, for the selection or for all pairs.
import type {SharedUniforms} from './box_material.ts';
import type {Colour, Palette} from './colours.ts';
import {LineLayer, VertexList} from './line_layer.ts';
import type {SceneModel} from './scene_model.ts';
import {State} from './states.ts';

export const pairLimit = 200_000;

export class PairLayer {
  readonly lines: LineLayer;
  count = 0;
  private now: unknown[] = [];

  constructor(shared: SharedUniforms) {
    this.lines = new LineLayer(shared);
  }

  show(model: SceneModel, which: 'none' | 'selection' | 'all', selected: readonly number[], partners: readonly number[], palette: Palette): void {
    // Many pairs take a while, so nothing is done if nothing changed.
    const now = [which, model.frame.info, model.frame.pairs, palette, ...(which === 'selection' ? [...selected, -1, ...partners] : [])];
    if (now.length === this.now.length && now.every((value, k) => value === this.now[k])) return;
    this.now = now;
    const list = new VertexList();
    const add = (a: number, b: number, colour: Colour): void => {
      const [p, q] = [model.rowOf(a), model.rowOf(b)];
      if (p < 0 || q < 0 || !model.exists(p) || !model.exists(q)) return;
      list.add(...model.middle(p), colour);
      list.add(...model.middle(q), colour);
    };
    if (which === 'selection' && selected.length) for (const b of partners) add(selected[0]!, b, palette.states[State.selected]!);
    if (which === 'all') this.addAll(model, palette, add);
    this.count = list.positions.length / 6;
    this.lines.set(list);
  }

  private addAll(model: SceneModel, palette: Palette, add: (a: number, b: number, colour: Colour) => void): void {
    const {pairs, began, ended} = model.frame;
    const key = (list: Uint32Array, k: number): number => list[k]! * 4294967296 + list[k + 1]!;
    const news = new Set<number>();
    for (let k = 0; k + 1 < began.length; k += 2) news.add(key(began, k));
    for (let k = 0; k + 1 < pairs.length && k < 2 * pairLimit; k += 2) {
      add(pairs[k]!, pairs[k + 1]!, palette.states[news.has(key(pairs, k)) ? State.began : State.colliding]!);
    }
    for (let k = 0; k + 1 < ended.length && k < 2 * pairLimit; k += 2) add(ended[k]!, ended[k + 1]!, palette.states[State.ended]!);
  }
}
