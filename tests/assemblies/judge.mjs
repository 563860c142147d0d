// Judges octopair's classes of all pairs of closed objects whose boxes meet: node judge.mjs LIBRARIES MODEL.obj RESULT.jsonl TOLERANCE
//
// LIBRARIES  folder with the installed libraries of package.json
// RESULT     written by octopair detect MODEL.obj --stage features --tolerance TOLERANCE --output RESULT.jsonl
//
// manifold-3d intersects the two solids, and largest_ball.mjs searches the largest ball in the common solid. Neither shares code with
// octopair. Prints a table of octopair's answers and the verdicts. Exits 1 if a verdict contradicts an answer:
//   no row       a ball lies in both solids
//   touching     a ball thicker than the tolerance lies in both solids
//   penetrating  thickness_kind is at_least, and no ball of this diameter was found
//   contained    the common volume is not that of the smaller object
//   duplicate    the common volume is not that of both objects
import {readFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {largestBall} from './largest_ball.mjs';
import {readObjects, shellsOf} from './shells.mjs';

// manifold-3d has float32 coordinates, here relative to the middle of the common box. So rounding moves a surface by at most a micrometre.
const rounding = 2e-6;
// Boxes that a search examines, about a second; thin layers of a large area need millions to exclude a thicker ball.
const budget = 50000;
const verdicts = ['no common volume', 'not thicker', 'no thicker ball found', 'thicker'];

const [libraries, model, result, toleranceWord] = process.argv.slice(2);
if (!toleranceWord) throw new Error('usage: node judge.mjs LIBRARIES MODEL.obj RESULT.jsonl TOLERANCE');
const tolerance = Number(toleranceWord);
const {default: load} = await import(pathToFileURL(resolve(libraries, 'manifold-3d/manifold.js')));
const library = await load();
library.setup();
const {Manifold, Mesh} = library;

// Returns the union of an object's shells, with the origin at `centre`.
function solidOf({vertices, shells}, centre) {
  const places = new Float32Array(vertices.flatMap(vertex => vertex.map((value, axis) => value - centre[axis])));
  const meshes = shells.map(shell => new Mesh({numProp: 3, vertProperties: places, triVerts: new Uint32Array(shell.flat())}));
  return Manifold.union(meshes.map(mesh => Manifold.ofMesh(mesh)));
}

// Sets the shells, the box and the volume of an object. Returns why the object is not judged, or nothing.
function prepare(object) {
  const found = shellsOf(object);
  if (!found) return 'not closed';
  object.shells = found.shells;
  object.low = [0, 1, 2].map(axis => Math.min(...object.vertices.map(vertex => vertex[axis])));
  object.high = [0, 1, 2].map(axis => Math.max(...object.vertices.map(vertex => vertex[axis])));
  try {
    object.volume = solidOf(object, object.low).volume();
    const sum = found.shells.reduce((all, shell) => all + solidOf({...object, shells: [shell]}, object.low).volume(), 0);
    // octopair takes shells without a common orientation by parity. If they do not overlap, this is their union.
    return found.oriented || sum <= object.volume * (1 + 1e-5) ? null : 'shells without a common orientation overlap';
  } catch (error) {
    return `refused by manifold-3d (${error.message ?? error})`;
  }
}

function ballIn(solid, search) {
  const {vertProperties, triVerts} = solid.getMesh();
  return largestBall({places: [...vertProperties], corners: triVerts}, search);
}

// Returns {volume, found, bound} of the common solid of two objects.
function intersect(a, b, search) {
  const centre = a.low.map((low, axis) => (Math.max(low, b.low[axis]) + Math.min(a.high[axis], b.high[axis])) / 2);
  const common = Manifold.intersection(solidOf(a, centre), solidOf(b, centre));
  const balls = common.decompose().map(part => ballIn(part, search));
  const most = values => Math.max(0, ...values);
  return {volume: common.volume(), found: most(balls.map(ball => ball.found)), bound: most(balls.map(ball => ball.bound))};
}

// Returns octopair's answer about a pair: the class, and what is known about the thickness.
function answerOf(row) {
  if (!row) return 'no row';
  return ['touching', 'penetrating'].includes(row.class) ? `${row.class} ${row.thickness_kind}` : row.class;
}

// Returns whether the common volume of two objects is that of one of them.
const isVolumeOf = (object, {volume}) => Math.abs(volume - object.volume) <= 1e-4 * object.volume;

// Whether the common solid of two objects contradicts octopair's answer.
const contradicts = {
  'no row': ({found}) => found > rounding,
  'touching at_most': ({found}) => found > tolerance + rounding,
  'penetrating at_least': ({found}, row) => found < row.thickness - rounding,
  'penetrating undecided': () => false,
  'contained': (common, row, a, b) => !isVolumeOf(a.volume < b.volume ? a : b, common),
  'duplicate': (common, row, a, b) => !isVolumeOf(a, common) || !isVolumeOf(b, common),
};

function verdictOf({volume, found, bound}) {
  if (found > tolerance) return 'thicker';
  if (bound > tolerance) return 'no thicker ball found';
  return volume > 0 ? 'not thicker' : 'no common volume';
}

// Throws if the search does not find the largest balls of solids that have known ones.
function checkSearch() {
  const turned = solid => solid.rotate([20, 30, 40]), plate = turned(Manifold.cube([2, 1, 0.002]));
  const tetrahedron = turned(Manifold.tetrahedron()).translate([5, 0, 0]), both = Manifold.union(plate, tetrahedron);
  for (const [solid, diameter] of [[plate, 0.002], [tetrahedron, 2 / Math.sqrt(3)], [both, 2 / Math.sqrt(3)]]) {
    const {found, bound} = ballIn(solid, {enough: Infinity, most: 0.001, budget});
    if (Math.abs(found - diameter) > 1e-4 * diameter || Math.abs(bound - diameter) > 1e-4 * diameter) {
      throw new Error(`the search found a ball of ${found}, and none above ${bound}; the largest one has ${diameter}`);
    }
  }
}

// Returns {answer, verdict, reason} of a pair; reason: what contradicts the answer, or nothing.
function judge(row, a, b) {
  const enough = Math.max(tolerance + rounding, row?.thickness_kind === 'at_least' ? row.thickness : 0);
  const answer = answerOf(row), common = intersect(a, b, {enough, most: row ? tolerance : rounding, budget});
  if (!contradicts[answer]) throw new Error(`${a.name} and ${b.name}: '${answer}' is no answer about closed objects`);
  const facts = `common volume ${common.volume}, largest ball found ${common.found}, no ball above ${common.bound}`;
  return {answer, verdict: verdictOf(common), reason: contradicts[answer](common, row, a, b) ? facts : null};
}

// Judges all pairs. Returns {table, wrong}: the verdicts by octopair's answer, and the number of contradictions.
function judgePairs(objects, rows) {
  const table = new Map(Object.keys(contradicts).map(answer => [answer, verdicts.map(() => 0)]));
  let wrong = 0;
  for (const [j, b] of objects.entries()) {
    for (const [i, a] of objects.slice(0, j).entries()) {
      if (a.left || b.left || !a.low.every((low, axis) => low <= b.high[axis] && b.low[axis] <= a.high[axis])) continue;
      const row = rows.get(`${i} ${j}`), {answer, verdict, reason} = judge(row, a, b);
      table.get(answer)[verdicts.indexOf(verdict)]++;
      if (!reason) continue;
      wrong++;
      console.log(`wrong: objects ${i} and ${j}: ${answer}, thickness ${row?.thickness}; ${reason}\n  ${a.name}\n  ${b.name}`);
    }
  }
  return {table, wrong};
}

checkSearch();
const objects = readObjects(readFileSync(model, 'utf8'));
const lines = readFileSync(result, 'utf8').split('\n').filter(Boolean);
const rows = new Map(lines.map(line => JSON.parse(line)).map(row => [`${row.a} ${row.b}`, row]));
for (const {a, b, a_label, b_label} of rows.values()) {
  if (objects[a].name !== a_label || objects[b].name !== b_label) throw new Error(`${a_label} and ${b_label} are not in ${model}`);
}
for (const object of objects) object.left = prepare(object);
for (const {name, left} of objects.filter(object => object.left)) console.log(`not judged: ${name}: ${left}`);
console.log(`${objects.filter(object => !object.left).length} of ${objects.length} objects are judged`);
const {table, wrong} = judgePairs(objects, rows);
console.log(['octopair'.padEnd(24), ...verdicts].join('  '));
for (const [answer, counts] of table) {
  console.log([answer.padEnd(24), ...verdicts.map((verdict, i) => String(counts[i]).padStart(verdict.length))].join('  '));
}
console.log(`${wrong} contradictions`);
process.exit(wrong > 0 ? 1 : 0);
