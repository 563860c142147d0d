// Tests of the page against the stand-in for the program (viewer/mock_server.mjs): their list and their run.
import assert from 'node:assert/strict';
import {existsSync} from 'node:fs';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';
import {parseArgs} from 'node:util';
import {launch, open, ready, runTests, viewerFolder} from './browser.mjs';

export const {values: options} = parseArgs({options: {
  page: {type: 'string', default: join(viewerFolder, 'page.html')}, only: {type: 'string', default: ''},
}});
if (!existsSync(options.page)) throw new Error(`${options.page} is missing: node viewer/build.mjs ${options.page}`);
export const {startMock} = await import(pathToFileURL(join(viewerFolder, 'mock_server.mjs')));

// The hash of a page with nothing selected. Without a hash, the page begins with the worst collision.
const whole = '#selected=';
const tests = [];

// A test of the page of a generated scene. `context` are the options of its browser's context, `hash` that of its address, and `expected`
// the errors of the browser that belong to the test.
export function test(name, scene, objects, run, context = {}) {
  tests.push({name, go: browser => testMock(browser, {scene, objects, run, context})});
}

// A test that opens its own pages.
export function testOf(name, go) {
  tests.push({name, go});
}

// The worst collision, as the mock sorts them.
export function worstOf(scene) {
  return scene.collisions(0, new URLSearchParams({sort: 'worst'})).rows[0];
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

// Runs the tests of this program and ends it.
export async function runAll() {
  const browser = await launch();
  const failed = await runTests(tests.map(({name, go}) => ({name, go: () => go(browser)})), options.only);
  await browser.close();
  process.exit(failed ? 1 : 0);
}
