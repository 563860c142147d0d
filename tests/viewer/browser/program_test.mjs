// Tests pages of the program in Chromium: node program_test.mjs --program octopair --python python3 --package FOLDER [--only TEXT]
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';
import {parseArgs} from 'node:util';
import {accessibility, clickAt, data, launch, open, pixel, project, ready, runTests, settings, waitForData} from '../page/browser.mjs';
import {checkAccessibility, checkKeys, colourAt, complete, depthDigits, depthText, describePicture, expectTable, light, near, partnersIn, readCsv, readJsonl,
  searchFor, tablePairs, text, topOf, waitForText} from './checks.mjs';
import {hostileName, Inputs, shapesScene, threeBoxes} from './inputs.mjs';
import {Child, readNpy, run, view} from './program.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const root = join(here, '../../..');
const {values: options} = parseArgs({options: {
  program: {type: 'string', default: join(root, 'build/release/src/cli/octopair')}, python: {type: 'string', default: '/usr/bin/python3'},
  package: {type: 'string', default: join(root, 'build/release/python/package')}, only: {type: 'string', default: ''},
}});
const folder = mkdtempSync(join(tmpdir(), 'octopair-browser-'));
const inputs = new Inputs(folder, options.program);
const browser = await launch();
const children = new Set();
const tests = [];
const test = (name, go) => tests.push({name, go});

function keep(child) {
  children.add(child);
  return child;
}

// Starts a server at a socket, and waits until it listens.
async function serve(name, ...more) {
  const server = keep(new Child(options.program, ['serve', '--listen', `unix:${inputs.path(name)}`, ...more, '--log-level', 'warn']));
  while (!existsSync(inputs.path(name))) await new Promise(done => setTimeout(done, 50));
  return server;
}

function python(...words) {
  return keep(new Child(options.python, [join(here, 'scenes.py'), ...words], {env: {...process.env, PYTHONPATH: options.package}}));
}

// Opens a page, waits for all its data, and checks at its end that the browser reported no error.
async function withPage(address, check, {expected, wait = complete, ...context} = {}) {
  const opened = await open(browser, address, context);
  try {
    await wait(opened.page);
    await check(opened.page);
    assert.deepEqual(opened.errors.filter(error => !expected?.test(error)), []);
  } finally {
    await opened.close();
  }
}

// The hash of a page with nothing selected. Without a hash, the page begins with the worst collision.
const whole = '#selected=';

async function withView(words, check, context = {}) {
  const program = keep(await view(options.program, words));
  try {
    await withPage(program.address + (context.hash ?? whole), page => check(page, program), context);
  } finally {
    await program.stop();
  }
}

// ---- Boxes -----------------------------------------------------------------------------------------------------------

test('three boxes: colours, a click and partners', () => withView([inputs.get('three.npy')], async page => {
  assert.equal(await text(page, '#counts'), '3 objects, 1 pair');
  assert.deepEqual(await pixel(page, {x: 600, y: 70}), light.background);
  await colourAt(page, topOf(threeBoxes[0]), light.free);
  await colourAt(page, topOf(threeBoxes[1]), light.colliding);
  assert.equal(await text(page, '#legend'), 'not colliding\ncolliding');
  await clickAt(page, topOf(threeBoxes[1]));
  await waitForData(page, 'selected', '1');
  await colourAt(page, topOf(threeBoxes[1]), light.selected);
  await page.locator('.chips button').first().waitFor();
  assert.deepEqual(await page.locator('.chips button').allInnerTexts(), ['2']);
  await page.mouse.click(600, 70);
  await waitForData(page, 'selected', '');
}));

test('ten boxes: the table has all pairs', () => withView([inputs.get('10.npy')], async page => {
  const pairs = readCsv(inputs.detect('10.npy', '.csv')).map(row => row.map(Number));
  assert.equal(await data(page, 'drawn'), '10');
  assert.equal(await data(page, 'pairs'), String(pairs.length));
  await expectTable(page, pairs);
  const {values} = readNpy(inputs.get('10.npy'));
  // The box nearest to the camera is in front of all others.
  const boxes = Array.from({length: 10}, (_, k) => [...values.subarray(6 * k, 6 * k + 6)]);
  const toCamera = box => 0.55 * box[3] - 0.69 * box[1] + 0.48 * box[5];
  const front = boxes.reduce((best, box, k) => toCamera(box) > toCamera(boxes[best]) ? k : best, 0);
  await clickAt(page, topOf(boxes[front]));
  await waitForData(page, 'selected', front);
}));

test('10,000 boxes: pages of the table, search and partners', () => withView([inputs.get('10k.npy')], async page => {
  const pairs = readCsv(inputs.detect('10k.npy', '.csv')).map(row => row.map(Number));
  assert.equal(await data(page, 'drawn'), '10000');
  assert.equal(await text(page, '#counts'), `10,000 objects, ${pairs.length.toLocaleString('en-US')} pairs`);
  await expectTable(page, pairs.slice(0, 100));
  await page.click('#next-page');
  await waitForText(page, '#table-totals', /^101 to 200/);
  assert.deepEqual(await tablePairs(page), pairs.slice(100, 200));
  const counts = new Map();
  for (const object of pairs.flat()) counts.set(object, (counts.get(object) ?? 0) + 1);
  const [busiest] = [...counts].reduce((best, entry) => entry[1] > best[1] ? entry : best);
  await searchFor(page, String(busiest));
  await waitForData(page, 'selected', busiest);
  await waitForText(page, '#selection h3', /partners?$/);
  const partners = partnersIn(pairs, busiest);
  assert.deepEqual((await page.locator('.chips button').allInnerTexts()).map(Number), partners);
  await waitForData(page, 'lines', partners.length);
  await page.check('#only-selected');
  await waitForText(page, '#table-totals', new RegExp(`of ${partners.length} `));
  assert.deepEqual(await tablePairs(page), pairs.filter(pair => pair.includes(busiest)));
  await page.click('.chips button');
  await waitForData(page, 'selected', partners[0]);
  await page.keyboard.press('l');
  await waitForData(page, 'lines', pairs.length);
}));

test('octants: levels, numbers and labels', () => withView([inputs.get('100k.npy')], async (page, program) => {
  const {levels} = await (await fetch(`${program.address}octants/0.json`)).json();
  await page.keyboard.press('o');
  await waitForData(page, 'octants', levels.reduce((sum, level) => sum + level.leaves, 0));
  for (const [level, {listed}] of levels.entries()) {
    await page.keyboard.press(']');
    await waitForData(page, 'octants', listed);
    assert.equal((await settings(page)).level, level);
  }
  await page.keyboard.press('m');
  const number = page.locator('#options input[aria-label^=Level]').last();
  // The deepest level depends on how the program divides octants; here the level above it is chosen.
  const chosen = levels.length - 2;
  await number.fill(String(chosen));
  await number.press('Enter');
  await waitForData(page, 'octants', levels[chosen].listed);
  const at = await project(page, [0.5, 0.5, 0.5]);
  await page.mouse.move(at.x, at.y);
  await page.locator('#label').waitFor();
  const [, code, level, entries] = /^octant (\{[\d,]+\}), level (\d+).*\n([\d,]+) entr/.exec(await text(page, '#label'));
  assert.equal(Number(level), chosen);
  const words = new Uint32Array(await (await fetch(`${program.address}octants/0/${chosen}.bin`)).arrayBuffer());
  const found = new Map();
  for (let k = 0; k < words.length; k += 11) {
    const digits = Array.from({length: chosen}, (_, depth) => (words[k + 9] >>> 28 - 3 * depth & 7) + 1);
    found.set(`{${digits}}`, words[k + 6]);
  }
  assert.equal(found.get(code), Number(entries.replace(',', '')));
  await page.keyboard.press('o');
  await waitForData(page, 'octants', '0');
}));

async function firstPicture(name) {
  const path = inputs.get(name);
  const began = performance.now();
  const program = keep(await view(options.program, [path]));
  const context = await browser.newContext({viewport: {width: 1280, height: 720}, reducedMotion: 'reduce'});
  const page = await context.newPage();
  const client = await context.newCDPSession(page);
  await page.goto(program.address, {waitUntil: 'commit'});
  await ready(page, 90_000);
  const all = Math.round(performance.now() - began);
  const own = await data(page, 'firstPicture');
  await complete(page, 90_000);
  const bytes = await page.evaluate(() => ['navigation', 'resource'].flatMap(type => performance.getEntriesByType(type))
    .reduce((sum, entry) => sum + entry.transferSize, 0));
  const {result} = await client.send('Runtime.evaluate', {expression: 'performance.memory.usedJSHeapSize'});
  const resident = await rendererMemory();
  console.log(`     ${name}: first picture ${all} ms after the program's start, ${own} ms after the navigation; ` +
    `${(bytes / 1e6).toFixed(1)} MB sent, tab ${resident} MB, of which JavaScript ${Math.round(result.value / 1e6)} MB`);
  return {page, program, close: () => context.close()};
}

// The memory of the largest renderer, in MB.
async function rendererMemory() {
  const session = await browser.newBrowserCDPSession();
  const {processInfo} = await session.send('SystemInfo.getProcessInfo');
  await session.detach();
  const sizes = processInfo.filter(process => process.type === 'renderer').map(({id}) => {
    const status = existsSync(`/proc/${id}/status`) ? readFileSync(`/proc/${id}/status`, 'utf8') : '';
    return Number(/VmRSS:\s+(\d+)/.exec(status)?.[1] ?? 0) / 1024;
  });
  return Math.round(Math.max(0, ...sizes));
}

test('100,000 boxes: the first picture', async () => {
  const {page, program, close} = await firstPicture('100k.npy');
  await page.keyboard.press('Escape');
  await waitForData(page, 'drawn', '100000');
  await close();
  await program.stop();
});

test('a million boxes: the first picture, a notice, and boxes near a place', async () => {
  const {page, program, close} = await firstPicture('1m.npy');
  const pairs = JSON.parse(run(options.program, ['detect', inputs.get('1m.npy'), '--count-only', '--quiet', '--stats', inputs.path('1m.json')]) || '0');
  assert.equal(await data(page, 'pairs'), String(pairs));
  assert.equal(JSON.parse(readFileSync(inputs.path('1m.json'))).pairs, pairs);
  assert.equal(await text(page, '#counts'), `1,000,000 objects, ${pairs.toLocaleString('en-US')} pairs`);
  // The page begins with the worst collision, although the overview may not have its objects.
  const [[a, b]] = await tablePairs(page);
  assert.equal(await data(page, 'selected'), `${a},${b}`);
  await waitForText(page, '#notices', /more boxes near the target are drawn/);
  await page.keyboard.press('Escape');
  await waitForText(page, '#notices', /800,000 of 1,000,000 boxes are drawn only where you zoom in/);
  await waitForData(page, 'drawn', '200000');
  await searchFor(page, '777777');
  await waitForData(page, 'selected', '777777');
  await waitForText(page, '#notices', /more boxes near the target are drawn/);
  const {values} = readNpy(inputs.get('1m.npy'));
  await colourAt(page, topOf([...values.subarray(6 * 777777, 6 * 777777 + 6)]), light.selected, 3);
  await close();
  await program.stop();
});

// ---- Special scenes --------------------------------------------------------------------------------------------------

test('no boxes', () => withView([inputs.get('none.npy')], async page => {
  assert.equal(await text(page, '#counts'), '0 objects, 0 pairs');
  assert.equal(await text(page, '#table-totals'), 'No pairs');
  for (const key of ['h', 'n', 'o', 'l', 'f']) await page.keyboard.press(key);
  assert.equal(await data(page, 'drawn'), '0');
}));

test('one box', () => withView([inputs.get('one.npy')], async page => {
  assert.equal(await text(page, '#counts'), '1 object, 0 pairs');
  await clickAt(page, [0.5, 1, 3]);
  await waitForData(page, 'selected', '0');
  await waitForText(page, '#selection', /No partners/);
}));

test('boxes that coincide', () => withView([inputs.get('same.npy')], async page => {
  assert.equal(await text(page, '#counts'), '40 objects, 780 pairs');
  await colourAt(page, [1.5, 1.5, 2], light.colliding);
  await page.evaluate(() => window.octopairView.select(7));
  await waitForText(page, '#selection h3', /^39 partners$/);
}));

test('far from the origin', () => withView([inputs.get('far.npy')], async page => {
  const far = threeBoxes.map(box => box.map((value, k) => value + [1e7, -1e7, 1e7][k % 3]));
  await colourAt(page, topOf(far[0]), light.free);
  await colourAt(page, topOf(far[1]), light.colliding);
  await page.evaluate(() => window.octopairView.select(2));
  await waitForText(page, '#selection', /10,000,001\.2, -9,999,997\.8, 10,000,001/);
}));

test('a box that is not a number', async () => {
  const child = spawnSync(options.program, ['view', inputs.get('nan.npy'), '--no-browser', '--quiet'], {encoding: 'utf8', timeout: 20_000});
  assert.equal(child.status, 3, child.stderr);
  assert.match(child.stderr, /nan\.npy.*object 1/);
});

// ---- Shapes and results ----------------------------------------------------------------------------------------------

test('shapes: pictures, names and contacts', () => withView([inputs.get('shapes.json')], async page => {
  const rows = readJsonl(inputs.detect('shapes.json', '.jsonl', '--stage', 'features'));
  await waitForData(page, 'shapes', '9');
  assert.equal(await data(page, 'pairs'), String(rows.length));
  await expectTable(page, rows.map(row => [row.a, row.b]));
  const at = k => shapesScene().objects[k].position[0];
  for (const top of [[at(0), 0, 2.1], [at(1), 0, 2.1], [at(3), 0, 2]]) await colourAt(page, top, light.free, 12);
  await colourAt(page, [at(5), 0, 2], light.colliding, 12);
  assert.deepEqual(await page.locator('#rows .number:not(.thickness)').allInnerTexts(), rows.map(depthText));
  const cells = page.locator('#rows td');
  assert.ok(await cells.evaluateAll(all => all.every(cell => cell.scrollWidth <= cell.clientWidth)));
  await page.locator('#rows tr').first().click();
  await waitForData(page, 'selected', `${rows[0].a},${rows[0].b}`);
  await waitForData(page, 'contacts', rows[0].contacts.length);
  await waitForText(page, '#depths', new RegExp(`^depth (≥ )?${depthDigits(rows[0].depth)}`));
  await page.evaluate(() => window.octopairView.select(1));
  await page.locator('#selection h2').waitFor();
  assert.equal(await text(page, '#selection h2'), hostileName);
  await page.fill('#search-text', 'onerror');
  await waitForText(page, '#found-list', /<img src=x/);
  assert.equal(await page.locator('img').count(), 0);
}));

test('an assembly: names and contacts', async () => {
  const file = 'assimp_models/glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb';
  const path = [join(root, 'data', file), join('/usr/share/assimp/models', file.slice('assimp_models/'.length))].find(existsSync);
  if (!path) return console.log('     skipped: scripts/data makes the assembly');
  const result = inputs.path('engine.jsonl');
  run(options.program, ['detect', path, '--stage', 'features', '--output', result, '--quiet']);
  const rows = readJsonl(result);
  return withView([path], async page => {
    assert.equal(await data(page, 'pairs'), String(rows.length));
    await expectTable(page, rows.slice(0, 100).map(row => [row.a, row.b]));
    assert.deepEqual(await page.locator('#rows .number:not(.thickness)').allInnerTexts(), rows.slice(0, 100).map(depthText));
    await waitForData(page, 'drawn', '67');
    const deepest = rows.reduce((best, row) => row.depth > best.depth ? row : best);
    await searchFor(page, deepest.a_name);
    await waitForText(page, '#selection dl', new RegExp(`index\\s+${deepest.a}\\s`));
    await page.selectOption('#sort', 'worst');
    await page.waitForFunction(pair => document.querySelector('#rows tr')?.dataset.pair === pair, `${deepest.a},${deepest.b}`);
    await page.locator('#rows tr').first().click();
    await waitForData(page, 'contacts', deepest.contacts.length);
    assert.ok(await page.locator('#rows td:last-child').evaluateAll(all => all.every(cell => cell.scrollWidth <= cell.clientWidth)));
  });
});

test('a result without its scene, and with it', async () => {
  const result = inputs.detect('shapes.json', '.jsonl', '--stage', 'features');
  const rows = readJsonl(result);
  const contacts = rows.reduce((sum, row) => sum + row.contacts.length, 0);
  await withView([result], async page => {
    await expectTable(page, rows.map(row => [row.a, row.b]));
    assert.equal(await data(page, 'contacts'), String(contacts));
    assert.equal((await settings(page)).others, 0.15);
    assert.match(await text(page, '#notices'), /A result has no boxes/);
  });
  await withView([inputs.get('shapes.json'), result], async page => {
    await expectTable(page, rows.map(row => [row.a, row.b]));
    await waitForData(page, 'shapes', '9');
  });
  const pairs = inputs.detect('10.npy', '.npy');
  await withView([inputs.get('10.npy'), pairs], async page => {
    const {values} = readNpy(pairs);
    await expectTable(page, Array.from({length: values.length / 2}, (_, k) => [values[2 * k], values[2 * k + 1]]));
    assert.equal(await data(page, 'drawn'), '10');
  });
});

// ---- Moving scenes ---------------------------------------------------------------------------------------------------

function countEvents() {
  const frames = Array.from({length: 25}, () => ({began: [], ended: [], pairs: 0}));
  for (const [frame, event, a, b] of readCsv(inputs.detect('moving.npy', '.csv', '--events'))) {
    frames[frame][event === 'begin' ? 'began' : 'ended'].push([Number(a), Number(b)]);
  }
  let pairs = 0;
  for (const frame of frames) frame.pairs = pairs += frame.began.length - frame.ended.length;
  return frames;
}

function countsText({pairs, began, ended}) {
  return `300 objects, ${pairs} pairs, ${began.length} began, ${ended.length} ended`;
}

test('frames: counts, steps, speed and a link', () => withView([inputs.get('moving.npy')], async (page, program) => {
  const frames = countEvents();
  assert.equal(await text(page, '#counts'), countsText(frames[0]));
  const timeline = await (await fetch(`${program.address}timeline.json`)).json();
  assert.deepEqual(timeline.began, frames.map(frame => frame.began.length));
  assert.deepEqual(timeline.ended, frames.map(frame => frame.ended.length));
  for (const f of [1, 2]) {
    await page.click('#step-forward');
    await waitForData(page, 'frame', f);
    assert.equal(await text(page, '#counts'), countsText(frames[f]));
  }
  for (const f of [24, 10]) {
    await page.locator('#frame-slider').fill(String(f));
    await waitForData(page, 'frame', f);
    assert.equal(await text(page, '#counts'), countsText(frames[f]));
  }
  // The times at which frames came. A slow machine makes them come late, never early.
  await page.evaluate(() => {
    window.came = [];
    new MutationObserver(() => window.came.push(performance.now())).observe(document.documentElement, {attributeFilter: ['data-frame']});
  });
  const play = async (speed, enough) => {
    await page.selectOption('#speed', speed);
    const began = await page.evaluate(() => { window.came.length = 0; return performance.now(); });
    await page.click('#play');
    await page.waitForFunction(enough);
    const came = await page.evaluate(() => window.came);
    await page.click('#play');
    return came.map(time => time - began);
  };
  const slow = await play('1', () => window.came.length >= 3);
  assert.ok(slow[2] >= 1990, `the third frame came after ${slow[2]} ms, but there is one in a second`);
  await page.evaluate(() => {
    const wait = window.setTimeout;
    window.waits = [];
    window.setTimeout = (go, milliseconds) => {
      window.waits.push(milliseconds);
      return wait(go, milliseconds);
    };
  });
  // Between frames the page waits for what is left of the interval, and at least 5 ms.
  await play('30', () => window.came.length >= 3 && window.waits.some(milliseconds => milliseconds >= 5 && milliseconds <= 1000 / 30));
  await page.click('#step-back');
  // Pictures may be late: the last frame is drawn after it was read.
  await waitForData(page, 'reading', 'false');
  const frame = await page.evaluate(() => String(window.octopairView.frame().frame));
  await waitForData(page, 'frame', frame);
  // The address names a frame that is not the first.
  const named = frame === '0' ? '^((?!frame=).)*$' : `frame=${frame}(&|$)`;
  await page.waitForFunction(wanted => new RegExp(wanted).test(location.hash), named);
  await withPage(page.url(), async other => {
    assert.equal(await data(other, 'frame'), frame);
    assert.equal(await text(other, '#counts'), countsText(frames[frame]));
  });
}));

test('frames: colours of what began and ended', async () => {
  const frames = countEvents();
  const f = frames.findIndex((frame, k) => k > 0 && frame.began.length > 3 && frame.ended.length > 3);
  const {values} = readNpy(inputs.get('moving.npy'));
  await withView([inputs.get('moving.npy')], async page => {
    assert.equal(await data(page, 'frame'), String(f));
    assert.match(await text(page, '#legend'), /began\nended/);
    const seen = async pairs => Promise.all([...new Set(pairs.flat())].map(async object =>
      pixel(page, await project(page, topOf([...values.subarray(6 * (300 * f + object), 6 * (300 * f + object) + 6)])))));
    // Others may be in front of some.
    assert.ok((await seen(frames[f].began)).filter(colour => near(colour, light.began)).length >= 2);
    assert.ok((await seen(frames[f].ended)).filter(colour => near(colour, light.ended)).length >= 1);
  }, {hash: `#frame=${f}`});
});

test('a recording', async () => {
  const path = inputs.path('dust.rec');
  const recorder = python('record', path);
  const {counts} = JSON.parse(await recorder.line());
  await recorder.ended;
  await withView([path, '--up', 'y'], async page => {
    assert.equal((await settings(page)).up, 'y');
    await waitForText(page, '#frame-text', new RegExp(`of ${counts.length}$`));
    for (const f of [0, 3, counts.length - 1]) {
      await page.locator('#frame-slider').fill(String(f));
      await waitForData(page, 'frame', f);
      await waitForText(page, '#counts', new RegExp(`^200 objects, ${counts[f][0]} pairs?, ${counts[f][1]} began, ${counts[f][2]} ended$`));
    }
  });
});

// ---- Live scenes and servers -----------------------------------------------------------------------------------------

async function checkLive(page, simulation) {
  const frame = async () => Number(await data(page, 'frame'));
  const first = await frame();
  await page.waitForFunction(from => Number(document.documentElement.dataset.frame) > from + 3, first);
  // All boxes move, so the program sends whole frames, and the page finds the events.
  await waitForText(page, '#counts', /[1-9]\d* began/);
  simulation.write('pairs\n');
  const {pairs} = JSON.parse(await simulation.line());
  await waitForData(page, 'pairs', pairs.length);
  await page.waitForTimeout(1300);
  assert.equal(await data(page, 'pairs'), String(pairs.length));
  await page.keyboard.press('l');
  await page.waitForFunction(count => Number(document.documentElement.dataset.lines) >= count, pairs.length);
  const ended = await page.evaluate(() => window.octopairView.frame().ended);
  assert.equal(await data(page, 'lines'), String(pairs.length + ended));
  return pairs;
}

test('a live scene of Python', async () => {
  const simulation = python('live');
  const {address} = JSON.parse(await simulation.line());
  await withPage(address, async page => {
    const pairs = await checkLive(page, simulation);
    const sorted = pairs.map(pair => [...pair].sort((a, b) => a - b)).sort((p, q) => p[0] - q[0] || p[1] - q[1]);
    await expectTable(page, sorted.slice(0, 100));
    simulation.write('go\n');
    const frozen = await data(page, 'frame');
    await page.waitForFunction(old => document.documentElement.dataset.frame !== old, frozen);
    await page.click('#play');
    await page.waitForTimeout(300);
    const paused = await data(page, 'frame');
    await page.waitForTimeout(400);
    assert.equal(await data(page, 'frame'), paused);
    await page.click('#play');
    await page.waitForFunction(old => Number(document.documentElement.dataset.frame) > Number(old), paused);
  });
  // A page that dies does not disturb the simulation.
  const killed = await open(browser, address);
  await ready(killed.page);
  const session = await killed.page.context().newCDPSession(killed.page);
  session.send('Page.crash').catch(() => undefined);
  await new Promise(done => setTimeout(done, 300));
  await Promise.race([killed.close(), new Promise(done => setTimeout(done, 1000))]);  // a dead page does not answer
  const steps = async () => {
    simulation.write('steps\n');
    return JSON.parse(await simulation.line()).steps;
  };
  const before = await steps();
  await withPage(address, async page => {
    const first = await data(page, 'frame');
    await page.waitForFunction(old => Number(document.documentElement.dataset.frame) > Number(old), first);
    assert.ok(await steps() > before);
    simulation.write('stop\n');
    assert.equal(await simulation.ended, 0);
    await waitForText(page, '#notices', /ended|lost/);
    assert.equal(await data(page, 'drawn'), '200');
  }, {expected: /WebSocket|Failed to load/});
});

test('a server: jobs, scenes and the page of a scene', async () => {
  const address = `unix:${inputs.path('s.socket')}`;
  const server = await serve('s.socket', '--state', inputs.path('state'));
  const simulation = python('remote', address);
  await simulation.line();
  const program = keep(await view(options.program, [address]));
  await withPage(program.address, async page => {
    await waitForData(page, 'scenes', '1');
    assert.match(await text(page, '#scene-rows'), /200/);
    const job = python('job', address);
    await job.line();
    await waitForText(page, '#job-rows', /done[^]*1,000/);
    job.write('release\n');
    await job.ended;
    await waitForData(page, 'jobs', '0');
    await page.click('#scene-rows a');
    await complete(page);
    await checkLive(page, simulation);
  }, {wait: ready, expected: /WebSocket/});
  simulation.write('stop\n');
  await simulation.ended;
  await program.stop();
  await server.stop();
});

test('a server that ends and starts again', async () => {
  const address = `unix:${inputs.path('again.socket')}`;
  let server = await serve('again.socket');
  const simulation = python('remote', address);
  await simulation.line();
  const program = keep(await view(options.program, [address]));
  const check = async page => {
    await waitForData(page, 'scenes', '1');
    const scene = await open(browser, new URL(await page.locator('#scene-rows a').getAttribute('href'), program.address).href);
    await complete(scene.page);
    await server.stop('SIGKILL');
    await simulation.stop('SIGKILL');
    await waitForText(page, '#banner', /no server answers/);
    await waitForText(scene.page, '#banner', /no server answers/);
    server = await serve('again.socket');
    await page.locator('#banner').waitFor({state: 'hidden'});
    await waitForData(page, 'scenes', '0');
    await waitForText(scene.page, '#notices', /simulation has ended/);
    assert.ok(await scene.page.locator('#banner').isHidden());
    await scene.close();
  };
  await withPage(program.address, check, {wait: ready});
  await program.stop();
  await server.stop();
});

test('a server that stops for a while, with a scene at rest', async () => {
  const address = `unix:${inputs.path('rest.socket')}`;
  const server = await serve('rest.socket');
  const simulation = python('remote', address);
  await simulation.line();
  simulation.write('pairs\n');
  await simulation.line();
  const program = keep(await view(options.program, [address]));
  await withPage(program.address, async page => {
    await waitForData(page, 'scenes', '1');
    const scene = await open(browser, new URL(await page.locator('#scene-rows a').getAttribute('href'), program.address).href);
    await complete(scene.page);
    server.process.kill('SIGSTOP');
    await waitForText(page, '#banner', /not answered/);
    await waitForText(scene.page, '#banner', /not answered/);
    server.process.kill('SIGCONT');
    for (const each of [page, scene.page]) await each.locator('#banner').waitFor({state: 'hidden'});
    simulation.write('stop\n');
    await waitForText(scene.page, '#notices', /simulation has ended/);
    await scene.close();
  }, {wait: ready});
  await program.stop();
  await server.stop();
});

test('the program ends, and the page keeps its picture', () => withView([inputs.get('three.npy')], async (page, program) => {
  await program.stop();
  await waitForText(page, '#notices', /The program has ended/);
  assert.equal(await data(page, 'drawn'), '3');
  await colourAt(page, topOf(threeBoxes[0]), light.free);
  await page.evaluate(() => window.octopairView.select(1));
  await waitForText(page, '#selection h3', /^1 partner$/);
}, {expected: /Failed to load|WebSocket/}));

// ---- The page --------------------------------------------------------------------------------------------------------

test('every key', () => withView([inputs.get('moving.npy')], async page => {
  await checkKeys(page);
  await page.keyboard.press('.');
  await waitForData(page, 'frame', '1');
  await page.keyboard.press(',');
  await waitForData(page, 'frame', '0');
  await page.keyboard.press(' ');
  await waitForText(page, '#play', /Pause/);
  await page.keyboard.press(' ');
  await waitForText(page, '#play', /Play/);
}));

test('the width of the side panel', () => withView([inputs.get('three.npy')], async page => {
  const width = () => page.locator('#side').evaluate(side => side.offsetWidth);
  const before = await width();
  await page.focus('#side-edge');
  await page.keyboard.press('ArrowLeft');
  assert.equal(await width(), before + 20);
  const edge = await page.locator('#side-edge').boundingBox();
  await page.mouse.move(edge.x + 4, 400);
  await page.mouse.down();
  await page.mouse.move(780, 400, {steps: 4});
  await page.mouse.up();
  assert.ok(Math.abs(await width() - 500) < 8);
  // The whole scene is still in view, in the middle of what is free.
  const seen = await Promise.all(threeBoxes.map(box => project(page, topOf(box))));
  assert.ok(seen.every(({x, y}) => x > 248 && x < 780 && y > 45 && y < 720));
}));

test('keys of shapes', () => withView([inputs.get('shapes.json')], async page => {
  for (const [key, name] of [['b', 'style'], ['k', 'contacts']]) {
    const before = (await settings(page))[name];
    await page.keyboard.press(key);
    assert.notEqual((await settings(page))[name], before);
  }
}));

for (const colorScheme of ['light', 'dark']) {
  for (const viewport of [{width: 1280, height: 720}, {width: 390, height: 844}]) {
    test(`accessible in ${colorScheme} at ${viewport.width}`, () => withView([inputs.get('moving.npy')],
      page => checkAccessibility(page, viewport.width < 760), {colorScheme, viewport}));
  }
}

test('an exported page', async () => {
  const frames = countEvents();
  const file = inputs.path('export.html');
  run(options.program, ['view', inputs.get('moving.npy'), '--export', file, '--quiet']);
  await withPage(pathToFileURL(file).href, async page => {
    assert.equal(await text(page, '#counts'), countsText(frames[0]));
    // The page begins with its first row, the worst one.
    assert.equal(await data(page, 'selected'), (await tablePairs(page))[0].join(','));
    await expectTable(page, frames[0].began.slice(0, 100));
    await page.locator('#rows tr').nth(2).click();
    await waitForData(page, 'selected', frames[0].began[2].join(','));
    await page.locator('.pair button').first().click();
    await waitForData(page, 'selected', frames[0].began[2][0]);
    const partners = partnersIn(frames[0].began, frames[0].began[2][0]);
    assert.deepEqual((await page.locator('.chips button').allInnerTexts()).map(Number), partners);
    await page.click('#step-forward');
    await waitForData(page, 'frame', '1');
    assert.equal(await text(page, '#counts'), countsText(frames[1]));
  });
});

test('an exported page without the rows of all pairs', async () => {
  const file = inputs.path('many.html');
  run(options.program, ['view', inputs.get('many.npy'), '--export', file, '--quiet']);
  for (const [pair, words] of [['0,1', /^Collision/], ['698,699', /^Not among the collisions of this page/]]) {
    await withPage(`${pathToFileURL(file).href}#selected=${pair}&show=selection`, async page => {
      await waitForText(page, '#selection', words);
      assert.equal(await data(page, 'selected'), pair);
      await waitForText(page, '#table-totals', /of 200,000 pairs, 44,650 less bad left out$/);
    });
  }
});

test('a report that compares with an older result', async () => {
  const base = inputs.detect('shapes.json', '.jsonl', '--stage', 'features');
  // The last object but one goes away from its neighbour, to the first.
  const scene = shapesScene();
  scene.objects[7].position = [-0.7, 0, 1.5];
  writeFileSync(inputs.path('moved.json'), JSON.stringify(scene));
  run(options.program, ['detect', inputs.path('moved.json'), '--stage', 'features', '--baseline', base, '--report', inputs.path('report.html'), '--unit', 'mm',
    '-o', inputs.path('moved.jsonl'), '--quiet']);
  const rows = readJsonl(inputs.path('moved.jsonl'));
  const of = change => rows.filter(row => row.change === change);
  assert.ok(['new', 'same', 'gone'].every(change => of(change).length > 0));
  const address = pathToFileURL(inputs.path('report.html')).href;
  const worst = [...of('new'), ...of('same')].reduce((best, row) => row.depth > best.depth ? row : best);
  await withPage(address, async page => {
    assert.equal(await text(page, '#counts'), `9 objects, ${rows.length - of('gone').length} collisions`);
    assert.equal(await data(page, 'selected'), `${worst.a},${worst.b}`);
    assert.match(await text(page, '#head'), /depth \(mm\)\s+change/);
    assert.match(await text(page, '#selection h2'), new RegExp(`^${worst.class}, depth .*${depthDigits(worst.depth)} mm`, 'i'));
    for (const change of ['new', 'same', 'gone']) {
      const button = page.locator('#kinds button', {hasText: change});
      assert.equal(await button.innerText(), `${of(change).length} ${change}`);
      await button.click();
      await page.waitForFunction(([word, count]) => {
        const cells = [...document.querySelectorAll('#rows td.change')];
        return cells.length === count && cells.every(cell => cell.textContent === word);
      }, [change, of(change).length]);
      await button.click();
    }
    await page.locator('#kinds button', {hasText: 'gone'}).click();
    const [gone] = of('gone');
    await page.locator('#rows tr', {hasText: gone.b_label ?? gone.b_name}).first().click();
    await waitForText(page, '#selection', new RegExp(`^Gone: ${gone.class}[^]*${gone.a_name}[^]*${gone.b_name}`));
    await waitForData(page, 'selected', '');
    assert.deepEqual(await accessibility(page), []);
    await page.keyboard.press('Escape');
    assert.ok(await page.locator('#selection').isHidden());
  });
  const [other] = of('new');
  await withPage(`${address}#selected=${other.a},${other.b}`, async page => {
    assert.equal(await data(page, 'selected'), `${other.a},${other.b}`);
    assert.match(await text(page, '#selection'), /change\s+new/);
    assert.match(await text(page, '#legend'), /in both|contacts, with the deepest labelled\n.*the way out of it/);
  });
});

test('a report about two files', async () => {
  writeFileSync(inputs.path('walls.json'), JSON.stringify({objects: [{name: 'wall', shape: {type: 'box', half_extents: [2, 0.1, 1]}}]}));
  writeFileSync(inputs.path('pipes.json'), JSON.stringify({objects: [{name: 'far', shape: {type: 'sphere', radius: 1}, position: [9, 0, 0]},
    {name: 'pipe', shape: {type: 'cylinder', radius: 0.05, length: 1}, rotation: [1, 1, 0, 0]}]}));
  const words = [inputs.path('walls.json'), '--against', inputs.path('pipes.json'), '--quiet'];
  run(options.program, ['detect', ...words, '--stage', 'features', '--report', inputs.path('two.html'), '-o', inputs.path('two.jsonl')]);
  run(options.program, ['view', ...words, '--export', inputs.path('two_view.html')]);
  for (const name of ['two.html', 'two_view.html']) {
    await withPage(pathToFileURL(inputs.path(name)).href, async page => {
      assert.equal(await text(page, '#title'), 'walls.json against pipes.json');
      assert.deepEqual(await tablePairs(page), [[0, 2]]);
      assert.match(await text(page, '#selection'), /wall\s+walls\.json · #0\s+pipe\s+pipes\.json · #1/);
      assert.deepEqual(await page.locator('#rows small').allInnerTexts(), ['walls.json', 'pipes.json']);
    });
  }
});

test('screenshots', async () => {
  const page = await browser.newPage();
  for (const input of ['shapes.json', '10k.npy']) {
    const file = inputs.path(`${input}.png`);
    run(options.program, ['view', inputs.get(input), '--screenshot', file, '--quiet']);
    const {width, height, colours} = await describePicture(page, file);
    assert.deepEqual([width, height], [1280, 720]);
    assert.ok(colours > 100, `${colours} colours`);
  }
  await page.close();
});

let failed = 1;
try {
  failed = await runTests(tests, options.only, async () => {
    for (const child of children) await child.stop('SIGKILL');
    children.clear();
  });
} finally {
  await browser.close();
  rmSync(folder, {recursive: true});
}
process.exit(failed ? 1 : 0);
