// Tests pages of moving scenes, live scenes and servers, by the program and in Chromium:
// node moving_test.mjs [--program octopair] [--python python3] [--package FOLDER] [--only TEXT]
import assert from 'node:assert/strict';
import {data, open, pixel, project, ready, settings, waitForData} from '../page/browser.mjs';
import {colourAt, complete, expectTable, light, near, text, topOf, waitForText} from './checks.mjs';
import {threeBoxes} from './inputs.mjs';
import {browser, countEvents, countsText, inputs, keep, options, python, runAll, serve, test, withPage, withView} from './pages.mjs';
import {readNpy, view} from './program.mjs';

test('frames: counts, steps, speed and a link', () => withView([inputs.get('moving.npy')], async (page, program) => {
  const frames = countEvents();
  assert.equal(await text(page, '#counts'), countsText(frames[0]));
  const timeline = await (await fetch(`${program.address}timeline.json`)).json();
  assert.deepEqual(timeline.began, frames.map(frame => frame.began.length));
  assert.deepEqual(timeline.ended, frames.map(frame => frame.ended.length));
  for (const f of [1, 2]) {
    await page.click('#step-forward');
    await waitForData(page, 'frame', f);
    assert.equal(await text(page, '#counts'), countsText(frames[f]));
  }
  for (const f of [24, 10]) {
    await page.locator('#frame-slider').fill(String(f));
    await waitForData(page, 'frame', f);
    assert.equal(await text(page, '#counts'), countsText(frames[f]));
  }
  // The times at which frames came. A slow machine makes them come late, never early.
  await page.evaluate(() => {
    window.came = [];
    new MutationObserver(() => window.came.push(performance.now())).observe(document.documentElement, {attributeFilter: ['data-frame']});
  });
  const play = async (speed, enough) => {
    await page.selectOption('#speed', speed);
    const began = await page.evaluate(() => { window.came.length = 0; return performance.now(); });
    await page.click('#play');
    await page.waitForFunction(enough);
    const came = await page.evaluate(() => window.came);
    await page.click('#play');
    return came.map(time => time - began);
  };
  const slow = await play('1', () => window.came.length >= 3);
  assert.ok(slow[2] >= 1990, `the third frame came after ${slow[2]} ms, but there is one in a second`);
  await page.evaluate(() => {
    const wait = window.setTimeout;
    window.waits = [];
    window.setTimeout = (go, milliseconds) => {
      window.waits.push(milliseconds);
      return wait(go, milliseconds);
    };
  });
  // Between frames the page waits for what is left of the interval, and at least 5 ms.
  await play('30', () => window.came.length >= 3 && window.waits.some(milliseconds => milliseconds >= 5 && milliseconds <= 1000 / 30));
  await page.click('#step-back');
  // Pictures may be late: the last frame is drawn after it was read.
  await waitForData(page, 'reading', 'false');
  const frame = await page.evaluate(() => String(window.octopairView.frame().frame));
  await waitForData(page, 'frame', frame);
  // The address names a frame that is not the first.
  const named = frame === '0' ? '^((?!frame=).)*$' : `frame=${frame}(&|$)`;
  await page.waitForFunction(wanted => new RegExp(wanted).test(location.hash), named);
  await withPage(page.url(), async other => {
    assert.equal(await data(other, 'frame'), frame);
    assert.equal(await text(other, '#counts'), countsText(frames[frame]));
  });
}));

test('frames: colours of what began and ended', async () => {
  const frames = countEvents();
  const f = frames.findIndex((frame, k) => k > 0 && frame.began.length > 3 && frame.ended.length > 3);
  const {values} = readNpy(inputs.get('moving.npy'));
  await withView([inputs.get('moving.npy')], async page => {
    assert.equal(await data(page, 'frame'), String(f));
    assert.match(await text(page, '#legend'), /began\nended/);
    const seen = async pairs => Promise.all([...new Set(pairs.flat())].map(async object =>
      pixel(page, await project(page, topOf([...values.subarray(6 * (300 * f + object), 6 * (300 * f + object) + 6)])))));
    // Others may be in front of some.
    assert.ok((await seen(frames[f].began)).filter(colour => near(colour, light.began)).length >= 2);
    assert.ok((await seen(frames[f].ended)).filter(colour => near(colour, light.ended)).length >= 1);
  }, {hash: `#frame=${f}`});
});

test('a recording', async () => {
  const path = inputs.path('dust.rec');
  const recorder = python('record', path);
  const {counts} = JSON.parse(await recorder.line());
  await recorder.ended;
  await withView([path, '--up', 'y'], async page => {
    assert.equal((await settings(page)).up, 'y');
    await waitForText(page, '#frame-text', new RegExp(`of ${counts.length}$`));
    for (const f of [0, 3, counts.length - 1]) {
      await page.locator('#frame-slider').fill(String(f));
      await waitForData(page, 'frame', f);
      await waitForText(page, '#counts', new RegExp(`^200 objects, ${counts[f][0]} pairs?, ${counts[f][1]} began, ${counts[f][2]} ended$`));
    }
  });
});

async function checkLive(page, simulation) {
  const frame = async () => Number(await data(page, 'frame'));
  const first = await frame();
  await page.waitForFunction(from => Number(document.documentElement.dataset.frame) > from + 3, first);
  // All boxes move, so the program sends whole frames, and the page finds the events.
  await waitForText(page, '#counts', /[1-9]\d* began/);
  simulation.write('pairs\n');
  const {pairs} = JSON.parse(await simulation.line());
  await waitForData(page, 'pairs', pairs.length);
  await page.waitForTimeout(1300);
  assert.equal(await data(page, 'pairs'), String(pairs.length));
  await page.keyboard.press('l');
  await page.waitForFunction(count => Number(document.documentElement.dataset.lines) >= count, pairs.length);
  const ended = await page.evaluate(() => window.octopairView.frame().ended);
  assert.equal(await data(page, 'lines'), String(pairs.length + ended));
  return pairs;
}

test('a live scene of Python', async () => {
  const simulation = python('live');
  const {address} = JSON.parse(await simulation.line());
  await withPage(address, async page => {
    const pairs = await checkLive(page, simulation);
    const sorted = pairs.map(pair => [...pair].sort((a, b) => a - b)).sort((p, q) => p[0] - q[0] || p[1] - q[1]);
    await expectTable(page, sorted.slice(0, 100));
    simulation.write('go\n');
    const frozen = await data(page, 'frame');
    await page.waitForFunction(old => document.documentElement.dataset.frame !== old, frozen);
    await page.click('#play');
    await page.waitForTimeout(300);
    const paused = await data(page, 'frame');
    await page.waitForTimeout(400);
    assert.equal(await data(page, 'frame'), paused);
    await page.click('#play');
    await page.waitForFunction(old => Number(document.documentElement.dataset.frame) > Number(old), paused);
  });
  // A page that dies does not disturb the simulation.
  const killed = await open(browser, address);
  await ready(killed.page);
  const session = await killed.page.context().newCDPSession(killed.page);
  session.send('Page.crash').catch(() => undefined);
  await new Promise(done => setTimeout(done, 300));
  await Promise.race([killed.close(), new Promise(done => setTimeout(done, 1000))]);  // a dead page does not answer
  const steps = async () => {
    simulation.write('steps\n');
    return JSON.parse(await simulation.line()).steps;
  };
  const before = await steps();
  await withPage(address, async page => {
    const first = await data(page, 'frame');
    await page.waitForFunction(old => Number(document.documentElement.dataset.frame) > Number(old), first);
    assert.ok(await steps() > before);
    simulation.write('stop\n');
    assert.equal(await simulation.ended, 0);
    await waitForText(page, '#notices', /ended|lost/);
    assert.equal(await data(page, 'drawn'), '200');
  }, {expected: /WebSocket|Failed to load/});
});

test('a server: jobs, scenes and the page of a scene', async () => {
  const address = `unix:${inputs.path('s.socket')}`;
  const server = await serve('s.socket', '--state', inputs.path('state'));
  const simulation = python('remote', address);
  await simulation.line();
  const program = keep(await view(options.program, [address]));
  await withPage(program.address, async page => {
    await waitForData(page, 'scenes', '1');
    assert.match(await text(page, '#scene-rows'), /200/);
    const job = python('job', address);
    await job.line();
    await waitForText(page, '#job-rows', /done[^]*1,000/);
    job.write('release\n');
    await job.ended;
    await waitForData(page, 'jobs', '0');
    await page.click('#scene-rows a');
    await complete(page);
    await checkLive(page, simulation);
  }, {wait: ready, expected: /WebSocket/});
  simulation.write('stop\n');
  await simulation.ended;
  await program.stop();
  await server.stop();
});

test('a server that ends and starts again', async () => {
  const address = `unix:${inputs.path('again.socket')}`;
  let server = await serve('again.socket');
  const simulation = python('remote', address);
  await simulation.line();
  const program = keep(await view(options.program, [address]));
  const check = async page => {
    await waitForData(page, 'scenes', '1');
    const scene = await open(browser, new URL(await page.locator('#scene-rows a').getAttribute('href'), program.address).href);
    await complete(scene.page);
    await server.stop('SIGKILL');
    await simulation.stop('SIGKILL');
    await waitForText(page, '#banner', /no server answers/);
    await waitForText(scene.page, '#banner', /no server answers/);
    server = await serve('again.socket');
    await page.locator('#banner').waitFor({state: 'hidden'});
    await waitForData(page, 'scenes', '0');
    await waitForText(scene.page, '#notices', /simulation has ended/);
    assert.ok(await scene.page.locator('#banner').isHidden());
    await scene.close();
  };
  await withPage(program.address, check, {wait: ready});
  await program.stop();
  await server.stop();
});

test('a server that stops for a while, with a scene at rest', async () => {
  const address = `unix:${inputs.path('rest.socket')}`;
  const server = await serve('rest.socket');
  const simulation = python('remote', address);
  await simulation.line();
  simulation.write('pairs\n');
  await simulation.line();
  const program = keep(await view(options.program, [address]));
  await withPage(program.address, async page => {
    await waitForData(page, 'scenes', '1');
    const scene = await open(browser, new URL(await page.locator('#scene-rows a').getAttribute('href'), program.address).href);
    await complete(scene.page);
    server.process.kill('SIGSTOP');
    await waitForText(page, '#banner', /not answered/);
    await waitForText(scene.page, '#banner', /not answered/);
    server.process.kill('SIGCONT');
    for (const each of [page, scene.page]) await each.locator('#banner').waitFor({state: 'hidden'});
    simulation.write('stop\n');
    await waitForText(scene.page, '#notices', /simulation has ended/);
    await scene.close();
  }, {wait: ready});
  await program.stop();
  await server.stop();
});

test('the program ends, and the page keeps its picture', () => withView([inputs.get('three.npy')], async (page, program) => {
  await program.stop();
  await waitForText(page, '#notices', /The program has ended/);
  assert.equal(await data(page, 'drawn'), '3');
  await colourAt(page, topOf(threeBoxes[0]), light.free);
  await page.evaluate(() => window.octopairView.select(1));
  await waitForText(page, '#selection h3', /^1 partner$/);
}, {expected: /Failed to load|WebSocket/}));

await runAll();
