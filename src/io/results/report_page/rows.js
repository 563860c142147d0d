// Chooses and orders the rows of the table: columns, sorting, filters, groups.

// ---- Columns and sorting -------------------------------------------------------------------------------------------

const bracketUnit = summary.unit ? ` (${summary.unit})` : '';
const hasDepths = rows.some(row => row.depth !== null);
const columns = [
  {key: 'first', title: 'object a', style: 'name'},
  {key: 'second', title: 'object b', style: 'name'},
  {key: 'kind', title: 'class', style: ''},
  {key: 'depth', title: 'depth' + bracketUnit, style: 'number'},
  {key: 'distance', title: 'distance' + bracketUnit, style: hasDepths ? 'number extra' : 'number'},
  {key: 'time', title: 'time', style: 'number extra'},
  {key: 'contacts', title: 'contacts', style: 'number extra'},
  {key: 'change', title: 'change', style: ''},
].filter(({key, style}) => style === 'name' || rows.some(row => key === 'kind' ? row.kind > 0 : row[key] !== null));
const has = key => columns.some(column => column.key === key);

// At first, the worst collisions come first: the deepest, or without depths those with the smallest distance.
let sorting = hasDepths ? 'depth' : has('distance') ? 'distance' : null, falling = sorting === 'depth';
let ordered = rows;

// Comparing names is slow, so each object gets the rank of its name once.
let ranked = false;
function rankNames() {
  if (ranked) return;
  ranked = true;
  const sorted = [...allObjects].sort((x, y) => collator.compare(x.label, y.label));
  sorted.forEach((object, i) => { object.rank = i > 0 && sorted[i - 1].label === object.label ? sorted[i - 1].rank : i; });
}
function sortRows() {
  if (sorting === null) return;
  const isName = sorting === 'first' || sorting === 'second', sign = falling ? -1 : 1;
  if (isName) rankNames();
  const valueOf = isName ? row => row[sorting].rank : row => row[sorting];
  ordered = [...rows].sort((x, y) => {
    const u = valueOf(x), v = valueOf(y);
    return u === null || v === null ? (u === null) - (v === null) : sign * (u - v);
  });
}
function sortBy(key) {
  falling = sorting === key ? !falling : key === 'depth';
  sorting = key;
  sortRows();
  listHead();
  refresh();
  element('head').children[columns.findIndex(column => column.key === key)].firstChild.focus();
}

// ---- Filters -------------------------------------------------------------------------------------------------------

const selects = ['class', 'change', 'type', 'level', 'material'];
const filterIds = ['search', ...selects, 'from', 'to'];
let shown = rows;

function readFilter() {
  const choice = id => element(id).value === '' ? null : Number(element(id).value);
  const filter = Object.fromEntries([...selects, 'from', 'to'].map(id => [id, choice(id)]));
  // Bit i of an object's `found` says that the object's text contains searched word i. At most 30 words fit.
  const searched = element('search').value.toLowerCase().split(/\s+/).filter(word => word).slice(0, 30);
  filter.all = (1 << searched.length) - 1;
  if (searched.length) markFound(searched);
  return filter;
}
function markFound(searched) {
  for (const object of allObjects) {
    object.text ??= searchText(object);
    object.found = 0;
    searched.forEach((word, i) => { if (object.text.includes(word)) object.found |= 1 << i; });
  }
}
function searchText(object) {
  const known = ['type', 'parent', 'level', 'material'].map(field => words[object[field]]);
  return [object.path, object.label, object.id, '#' + object.number, ...known].join('\n').toLowerCase();
}
const everyChange = -1, notGone = -2;
function passes({first, second, kind, change, depth}, filter) {
  return (filter.class === null || kind === filter.class) &&
         (filter.change === null || filter.change === everyChange || change === filter.change ||
          (filter.change === notGone && change !== gone)) &&
         (filter.type === null || first.type === filter.type || second.type === filter.type) &&
         (filter.level === null || first.level === filter.level || second.level === filter.level) &&
         (filter.material === null || first.material === filter.material || second.material === filter.material) &&
         (filter.from === null || (depth !== null && depth >= filter.from)) &&
         (filter.to === null || (depth !== null && depth <= filter.to)) &&
         (filter.all === 0 || (first.found | second.found) === filter.all);
}
function clearFilters() {
  for (const id of filterIds) element(id).value = '';
  // If there are other collisions, those that are gone are hidden at first.
  if (has('change')) element('change').value = present.length ? notGone : everyChange;
}

function fillSelect(id, all, options) {
  element(id).append(...(all ? [new Option(all, '')] : []), ...options.map(([value, text]) => new Option(text, value)));
  element(id).parentElement.hidden = options.length < 2;
}
function wordOptions(field) {
  const found = new Set(allObjects.map(object => object[field]));
  found.delete(0);
  return [...found].map(index => [index, words[index]]).sort((x, y) => collator.compare(x[1], y[1]));
}
function fillFilters() {
  const kinds = new Set(rows.map(row => row.kind)), used = new Set(rows.map(row => row.change));
  fillSelect('class', 'all', classes.map((word, i) => [i, word]).filter(([i]) => kinds.has(i)));
  fillSelect('change', '', has('change') ? [[notGone, 'new or same'], [everyChange, 'new, same or gone'],
             ...changes.map((word, i) => [i, word]).filter(([i]) => used.has(i))] : []);
  for (const field of ['type', 'level', 'material']) fillSelect(field, 'all', wordOptions(field));
  element('from-label').textContent = `depth${bracketUnit} from`;
  element('depths').hidden = !hasDepths;
  clearFilters();
}

// ---- Groups --------------------------------------------------------------------------------------------------------

// A grouping has a title for the reader, a hint, and these functions:
// - keys: returns the keys of the groups that a row belongs to;
// - describe: returns the title of the group of a key, and a longer text about the group;
// - known: returns true if the data have the details that the grouping needs.
// A pair of words in any order is one key. The key is a number, because a Map of numbers is fast.
function pairKey(row, field) {
  const u = row.first[field], v = row.second[field];
  return u < v ? u * words.length + v : v * words.length + u;
}
function pairTitle(key, field) {
  const pair = [Math.floor(key / words.length), key % words.length].sort((x, y) => collator.compare(words[x], words[y]));
  const join = names => (names[0] === names[1] && field !== 'type' ? names.slice(1) : names).join(' \u00d7 ');
  const title = join(pair.map(index => shortWord(index) || 'no ' + field)), full = join(pair.map(index => words[index]));
  return {title, more: hasDetails ? '' : full};
}
const byPair = (title, field, hint) => ({
  title, hint, keys: row => [pairKey(row, field)], describe: key => pairTitle(key, field),
  known: () => allObjects.some(object => object[field] > 0),
});
const pairHint = word => `A group has the collisions within one ${word}, or between two.`;
const groupings = {
  none: {title: 'nothing', hint: '', known: () => true},
  type: byPair('pair of types', 'type', 'A pair of types is one group in either order.'),
  parent: byPair('pair of parents', 'parent', pairHint('parent')),
  level: byPair('level', 'level', pairHint('level')),
  material: byPair('material', 'material', pairHint('material')),
  object: {
    title: 'object', hint: 'Each collision counts under both of its objects.', known: () => true,
    keys: row => row.first === row.second ? [row.first] : [row.first, row.second],
    describe: object => ({title: shorten(object.label), more: typeOrParent(object)}),
  },
};
let grouping = groupings.none, groups = null;
const open = new Set(), pageOfGroup = new Map();

// `shown` is sorted. So groups are in the order of their first rows, which are the worst. Without sorting, the largest group is first.
function makeGroups() {
  const found = new Map();
  for (const row of shown) {
    for (const key of grouping.keys(row)) {
      const members = found.get(key);
      if (members) members.push(row);
      else found.set(key, [row]);
    }
  }
  groups = [...found].map(([key, members]) => ({key, rows: members}));
  if (sorting === null) groups.sort((x, y) => y.rows.length - x.rows.length);
}
function defaultGrouping() {
  if (rows.length <= 50) return 'none';
  for (const id of ['type', 'parent']) {
    if (!groupings[id].known()) continue;
    const many = new Set(rows.flatMap(groupings[id].keys)).size;
    if (many > 1 && many <= rows.length / 2) return id;
  }
  return 'none';
}
function groupBy(id) {
  grouping = groupings[id];
  open.clear();
  pageOfGroup.clear();
  element('group').value = id;
  element('hint').textContent = grouping.hint;
}
function fillGroupings() {
  const known = Object.entries(groupings).filter(([, {known}]) => known());
  fillSelect('group', '', known.map(([id, {title}]) => [id, title]));
  groupBy(defaultGrouping());
}
