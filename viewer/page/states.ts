// The state of each row in a frame: what its colour means.
import type {SceneModel} from './scene_model.ts';

export const State = {absent: 0, free: 1, colliding: 2, ended: 3, began: 4, partner: 5, selected: 6} as const;

// States in the order of importance: a later one replaces an earlier one.
export function computeStates(model: SceneModel, selected: readonly number[], partners: readonly number[]): Uint8Array {
  const states = new Uint8Array(model.rows);
  const {frame} = model;
  for (let row = 0; row < model.rows; ++row) {
    if (model.exists(row)) states[row] = frame.partners[row] ? State.colliding : State.free;
  }
  const mark = (objects: ArrayLike<number>, state: number): void => {
    for (let k = 0; k < objects.length; ++k) {
      const row = model.rowOf(objects[k]!);
      if (row >= 0 && states[row] !== State.absent) states[row] = state;
    }
  };
  mark(frame.ended, State.ended);
  mark(frame.began, State.began);
  mark(partners, State.partner);
  mark(selected, State.selected);
  return states;
}
