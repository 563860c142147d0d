// Opens the page of a scene and measures its first picture, for tests and for bench/viewer/first_picture.mjs.
import {existsSync, readFileSync} from 'node:fs';
import {ready} from '../page/browser.mjs';
import {complete} from './checks.mjs';
import {view} from './program.mjs';

// Returns the page when all its data are there, the program, a function that closes the page, and what was measured: milliseconds from the
// start of the program to the first picture, megabytes sent to the page, and megabytes of memory of the tab. `keep` gets the program.
export async function firstPicture(browser, program, path, keep = child => child) {
  const began = performance.now();
  const child = keep(await view(program, [path]));
  const context = await browser.newContext({viewport: {width: 1280, height: 720}, reducedMotion: 'reduce'});
  const page = await context.newPage();
  await page.goto(child.address, {waitUntil: 'commit'});
  await ready(page, 90_000);
  const milliseconds = performance.now() - began;
  await complete(page, 90_000);
  const bytes = await page.evaluate(() => ['navigation', 'resource'].flatMap(type => performance.getEntriesByType(type))
    .reduce((sum, entry) => sum + entry.transferSize, 0));
  const measured = {milliseconds, megabytes_sent: bytes / 1e6, megabytes_of_tab: await rendererMemory(browser)};
  return {page, program: child, close: () => context.close(), measured};
}

// Returns the memory of the largest renderer, in megabytes.
async function rendererMemory(browser) {
  const session = await browser.newBrowserCDPSession();
  const {processInfo} = await session.send('SystemInfo.getProcessInfo');
  await session.detach();
  const sizes = processInfo.filter(process => process.type === 'renderer').map(({id}) => {
    const status = existsSync(`/proc/${id}/status`) ? readFileSync(`/proc/${id}/status`, 'utf8') : '';
    return Number(/VmRSS:\s+(\d+)/.exec(status)?.[1] ?? 0) * 1024 / 1e6;
  });
  return Math.max(0, ...sizes);
}
