'use strict';
// The data: rows (collisions), gone (collisions of an older result), objects, others (boxes of objects without a collision),
// words (texts that objects refer to by index) and summary. The page sets names only as text, never as HTML.

// ---- Data ----------------------------------------------------------------------------------------------------------

const element = id => document.getElementById(id);
const read = id => JSON.parse(element(id)?.textContent ?? '[]');
const summary = read('summary'), words = read('words'), others = read('others');
if (words.length === 0) words.push('');
const classes = ['unknown', 'clearance', 'collision', 'touching', 'penetrating', 'contained', 'duplicate'];
const changes = ['new', 'same', 'gone'], gone = 2;
const axes = 'xyz', perPage = 100;
const unit = summary.unit ? '\u00a0' + summary.unit : '';

const collator = new Intl.Collator(undefined, {numeric: true});
const lastPart = path => path.slice(path.lastIndexOf('/') + 1) || path;

// `type`, `parent`, `level` and `material` are indices into `words`; index 0 means that the value is not known.
function makeObject([number, path, ...rest]) {
  const [label = 0, type = 0, id = 0, parent = 0, level = 0, material = 0] = rest.slice(6);
  const box = rest.length >= 6 ? rest.slice(0, 6) : null;
  return {number, path, box, label: words[label] || lastPart(path) || '#' + number, id: words[id] || '',
          type, parent, level, material, text: null, found: 0, rank: 0};
}
const objects = read('objects').map(list => new Map(list.map(fields => [fields[0], makeObject(fields)])));
const allObjects = objects.flatMap(map => [...map.values()]);

function makeRow([a, b, kind, change, distance, depth, time, contacts, more, at, atLeast, atMost = null, open = 0]) {
  return {first: objects[0].get(a), second: objects[summary.join ? 1 : 0].get(b), kind, change, distance, depth, time,
          contacts, more, at, atLeast, atMost, open, a, b};
}
function numberOfWord(text) {
  const found = words.indexOf(text);
  return found >= 0 ? found : words.push(text) - 1;
}
// For a collision that is gone, only names, labels and types of the objects are known.
function makeGoneRow([a, b, kind, distance, depth, time, contacts, atLeast, ...details]) {
  const known = Math.max(0, classes.indexOf(kind)), noBox = Array(6).fill(null);
  const row = makeRow([null, null, known, gone, distance, depth, time, contacts, 0, null, atLeast]);
  const [aLabel, aType, bLabel, bType] = details.map(numberOfWord);
  row.first = makeObject([null, a, ...noBox, aLabel, aType]);
  row.second = makeObject([null, b, ...noBox, bLabel, bType]);
  row.first.box = row.second.box = null;
  allObjects.push(row.first, row.second);
  return row;
}
const isGone = row => row.a === null;
const present = read('rows').map(makeRow);
const rows = [...present, ...read('gone').map(makeGoneRow)];

// Without details, the parent of an object is the part of its path before the last "/".
const hasDetails = allObjects.some(object => object.type || object.parent || object.level || object.material);
function deriveParents() {
  const index = new Map();
  for (const object of allObjects) {
    const parent = object.path.slice(0, Math.max(0, object.path.lastIndexOf('/')));
    if (parent && !index.has(parent)) index.set(parent, words.push(parent) - 1);
    object.parent = index.get(parent) ?? 0;
  }
}
if (!hasDetails) deriveParents();

// Returns where the pair meets; without a known place, the centre of the overlap (or gap) of the two boxes.
function placeOf(row) {
  if (row.at !== null || !row.first.box) return row.at;
  const a = row.first.box, b = row.second.box;
  return [0, 1, 2].map(i => (Math.max(a[i], b[i]) + Math.min(a[i + 3], b[i + 3])) / 2);
}

// ---- Text ----------------------------------------------------------------------------------------------------------

const meanings = [
  'The check did not determine how the two objects meet.',
  'The objects are apart, but nearer than the margin.',
  'The two objects meet. The check did not determine how.',
  'The objects share only surface, or a motion of at most the tolerance separates them.',
  'The insides of the objects share space.',
  'One object lies wholly inside the other.',
  'The objects have the same geometry at the same place.',
];
const number = value => String(Number(value.toPrecision(6)));
const length = value => number(value) + unit;
const point = at => at.map((value, i) => `${axes[i]}\u00a0${number(value)}`).join(', ') + unit;
const count = (many, one) => `${many.toLocaleString('en')} ${many === 1 ? one : one + 's'}`;
const className = row => row.kind === 0 ? '' : classes[row.kind];
const depthText = row => (row.atLeast ? 'at least ' : '') + length(row.depth);
const shorten = text => text.length > 100 ? text.slice(0, 99) + '\u2026' : text;
const nameAndType = object => shorten(object.label) + (object.type ? ` (${shorten(words[object.type])})` : '');
const shortWord = index => hasDetails ? words[index] : lastPart(words[index]);
const typeOrParent = object => words[object.type] || shortWord(object.parent);

function make(tag, text = '', style = '') {
  const made = document.createElement(tag);
  made.textContent = text;
  if (style) made.className = style;
  return made;
}
function makeButton(text, action) {
  const button = make('button', text);
  button.type = 'button';
  button.onclick = action;
  return button;
}
function say(text) { element('said').textContent = text; }
