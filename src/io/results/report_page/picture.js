// The three drawings of the boxes: from three sides.

// ---- Picture -------------------------------------------------------------------------------------------------------

// A view has an axis and a sign for the directions right and up. Each view is right-handed: right x up points to the reader.
const views = summary.up === 1 ? [
  {title: 'from above: x to the right, z down', right: [0, 1], up: [2, -1]},
  {title: 'from the front: x to the right, y up', right: [0, 1], up: [1, 1]},
  {title: 'from the side: z to the left, y up', right: [2, -1], up: [1, 1]},
] : [
  {title: 'from above: x to the right, y up', right: [0, 1], up: [1, 1]},
  {title: 'from the front: x to the right, z up', right: [0, 1], up: [2, 1]},
  {title: 'from the side: y to the right, z up', right: [1, 1], up: [2, 1]},
];
const fewRows = 200, cell = 6, heatColours = 5;  // more rows than `fewRows` are drawn as counts per cell of `cell` pixels
const maxOutlines = 20000;  // above this number, outlines of boxes would cover everything
const objectBoxes = allObjects.map(object => object.box).filter(box => box !== null);
const allBounds = boundsOf([...others, ...objectBoxes]);
const stride = Math.ceil((others.length + objectBoxes.length) / maxOutlines);
const outlinedBoxes = [...others, ...objectBoxes].filter((box, i) => i % stride === 0);

function boundsOf(boxes) {
  const bounds = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
  for (const box of boxes) {
    for (let i = 0; i < 3; ++i) {
      bounds[i] = Math.min(bounds[i], box[i]);
      bounds[i + 3] = Math.max(bounds[i + 3], box[i + 3]);
    }
  }
  return bounds;
}
// Returns the overlap of the boxes of the chosen pair, enlarged on each side to show what is around.
function boundsOfPlace({first, second}) {
  const a = first.box, b = second.box, low = [], high = [];
  for (let i = 0; i < 3; ++i) {
    const ends = [Math.max(a[i], b[i]), Math.min(a[i + 3], b[i + 3])];
    low.push(Math.min(...ends));
    high.push(Math.max(...ends));
  }
  const room = .5 * Math.max(...high.map((value, i) => value - low[i])) || .02 * sizeOf(boundsOf([a, b]));
  return [...low.map(value => value - room), ...high.map(value => value + room)];
}
const sizeOf = bounds => Math.max(...[0, 1, 2].map(i => bounds[i + 3] - bounds[i]));
function boundsToShow() {
  const what = element('show').value;
  if (!chosen?.first.box || what === 'all') return allBounds;
  return what === 'pair' ? boundsOf([chosen.first.box, chosen.second.box]) : boundsOfPlace(chosen);
}

function makeViews() {
  for (const view of views) {
    const figure = make('figure');
    view.canvas = make('canvas');
    view.canvas.setAttribute('role', 'img');
    view.canvas.onclick = event => chooseNearest(view, event.offsetX, event.offsetY);
    figure.append(view.canvas, make('figcaption', view.title));
    element('views').append(figure);
  }
}
// Sets the functions that map a point to the canvas. The bounds fill the canvas, and both directions have the same scale.
function fitView(view, bounds) {
  const {canvas, right: [across, acrossSign], up: [along, alongSign]} = view, edge = 14, dense = devicePixelRatio || 1;
  view.width = canvas.clientWidth;
  view.height = canvas.clientHeight;
  canvas.width = view.width * dense;
  canvas.height = view.height * dense;
  view.context = canvas.getContext('2d');
  view.context.scale(dense, dense);
  const middle = axis => (bounds[axis] + bounds[axis + 3]) / 2, extent = axis => bounds[axis + 3] - bounds[axis];
  const size = sizeOf(bounds) || 1, fit = (pixels, axis) => (pixels - 2 * edge) / Math.max(extent(axis), size / 1000);
  view.scale = Math.min(fit(view.width, across), fit(view.height, along));
  view.x = at => view.width / 2 + acrossSign * (at[across] - middle(across)) * view.scale;
  view.y = at => view.height / 2 - alongSign * (at[along] - middle(along)) * view.scale;
  view.rectangle = box => {
    const high = box.slice(3), x = Math.min(view.x(box), view.x(high)), y = Math.min(view.y(box), view.y(high));
    view.context.rect(x, y, (box[across + 3] - box[across]) * view.scale, (box[along + 3] - box[along]) * view.scale);
  };
}

let drawing = false;
function drawSoon() {
  if (drawing) return;
  drawing = true;
  requestAnimationFrame(() => { drawing = false; draw(); });
}
function draw() {
  if (!objectBoxes.length) return;
  const bounds = boundsToShow(), isHeat = shown.length > fewRows;
  const places = shown.map(placeOf).filter(at => at !== null);
  for (const view of views) fitView(view, bounds);
  const heat = isHeat ? views.map(view => countPerCell(view, places)) : [];
  const limits = isHeat ? heatLimits(heat.reduce((most, counts) => counts.reduce((x, y) => Math.max(x, y), most), 1)) : [];
  views.forEach((view, i) => {
    outline(view, outlinedBoxes, 'box', 1, isHeat ? .3 : .6);
    if (isHeat) paintHeat(view, heat[i], limits);
    else outlineShown(view);
    drawChosen(view);
    drawScaleBar(view);
    describe(view, places.length, bounds);
  });
  writeLegend(limits);
}
const colourOf = name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
function outline(view, boxes, colour, thickness, strength) {
  const {context} = view;
  context.beginPath();
  boxes.forEach(view.rectangle);
  context.strokeStyle = colourOf(colour);
  context.globalAlpha = strength;
  context.lineWidth = thickness;
  context.stroke();
  context.globalAlpha = 1;
}
function outlineShown(view) {
  for (const [colour, isNear] of [['near', true], ['hit', false]]) {
    const some = shown.filter(row => (row.kind === 1) === isNear && row.first.box);
    outline(view, some.flatMap(row => [row.first.box, row.second.box]), colour, 1, chosen ? .45 : .9);
    for (const row of some) drawDot(view, placeOf(row), colour, 2.5);
  }
}
function drawDot(view, at, colour, radius) {
  view.context.beginPath();
  view.context.arc(view.x(at), view.y(at), radius, 0, 7);
  view.context.fillStyle = colourOf(colour);
  view.context.fill();
}
function drawChosen(view) {
  if (!chosen?.first.box) return;
  outline(view, [chosen.first.box], 'a', 2.5, 1);
  outline(view, [chosen.second.box], 'b', 2.5, 1);
  drawDot(view, placeOf(chosen), 'page', 6);
  drawDot(view, placeOf(chosen), 'hit', 4);
}

// Returns the number of places in each cell of a view, row by row.
function countPerCell(view, places) {
  const wide = Math.ceil(view.width / cell), high = Math.ceil(view.height / cell), counts = new Uint32Array(wide * high);
  for (const at of places) {
    const column = Math.floor(view.x(at) / cell), line = Math.floor(view.y(at) / cell);
    if (column >= 0 && column < wide && line >= 0 && line < high) ++counts[line * wide + column];
  }
  return counts;
}
// Returns limits: colour i stands for counts from limits[i] to limits[i + 1] - 1. The limits grow by a constant factor,
// because few cells have most of the places.
function heatLimits(most) {
  const limits = Array.from({length: heatColours}, (_, i) => Math.round(most ** (i / heatColours)));
  return [...new Set(limits), most + 1];
}
const heatColour = (i, limits) => colourOf('heat' + Math.round(i * (heatColours - 1) / Math.max(1, limits.length - 2)));
function paintHeat(view, counts, limits) {
  const wide = Math.ceil(view.width / cell), colours = limits.slice(1).map((_, i) => heatColour(i, limits));
  counts.forEach((many, i) => {
    if (many === 0) return;
    view.context.fillStyle = colours[limits.findLastIndex(least => least <= many)];
    view.context.fillRect(i % wide * cell, Math.floor(i / wide) * cell, cell, cell);
  });
}

// Draws a bar of a round length (1, 2 or 5 times a power of ten) that is at most a third of the width.
function drawScaleBar({context, width, height, scale}) {
  const most = width / 3 / scale, power = 10 ** Math.floor(Math.log10(most));
  const long = [5, 2, 1].find(factor => factor * power <= most) * power, text = length(long);
  context.font = '12px system-ui, sans-serif';
  context.strokeStyle = colourOf('panel');  // an edge around the letters, so that lines below do not hide the letters
  context.lineWidth = 3;
  context.strokeText(text, 8, height - 10);
  context.fillStyle = colourOf('text');
  context.fillRect(8, height - 6, long * scale, 2);
  context.fillText(text, 8, height - 10);
}
function describe(view, many, bounds) {
  const extent = ([i]) => `${axes[i]} from ${number(bounds[i])} to ${number(bounds[i + 3])}`;
  view.canvas.ariaLabel = `Picture ${view.title}. ${count(many, 'collision')}; ${extent(view.right)}, ${extent(view.up)}${unit}.`;
}
function writeLegend(limits) {
  const entry = (text, colour, fill) => {
    const made = make('span'), swatch = make('i', '', 'swatch');
    swatch.style.color = colour;
    if (fill) swatch.style.background = colour;
    made.append(swatch, text);
    return made;
  };
  const steps = limits.slice(1).map((next, i) => {
    const least = limits[i], range = next - 1 === least ? `${least}` : `${least} to ${next - 1}`;
    return entry(range, heatColour(i, limits), true);
  });
  const hit = shown.some(row => row.kind !== 1) ? [entry('collides', 'var(--hit)')] : [];
  const near = shown.some(row => row.kind === 1) ? [entry('nearer than the margin', 'var(--near)')] : [];
  const pair = chosen ? [entry('chosen: a', 'var(--a)'), entry('chosen: b', 'var(--b)')] : [];
  const what = steps.length ? [make('span', 'collisions per cell:'), ...steps] : [...hit, ...near];
  element('show-label').hidden = !chosen?.first.box;
  element('legend').replaceChildren(...what, entry('other objects', 'var(--box)'), ...pair);
}
// Chooses the deepest collision within 5 pixels; if there is none, the nearest within 40 pixels.
function chooseNearest(view, x, y) {
  let best = null, least = 40;
  for (const row of shown) {
    const at = placeOf(row);
    if (at === null) continue;
    const away = Math.max(5, Math.hypot(view.x(at) - x, view.y(at) - y));
    if (away < least || (away === least && row.depth > best.depth)) { best = row; least = away; }
  }
  if (best) chooseAndReveal(best);
}
