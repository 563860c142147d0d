// Tests frames, live scenes, servers and exported pages in Chromium with the mock server: node frames_test.mjs [--page FILE] [--only TEXT]
import assert from 'node:assert/strict';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';
import {complete, text} from '../browser/checks.mjs';
import {accessibility, data, open, pictures, pixel, project, ready, settings, waitForData} from './browser.mjs';
import {exportPage} from './export.mjs';
import {options, startMock, runAll, test, testOf, worstOf} from './stand_in.mjs';

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

test('a live scene begins with the worst collision, and keeps what was selected', 'live', 200, async ({page, scene, address}) => {
  // The first page may have written its view into its address by now, and this one has to begin without a link.
  await page.goto('about:blank');
  // The first answer has no collisions yet.
  let answers = 0;
  await page.route('**/collisions/*.json*', route => answers++ === 0 ? route.fulfill({json: {total: 0, rows: []}}) : route.continue());
  await page.goto(address);
  await complete(page);
  await page.waitForFunction(() => document.documentElement.dataset.selected?.includes(','));
  assert.ok(answers > 1);
  assert.equal(await data(page, 'drawn'), String(scene.n));
  assert.equal((await settings(page)).ghosts, false);
  // The rows that come later do not select anything again.
  await page.keyboard.press('Escape');
  await waitForData(page, 'selected', '');
  for (const known of [answers, answers + 1]) {
    while (answers <= known) await page.waitForResponse(/collisions/);
    await pictures(page, 2);
    assert.equal(await data(page, 'selected'), '');
  }
}, {hash: ''});

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

testOf('exported page', testExport);

await runAll();
