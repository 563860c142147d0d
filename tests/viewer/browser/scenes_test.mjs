// Tests pages of scenes at rest, by the program and in Chromium:
// node scenes_test.mjs [--program octopair] [--python python3] [--package FOLDER] [--only TEXT]
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {existsSync, readFileSync} from 'node:fs';
import {join} from 'node:path';
import {clickAt, data, pixel, project, settings, waitForData} from '../page/browser.mjs';
import {colourAt, depthDigits, depthText, expectTable, light, partnersIn, readCsv, readJsonl, searchFor, tablePairs,
  text, topOf, waitForText} from './checks.mjs';
import {firstPicture} from './first_picture.mjs';
import {hostileName, shapesScene, threeBoxes} from './inputs.mjs';
import {browser, inputs, keep, options, root, runAll, test, withView} from './pages.mjs';
import {readNpy, run} from './program.mjs';

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

function openBoxes(name) {
  return firstPicture(browser, options.program, inputs.get(name), keep);
}

test('100,000 boxes: the first picture', async () => {
  const {page, program, close} = await openBoxes('100k.npy');
  await page.keyboard.press('Escape');
  await waitForData(page, 'drawn', '100000');
  await close();
  await program.stop();
});

test('a million boxes: the first picture, a notice, and boxes near a place', async () => {
  const {page, program, close} = await openBoxes('1m.npy');
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

await runAll();
