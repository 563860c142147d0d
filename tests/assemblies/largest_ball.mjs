// The largest ball in a solid, by a search that shares no code with octopair.
//
// Method    The search divides boxes, first the box with the largest bound of a ball's radius. If a point moves, its signed distance to the
//           surface changes by at most the length of the move. So the radius of a ball with its centre in a box is at most the distance at
//           the middle plus half the diagonal. If the middle is inside, a ball there grows by random moves.
// Mesh      {places: [x, y, z, ...], corners: [three vertices of each triangle, ...]}, closed, counterclockwise from outside.

const minus = (p, q) => [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
const plus = (p, q, factor) => [p[0] + factor * q[0], p[1] + factor * q[1], p[2] + factor * q[2]];
const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
const cross = (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];

// Returns the square of the distance of a point to a segment.
function squareToSegment(point, p, q) {
  const along = minus(q, p), from = minus(point, p), length = dot(along, along);
  const rest = plus(from, along, length > 0 ? -Math.min(1, Math.max(0, dot(from, along) / length)) : 0);
  return dot(rest, rest);
}

// Returns the square of the distance of a point to a triangle: to its plane if the point is above the triangle, otherwise to an edge.
function squareToTriangle(point, {corners, normal}) {
  const square = dot(normal, normal);
  let above = square > 0;
  for (let i = 0; above && i < 3; i++) {
    above = dot(cross(minus(corners[(i + 1) % 3], corners[i]), minus(point, corners[i])), normal) >= 0;
  }
  if (above) return dot(minus(point, corners[0]), normal) ** 2 / square;
  return Math.min(...[0, 1, 2].map(i => squareToSegment(point, corners[i], corners[(i + 1) % 3])));
}

// Returns the solid angle that a triangle fills as seen from a point (van Oosterom and Strackee, 1983).
function solidAngle(point, {corners}) {
  const [a, b, c] = corners.map(corner => minus(corner, point));
  const [x, y, z] = [a, b, c].map(corner => Math.sqrt(dot(corner, corner)));
  return 2 * Math.atan2(dot(a, cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
}

function trianglesOf({places, corners}) {
  const place = i => [places[3 * i], places[3 * i + 1], places[3 * i + 2]];
  const triangles = [];
  for (let i = 0; i < corners.length; i += 3) {
    const [a, b, c] = [place(corners[i]), place(corners[i + 1]), place(corners[i + 2])];
    triangles.push({corners: [a, b, c], normal: cross(minus(b, a), minus(c, a))});
  }
  return triangles;
}

// Heap of boxes, the largest bound first.
class Heap {
  items = [];

  push(item) {
    const items = this.items;
    let place = items.push(item) - 1;
    for (let above; place > 0 && items[above = (place - 1) >> 1].bound < item.bound; place = above) items[place] = items[above];
    items[place] = item;
  }

  pop() {
    const items = this.items, first = items[0], last = items.pop();
    let place = 0;
    for (let below; (below = 2 * place + 1) < items.length; place = below) {
      if (below + 1 < items.length && items[below + 1].bound > items[below].bound) below++;
      if (items[below].bound <= last.bound) break;
      items[place] = items[below];
    }
    if (items.length > 0) items[place] = last;
    return first;
  }
}

class Search {
  // Radii: the search drops boxes whose balls are smaller than `most`.
  constructor(mesh, most) {
    this.triangles = trianglesOf(mesh);
    this.most = most;
    this.found = 0;
    this.heap = new Heap();
    this.random = 1;
  }

  inside(point) {
    return Math.abs(this.triangles.reduce((sum, triangle) => sum + solidAngle(point, triangle), 0)) > 2 * Math.PI;
  }

  // Returns a number from -1 to 1; each run gives the same numbers.
  next() {
    this.random = (this.random * 48271) % 2147483647;
    return 2 * this.random / 2147483647 - 1;
  }

  // Examines a box. Only triangles that are the nearest one of some point in the box can be the nearest one in a part of the box.
  add(middle, half, near) {
    const reach = Math.sqrt(dot(half, half));
    const distances = near.map(triangle => Math.sqrt(squareToTriangle(middle, triangle))), distance = Math.min(...distances);
    const inside = this.inside(middle), bound = (inside ? distance : -distance) + reach;
    if (bound <= Math.max(this.found, this.most)) return;
    if (inside && distance > this.found) this.climb(middle, distance);
    this.heap.push({middle, half, bound, near: near.filter((_, i) => distances[i] <= distance + 2 * reach)});
  }

  // Moves the centre of a ball at random, as long as the ball grows.
  climb(centre, radius) {
    for (let step = radius / 2; step > 1e-4 * radius;) {
      const moved = plus(centre, [this.next(), this.next(), this.next()], step);
      const larger = Math.sqrt(Math.min(...this.triangles.map(triangle => squareToTriangle(moved, triangle))));
      if (larger > radius && this.inside(moved)) {
        [centre, radius] = [moved, larger];
        step *= 2;
      } else {
        step *= 0.9;
      }
    }
    this.found = Math.max(this.found, radius);
  }

  // Divides the box whose bound is the largest along its longest axis.
  divide() {
    const {middle, half, near} = this.heap.pop();
    const axis = half.indexOf(Math.max(...half)), smaller = half.map((h, i) => i === axis ? h / 2 : h);
    for (const side of [-1, 1]) this.add(middle.map((m, i) => i === axis ? m + side * smaller[i] : m), smaller, near);
  }
}

// Returns the least width of a solid along the normals of its triangles. No ball in the solid is thicker.
function leastWidth(triangles) {
  let least = Infinity;
  for (const {normal} of triangles) {
    const length = Math.sqrt(dot(normal, normal));
    let low = Infinity, high = -Infinity;
    for (const {corners} of triangles) {
      for (const corner of corners) {
        const along = dot(corner, normal);
        low = Math.min(low, along);
        high = Math.max(high, along);
      }
    }
    if (length > 0) least = Math.min(least, (high - low) / length);
  }
  return least;
}

// Returns {found, bound}: a ball of diameter `found` lies in the solid, and none of a diameter above `bound` does. The search ends if a ball
// is larger than `enough`, if no ball is larger than `most`, or after `budget` boxes.
export function largestBall(mesh, {enough, most, budget}) {
  const search = new Search(mesh, most / 2), width = leastWidth(search.triangles);
  if (width <= most) return {found: 0, bound: width};
  const axes = [0, 1, 2].map(axis => mesh.places.filter((_, i) => i % 3 === axis));
  const low = axes.map(places => places.reduce((a, b) => Math.min(a, b)));
  const high = axes.map(places => places.reduce((a, b) => Math.max(a, b)));
  search.add(low.map((l, i) => (l + high[i]) / 2), low.map((l, i) => (high[i] - l) / 2), search.triangles);
  const {items} = search.heap;
  for (let boxes = 0; boxes < budget && 2 * search.found <= enough && items.length > 0; boxes++) search.divide();
  const left = items.length > 0 ? items[0].bound : 0;
  return {found: 2 * search.found, bound: Math.min(width, 2 * Math.max(search.found, search.most, left))};
}
