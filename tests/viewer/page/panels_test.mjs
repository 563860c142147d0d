// Tests the list of collisions, the panels and the keys of the page in Chromium with the mock server: node panels_test.mjs [--page FILE] [--only TEXT]
import assert from 'node:assert/strict';
import {checkAccessibility, checkKeys, complete, depthDigits, tablePairs, text, waitForText} from '../browser/checks.mjs';
import {accessibility, data, ready, settings, waitForData} from './browser.mjs';
import {runAll, test} from './stand_in.mjs';

test('the summary of the run', 'static', 60, async ({page, scene}) => {
  await complete(page);
  await page.click('#tab-scene');
  const {penetrating, touching} = scene.classCounts(0);
  assert.deepEqual((await text(page, '#frame-info')).split(/\s+/), ['collisions', String(penetrating + touching),
    ...Object.entries(scene.classCounts(0)).flatMap(([word, count]) => [word, String(count)])]);
  assert.match(await text(page, '#summary'), /objects\s+60\s+unit\s+m\s+format\s+npy/);
});

test('partners lead to other objects', 'static', 200, async ({page, scene}) => {
  const [a, b] = scene.frame(0).pairs[0];
  await page.evaluate(k => window.octopairView.select(k), a);
  await page.locator('.chips button').first().click();
  await waitForData(page, 'selected', b);
  assert.ok(Number(await data(page, 'lines')) >= 1);
  await waitForData(page, 'contacts', scene.object(0, b).partner_count);
});

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

test('every key has its effect', 'moving', 60, async ({page}) => {
  await checkKeys(page, {k: 'contacts'});
  await page.keyboard.press('.');
  await waitForData(page, 'frame', '1');
  await page.keyboard.press(',');
  await waitForData(page, 'frame', '0');
});

test('the error of an input', 'failed', 10, async ({page}) => {
  await page.locator('#failure').waitFor();
  assert.match(await text(page, '#failure'), /the minimum of x is above the maximum/);
});

test('progress while loading', 'loading', 10, async ({page}) => {
  await ready(page);
  assert.equal(await data(page, 'drawn'), '10');
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

await runAll();
