// Takes the pictures of docs/images/moving from an exported page: node moving.mjs PAGE NODE_MODULES THEME FOLDER
//
// Shows the canvas of the page, with a caption in place of panels, and writes frames 1 and later as FOLDER/NNN.png. Frame 0 is left out,
// because all its pairs are new. The pictures have twice the size of the result, so that its edges are smooth.
import {createRequire} from 'node:module';
import {join, resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [file, modules, theme, folder] = process.argv.slice(2);
const {chromium} = createRequire(import.meta.url)(join(resolve(modules), 'playwright-core'));

// Target, distance, yaw and pitch of the camera: the part `at` of a link.
const camera = [0.11, -0.139, -0.1, 1.93, -0.9, 0.5].join('_');
const hidden = ['bar', 'time', 'side', 'options', 'corner', 'notices', 'overview', 'message'].map(id => `#${id}`).join();
const style = `
  ${hidden} { display: none !important; }
  #caption { position: absolute; left: 0; right: 0; bottom: 14px; display: flex; justify-content: center; gap: 22px; font-size: 14px; }
  #caption b { width: 9em; text-align: right; font-variant-numeric: tabular-nums; }
`;
const args = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage'];
if (process.getuid() === 0) args.push('--no-sandbox');
const browser = await chromium.launch({executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args});
const viewport = {width: 800, height: 380};
const page = await browser.newPage({viewport, deviceScaleFactor: 2, colorScheme: theme, reducedMotion: 'reduce'});
await page.goto(`${pathToFileURL(resolve(file))}#at=${camera}&frame=1`);
await page.waitForFunction(() => document.documentElement.dataset.complete === 'true', null, {timeout: 60_000});

async function show(frame) {
  await page.evaluate(number => {
    const slider = document.getElementById('frame-slider');
    slider.value = String(number);
    slider.dispatchEvent(new Event('input', {bubbles: true}));
  }, frame);
  await page.waitForFunction(number => {
    const {frame: shown, reading} = document.documentElement.dataset;
    return shown === String(number) && reading === 'false';
  }, frame);
}

// The legend of the page has the states of one frame. The caption has those of all frames, so that it does not move.
const entries = new Map();
const last = await page.evaluate(() => Number(document.getElementById('frame-slider').max));
for (let frame = 1; frame <= last; ++frame) {
  await show(frame);
  const list = await page.evaluate(() => [...document.querySelectorAll('#legend li')].map(entry => [entry.textContent, entry.innerHTML]));
  for (const [text, html] of list) entries.set(text, html);
}
await page.addStyleTag({content: style});
await page.evaluate(list => {
  const caption = document.createElement('p');
  caption.id = 'caption';
  caption.innerHTML = `<b></b>${list.map(html => `<span>${html}</span>`).join('')}`;
  document.getElementById('stage').append(caption);
  window.dispatchEvent(new Event('resize'));
}, [...entries.values()]);

for (let frame = 1; frame <= last; ++frame) {
  await show(frame);
  await page.evaluate(async () => {
    document.querySelector('#caption b').textContent = `${document.documentElement.dataset.pairs} pairs`;
    for (let k = 0; k < 3; ++k) await new Promise(done => requestAnimationFrame(done));
  });
  await page.screenshot({path: join(folder, `${String(frame).padStart(3, '0')}.png`)});
}
await browser.close();
