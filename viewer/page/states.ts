// The state of each row in a frame: what its colour means.
import type {SceneModel} from './scene_model.ts';

export const State = {
  absent: 0, free: 1, clearance: 2, touching: 3, colliding: 4, ended: 5, began: 6, partner: 7, selected: 8, second: 9,
} as const;

// The states of the classes of collisions, in the order of their numbers (protocol.md).
const stateOfClass: readonly number[] = [
  State.colliding, State.clearance, State.colliding, State.touching, State.colliding, State.colliding, State.colliding,
  State.colliding,
];

// What is selected: one object and its partners, or the two objects of a pair.
export interface Marks {
  objects: readonly number[];
  partners: readonly number[];
}

// States in the order of importance: a later one replaces an earlier one.
export function computeStates(model: SceneModel, {objects, partners}: Marks): Uint8Array {
  const states = new Uint8Array(model.rows);
  const {frame} = model;
  for (let row = 0; row < model.rows; ++row) {
    if (!model.exists(row)) continue;
    states[row] = frame.partners[row] ? stateOfClass[frame.classes?.[row] ?? 0] ?? State.colliding : State.free;
  }
  const mark = (list: ArrayLike<number>, state: number): void => {
    for (let k = 0; k < list.length; ++k) {
      const row = model.rowOf(list[k]!);
      if (row >= 0 && states[row] !== State.absent) states[row] = state;
    }
  };
  mark(frame.ended, State.ended);
  // In the first frame, all pairs are new.
  if (frame.info.frame > 0) mark(frame.began, State.began);
  mark(partners, State.partner);
  mark(objects.slice(0, 1), State.selected);
  mark(objects.slice(1), State.second);
  return states;
}
