// The surface of a shape for drawing: normals that are smooth across blunt edges, and the sharp edges as lines.

export interface Surface {
  // Nine numbers a triangle.
  positions: Float32Array;
  normals: Float32Array;
  // Six numbers a line.
  edges: Float32Array;
}

// Two faces whose normals differ more are separated by an edge.
const sharpCosine = Math.cos(38 * Math.PI / 180);

// Numbers of vertices where all at the same place have the same number. Places are whole multiples of a millionth of the size.
function weld(vertices: Float32Array): Uint32Array {
  let size = 0;
  for (const value of vertices) size = Math.max(size, Math.abs(value));
  const places = Int32Array.from(vertices, value => Math.round(5e5 * value / (size || 1)));
  const count = vertices.length / 3;
  const slots = new Int32Array(2 ** Math.ceil(Math.log2(2 * count + 2))).fill(-1);
  const mask = slots.length - 1;
  const same = (p: number, q: number): boolean =>
    places[3 * p] === places[3 * q] && places[3 * p + 1] === places[3 * q + 1] && places[3 * p + 2] === places[3 * q + 2];
  const first = new Uint32Array(count);
  for (let v = 0; v < count; ++v) {
    let at = Math.imul(places[3 * v]! ^ Math.imul(places[3 * v + 1]! ^ Math.imul(places[3 * v + 2]!, 0x9e3779b1), 0x85ebca6b), 0xc2b2ae35);
    at = (at ^ (at >>> 15)) & mask;
    while (slots[at]! >= 0 && !same(slots[at]!, v)) at = (at + 1) & mask;
    if (slots[at]! < 0) slots[at] = v;
    first[v] = slots[at]!;
  }
  return first;
}

// The normal of each triangle, as long as twice its area.
function faceNormals(vertices: Float32Array, triangles: Uint32Array): Float32Array {
  const out = new Float32Array(triangles.length);
  for (let t = 0; t + 2 < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t]!, 3 * triangles[t + 1]!, 3 * triangles[t + 2]!];
    const [ux, uy, uz] = [vertices[b]! - vertices[a]!, vertices[b + 1]! - vertices[a + 1]!, vertices[b + 2]! - vertices[a + 2]!];
    const [vx, vy, vz] = [vertices[c]! - vertices[a]!, vertices[c + 1]! - vertices[a + 1]!, vertices[c + 2]! - vertices[a + 2]!];
    out[t] = uy * vz - uz * vy;
    out[t + 1] = uz * vx - ux * vz;
    out[t + 2] = ux * vy - uy * vx;
  }
  return out;
}

function cosine(normals: Float32Array, s: number, t: number): number {
  // A face without area is as flat as its neighbours.
  const length = (k: number): number => Math.hypot(normals[k]!, normals[k + 1]!, normals[k + 2]!);
  const lengths = length(s) * length(t);
  if (lengths < 1e-30) return 1;
  const dot = normals[s]! * normals[t]! + normals[s + 1]! * normals[t + 1]! + normals[s + 2]! * normals[t + 2]!;
  return dot / lengths;
}

// The corners of each vertex: positions in `triangles`, vertex by vertex.
function cornersOf(vertexOf: Uint32Array, vertices: number): {start: Uint32Array; corners: Uint32Array} {
  const start = new Uint32Array(vertices + 1);
  for (const v of vertexOf) start[v + 1]! += 1;
  for (let v = 0; v < vertices; ++v) start[v + 1]! += start[v]!;
  const next = start.slice();
  const corners = new Uint32Array(vertexOf.length);
  vertexOf.forEach((v, corner) => corners[next[v]!++] = corner);
  return {start, corners};
}

// A corner's normal is the sum of those of the faces around its vertex that are not across a sharp edge.
function cornerNormals(faces: Float32Array, vertexOf: Uint32Array, vertices: number): Float32Array {
  const {start, corners} = cornersOf(vertexOf, vertices);
  const out = new Float32Array(3 * vertexOf.length);
  vertexOf.forEach((v, corner) => {
    const own = 3 * Math.floor(corner / 3);
    for (let k = start[v]!; k < start[v + 1]!; ++k) {
      const other = 3 * Math.floor(corners[k]! / 3);
      if (cosine(faces, own, other) < sharpCosine) continue;
      for (let axis = 0; axis < 3; ++axis) out[3 * corner + axis]! += faces[other + axis]!;
    }
  });
  return out;
}

// The edges between faces that are not nearly flat, and those of only one face.
function sharpEdges(vertices: Float32Array, faces: Float32Array, vertexOf: Uint32Array): Float32Array {
  const open = new Map<number, number>();
  const count = vertices.length / 3;
  const lines: number[] = [];
  const add = (key: number): void => {
    for (const v of [Math.floor(key / count), key % count]) lines.push(vertices[3 * v]!, vertices[3 * v + 1]!, vertices[3 * v + 2]!);
  };
  vertexOf.forEach((v, corner) => {
    const face = corner - corner % 3;
    const [w, x] = [vertexOf[face + (corner + 1) % 3]!, vertexOf[face + (corner + 2) % 3]!];
    if (v === w || w === x || v === x) return;
    const key = Math.min(v, w) * count + Math.max(v, w);
    const other = open.get(key);
    if (other === undefined) open.set(key, face);
    else {
      open.delete(key);
      if (Math.abs(cosine(faces, other, face)) < sharpCosine) add(key);
    }
  });
  for (const key of open.keys()) add(key);
  return Float32Array.from(lines);
}

// Whether each edge has two faces, so that the shape has an inside.
export function isClosed(vertices: Float32Array, triangles: Uint32Array): boolean {
  const same = weld(vertices);
  const count = vertices.length / 3;
  const open = new Set<number>();
  for (let t = 0; t + 2 < triangles.length; t += 3) {
    const corners = [0, 1, 2].map(k => same[triangles[t + k]!]!);
    if (new Set(corners).size < 3) continue;
    corners.forEach((v, k) => {
      const w = corners[(k + 1) % 3]!;
      const key = Math.min(v, w) * count + Math.max(v, w);
      if (!open.delete(key)) open.add(key);
    });
  }
  return open.size === 0;
}

export function surfaceOf(vertices: Float32Array, triangles: Uint32Array): Surface {
  const same = weld(vertices);
  const vertexOf = triangles.map(v => same[v]!);
  const faces = faceNormals(vertices, triangles);
  const positions = new Float32Array(3 * triangles.length);
  for (let k = 0; k < positions.length; ++k) positions[k] = vertices[3 * triangles[Math.floor(k / 3)]! + k % 3]!;
  return {positions, normals: cornerNormals(faces, vertexOf, vertices.length / 3), edges: sharpEdges(vertices, faces, vertexOf)};
}
