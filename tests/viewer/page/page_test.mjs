// Tests the page in Chromium: node page_test.mjs --page FILE [--only TEXT] against the mock server, or --server 'COMMAND' against a program.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {existsSync, mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';
import {parseArgs} from 'node:util';
import {checkAccessibility, checkKeys, colourAt, complete, depthDigits, light, near, tablePairs, text, waitForText} from '../browser/checks.mjs';
import {accessibility, clickAt, data, launch, open, pixel, project, ready, runTests, settings, viewerFolder, waitForData} from './browser.mjs';
import {exportPage} from './export.mjs';

const {values: options} = parseArgs({options: {
  page: {type: 'string', default: join(viewerFolder, 'page.html')}, only: {type: 'string', default: ''}, server: {type: 'string'},
}});
const {startMock} = await import(pathToFileURL(join(viewerFolder, 'mock_server.mjs')));

// The hash of a page with nothing selected. Without a hash, the page begins with the worst collision.
const whole = '#selected=';
const tests = [];
const test = (name, scene, objects, run, context = {}) => tests.push({name, scene, objects, run, context});

// The worst collision, as the mock sorts them.
function worstOf(scene) {
  return scene.collisions(0, new URLSearchParams({sort: 'worst'})).rows[0];
}

// Whether a section through this pixel has the colour of what both objects have in common, beside the mark of the contact.
async function isCommon(page, at) {
  const beside = [[1, 1], [-1, 1], [1, -1], [-1, -1]].map(([x, y]) => pixel(page, {x: at.x + 9 * x, y: at.y + 9 * y}));
  return (await Promise.all(beside)).some(colour => near(colour, light.contact));
}

async function distance(page) {
  return Number((await page.evaluate(() => window.octopairView.camera())).split('_')[3]);
}

// The middle of the box of an object that is drawn in front, from the mock's first frame.
function middleOf(scene, k) {
  const {boxes} = scene.frame(0);
  return [0, 1, 2].map(axis => 1000 * (axis + 1) + 0.5 * (boxes[6 * k + axis] + boxes[6 * k + axis + 3]));
}

test('loads and counts', 'static', 10, async ({page, scene}) => {
  assert.equal(await data(page, 'drawn'), '10');
  assert.equal(await data(page, 'pairs'), String(scene.frame(0).pairs.length));
  assert.match(await text(page, '#counts'), /^10 objects, \d+ collisions?$/);
  assert.match(await page.title(), /mock static/);
});

test('the summary of the run', 'static', 60, async ({page, scene}) => {
  await complete(page);
  await page.click('#tab-scene');
  const {penetrating, touching} = scene.classCounts(0);
  assert.deepEqual((await text(page, '#frame-info')).split(/\s+/), ['collisions', String(penetrating + touching),
    ...Object.entries(scene.classCounts(0)).flatMap(([word, count]) => [word, String(count)])]);
  assert.match(await text(page, '#summary'), /objects\s+60\s+unit\s+m\s+format\s+npy/);
});

test('colours are those of the legend', 'static', 1, async ({page, scene}) => {
  // The top of a box that does not collide has the colour of the legend itself.
  const {boxes} = scene.frame(0);
  const top = [1000 + 0.5 * (boxes[0] + boxes[3]), 2000 + 0.5 * (boxes[1] + boxes[4]), 3000 + boxes[5]];
  await colourAt(page, top, light.free, 0);
  assert.deepEqual(await pixel(page, {x: 500, y: 60}), light.background);
  await page.evaluate(() => window.octopairView.select(0));
  await colourAt(page, top, light.selected, 0);
});

test('a click selects', 'static', 1, async ({page, scene}) => {
  await clickAt(page, middleOf(scene, 0));
  await waitForData(page, 'selected', '0');
  await page.locator('#selection dl').waitFor();
  assert.match(await text(page, '#selection'), /octal code\s+\{1,4\}/);
  await page.mouse.click(700, 660);
  await waitForData(page, 'selected', '');
});

test('a click selects what is in front', 'static', 300, async ({page, scene}) => {
  // Every object whose middle is visible must be found at its middle: a click never selects an object behind another.
  let found = 0;
  for (let k = 0; k < 300; k += 30) {
    await clickAt(page, middleOf(scene, k));
    await page.waitForFunction(() => document.documentElement.dataset.selected !== '');
    if (await data(page, 'selected') === String(k)) found += 1;
  }
  assert.ok(found > 0);
});

test('partners lead to other objects', 'static', 200, async ({page, scene}) => {
  const [a, b] = scene.frame(0).pairs[0];
  await page.evaluate(k => window.octopairView.select(k), a);
  await page.locator('.chips button').first().click();
  await waitForData(page, 'selected', b);
  assert.ok(Number(await data(page, 'lines')) >= 1);
  await waitForData(page, 'contacts', scene.object(0, b).partner_count);
});

test('drag, wheel and double click move the camera', 'static', 50, async ({page, scene}) => {
  const camera = async () => (await page.evaluate(() => window.octopairView.camera())).split('_').map(Number);
  const [start] = [await camera()];
  await page.mouse.move(600, 400);
  await page.mouse.down();
  await page.mouse.move(700, 440, {steps: 4});
  await page.mouse.up();
  const turned = await camera();
  assert.ok(turned[4] < start[4] && turned[5] > start[5]);
  assert.equal(await data(page, 'selected'), '');
  await page.mouse.wheel(0, -300);
  await page.waitForTimeout(100);
  const zoomed = await camera();
  assert.ok(zoomed[3] < turned[3]);
  await page.keyboard.down('Shift');
  await page.mouse.down();
  await page.mouse.move(650, 400, {steps: 4});
  await page.mouse.up();
  await page.keyboard.up('Shift');
  assert.notDeepEqual((await camera()).slice(0, 3), zoomed.slice(0, 3));
  await page.keyboard.press('h');
  const at = await project(page, middleOf(scene, 3));
  await page.mouse.dblclick(at.x, at.y);
  await page.waitForFunction(() => document.documentElement.dataset.selected);
  assert.ok((await camera())[3] < start[3]);
});

test('two fingers zoom', 'static', 50, async ({page}) => {
  const distance = () => page.evaluate(() => Number(window.octopairView.camera().split('_')[3]));
  const client = await page.context().newCDPSession(page);
  const touch = (type, ...points) => client.send('Input.dispatchTouchEvent', {type, touchPoints: points.map(([x, y], id) => ({x, y, id}))});
  const before = await distance();
  await touch('touchStart', [180, 400], [220, 400]);
  for (let k = 1; k <= 5; ++k) await touch('touchMove', [180 - 12 * k, 400], [220 + 12 * k, 400]);
  await touch('touchEnd');
  assert.ok(await distance() < 0.6 * before);
}, {viewport: {width: 390, height: 844}, hasTouch: true});

test('search by name and index', 'static', 100, async ({page}) => {
  await page.keyboard.press('/');
  await page.keyboard.type('plate 42');
  // While the text is typed slowly, the list has results of its beginning.
  await page.locator('#found-list button', {hasText: 'plate 42'}).first().click();
  await waitForData(page, 'selected', '42');
  await page.fill('#search-text', '17');
  await page.keyboard.press('Enter');
  await waitForData(page, 'selected', '17');
  // Keys do nothing while a text is typed.
  await page.fill('#search-text', '');
  await page.focus('#search-text');
  await page.keyboard.type('oct?');
  assert.equal((await settings(page)).octants, false);
  assert.equal(await page.locator('#help').evaluate(dialog => dialog.open), false);
});

test('a slow search opens its first object', 'shapes', 60, async ({page}) => {
  await page.route('**/search.json*', async route => {
    await new Promise(done => setTimeout(done, 500));
    await route.continue();
  });
  await page.fill('#search-text', '42');
  await page.waitForTimeout(100);
  await page.press('#search-text', 'Enter');
  await waitForData(page, 'selected', '42');
  await page.waitForTimeout(700);
  assert.ok(await page.locator('#found').isHidden());
});

test('names are texts', 'static', 20, async ({page}) => {
  await page.evaluate(() => window.octopairView.select(1));
  await page.locator('#selection h2').waitFor();
  assert.equal(await text(page, '#selection h2'), '<img src=x onerror=alert(1)>');
  assert.equal(await page.locator('img').count(), 0);
});

test('the table sorts, filters and selects', 'static', 1000, async ({page, scene}) => {
  const total = scene.frame(0).pairs.length;
  await page.locator('#rows tr').first().waitFor();
  assert.equal(await page.locator('#rows tr').count(), 100);
  assert.match(await text(page, '#table-totals'), new RegExp(`^1 to 100 of ${total} collisions$`));
  await page.click('#next-page');
  await page.waitForFunction(() => document.getElementById('table-totals').textContent.startsWith('101 to'));
  // Overlapping pairs are before touching ones, and the deepest first.
  const worst = scene.collisions(0, new URLSearchParams({sort: 'worst'})).rows;
  const pairsOf = rows => rows.map(({a, b}) => [a, b]);
  assert.deepEqual(await tablePairs(page), pairsOf(worst.slice(100, 200)));
  await page.selectOption('#sort', 'pair');
  await page.waitForFunction(() => document.getElementById('table-totals').textContent.startsWith('1 to'));
  assert.deepEqual(await tablePairs(page), scene.frame(0).pairs.slice(0, 100));
  await page.selectOption('#sort', 'worst');
  await page.waitForFunction(a => document.querySelector('#rows tr').dataset.pair.startsWith(`${a},`), worst[0].a);
  assert.deepEqual(await tablePairs(page), pairsOf(worst.slice(0, 100)));
  // A lower bound does not look like the depth itself.
  const shown = await page.locator('#rows .number:not(.thickness)').allInnerTexts();
  assert.deepEqual(shown, worst.slice(0, 100).map(row => `${row.depth_kind === 'at_least' ? '≥ ' : ''}${depthDigits(row.depth)}`));
  const before = await page.evaluate(() => window.octopairView.camera());
  await page.locator('#rows tr').nth(2).click();
  await page.waitForFunction(() => document.documentElement.dataset.selected.includes(','));
  assert.notEqual(await page.evaluate(() => window.octopairView.camera()), before);
  await page.check('#only-selected');
  const selected = (await data(page, 'selected')).split(',')[0];
  const own = scene.object(0, Number(selected)).partner_count;
  await page.waitForFunction(count => document.querySelectorAll('#rows tr').length === count, own);
  await page.uncheck('#only-selected');
  await page.fill('#filter', 'plate 1');
  await page.waitForFunction(() => [...document.querySelectorAll('#rows tr')].length > 0 &&
    [...document.querySelectorAll('#rows tr')].every(row => row.textContent.includes('plate 1')));
});

// The pairs of a scene that pass, the worst first.
function worstPairs(scene, passes) {
  const {rows} = scene.collisions(0, new URLSearchParams({sort: 'worst'}));
  return rows.filter(row => passes(row, scene.detailsOf(row.a), scene.detailsOf(row.b))).map(({a, b}) => [a, b]);
}

async function expectPairs(page, pairs) {
  await waitForText(page, '#table-totals', pairs.length ? new RegExp(`of ${pairs.length.toLocaleString('en-US')} collisions?$`) : /^No collisions$/);
  assert.deepEqual(await tablePairs(page), pairs.slice(0, 100));
}

test('classes, words, details and depths filter the list', 'static', 300, async ({page, scene}) => {
  await complete(page);
  const counts = scene.classCounts(0);
  assert.deepEqual(await page.locator('#kinds button').allInnerTexts(), [`${counts.penetrating} penetrating`, `${counts.touching} touching`]);
  const kind = word => page.locator('#kinds button', {hasText: word});
  await kind('touching').click();
  await expectPairs(page, worstPairs(scene, row => row.class === 'touching'));
  assert.equal(await kind('touching').getAttribute('aria-pressed'), 'true');
  await page.click('#filters summary');
  await page.selectOption('#filter-type', 'rib');
  await expectPairs(page, worstPairs(scene, (row, a, b) => row.class === 'touching' && (a.type === 'rib' || b.type === 'rib')));
  await kind('touching').click();
  await page.selectOption('#filter-level', 'deck 1');
  await page.fill('#depth-from', '0.3');
  const all = (row, a, b) => row.depth >= 0.3 && [a, b].some(object => object.type === 'rib') && [a, b].some(object => object.level === 'deck 1');
  await expectPairs(page, worstPairs(scene, all));
  // Each word is part of a text about one of the two objects.
  await page.fill('#filter', 'BOLT plate');
  await expectPairs(page, worstPairs(scene, (row, a, b) => all(row, a, b) && [a, b].some(object => object.type === 'bolt')));
  await page.fill('#depth-to', '0.2');
  await waitForText(page, '#no-rows', /^No collision passes the filters/);
  await page.click('#clear-filters');
  await expectPairs(page, worstPairs(scene, () => true));
  assert.deepEqual(await accessibility(page), []);
});

test('the buttons of classes have the numbers of their frame', 'moving', 200, async ({page, scene}) => {
  await complete(page);
  const other = [...Array(20).keys()].find(f => scene.classCounts(f).touching !== scene.classCounts(0).touching);
  await page.locator('#frame-slider').fill(String(other));
  await waitForText(page, '#kinds', new RegExp(`${scene.classCounts(other).touching} touching`));
});

test('groups gather the list, and keys move in it', 'static', 300, async ({page, scene}) => {
  await complete(page);
  await page.selectOption('#group', 'type');
  await waitForText(page, '#table-totals', /^1 to 6 of 6 groups, /);
  const groups = new Map();
  for (const [a, b] of worstPairs(scene, () => true)) {
    const title = [scene.detailsOf(a).type, scene.detailsOf(b).type].sort().join(' × ');
    groups.set(title, [...groups.get(title) ?? [], [a, b]]);
  }
  assert.deepEqual(await page.locator('#rows strong').allInnerTexts(), [...groups.keys()]);
  assert.deepEqual(await tablePairs(page), []);
  const [first] = groups.values();
  await page.locator('#rows tr').first().focus();
  await page.keyboard.press('ArrowRight');
  await page.waitForFunction(() => document.querySelectorAll('#rows tr[data-pair]').length > 0);
  assert.deepEqual(await tablePairs(page), first.slice(0, 100));
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Enter');
  await waitForData(page, 'selected', first[0].join(','));
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.press('ArrowLeft');
  await page.waitForFunction(() => document.querySelectorAll('#rows tr[data-pair]').length === 0);
  await page.selectOption('#group', 'object');
  await waitForText(page, '#table-totals', / groups, /);
  const objects = new Set(scene.frame(0).pairs.flat());
  await waitForText(page, '#table-totals', new RegExp(`of ${objects.size.toLocaleString('en-US')} groups`));
  assert.deepEqual(await accessibility(page), []);
});

test('rows have labels, and dense rows one line', 'static', 12, async ({page}) => {
  await complete(page);
  const [[a]] = await tablePairs(page);
  assert.equal(await page.locator('#rows .label').first().innerText(), a === 1 ? '<img src=x onerror=alert(1)>' : `plate ${a}`);
  assert.match(await page.locator('#rows small').first().innerText(), /^(plate|rib|bolt) · deck [01]$/);
  const height = () => page.locator('#rows tr').first().evaluate(row => row.offsetHeight);
  const roomy = await height();
  await page.check('#dense');
  assert.ok(await height() < 0.7 * roomy);
  assert.match(await text(page, '#head'), /depth \(m\)/);
});

test('rows have a thickness where it is known, and labels that tell objects apart', 'static', 12, async ({page, scene}) => {
  const kinds = ['at_most', 'at_least', 'undecided'];
  const nameOf = k => k === 1 ? 'hull/rib' : k === 2 ? 'deck/rib' : 'hull/plate';
  await page.route('**/collisions/*.json*', async route => {
    const answer = await (await route.fetch()).json();
    answer.rows.forEach((row, k) => Object.assign(row, {name_a: nameOf(row.a), name_b: nameOf(row.b), thickness_kind: kinds[k % 3]}, k % 3 < 2 ? {thickness: 0.25} : {}));
    await route.fulfill({json: answer});
  });
  await page.route('**/names.json', route => route.fulfill({json: scene.names.map((_, k) => nameOf(k))}));
  await page.reload();
  await complete(page);
  const head = page.locator('#head th', {hasText: 'thickness (m)'});
  assert.equal(await head.isVisible(), false, 'in a narrow list, the labels need the room');
  await page.setViewportSize({width: 1700, height: 900});
  assert.equal(await head.isVisible(), true);
  const cells = await page.locator('#rows td:last-child').allInnerTexts();
  assert.deepEqual(cells, cells.map((_, k) => ['≤ 0.25', '≥ 0.25', '?'][k % 3]));
  await page.locator('#rows tr').first().click();
  await waitForText(page, '#selection', /thickness\s+≤ 0\.25 m/);
  const labelOf = k => nameOf(k).endsWith('rib') ? nameOf(k) : `plate #${k}`;
  assert.deepEqual(await page.locator('#rows .label').allInnerTexts(), (await tablePairs(page)).flat().map(labelOf));
});

test('a scale has a round length', 'static', 40, async ({page}) => {
  await complete(page);
  for (const key of ['+', '-', '-', '-']) {
    await page.keyboard.press(key);
    await pictures(page, 2);
    const [, length] = /^([\d.]+) m$/.exec(await text(page, '#scale'));
    assert.match(String(Number(length).toExponential()), /^[125]e/);
    const width = await page.locator('#scale span').evaluate(bar => bar.getBoundingClientRect().width);
    // Two points at the distance of what the camera looks at, across its direction.
    const [x, y, z, , yaw] = (await page.evaluate(() => window.octopairView.camera())).split('_').map(Number);
    const at = along => project(page, [1000 + x, 2000 + y, 3000 + z].map((value, k) => value + along * [-Math.sin(yaw), Math.cos(yaw), 0][k]));
    const [p, q] = [await at(-0.5 * length), await at(0.5 * length)];
    assert.ok(Math.abs(Math.hypot(p.x - q.x, p.y - q.y) - width) < 0.25 * width + 3, `${Math.hypot(p.x - q.x, p.y - q.y)} for ${width}`);
  }
});

test('the page on paper has the picture', 'static', 40, async ({page}) => {
  await complete(page);
  await page.emulateMedia({media: 'print'});
  await page.evaluate(() => window.dispatchEvent(new Event('beforeprint')));
  const {colours, wide} = await page.evaluate(async () => {
    const picture = document.querySelector('.printed');
    await picture.decode();
    const canvas = new OffscreenCanvas(picture.naturalWidth, picture.naturalHeight);
    const context = canvas.getContext('2d');
    context.drawImage(picture, 0, 0);
    return {colours: new Set(new Uint32Array(context.getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size, wide: picture.offsetWidth};
  });
  assert.ok(colours > 100 && wide > 300, `${colours} colours, ${wide} pixels wide`);
  assert.equal(await data(page, 'theme'), 'light');
  assert.ok(await page.locator('#rows tr').first().isVisible());
  await page.evaluate(() => window.dispatchEvent(new Event('afterprint')));
  assert.equal(await page.locator('.printed').count(), 0);
  assert.equal(await data(page, 'theme'), 'dark');
}, {hash: '', colorScheme: 'dark'});

test('very many ghosts are boxes', 'shapes', 20_500, async ({page}) => {
  await complete(page);
  assert.equal(await data(page, 'drawn'), '20500');
  await page.evaluate(() => window.octopairView.select(7));
  await page.keyboard.press('f');
  // Boxes far from what the camera looks at are not drawn.
  await page.waitForFunction(() => Number(document.documentElement.dataset.drawn) < 20_000);
  assert.ok(Number(await data(page, 'drawn')) > 0);
});

test('every key has its effect', 'moving', 60, async ({page}) => {
  await checkKeys(page, {k: 'contacts'});
  await page.keyboard.press('.');
  await waitForData(page, 'frame', '1');
  await page.keyboard.press(',');
  await waitForData(page, 'frame', '0');
});

test('frames step and play', 'moving', 100, async ({page, scene}) => {
  await page.click('#step-forward');
  await waitForData(page, 'frame', '1');
  await waitForData(page, 'pairs', scene.frame(1).pairs.length);
  assert.match(await text(page, '#frame-text'), /^frame 1 of 40$/);
  await page.locator('#frame-slider').fill('20');
  await waitForData(page, 'frame', '20');
  await page.selectOption('#speed', '30');
  await page.click('#play');
  await page.waitForFunction(() => Number(document.documentElement.dataset.frame) > 22);
  await page.click('#play');
  assert.equal(await text(page, '#play'), 'Play');
  assert.ok(await page.locator('#plot canvas').count() === 1);
});

test('steps while a frame is read', 'moving', 50, async ({page}) => {
  const read = [];
  let release;
  const held = new Promise(done => release = done);
  await page.route('**/frame/*.json', async route => {
    read.push(/\d+/.exec(new URL(route.request().url()).pathname)[0]);
    await held;
    await route.continue();
  });
  assert.equal(await data(page, 'reading'), 'false');
  const asked = page.waitForRequest('**/frame/1.json');
  await page.click('#step-forward');
  await asked;
  for (let k = 0; k < 3; ++k) await page.click('#step-forward');
  await page.click('#step-back');
  assert.equal(await data(page, 'frame'), '0');
  assert.equal(await data(page, 'reading'), 'true');
  assert.equal(await page.locator('#frame-slider').inputValue(), '3');
  release();
  await waitForData(page, 'frame', '3');
  await waitForData(page, 'reading', 'false');
  assert.match(await text(page, '#frame-text'), /^frame 3 of 40$/);
  assert.deepEqual(read, ['1', '3']);
});

test('a frame that cannot be read', 'moving', 50, async ({page}) => {
  await page.route('**/frame/1.json', route => route.abort());
  await page.locator('#frame-slider').fill('1');
  await page.waitForFunction(() => document.getElementById('message').textContent !== '');
  assert.equal(await page.locator('#frame-slider').inputValue(), '0');
  await page.unroute('**/frame/1.json');
  await page.click('#step-forward');
  await waitForData(page, 'frame', '1');
}, {expected: /Failed to load|Failed to fetch/});

test('frames play once at a time', 'moving', 50, async ({page}) => {
  await page.selectOption('#speed', '1');
  for (let k = 0; k < 9; ++k) await page.click('#play');
  await page.waitForTimeout(2300);
  // Each of the five clicks on Play shows the next frame. Then the last one goes on.
  const frame = Number(await data(page, 'frame'));
  assert.ok(frame >= 6 && frame <= 8, `frame ${frame}`);
});

test('the end of the program stops play', 'moving', 50, async ({page, stop}) => {
  await page.selectOption('#speed', '30');
  await page.click('#play');
  await page.waitForFunction(() => Number(document.documentElement.dataset.frame) > 1);
  stop();
  await page.waitForFunction(() => document.getElementById('play').textContent === 'Play');
}, {expected: /WebSocket|Failed to load|Failed to fetch/});

test('octants by level', 'static', 200, async ({page}) => {
  await page.keyboard.press('o');
  await waitForData(page, 'octants', '512');
  for (const count of ['1', '8', '64']) {
    await page.keyboard.press(']');
    await waitForData(page, 'octants', count);
  }
  const at = await project(page, [1050, 2050, 3050]);
  await page.mouse.move(at.x, at.y);
  await page.locator('#label').waitFor();
  assert.match(await text(page, '#label'), /octant \{\d,\d\}, level 2\n\d+ entr(y|ies)/);
  await page.keyboard.press('o');
  await waitForData(page, 'octants', '0');
});

test('lines of all pairs', 'static', 500, async ({page, scene}) => {
  await page.keyboard.press('l');
  await waitForData(page, 'lines', scene.frame(0).pairs.length);
  await page.keyboard.press('l');
  await waitForData(page, 'lines', '0');
});

test('a section hides boxes, and colours have a legend', 'static', 500, async ({page}) => {
  await page.keyboard.press('c');
  await page.waitForFunction(() => document.getElementById('legend').textContent.includes('groups'));
  await page.keyboard.press('c');
  await page.waitForFunction(() => document.getElementById('legend').textContent.includes('level'));
  await page.keyboard.press('v');
  await page.waitForFunction(() => Number(document.documentElement.dataset.drawn) < 500);
});

test('a section cuts boxes', 'static', 1, async ({page, scene, address, browser}) => {
  const at = await project(page, middleOf(scene, 0));
  const seen = await pixel(page, at);
  assert.notDeepEqual(seen, light.background);
  for (const [hash, hidden] of [['section=x&cut=0', true], ['section=x&cut=1', false], ['section=z&cut=1&flip=1', true], ['section=z&cut=0&flip=1', false]]) {
    const other = await open(browser, `${address}#${hash}`);
    await ready(other.page);
    assert.deepEqual(await pixel(other.page, at), hidden ? light.background : seen, hash);
    await other.close();
  }
});

test('began and ended have their colours', 'moving', 40, async ({page, scene, address, browser}) => {
  const frame = [...Array(40).keys()].find(f => f > 0 && scene.changes(f).began.length > 0);
  const [a, b] = scene.changes(frame).began[0];
  const other = await open(browser, `${address}#frame=${frame}&show=colliding&lines=all`);
  await ready(other.page);
  await waitForData(other.page, 'frame', frame);
  const {boxes} = scene.frame(frame);
  const hue = async k => {
    const top = [0, 1, 2].map(axis => 1000 * (axis + 1) + (axis === 2 ? boxes[6 * k + 5] : 0.5 * (boxes[6 * k + axis] + boxes[6 * k + axis + 3])));
    return pixel(other.page, await project(other.page, top));
  };
  // One of the two may be behind another box.
  const found = [await hue(a), await hue(b)].map(String);
  assert.ok(found.includes('240,176,40'), found.join(' '));
  assert.match(await text(other.page, '#legend'), /began/);
  await other.close();
  // In the first frame, all pairs are new.
  assert.doesNotMatch(await text(page, '#legend'), /began/);
});

test('shapes are drawn', 'shapes', 30, async ({page, scene}) => {
  await waitForData(page, 'shapes', '3');
  assert.equal((await settings(page)).style, 'shapes');
  await waitForData(page, 'drawn', '30');
  const {boxes} = scene.frame(0);
  // The top of a cube that nothing hides.
  const cube = [...Array(30).keys()].filter(k => k % 3 === 1).sort((p, q) => boxes[6 * q + 5] - boxes[6 * p + 5])[0];
  const top = [0, 1, 2].map(axis => 1000 * (axis + 1) + (axis === 2 ? boxes[6 * cube + 5] : 0.5 * (boxes[6 * cube + axis] + boxes[6 * cube + axis + 3])));
  await colourAt(page, top, scene.partnerCounts(0)[cube] ? light.colliding : light.free);
  await page.keyboard.press('b');
  assert.equal((await settings(page)).style, 'both');
  await waitForData(page, 'drawn', '30');
  await clickAt(page, middleOf(scene, 0));
  await page.waitForFunction(() => document.documentElement.dataset.selected);
});

test('boxes near the target', 'near', 4000, async ({page}) => {
  assert.equal(await data(page, 'drawn'), '1000');
  assert.match(await text(page, '#notices'), /3,000 of 4,000 boxes are not drawn/);
  for (let k = 0; k < 8; ++k) await page.keyboard.press('+');
  await page.waitForFunction(() => /more boxes near the target/.test(document.getElementById('notices').textContent));
  await page.keyboard.press('/');
  await page.keyboard.type('4001');
  await page.keyboard.press('Enter');
});

test('a link holds the view', 'moving', 100, async ({page, address, browser}) => {
  await page.keyboard.press('c');
  await page.keyboard.press('.');
  await waitForData(page, 'frame', '1');
  await page.evaluate(() => window.octopairView.select(5));
  await page.keyboard.press('f');
  await page.waitForFunction(() => location.hash.includes('selected=5') && location.hash.includes('frame=1'));
  await page.waitForTimeout(400);
  const camera = await page.evaluate(() => window.octopairView.camera());
  const other = await open(browser, address + new URL(page.url()).hash);
  await ready(other.page);
  await waitForData(other.page, 'selected', '5');
  await waitForData(other.page, 'frame', '1');
  assert.equal(await other.page.evaluate(() => window.octopairView.camera()), camera);
  assert.equal((await settings(other.page)).colour, 'group');
  // A link that is pasted over another one, with values that are not allowed.
  await other.page.evaluate(() => location.hash = '#others=1e9&edges=yes&cut=7&level=2.5&flip=1&selected=6');
  await waitForData(other.page, 'selected', '6');
  const {others, edges, cut, level, flip} = await settings(other.page);
  assert.deepEqual({others, edges, cut, level, flip}, {others: 1, edges: true, cut: 0.5, level: -1, flip: true});
  await other.close();
});

// Waits until the page has drawn some pictures.
async function pictures(page, count) {
  for (let k = 0; k < count; ++k) await page.evaluate(() => new Promise(done => requestAnimationFrame(done)));
}

// The mock stands still from now on, and the page shows its last frame and has asked for the next one.
async function standStill(page, scene) {
  scene.stop();
  await waitForData(page, 'frame', scene.now);
  for (let drawn = 0; scene.waiting.length === 0; ++drawn) {
    assert.ok(drawn < 1000, 'the page does not ask for the next frame');
    await pictures(page, 1);
  }
}

test('live frames', 'live', 300, async ({page, scene}) => {
  const first = Number(await data(page, 'frame'));
  await page.waitForFunction(frame => Number(document.documentElement.dataset.frame) > frame + 3, first);
  await standStill(page, scene);
  const asked = [];
  const {receive} = scene;
  scene.receive = (message, send) => {
    asked.push(message.want);
    receive.call(scene, message, send);
  };
  await page.click('#play');
  // The frame that the page asked for before it was paused still comes, and no other one. A page that plays asks two pictures later.
  scene.step();
  const paused = scene.now;
  await waitForData(page, 'frame', paused);
  await pictures(page, 10);
  scene.step();
  scene.step();
  await pictures(page, 10);
  assert.deepEqual(asked, []);
  assert.equal(await data(page, 'frame'), String(paused));
  await page.click('#play');
  await waitForData(page, 'frame', scene.now);
  assert.equal(asked[0], paused);
  assert.match(await text(page, '#frame-text'), /^frame \d+, step 1\.23 ms$/);
});

test('live partners are those of a whole frame', 'live', 300, async ({page, scene}) => {
  await page.waitForFunction(() => Number(document.documentElement.dataset.frame) > 3);
  await standStill(page, scene);
  const {pairs} = scene.history[scene.now];
  assert.equal(await data(page, 'pairs'), String(pairs.length));
  await page.keyboard.press('l');
  await waitForData(page, 'lines', pairs.length + await page.evaluate(() => window.octopairView.frame().ended));
});

test('a lost connection is told, and the page keeps its frame', 'live', 50, async ({page, stop}) => {
  stop();
  await page.waitForFunction(() => /connection to the program is lost/.test(document.getElementById('notices').textContent), null, {timeout: 20_000});
  assert.equal(await data(page, 'drawn'), '50');
}, {expected: /WebSocket|Failed to load|Failed to fetch/});

test('jobs and scenes of a server', 'server', 0, async ({page}) => {
  await waitForData(page, 'jobs', '3');
  assert.equal(await page.locator('#scene-rows a').getAttribute('href'), 'scene/crane%207/');
  assert.match(await text(page, '#job-rows'), /the input has no boxes/);
  assert.deepEqual(await accessibility(page), []);
});

test('jobs that come before the view', 'server', 0, async ({page, scene}) => {
  await page.route('**/view.json', async route => {
    await waitForData(page, 'jobs', '3');
    scene.silent = true;
    await route.continue();
  });
  await page.reload();
  await page.waitForFunction(() => document.title.startsWith('server'));
  assert.equal(await data(page, 'jobs'), '3');
  assert.match(await text(page, '#job-rows'), /the input has no boxes/);
});

test('a server that does not answer for a while', 'server', 0, async ({page, scene}) => {
  await waitForData(page, 'jobs', '3');
  assert.ok(await page.locator('#banner').isHidden());
  scene.silent = true;
  scene.send({event: 'waiting', message: 'unix:s.socket: no server answers'});
  await page.locator('#banner').waitFor();
  assert.equal(await text(page, '#banner'), 'unix:s.socket: no server answers');
  assert.deepEqual(await accessibility(page), []);
  scene.silent = false;
  await page.locator('#banner').waitFor({state: 'hidden'});
});

test('the end of a program that shows a server', 'server', 0, async ({page, scene}) => {
  await waitForData(page, 'jobs', '3');
  scene.silent = true;
  scene.send({event: 'closed'});
  await page.locator('#banner').waitFor();
  assert.match(await text(page, '#banner'), /program has ended/);
});

test('the error of an input', 'failed', 10, async ({page}) => {
  await page.locator('#failure').waitFor();
  assert.match(await text(page, '#failure'), /the minimum of x is above the maximum/);
});

test('progress while loading', 'loading', 10, async ({page}) => {
  await ready(page);
  assert.equal(await data(page, 'drawn'), '10');
});

test('the first picture shows the worst collision', 'static', 300, async ({page, scene}) => {
  const worst = worstOf(scene);
  await complete(page);
  assert.equal(await data(page, 'selected'), `${worst.a},${worst.b}`);
  assert.equal(await data(page, 'contacts'), '1');
  assert.equal(await page.locator('#rows tr[aria-current]').count(), 1);
  assert.match(await text(page, '#legend'), new RegExp(`plate ${worst.a}\\n.*plate ${worst.b}\\nother objects`));
  // The depth of the pair, which is not that of its contact.
  const bound = worst.depth_kind === 'at_least';
  assert.equal(await text(page, '#depths'), `depth ${bound ? '≥ ' : ''}${depthDigits(worst.depth)} m`);
  assert.match(await text(page, '#selection'), new RegExp(`Penetrating[^]*depth\\s+${bound ? 'at least ' : ''}${depthDigits(worst.depth)} m`));
  assert.deepEqual(await accessibility(page), []);
  await page.click('#selection summary');
  assert.match(await text(page, '#selection details'), new RegExp(`own depth[^]*\\s${depthDigits(0.5 * worst.depth)}$`));
  // The contact is in the middle of the picture, and the small picture shows where that is.
  const at = await project(page, worst.contacts[0].point);
  const stage = await page.locator('#stage').boundingBox();
  assert.ok(Math.abs(at.x - (stage.x + 0.5 * stage.width)) < 60 && Math.abs(at.y - (stage.y + 0.5 * stage.height)) < 60);
  assert.ok(await page.locator('#overview').isVisible());
  // In a section, what both boxes have in common has a colour of its own.
  await page.keyboard.press('j');
  await waitForData(page, 'drawn', '2');
  await page.keyboard.press('x');
  assert.equal((await settings(page)).section, 'contact');
  assert.ok(await isCommon(page, at));
  assert.match(await text(page, '#legend'), /\nin both\n/);
  await page.click('#selection button:text("Section")');
  assert.equal((await settings(page)).section, 'none');
  assert.doesNotMatch(await text(page, '#legend'), /in both/);
  // All objects, in the colours of their classes.
  await page.click('#selection button:text("Only these two")');
  const close = await distance(page);
  await page.keyboard.press('Escape');
  await waitForData(page, 'selected', '');
  assert.ok(await distance(page) > 2 * close);
  assert.match(await text(page, '#legend'), /^not colliding\s+touching\s+penetrating$/);
  assert.ok(await page.locator('#overview').isHidden());
}, {hash: ''});

test('contacts leave with their frame', 'moving', 50, async ({page}) => {
  await complete(page);
  assert.notEqual(await data(page, 'contacts'), '0');
  const selected = await data(page, 'selected');
  await page.route('**/collisions/**', () => {});  // is never answered
  await page.click('#step-forward');
  await waitForData(page, 'frame', '1');
  assert.equal(await data(page, 'contacts'), '0');
  assert.equal(await data(page, 'selected'), selected);
}, {hash: ''});

test('objects of a pair have two colours, and others are ghosts', 'static', 40, async ({page, scene, address, browser}) => {
  const {a, b} = worstOf(scene);
  const {boxes, pairs} = scene.frame(0);
  const top = k => [0, 1, 2].map(axis => 1000 * (axis + 1) + (axis === 2 ? boxes[6 * k + 5] : 0.5 * (boxes[6 * k + axis] + boxes[6 * k + axis + 3])));
  const seen = async k => pixel(page, await project(page, top(k)));
  await complete(page);
  await page.keyboard.press('h');
  // One of the two may be glass, since it would hide the other, and may itself hide a part of the other.
  const onTop = async k => {
    const [x, y, z] = top(k);
    const places = [-0.4, 0, 0.4].flatMap(i => [-0.4, 0, 0.4].map(j => [x + i * (boxes[6 * k + 3] - boxes[6 * k]), y + j * (boxes[6 * k + 4] - boxes[6 * k + 1]), z]));
    return Promise.all(places.map(async place => pixel(page, await project(page, place))));
  };
  const two = [await onTop(a), await onTop(b)];
  assert.ok(two[0].some(colour => near(colour, light.selected)) || two[1].some(colour => near(colour, light.second)), two.join(' '));
  const others = [...new Set(pairs.flat())].filter(k => k !== a && k !== b);
  const grey = colour => Math.max(...colour) - Math.min(...colour) < 40 && Math.min(...colour) > 120;
  const colours = await Promise.all(others.map(seen));
  assert.ok(colours.filter(grey).length >= others.length - 1, colours.join(' '));
  // Solid, they have the colours of their states.
  const solid = await open(browser, `${address}#selected=${a},${b}&ghosts=0`);
  await complete(solid.page);
  assert.match(await text(solid.page, '#legend'), /not colliding[^]*penetrating/);
  await solid.close();
}, {hash: ''});

test('a row and a link zoom to the contact', 'hall', 60, async ({page, scene, address, browser}) => {
  // One of the two objects is as large as the scene.
  const whole = await distance(page);
  await page.locator('#rows tr').nth(1).click();
  await page.waitForFunction(() => document.documentElement.dataset.selected.startsWith('0,'));
  assert.ok(await distance(page) < 0.5 * whole);
  await page.keyboard.press('h');
  assert.ok(await distance(page) > 0.9 * whole);
  await page.keyboard.press('f');
  assert.ok(await distance(page) < 0.5 * whole);
  const {a, b} = worstOf(scene);
  const other = await open(browser, `${address}#selected=${a},${b}`);
  await complete(other.page);
  assert.equal(await data(other.page, 'selected'), `${a},${b}`);
  assert.ok(await distance(other.page) < 0.5 * whole);
  await other.close();
});

test('the worst collision of a large scene', 'near', 4000, async ({page, scene}) => {
  const {a, b, boxes: [first, second]} = scene.collisions(0, new URLSearchParams({sort: 'worst'})).rows[0];
  await complete(page);
  assert.equal(await data(page, 'selected'), `${a},${b}`);
  assert.match(await text(page, '#notices'), /more boxes near the target/);
  // A section shows what both boxes have in common, around its middle.
  await page.keyboard.press('x');
  const middle = [0, 1, 2].map(k => 0.5 * (Math.max(first.min[k], second.min[k]) + Math.min(first.max[k], second.max[k])));
  const at = await project(page, middle);
  assert.ok(await isCommon(page, at), String(await pixel(page, at)));
}, {hash: ''});

test('a live scene begins with the worst collision, and keeps what was selected', 'live', 200, async ({page, scene}) => {
  // The first answer has no collisions yet.
  let answers = 0;
  await page.route('**/collisions/*.json*', route => answers++ === 0 ? route.fulfill({json: {total: 0, rows: []}}) : route.continue());
  await page.reload();
  await complete(page);
  await page.waitForFunction(() => document.documentElement.dataset.selected?.includes(','));
  assert.ok(answers > 1);
  assert.equal(await data(page, 'drawn'), String(scene.n));
  assert.equal((await settings(page)).ghosts, false);
  // The rows that come later do not select anything again.
  await page.keyboard.press('Escape');
  await waitForData(page, 'selected', '');
  for (const known of [answers, answers + 1]) {
    await page.waitForResponse(/collisions/);
    assert.ok(answers > known);
    await pictures(page, 2);
    assert.equal(await data(page, 'selected'), '');
  }
}, {hash: ''});

test('the first frame does not flatten the plot', 'moving', 2000, async ({page, scene}) => {
  await complete(page);
  const {pairs: totals, began, ended} = scene.timeline();
  const {pairs, events} = await page.evaluate(() => window.octopairView.plot());
  const most = Math.max(...began.slice(1), ...ended.slice(1));
  assert.ok(began[0] > 1.5 * most);
  assert.ok(events[0] === 0 && events[1] >= most && events[1] < 1.2 * most, `${events} for ${most}`);
  const [low, high] = [Math.min(...totals), Math.max(...totals)];
  assert.ok(pairs[0] <= low && pairs[1] >= high && pairs[1] - pairs[0] < 1.3 * Math.max(high - low, 0.1 * high), `${pairs} for ${low} to ${high}`);
});

test('no collision', 'static', 1, async ({page}) => {
  await complete(page);
  assert.equal(await data(page, 'selected'), '');
  await waitForText(page, '#no-rows', /No objects collide/);
}, {hash: ''});

for (const colorScheme of ['light', 'dark']) {
  for (const viewport of [{width: 1280, height: 720}, {width: 390, height: 844}]) {
    test(`accessible in ${colorScheme} at ${viewport.width}`, 'moving', 60, async ({page}) => {
      assert.equal(await data(page, 'theme'), colorScheme);
      await checkAccessibility(page, viewport.width < 760);
    }, {colorScheme, viewport});
  }
}

async function testExport(browser) {
  const mock = await startMock({scene: 'moving', objects: 80, page: options.page});
  mock.scene.frames = 3;
  const folder = mkdtempSync(join(tmpdir(), 'octopair-page-'));
  const file = join(folder, 'export.html');
  exportPage(mock.scene, options.page, file);
  const {page, errors, close} = await open(browser, pathToFileURL(file).href);
  try {
    await complete(page);
    const worst = worstOf(mock.scene);
    assert.equal(await data(page, 'selected'), `${worst.a},${worst.b}`);
    await page.keyboard.press('Escape');
    await waitForData(page, 'drawn', '80');
    await page.locator('#rows tr').first().waitFor();
    await page.locator('#rows tr').first().click();
    await page.waitForFunction(() => document.documentElement.dataset.selected.includes(','));
    await page.fill('#search-text', 'plate 42');
    await page.keyboard.press('Enter');
    await waitForData(page, 'selected', '42');
    await page.click('#step-forward');
    await waitForData(page, 'frame', '1');
    await page.click('#view', {position: {x: 600, y: 500}});
    await page.keyboard.press('o');
    await waitForData(page, 'octants', '512');
    assert.deepEqual(errors, []);
  } finally {
    await close();
    mock.stop();
    rmSync(folder, {recursive: true});
  }
}

async function testMock(browser, {scene, objects, run, context}) {
  const mock = await startMock({scene, objects, page: options.page});
  const {expected, hash = whole, ...view} = context;
  const {page, errors, close} = await open(browser, mock.address + hash, view);
  try {
    if (scene !== 'failed') await ready(page);
    await run({page, scene: mock.scene, address: mock.address, browser, stop: mock.stop});
    assert.deepEqual(errors.filter(error => !expected?.test(error)), []);
  } finally {
    await close();
    mock.stop();
  }
}

// Starts a program that prints its address, and checks what any scene must have.
async function testProgram(browser, command) {
  const program = spawn(command, {shell: true, detached: true, stdio: ['ignore', 'pipe', 'inherit']});
  try {
    const address = await new Promise((found, failed) => {
      program.stdout.on('data', bytes => {
        const match = /http:\/\/\S+/.exec(String(bytes));
        if (match) found(match[0]);
      });
      program.on('exit', code => failed(new Error(`the program ended with ${code}`)));
    });
    const {page, errors} = await open(browser, address);
    await ready(page, 60_000);
    assert.ok(Number(await data(page, 'drawn')) > 0);
    await page.evaluate(() => window.octopairView.select(0));
    await page.locator('#selection dl').waitFor();
    assert.deepEqual(await accessibility(page), []);
    assert.deepEqual(errors, []);
  } finally {
    process.kill(-program.pid);
  }
}

async function runAll() {
  const browser = await launch();
  const all = options.server ? [{name: 'program', go: () => testProgram(browser, options.server)}] :
    [...tests.map(entry => ({name: entry.name, go: () => testMock(browser, entry)})), {name: 'exported page', go: () => testExport(browser)}];
  const failed = await runTests(all, options.only);
  await browser.close();
  return failed;
}

if (!options.server && !existsSync(options.page)) throw new Error(`${options.page} is missing: node viewer/build.mjs ${options.page}`);
process.exit(await runAll() ? 1 : 0);
