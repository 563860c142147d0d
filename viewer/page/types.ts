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
  seconds?: Record<string, number>;
}

export interface Contact {
  point: Point;
  // Unknown if only the point is known.
  normal?: Point;
  depth?: number;
}

export interface Collision {
  a: number;
  b: number;
  name_a?: string;
  name_b?: string;
  class?: string;
  depth?: number;
  // "least", or "at_least" if the depth is a lower bound; then perhaps with an upper bound.
  depth_kind?: string;
  depth_at_most?: number;
  distance?: number;
  // Of the boxes, if no exact test computed a depth. Negative for a gap.
  overlap?: number;
  change?: string;
  // The deepest first.
  contacts?: Contact[];
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
    boxes: true};
  return {
    version: '', title: '', kind: 'scene', objects: 0, frames: 1, origin: [0, 0, 0], up: '', unit: '', margin: 0, notices: [], summary: {},
    ...answer, shown: answer.shown ?? answer.objects ?? 0,
    bounds: answer.bounds ?? {min: [0, 0, 0], max: [1, 1, 1]}, has: {...none, ...answer.has},
  };
}
