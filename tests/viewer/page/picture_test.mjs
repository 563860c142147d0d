// Tests what the page draws, and its camera, in Chromium with the mock server: node picture_test.mjs [--page FILE] [--only TEXT]
import assert from 'node:assert/strict';
import {colourAt, complete, depthDigits, light, near, text} from '../browser/checks.mjs';
import {accessibility, clickAt, data, open, pictures, pixel, project, ready, settings, waitForData} from './browser.mjs';
import {runAll, test, worstOf} from './stand_in.mjs';

// The middle of the box of an object that is drawn in front, from the mock's first frame.
function middleOf(scene, k) {
  const {boxes} = scene.frame(0);
  return [0, 1, 2].map(axis => 1000 * (axis + 1) + 0.5 * (boxes[6 * k + axis] + boxes[6 * k + axis + 3]));
}

async function distance(page) {
  return Number((await page.evaluate(() => window.octopairView.camera())).split('_')[3]);
}

// Whether a section through this pixel has the colour of what both objects have in common, beside the mark of the contact.
async function isCommon(page, at) {
  const beside = [[1, 1], [-1, 1], [1, -1], [-1, -1]].map(([x, y]) => pixel(page, {x: at.x + 9 * x, y: at.y + 9 * y}));
  return (await Promise.all(beside)).some(colour => near(colour, light.contact));
}

test('loads and counts', 'static', 10, async ({page, scene}) => {
  assert.equal(await data(page, 'drawn'), '10');
  assert.equal(await data(page, 'pairs'), String(scene.frame(0).pairs.length));
  assert.match(await text(page, '#counts'), /^10 objects, \d+ collisions?$/);
  assert.match(await page.title(), /mock static/);
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

await runAll();
