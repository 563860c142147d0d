// The collision that the reader has chosen: its address, and all details that the data have.

// ---- The chosen collision ------------------------------------------------------------------------------------------

function choose(row) {
  chosen = row;
  lines.forEach((entry, i) => { if (entry.row) element('body').children[i].ariaSelected = entry.row === row; });
  writeFragment();
  showDetails();
  drawSoon();
  showInViewer(row);
  say(row ? `Chosen: ${row.first.label} and ${row.second.label}` : 'No collision is chosen');
}
// Chooses a row and shows it in the table. If filters hide the row, clears the filters.
function chooseAndReveal(row) {
  if (!shown.includes(row)) {
    clearFilters();
    if (isGone(row)) element('change').value = everyChange;
    refresh();
  }
  const group = groups?.find(candidate => candidate.rows.includes(row)) ?? null;
  page = Math.floor((groups ? groups.indexOf(group) : shown.indexOf(row)) / perPage);
  if (group) {
    open.add(group.key);
    pageOfGroup.set(group.key, Math.floor(group.rows.indexOf(row) / perPage));
  }
  list();
  setCurrent(lines.findIndex(entry => entry.row === row));
  choose(row);
}
function goToChosen() {
  focusLine(current);
  element('body').children[current].scrollIntoView({block: 'center'});
}
// Clears the choice, which removes the buttons of the details. If one of these has the focus, moves the focus to the table.
function endChoice() {
  const wasInside = element('details').contains(document.activeElement);
  choose(null);
  if (wasInside) focusLine(current);
}

// The fragment of the address names the pair by its numbers, for example #clash=12-34. A collision that is gone has no numbers.
const fragmentOf = row => row && !isGone(row) ? `#clash=${row.a}-${row.b}` : '';
function writeFragment() {
  const fragment = fragmentOf(chosen);
  if (location.hash === fragment) return;
  try { history.replaceState(null, '', fragment || location.pathname + location.search); }
  catch { /* A page within another document may not change its address. */ }
}
function followFragment() {
  const pair = /^#clash=(\d+)-(\d+)$/.exec(location.hash)?.slice(1).map(Number);
  if (!pair) return;
  const [a, b] = pair, isPair = row => row.a === a && row.b === b, isSwapped = row => row.a === b && row.b === a;
  const row = present.find(isPair) ?? (summary.join ? undefined : present.find(isSwapped));
  if (!row) return say('The address names a collision that this report does not have');
  if (row !== chosen) chooseAndReveal(row);
  goToChosen();
}
async function copy(text) {
  try { await navigator.clipboard.writeText(text); }
  catch { copyBySelection(text); }
}
// Copies a text if the browser gives the page no access to the clipboard.
function copyBySelection(text) {
  const area = make('textarea', text, 'unseen'), focused = document.activeElement;
  document.body.append(area);
  area.select();
  document.execCommand('copy');
  area.remove();
  focused?.focus();
}

// ---- Details -------------------------------------------------------------------------------------------------------

// An entry of the details has a term and a value. If a button copies the value, the entry also has the text to copy.
function definitions(entries) {
  const made = make('dl');
  for (const [term, value, copied] of entries) {
    if (value === null || value === '') continue;
    const text = make('dd', value);
    if (copied) text.append(makeCopyButton('copy', copied, `Copy the ${term}`));
    made.append(make('dt', term), text);
  }
  return made;
}
function makeCopyButton(title, text, spoken) {
  const button = makeButton(title, async () => {
    await copy(text);
    button.textContent = 'copied';
    say('Copied');
    setTimeout(() => { button.textContent = title; }, 1500);
  });
  if (spoken) button.ariaLabel = spoken;
  return button;
}
function showDetails() {
  const panel = element('details');
  panel.className = chosen ? '' : 'empty';
  if (!chosen) {
    panel.replaceChildren('Choose a collision in the table or in the picture to see what is known about it.');
    return;
  }
  panel.replaceChildren(make('h2', className(chosen) || 'collision'), make('p', meanings[chosen.kind]), detailButtons(),
                        definitions(measures(chosen)), ...openNotes(chosen), ...objectDetails(chosen.first, 'a'),
                        ...objectDetails(chosen.second, 'b'));
  panel.scrollTop = 0;
}
function measures(row) {
  const atMost = row.atMost === null ? '' : `, at most ${length(row.atMost)}`;
  const place = placeOf(row), estimate = row.at === null ? ' (estimated from the boxes)' : '';
  return [
    ['depth', row.depth === null ? '' : depthText(row) + atMost],
    ['', row.depth === null ? '' : 'The depth is the length of the least translation that separates the two objects.'],
    ['distance', row.distance === null ? '' : length(row.distance)],
    ['time', row.time === null ? '' : number(row.time)],
    ['contacts', row.contacts === null ? '' : (row.more ? 'more than ' : '') + row.contacts],
    ['place', place === null ? '' : point(place) + estimate, place?.join(', ')],
    ['change', row.change === null ? '' : changes[row.change]],
  ];
}
function openNotes({open: bits}) {
  if (!bits) return [];
  const which = ['', 'Mesh a is not closed', 'Mesh b is not closed', 'Neither mesh is closed'][bits];
  return [make('p', which + ', so the pair was judged without an inside.', 'near')];
}
function objectDetails(object, side) {
  const title = make('h3'), swatch = make('i', '', 'swatch');
  swatch.style.color = `var(--${side})`;
  title.append(swatch, `${side}: ${object.label}`);
  const range = i => `${axes[i]}\u00a0${number(object.box[i])} to ${number(object.box[i + 3])}`;
  const box = object.box && [0, 1, 2].map(range).join(', ') + unit;
  return [title, definitions([
    ['type', words[object.type]], ['path', object.path, object.path], ['id', object.id, object.id],
    ['parent', words[object.parent]], ['level', words[object.level]], ['material', words[object.material]],
    ['number', object.number === null ? '' : String(object.number)], ['box', box],
  ])];
}
function detailButtons() {
  const made = make('div', '', 'buttons');
  if (chosen.first.box) made.append(makeButton('show in the picture', () => {
    element('show').value = 'place';
    draw();
    element('picture').scrollIntoView();
  }));
  if (!isGone(chosen)) made.append(makeCopyButton('copy link', location.href.split('#')[0] + fragmentOf(chosen)));
  made.append(makeButton('close', endChoice));
  return made;
}
