// The JSON answers of the protocol (protocol.md), as types.

export type Point = [number, number, number];

export interface Bounds {
  min: Point;
  max: Point;
}

export interface Has {
  names: boolean;
  groups: boolean;
  shapes: boolean;
  contacts: boolean;
  classes: boolean;
  events: boolean;
  search: boolean;
  near: boolean;
  rows: boolean;
  boxes: boolean;
  details: boolean;
  gone: boolean;
  octants: boolean;
}

export interface SceneFile {
  name: string;
  // Its first object.
  first: number;
}

export interface View {
  version: string;
  title: string;
  kind: 'scene' | 'live' | 'server';
  objects: number;
  shown: number;
  frames: number;
  origin: Point;
  bounds: Bounds;
  up: string;
  unit: string;
  margin: number;
  // The files that the objects are from, if there are several.
  files: SceneFile[];
  // The first object of the second set, if each pair has one object of each set. Results number both sets from 0.
  second_set?: number;
  has: Has;
  notices: string[];
  summary: Record<string, unknown>;
}

export interface FrameInfo {
  frame: number;
  // Those that exist.
  objects?: number;
  pairs: number;
  pairs_listed?: number;
  began?: number;
  ended?: number;
  // The number of collisions of each class.
  classes?: Record<string, number>;
  // The number of collisions that are new, the same or gone since an older result.
  new?: number;
  same?: number;
  gone?: number;
  seconds?: Record<string, number>;
}

export interface Contact {
  point: Point;
  // Unknown if only the point is known.
  normal?: Point;
  depth?: number;
}

// Texts about the objects of a collision that is gone.
type GoneTexts = {[key in `${'label' | 'type' | 'id'}_${'a' | 'b'}`]?: string};

// A row of the table. A collision that is gone has the objects -1, and only texts about them.
export interface Collision extends GoneTexts {
  a: number;
  b: number;
  name_a?: string;
  name_b?: string;
  class?: string;
  depth?: number;
  // "least", or "at_least" if the depth is a lower bound; then perhaps with an upper bound.
  depth_kind?: string;
  depth_at_most?: number;
  // The diameter of the largest ball inside both objects: "at_most" or "at_least" this, or "undecided".
  thickness?: number;
  thickness_kind?: string;
  // The objects that are meshes with a part that is not closed: "a", "b" or "ab".
  open?: string;
  // The time of impact of objects that move.
  time?: number;
  distance?: number;
  // Of the boxes, if no exact test computed a depth. Negative for a gap.
  overlap?: number;
  change?: string;
  // The decision of people about the collision.
  status?: string;
  comment?: string;
  // The deepest first.
  contacts?: Contact[];
  // The number of contacts, if the row has only some.
  contact_count?: number;
  // Whether the search left out further contacts.
  more_contacts?: boolean;
  // The boxes of both objects, if one of them is not shown.
  boxes?: [Bounds, Bounds];
  // Of objects that are apart.
  nearest?: [Point, Point];
}

export interface Collisions {
  total: number;
  rows: Collision[];
  // Whether an exported page left out rows: it has the worst ones of a frame.
  partial?: boolean;
}

export interface CollisionQuery {
  from: number;
  count: number;
  sort: string;
  object?: number;
  // Only pairs of `object` with this one.
  with?: number;
  q?: string;
}

// The words of the details, and for each detail the words of all shown objects.
export interface DetailColumns {
  words: string[];
  [detail: string]: readonly string[] | readonly number[];
}

export interface ObjectInfo {
  index: number;
  name?: string;
  details?: Record<string, unknown>;
  box?: Bounds;
  row: number;
  code?: string;
  level?: number;
  groups?: number;
  partner_count: number;
  partners: number[];
}

export interface Found {
  total: number;
  found: {index: number; name: string}[];
}

export interface OctantLevel {
  octants: number;
  leaves: number;
  listed: number;
}

export interface Timeline {
  frames: number;
  done: number;
  pairs: number[];
  began: number[];
  ended: number[];
  // Why later frames are missing.
  failed?: string;
}

export interface Job {
  id: string;
  owner: string;
  state: string;
  progress: number;
  queued_before: number;
  objects: number;
  pairs: number;
  count_only: boolean;
  error: string;
}

export interface ServedScene {
  id: string;
  owner: string;
  objects: number;
  pairs: number;
  steps: number;
  step_seconds: number;
}

export interface SocketEvent {
  event: string;
  what?: string;
  done?: number;
  message?: string;
  jobs?: Job[];
  scenes?: ServedScene[];
}

// Fills in all that an answer may leave out.
export function completeView(answer: Partial<View>): View {
  const none: Has = {names: false, groups: false, shapes: false, contacts: false, classes: false, events: false, search: false, near: false, rows: false,
    boxes: true, details: false, gone: false, octants: true};
  return {
    version: '', title: '', kind: 'scene', objects: 0, frames: 1, origin: [0, 0, 0], up: '', unit: '', margin: 0, files: [], notices: [], summary: {},
    ...answer, shown: answer.shown ?? answer.objects ?? 0,
    bounds: answer.bounds ?? {min: [0, 0, 0], max: [1, 1, 1]}, has: {...none, ...answer.has},
  };
}
