// Tests of pages of the program in Chromium: the program, its children, and the run of the tests.
import assert from 'node:assert/strict';
import {existsSync, mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {parseArgs} from 'node:util';
import {launch, open, runTests} from '../page/browser.mjs';
import {complete, readCsv} from './checks.mjs';
import {Inputs} from './inputs.mjs';
import {Child, view} from './program.mjs';

const here = dirname(fileURLToPath(import.meta.url));
export const root = join(here, '../../..');
export const {values: options} = parseArgs({options: {
  program: {type: 'string', default: join(root, 'build/release/src/cli/octopair')}, python: {type: 'string', default: '/usr/bin/python3'},
  package: {type: 'string', default: join(root, 'build/release/python/package')}, only: {type: 'string', default: ''},
}});
const folder = mkdtempSync(join(tmpdir(), 'octopair-browser-'));
export const inputs = new Inputs(folder, options.program);
export const browser = await launch();
const children = new Set();
const tests = [];
export const test = (name, go) => tests.push({name, go});

export function keep(child) {
  children.add(child);
  return child;
}

// Starts a server at a socket, and waits until it listens.
export async function serve(name, ...more) {
  const server = keep(new Child(options.program, ['serve', '--listen', `unix:${inputs.path(name)}`, ...more, '--log-level', 'warn']));
  while (!existsSync(inputs.path(name))) await new Promise(done => setTimeout(done, 50));
  return server;
}

export function python(...words) {
  return keep(new Child(options.python, [join(here, 'scenes.py'), ...words], {env: {...process.env, PYTHONPATH: options.package}}));
}

// Opens a page, waits for all its data, and checks at its end that the browser reported no error.
export async function withPage(address, check, {expected, wait = complete, ...context} = {}) {
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
export const whole = '#selected=';

export async function withView(words, check, context = {}) {
  const program = keep(await view(options.program, words));
  try {
    await withPage(program.address + (context.hash ?? whole), page => check(page, program), context);
  } finally {
    await program.stop();
  }
}

// For each frame of moving.npy: the pairs that begin, the pairs that end, and the number of pairs. The program's events give them.
export function countEvents() {
  const frames = Array.from({length: 25}, () => ({began: [], ended: [], pairs: 0}));
  for (const [frame, event, a, b] of readCsv(inputs.detect('moving.npy', '.csv', '--events'))) {
    frames[frame][event === 'begin' ? 'began' : 'ended'].push([Number(a), Number(b)]);
  }
  let pairs = 0;
  for (const frame of frames) frame.pairs = pairs += frame.began.length - frame.ended.length;
  return frames;
}

// The text in which the page counts the objects and pairs of a frame of moving.npy.
export function countsText({pairs, began, ended}) {
  return `300 objects, ${pairs} pairs, ${began.length} began, ${ended.length} ended`;
}

// Runs the tests of this program and ends it.
export async function runAll() {
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
}
