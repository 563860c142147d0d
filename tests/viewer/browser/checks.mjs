// Checks that several tests of the pages share.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {accessibility, data, pixel, project, settings} from '../page/browser.mjs';

export const light = {background: [243, 245, 247], free: [176, 188, 200], colliding: [222, 88, 50], began: [240, 176, 40], ended: [42, 157, 143],
  selected: [28, 110, 235], second: [240, 140, 20], contact: [190, 0, 70], touching: [118, 156, 196]};

export function text(page, selector) {
  return page.locator(selector).innerText();
}

export function near(seen, wanted, slack = 2) {
  return seen.every((value, k) => Math.abs(value - wanted[k]) <= slack);
}

export async function colourAt(page, point, wanted, slack = 2) {
  const seen = await pixel(page, await project(page, point));
  assert.ok(near(seen, wanted, slack), `${seen} instead of ${wanted} at ${point}`);
}

// The middle of the upper side of a box.
export function topOf(box) {
  return [0.5 * (box[0] + box[3]), 0.5 * (box[1] + box[4]), box[5]];
}

// The rows of the table: pairs of indices.
export function tablePairs(page) {
  return page.evaluate(() => [...document.querySelectorAll('#rows tr[data-pair]')].map(row => row.dataset.pair.split(',').map(Number)));
}

// Sorts the table, and checks that it comes to have these pairs of indices.
export async function expectTable(page, pairs, sort = 'pair') {
  await page.selectOption('#sort', sort);
  await page.waitForFunction(wanted => [...document.querySelectorAll('#rows tr[data-pair]')].map(row => row.dataset.pair).join(' ') === wanted,
    pairs.map(pair => pair.join(',')).join(' '), {timeout: 10_000})
    .catch(() => undefined);
  assert.deepEqual(await tablePairs(page), pairs);
}

// A number with the digits that the page gives a depth.
export function depthDigits(value) {
  const rounded = Number(value.toPrecision(4));
  return rounded !== 0 && (rounded < 1e-4 || rounded >= 1e7) ? rounded.toExponential() : rounded.toLocaleString('en-US', {maximumFractionDigits: 8});
}

// The depth of a row as the table shows it: a lower bound does not look like the depth itself.
export function depthText({depth, depth_kind}) {
  const known = depth !== undefined && (depth > 0 || depth_kind !== 'at_least');
  return !known ? '' : `${depth_kind === 'at_least' ? '≥ ' : ''}${depthDigits(depth)}`;
}

// The rows of a CSV file, without its header.
export function readCsv(path) {
  return readFileSync(path, 'utf8').trim().split('\n').slice(1).map(line => line.split(','));
}

export function readJsonl(path) {
  return readFileSync(path, 'utf8').trim().split('\n').map(line => JSON.parse(line));
}

export function partnersIn(pairs, object) {
  return pairs.flatMap(([a, b]) => a === object ? [b] : b === object ? [a] : []).sort((p, q) => p - q);
}

export async function searchFor(page, words) {
  await page.fill('#search-text', words);
  await page.waitForTimeout(100);
  await page.press('#search-text', 'Enter');
}

// The page has all its data.
export async function complete(page, timeout = 60_000) {
  await page.waitForFunction(() => document.documentElement.dataset.complete === 'true', null, {timeout});
}

export async function waitForText(page, selector, pattern, timeout = 20_000) {
  try {
    await page.waitForFunction(([where, source, flags]) => new RegExp(source, flags).test(document.querySelector(where)?.innerText ?? ''),
      [selector, pattern.source, pattern.flags], {timeout});
  } catch {
    throw new Error(`${selector} is "${await text(page, selector)}" and does not match ${pattern}`);
  }
}

// Every key changes what it says. `more`: further keys, with the settings that they change.
export async function checkKeys(page, more = {}) {
  const camera = () => page.evaluate(() => window.octopairView.camera());
  const key = async (name, check) => {
    const [before, place] = [await settings(page), await camera()];
    await page.keyboard.press(name);
    await page.waitForTimeout(30);
    assert.ok(check(await settings(page), before, await camera() !== place), `key ${name}`);
  };
  for (const name of ['w', 's', 'a', 'd', 'e', 'q', 'ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', '+', '-', '=', '1', '2', '3', '4', 'h']) {
    await key(name, (_, __, moved) => moved);
  }
  const names = {c: 'colour', v: 'show', g: 'edges', l: 'lines', o: 'octants', x: 'section', PageUp: 'cut', PageDown: 'cut', r: 'flip', u: 'up', i: 'camera',
    t: 'theme', ...more};
  for (const [name, setting] of Object.entries(names)) await key(name, (now, before) => now[setting] !== before[setting]);
  for (const name of ['v', 'v', 'u', 'i']) await page.keyboard.press(name);
  await page.waitForTimeout(300);
  await key(']', (now, before) => now.level === before.level + 1);
  await key('[', (now, before) => now.level === before.level - 1);
  await page.keyboard.press('n');
  await page.waitForFunction(() => document.documentElement.dataset.selected.includes(','));
  const first = await data(page, 'selected');
  await page.keyboard.press('n');
  await page.waitForFunction(old => document.documentElement.dataset.selected !== old, first);
  await page.keyboard.press('p');
  await page.waitForFunction(old => document.documentElement.dataset.selected === old, first);
  await page.keyboard.press('h');
  await key('f', (_, __, moved) => moved);
  await page.keyboard.press('Escape');
  await page.waitForFunction(() => document.documentElement.dataset.selected === '');
  for (const [name, drawer, states] of [['z', 'side', ['closed', 'open']], ['m', 'options', ['open', 'closed']]]) {
    for (const state of states) {
      await page.keyboard.press(name);
      await page.waitForFunction(([which, wanted]) => document.documentElement.dataset[which] === wanted, [drawer, state]);
    }
  }
  await page.keyboard.press('y');
  await waitForText(page, '#message', /link/i);
  await page.keyboard.press('/');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'search-text');
  await page.keyboard.press('Escape');
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press('?');
  assert.equal(await page.locator('#help').evaluate(dialog => dialog.open), true);
  assert.ok(await page.locator('#help-rows tr').count() > 25);
  assert.match(await text(page, '#help'), /pinch/);
  await page.keyboard.press('Escape');
  assert.equal(await page.locator('#help').evaluate(dialog => dialog.open), false);
}

// No serious violation of accessibility with the lists, a selection, the settings and the help.
export async function checkAccessibility(page, narrow) {
  assert.deepEqual(await accessibility(page), []);
  await page.evaluate(() => window.octopairView.select(3));
  if (narrow) await page.keyboard.press('z');
  await page.locator('#selection dl').waitFor();
  assert.deepEqual(await accessibility(page), []);
  await page.click('#tab-scene');
  if (narrow) await page.keyboard.press('m');
  assert.deepEqual(await accessibility(page), []);
  await page.keyboard.press('?');
  assert.deepEqual(await accessibility(page), []);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
}

// The size of a PNG picture and its number of colours.
export async function describePicture(page, path) {
  const bytes = readFileSync(path);
  assert.deepEqual([...bytes.subarray(0, 8)], [0x89, 0x50, 0x4e, 0x47, 13, 10, 26, 10]);
  const colours = await page.evaluate(async base64 => {
    const picture = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
    const context = new OffscreenCanvas(picture.width, picture.height).getContext('2d');
    context.drawImage(picture, 0, 0);
    return new Set(new Uint32Array(context.getImageData(0, 0, picture.width, picture.height).data.buffer)).size;
  }, bytes.toString('base64'));
  return {width: bytes.readUInt32BE(16), height: bytes.readUInt32BE(20), colours};
}
