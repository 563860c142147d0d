// Fills the page and connects its controls.

// ---- Start ---------------------------------------------------------------------------------------------------------

function fillHeader() {
  document.title = summary.title + ': collisions';
  element('title').textContent = summary.title;
  element('facts').append(...summary.facts.map(([label, value]) => {
    const fact = make('div');
    const isCount = /^\d{5,}$/.test(value);
    fact.append(make('dt', label), make('dd', isCount ? Number(value).toLocaleString('en') : value));
    return fact;
  }));
  element('notes').textContent = summary.notes.join(' ');
  element('notes').hidden = summary.notes.length === 0;
}
// Returns the deepest collision. If no objects meet, returns the nearest pair. Null if no such row exists.
function worstRow() {
  let worst = null;
  for (const row of present) if (row.depth > 0 && row.depth > (worst?.depth ?? 0)) worst = row;
  if (worst || present.some(row => row.kind !== 1)) return worst;
  for (const row of present) if (row.distance !== null && row.distance < (worst?.distance ?? Infinity)) worst = row;
  return worst;
}
function fillWorst() {
  const worst = worstRow(), card = element('worst');
  if (!worst) return;
  const isNear = worst.kind === 1, place = placeOf(worst);
  card.hidden = false;
  card.classList.toggle('near-only', isNear);
  card.append(make('strong', isNear ? 'No objects meet. The nearest pair: ' : 'The worst collision: '),
              make('bdi', nameAndType(worst.first)), ' and ', make('bdi', nameAndType(worst.second)), ', ',
              make('strong', isNear ? `${length(worst.distance)} apart` : `${className(worst)}, ${depthText(worst)} deep`),
              place ? `, at ${point(place)}.` : '.');
  card.onclick = () => { chooseAndReveal(worst); goToChosen(); };
}
function listen() {
  for (const id of filterIds) element(id).oninput = refresh;
  element('clear').onclick = () => { clearFilters(); refresh(); };
  element('group').onchange = () => { groupBy(element('group').value); refresh(); };
  element('show').onchange = draw;
  element('body').onkeydown = onTableKey;
  const isEscape = event => event.key === 'Escape' && event.target.id !== 'search';
  addEventListener('keydown', event => { if (chosen && isEscape(event)) endChoice(); });
  addEventListener('hashchange', followFragment);
  addEventListener('resize', drawSoon);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawSoon);
  // Paper has light colours, whatever the colours of the screen.
  const paper = on => () => { document.documentElement.classList.toggle('paper', on); draw(); };
  addEventListener('beforeprint', paper(true));
  addEventListener('afterprint', paper(false));
}
function start() {
  fillHeader();
  element('none').hidden = present.length > 0;
  element('none-gone').hidden = rows.length === 0;
  element('report').hidden = rows.length === 0;
  if (rows.length === 0) return;
  element('picture').hidden = objectBoxes.length === 0;
  element('controls').hidden = rows.length === 1;
  fillWorst();
  fillFilters();
  fillGroupings();
  makeViews();
  startViewer();
  sortRows();
  listHead();
  showDetails();
  listen();
  refresh();
  followFragment();
}
start();
