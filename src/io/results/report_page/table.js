// The table: its lines, its pages, and the keys that control it.

// ---- Table ---------------------------------------------------------------------------------------------------------

// `lines[i]` is the content of row i of the table. `current` is the index of the row that the Tab key reaches.
let page = 0, lines = [], current = 0, chosen = null;

function refresh() {
  const filter = readFilter();
  shown = ordered.filter(row => passes(row, filter));
  groups = null;
  if (grouping.keys) makeGroups();
  page = 0;
  current = 0;
  pageOfGroup.clear();
  const gathered = groups ? ` in ${count(groups.length, 'group')}` : '';
  const total = filter.change === notGone ? present.length : rows.length;
  element('count-text').textContent = `${shown.length.toLocaleString('en')} of ${count(total, 'collision')}${gathered}.`;
  list();
  drawSoon();
}
function listHead() {
  element('head').replaceChildren(...columns.map(({key, title, style}) => {
    const cell = make('th', '', style.replace('name', '')), arrow = sorting !== key ? '' : falling ? ' \u2193' : ' \u2191';
    cell.scope = 'col';
    cell.dataset.title = title + arrow;
    cell.ariaSort = arrow === '' ? 'none' : falling ? 'descending' : 'ascending';
    cell.append(makeButton(title + arrow, () => sortBy(key)));
    return cell;
  }));
}
const onPage = (all, which) => all.slice(which * perPage, (which + 1) * perPage);
function visibleLines() {
  if (!groups) return onPage(shown, page).map(row => ({row, group: null}));
  return onPage(groups, page).flatMap(group => {
    if (!open.has(group.key)) return [{group, row: null}];
    const members = onPage(group.rows, pageOfGroup.get(group.key) ?? 0).map(row => ({row, group}));
    return [{group, row: null}, ...members, ...(group.rows.length > perPage ? [{group, row: null, turn: true}] : [])];
  });
}
function list() {
  lines = visibleLines();
  current = Math.min(current, Math.max(0, lines.length - 1));
  element('body').replaceChildren(...lines.map(tableLine));
  element('empty').hidden = shown.length > 0;
  const all = groups ?? shown;
  const turn = to => {
    page = to;
    current = 0;
    list();
    focusLine(0);
  };
  const buttons = all.length > perPage ? [pageButtons(all.length, page, groups ? 'group' : 'collision', turn)] : [];
  element('pages').replaceChildren(...buttons);
}
function pageButtons(many, at, what, turn) {
  const made = make('div', '', 'pages'), first = at * perPage + 1, last = Math.min(many, first + perPage - 1);
  const back = makeButton('\u2190 back', () => turn(at - 1)), next = makeButton('next \u2192', () => turn(at + 1));
  back.disabled = at === 0;
  next.disabled = last === many;
  made.append(back, next, `${first.toLocaleString('en')} to ${last.toLocaleString('en')} of ${count(many, what)}`);
  return made;
}
function tableLine(entry, i) {
  if (entry.turn) return turnLine(entry.group);
  const line = entry.row ? rowLine(entry.row, entry.group) : groupLine(entry.group);
  line.tabIndex = i === current ? 0 : -1;
  line.onclick = () => { setCurrent(i); activate(entry); };
  return line;
}
function rowLine(row, group) {
  const line = make('tr', '', group ? 'member' : '');
  line.ariaLevel = group ? 2 : 1;
  line.ariaSelected = row === chosen;
  line.append(...columns.map(({key, style}) => {
    if (style === 'name') return nameCell(row[key]);
    const mark = isGone(row) ? ' gone' : key !== 'kind' ? '' : row.kind === 1 ? ' near' : ' hit';
    return make('td', cellText(row, key), key === 'kind' || key === 'change' ? style + mark : style);
  }));
  return line;
}
function nameCell(object) {
  const cell = make('td', '', 'name'), quiet = typeOrParent(object);
  cell.title = object.path;
  cell.append(make('span', object.label));
  if (quiet) cell.append(make('small', quiet));
  return cell;
}
function cellText(row, key) {
  if (key === 'kind') return className(row);
  if (row[key] === null) return '';
  if (key === 'change') return changes[row.change];
  if (key === 'contacts') return row.contacts + (row.more ? '+' : '');
  return (key === 'depth' && row.atLeast ? '\u2265\u00a0' : '') + number(row[key]);
}
function groupLine(group) {
  const line = make('tr', '', 'group'), {title, more} = grouping.describe(group.key), isOpen = open.has(group.key);
  line.ariaLevel = 1;
  line.ariaExpanded = isOpen;
  const cell = make('td', isOpen ? '\u25be ' : '\u25b8 ', 'name'), spanned = has('kind') ? 3 : 2;
  cell.colSpan = spanned;
  cell.append(make('strong', title), make('span', count(group.rows.length, 'collision')));
  cell.append(make('small', classCounts(group.rows)));
  if (more) cell.append(make('small', more));
  line.append(cell, ...columns.slice(spanned).map(({key, style}) => make('td', groupText(group, key), style)));
  return line;
}
// Returns the text of a group in a column: its greatest depth or smallest distance.
function groupText(group, key) {
  if (key !== 'depth' && key !== 'distance') return '';
  const sign = key === 'depth' ? 1 : -1;
  let best = null;
  for (const row of group.rows) if (row[key] !== null && (best === null || sign * (row[key] - best[key]) > 0)) best = row;
  return best === null ? '' : cellText(best, key);
}
function classCounts(members) {
  if (!has('kind')) return '';
  const many = new Array(classes.length).fill(0);
  for (const row of members) ++many[row.kind];
  const texts = many.map((value, i) => value ? `${value.toLocaleString('en')}\u00a0${classes[i]}` : '');
  return texts.filter(text => text).reverse().join(', ');
}
function turnLine(group) {
  const line = make('tr', '', 'turn'), cell = line.insertCell();
  cell.colSpan = columns.length;
  cell.append(pageButtons(group.rows.length, pageOfGroup.get(group.key) ?? 0, 'collision', to => {
    pageOfGroup.set(group.key, to);
    list();
    focusLine(lines.findIndex(entry => entry.group === group) + 1);
  }));
  return line;
}

// ---- Keyboard ------------------------------------------------------------------------------------------------------

function setCurrent(i) {
  const all = element('body').children;
  if (all[current]) all[current].tabIndex = -1;
  current = i;
  if (all[i]) all[i].tabIndex = 0;
}
function focusLine(i) {
  if (i < 0 || i >= lines.length) return;
  setCurrent(i);
  element('body').children[i].focus();
}
// Moves to the next line in direction `step` that is not a line of page buttons.
function moveBy(step) {
  let to = current + step;
  if (lines[to]?.turn) to += step;
  focusLine(to);
}
function activate({group, row}) {
  if (row) choose(row === chosen ? null : row);
  else toggleGroup(group);
}
function toggleGroup(group) {
  if (!open.delete(group.key)) open.add(group.key);
  list();
  focusLine(lines.findIndex(entry => entry.group === group));
}
function onTableKey(event) {
  if (event.target.localName !== 'tr' || event.ctrlKey || event.metaKey || event.altKey) return;
  const entry = lines[current], isOpen = entry.group && open.has(entry.group.key);
  const toGroup = () => focusLine(lines.findIndex(({group}) => group === entry.group));
  const actions = {
    ArrowDown: () => moveBy(1), ArrowUp: () => moveBy(-1),
    Home: () => focusLine(0), End: () => focusLine(lines.length - (lines.at(-1).turn ? 2 : 1)),
    Enter: () => activate(entry), ' ': () => activate(entry),
    ArrowRight: () => { if (entry.group && !isOpen) toggleGroup(entry.group); },
    ArrowLeft: () => { if (entry.row && entry.group) toGroup(); else if (isOpen) toggleGroup(entry.group); },
  };
  if (!actions[event.key]) return;
  event.preventDefault();
  actions[event.key]();
}
