// Measures `octopair view` until the first picture of a page, in Chromium without a graphics card:
//     node first_picture.mjs PROGRAM [--quick] --json FILE
// For uniform boxes: milliseconds from the start of the program, megabytes that the page receives, megabytes of the tab; medians.
import {mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {parseArgs} from 'node:util';
import {firstPicture} from '../../tests/viewer/browser/first_picture.mjs';
import {run} from '../../tests/viewer/browser/program.mjs';
import {launch} from '../../tests/viewer/page/browser.mjs';

const {values, positionals: [program]} = parseArgs({allowPositionals: true, options: {quick: {type: 'boolean'}, json: {type: 'string'}}});
const median = numbers => numbers.sort((a, b) => a - b)[numbers.length >> 1];
const folder = mkdtempSync(join(tmpdir(), 'octopair-first-picture-'));
const browser = await launch();
const rows = [];
try {
  for (const boxes of values.quick ? [1000] : [100_000, 1_000_000]) {
    const path = join(folder, `${boxes}.npy`);
    run(program, ['generate', 'uniform', '--objects', String(boxes), '--seed', '1', '--output', path, '--quiet']);
    const rounds = [];
    for (let round = 0; round < (values.quick ? 1 : 5); ++round) {
      const {program: child, close, measured} = await firstPicture(browser, program, path);
      rounds.push(measured);
      await close();
      await child.stop();
    }
    const row = {boxes};
    for (const name of Object.keys(rounds[0])) row[name] = median(rounds.map(round => round[name]));
    rows.push(row);
  }
} finally {
  await browser.close();
  rmSync(folder, {recursive: true});
}
writeFileSync(values.json, JSON.stringify({rows}));
