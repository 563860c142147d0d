// Geometry of elements: the meshes of web-ifc, welded exactly, and shared by all elements that have them alike.
//
// web-ifc gives an element as pieces: a mesh in float32, and a float64 transform from it to the world in metres, with y up. Pieces of an
// element become one shape, in the coordinates of the first piece. Elements whose pieces lie alike, to 1e-9 there, share a shape. The mesh of
// one id differs between elements: openings of the element are cut from it. So meshes are told apart by their contents.

// The axes of IFC from those of web-ifc, exactly: (x, y, z) becomes (x, -z, y).
function worldTransform(columns) {
  const row = k => [columns[k], columns[4 + k], columns[8 + k], columns[12 + k]];
  return [...row(0), ...row(2).map(value => 0 - value), ...row(1), 0, 0, 0, 1];
}

function product(a, b) {
  const result = new Array(16).fill(0);
  for (let i = 0; i < 4; ++i) {
    for (let j = 0; j < 4; ++j) {
      for (let k = 0; k < 4; ++k) result[4 * i + j] += a[4 * i + k] * b[4 * k + j];
    }
  }
  return result;
}

// The inverse of an affine transform, or null.
function inverse(m) {
  const [a, b, c, d, e, f, g, h, i] = [m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]];
  const det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
  if (!(Math.abs(det) > 1e-12)) return null;
  const r = [e * i - f * h, c * h - b * i, b * f - c * e, f * g - d * i, a * i - c * g, c * d - a * f, d * h - e * g, b * g - a * h, a * e - b * d]
    .map(value => value / det);
  const shift = [0, 1, 2].map(k => -(r[3 * k] * m[3] + r[3 * k + 1] * m[7] + r[3 * k + 2] * m[11]));
  return [r[0], r[1], r[2], shift[0], r[3], r[4], r[5], shift[1], r[6], r[7], r[8], shift[2], 0, 0, 0, 1];
}

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

// The largest factor by which a transform lengthens an axis.
function stretch(m) {
  return Math.max(...[0, 1, 2].map(k => Math.hypot(m[k], m[4 + k], m[8 + k])));
}

// Joins vertices with equal coordinates, and leaves out triangles with two equal corners.
function weld(coordinates, triangles) {
  const vertices = new Float64Array(coordinates.length);
  for (let i = 0; i < vertices.length; ++i) vertices[i] = coordinates[i] + 0;  // -0 becomes 0
  const words = new Uint32Array(vertices.buffer);
  const newNumber = new Uint32Array(vertices.length / 3);
  // A hash table with open addressing has the numbers of the joined vertices, which move to the front of `vertices`.
  const mask = 2 ** Math.ceil(Math.log2(2 * newNumber.length + 2)) - 1;
  const table = new Int32Array(mask + 1).fill(-1);
  let count = 0;
  for (let i = 0; i < newNumber.length; ++i) {
    let hash = 0;
    for (let k = 6 * i; k < 6 * i + 6; ++k) hash = Math.imul(hash ^ words[k] ^ hash >>> 15, 0x9E3779B1);
    let at = (hash ^ hash >>> 15) & mask;
    const [x, y, z] = [vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]];
    while (table[at] >= 0) {
      const known = 3 * table[at];
      if (vertices[known] === x && vertices[known + 1] === y && vertices[known + 2] === z) break;
      at = at + 1 & mask;
    }
    if (table[at] < 0) {
      table[at] = count;
      vertices[3 * count] = x;
      vertices[3 * count + 1] = y;
      vertices[3 * count + 2] = z;
      ++count;
    }
    newNumber[i] = table[at];
  }
  const kept = new Uint32Array(triangles.length);
  let size = 0;
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [newNumber[triangles[i]], newNumber[triangles[i + 1]], newNumber[triangles[i + 2]]];
    if (a === b || b === c || c === a) continue;
    kept[size++] = a;
    kept[size++] = b;
    kept[size++] = c;
  }
  return {vertices: vertices.slice(0, 3 * count), triangles: kept.slice(0, size)};
}

// A number for contents, which different contents hardly share.
function digest(...arrays) {
  let [a, b] = [0, 0];
  for (const array of arrays) {
    const words = new Uint32Array(array.buffer, array.byteOffset, array.length);
    for (let i = 0; i < words.length; ++i) {
      a = Math.imul(a ^ words[i] ^ a >>> 15, 0x9E3779B1);
      b = Math.imul(b ^ words[i] ^ b >>> 13, 0x85EBCA6B) + 1 | 0;
    }
  }
  return `${a}:${b}:${arrays.map(array => array.length)}`;
}

export class Shapes {
  constructor(api, model, writer) {
    this.api = api;
    this.model = model;
    this.writer = writer;
    this.meshes = new Map();   // of web-ifc's geometries, by their ids and contents
    this.written = new Map();  // numbers of shapes, by their pieces
  }

  // Returns the shape and the transform of an element; null if it has no triangles.
  of(element) {
    const mesh = this.api.GetFlatMesh(this.model, element);
    const pieces = [];
    for (let i = 0; i < mesh.geometries.size(); ++i) {
      const {geometryExpressID, flatTransformation} = mesh.geometries.get(i);
      const geometry = this.readMesh(geometryExpressID);
      if (this.meshes.get(geometry).triangles.length > 0) pieces.push({geometry, transform: worldTransform(flatTransformation)});
    }
    mesh.delete?.();
    if (pieces.length === 0) return null;
    // A transform that cannot be undone flattens the element. Then its pieces are placed one by one, in the world.
    const first = inverse(pieces[0].transform);
    const base = first ? pieces[0].transform : identity;
    for (const [k, piece] of pieces.entries())
      piece.local = first ? (k === 0 ? identity : product(first, piece.transform)) : piece.transform;
    const key = pieces.map(({geometry, local}) => `${geometry}:${local.map(value => value.toFixed(9)).join(',')}`).join(';');
    let shape = this.written.get(key);
    if (shape === undefined) {
      const made = this.shapeOf(pieces);
      shape = made.triangles.length > 0 ? this.writer.shape(made) : null;
      this.written.set(key, shape);
    }
    return shape === null ? null : {shape, transform: base};
  }

  // Returns the key of the mesh that a geometry has now.
  readMesh(geometry) {
    const read = this.api.GetGeometry(this.model, geometry);
    const data = this.api.GetVertexArray(read.GetVertexData(), read.GetVertexDataSize());
    const indices = this.api.GetIndexArray(read.GetIndexData(), read.GetIndexDataSize());
    read.delete?.();
    const key = `${geometry}:${digest(data, indices)}`;
    if (!this.meshes.has(key)) {
      const vertices = new Float64Array(data.length / 2);  // data has a normal for each vertex
      for (let i = 0; i < vertices.length; ++i) vertices[i] = data[6 * Math.floor(i / 3) + i % 3];
      this.meshes.set(key, weld(vertices, indices));
    }
    return key;
  }

  shapeOf(pieces) {
    const vertices = [];
    const triangles = [];
    let error = 0;
    for (const {geometry, local} of pieces) {
      const mesh = this.meshes.get(geometry);
      const first = vertices.length / 3;
      const scale = stretch(local);
      for (let i = 0; i < mesh.vertices.length; i += 3) {
        const [x, y, z] = [mesh.vertices[i], mesh.vertices[i + 1], mesh.vertices[i + 2]];
        error = Math.max(error, scale * Math.abs(x), scale * Math.abs(y), scale * Math.abs(z));
        for (let k = 0; k < 3; ++k)
          vertices.push(local === identity ? mesh.vertices[i + k] : local[4 * k] * x + local[4 * k + 1] * y + local[4 * k + 2] * z + local[4 * k + 3]);
      }
      for (const corner of mesh.triangles) triangles.push(first + corner);
    }
    const made = pieces.length === 1 ? {vertices: Float64Array.from(vertices), triangles: Uint32Array.from(triangles)}
      : weld(vertices, triangles);
    return {...made, error: error * 2 ** -24};  // vertices were rounded to float32
  }
}
