// Opens pages in Debian's Chromium for tests: waits, clicks, colours of pixels, and the rules of accessibility.
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

export const viewerFolder = join(dirname(fileURLToPath(import.meta.url)), '../../../viewer');
const require = createRequire(join(viewerFolder, 'package.json'));
const {chromium} = require('playwright-core');
const axeSource = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

export async function launch() {
  const args = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage'];
  if (process.getuid?.() === 0) args.push('--no-sandbox');
  return chromium.launch({executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args});
}

// A page that collects its errors. `options` are those of a context of playwright: viewport, colorScheme, hasTouch.
export async function open(browser, address, options = {}) {
  const context = await browser.newContext({viewport: {width: 1280, height: 720}, reducedMotion: 'reduce', bypassCSP: false, ...options});
  const page = await context.newPage();
  const errors = [];
  page.on('console', message => message.type() === 'error' && errors.push(message.text()));
  page.on('pageerror', error => errors.push(String(error)));
  await page.goto(address);
  return {page, errors, close: () => context.close()};
}

export async function ready(page, timeout = 30_000) {
  await page.waitForFunction(() => document.documentElement.dataset.ready === 'true', null, {timeout});
}

export function data(page, name) {
  return page.evaluate(key => document.documentElement.dataset[key] ?? '', name);
}

export async function waitForData(page, name, value, timeout = 10_000) {
  try {
    await page.waitForFunction(([key, wanted]) => document.documentElement.dataset[key] === wanted, [name, String(value)], {timeout});
  } catch {
    throw new Error(`data-${name} is "${await data(page, name)}" and not "${value}"`);
  }
}

export function project(page, point) {
  return page.evaluate(([x, y, z]) => window.octopairView.project(x, y, z), point);
}

export function pixel(page, {x, y}) {
  return page.evaluate(([px, py]) => window.octopairView.pixel(px, py), [x, y]);
}

export async function clickAt(page, point) {
  const {x, y} = await project(page, point);
  await page.mouse.click(x, y);
}

export function settings(page) {
  return page.evaluate(() => window.octopairView.settings());
}

// Waits until the page has drawn some pictures.
export async function pictures(page, count) {
  for (let k = 0; k < count; ++k) await page.evaluate(() => new Promise(done => requestAnimationFrame(done)));
}

// The serious and critical violations, one line each. axe runs in an isolated world where the page's policy does not reach.
export async function accessibility(page) {
  await page.evaluate(axeSource);
  const result = await page.evaluate(() => window.axe.run(document, {resultTypes: ['violations']}));
  return result.violations.filter(violation => ['serious', 'critical'].includes(violation.impact))
    .map(violation => `${violation.id}: ${violation.nodes.map(node => `${node.target} ${node.failureSummary}`).join('; ')}`);
}

// Runs the tests whose names contain `only`, and prints a line for each. Returns how many failed.
export async function runTests(tests, only, after = () => undefined) {
  let failed = 0;
  for (const {name, go} of tests.filter(entry => entry.name.includes(only))) {
    const began = performance.now();
    try {
      await go();
      console.log(`ok   ${name} (${Math.round(performance.now() - began)} ms)`);
    } catch (error) {
      failed += 1;
      console.log(`FAIL ${name}: ${error.message}`);
    }
    await after();
  }
  return failed;
}
