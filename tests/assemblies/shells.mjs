// Reads the objects of an OBJ file, and divides them into closed shells whose triangles are counterclockwise from outside.

// Returns the objects: {name, vertices: [[x, y, z], ...], triangles: [[i, j, k], ...]}. Vertices at exactly the same place are joined.
export function readObjects(text) {
  const objects = [], places = [];
  let joined;
  for (const [number, line] of text.split('\n').entries()) {
    const [word, ...values] = line.trim().split(/\s+/), object = objects.at(-1);
    if (word === 'o') {
      objects.push({name: line.trim().slice(2), vertices: [], triangles: []});
      joined = new Map();
    } else if (word === 'v') {
      places.push(values.map(Number));
    } else if (word === 'f') {
      if (values.length !== 3) throw new Error(`line ${number + 1}: a face has ${values.length} corners; triangulate the model`);
      object.triangles.push(values.map(value => {
        const place = places[Number.parseInt(value) - 1], key = place.join(' ');
        if (!joined.has(key)) joined.set(key, object.vertices.push(place) - 1);
        return joined.get(key);
      }));
    }
  }
  return objects;
}

// Returns the edges of a triangle: [from, to, key]; the key is equal in both directions.
const edgesOf = triangle => triangle.map((from, i) => {
  const to = triangle[(i + 1) % 3];
  return [from, to, from < to ? `${from} ${to}` : `${to} ${from}`];
});

function volumeOf(vertices, triangles) {
  const origin = vertices[triangles[0][0]];
  return triangles.reduce((sum, triangle) => {
    const [a, b, c] = triangle.map(i => vertices[i].map((value, axis) => value - origin[axis]));
    return sum + (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6;
  }, 0);
}

// Returns {shells, oriented}, or nothing if an edge has not exactly two triangles or a shell has only one side. shells: lists of triangles,
// turned so that the volume of each is positive. oriented: the triangles agreed on which side is out, and no shell was turned.
export function shellsOf({vertices, triangles}) {
  const atEdge = new Map();
  triangles.forEach((triangle, index) => edgesOf(triangle).forEach(([, , key]) => atEdge.set(key, [...atEdge.get(key) ?? [], index])));
  if ([...atEdge.values()].some(indices => indices.length !== 2)) return null;
  const turned = new Map(), shells = [];
  let oriented = true;
  for (let first = 0; first < triangles.length; first++) {
    if (turned.has(first)) continue;
    turned.set(first, triangles[first]);
    const shell = [first];
    for (const index of shell) {
      for (const [from, to, key] of edgesOf(turned.get(index))) {
        const next = atEdge.get(key).find(other => other !== index), known = turned.get(next);
        const agrees = triangle => edgesOf(triangle).some(edge => edge[0] === to && edge[1] === from);
        if (known && !agrees(known)) return null;
        if (known) continue;
        oriented &&= agrees(triangles[next]);
        turned.set(next, agrees(triangles[next]) ? triangles[next] : [...triangles[next]].reverse());
        shell.push(next);
      }
    }
    const outward = shell.map(index => turned.get(index)), isOutward = volumeOf(vertices, outward) > 0;
    oriented &&= isOutward;
    shells.push(isOutward ? outward : outward.map(triangle => [...triangle].reverse()));
  }
  return {shells, oriented};
}
