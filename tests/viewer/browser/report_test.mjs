// Tests keys and layout, exported pages, reports and screenshots, by the program and in Chromium:
// node report_test.mjs [--program octopair] [--python python3] [--package FOLDER] [--only TEXT]
import assert from 'node:assert/strict';
import {writeFileSync} from 'node:fs';
import {pathToFileURL} from 'node:url';
import {accessibility, data, project, settings, waitForData} from '../page/browser.mjs';
import {checkAccessibility, checkKeys, depthDigits, describePicture, expectTable, partnersIn, readJsonl, tablePairs, text, topOf,
  waitForText} from './checks.mjs';
import {shapesScene, threeBoxes} from './inputs.mjs';
import {browser, countEvents, countsText, inputs, options, runAll, test, withPage, withView} from './pages.mjs';
import {run} from './program.mjs';

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

await runAll();
