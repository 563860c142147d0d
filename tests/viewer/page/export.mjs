// Makes an exported page from the answers of a mock scene.
import {readFileSync, writeFileSync} from 'node:fs';
import {gzipSync} from 'node:zlib';

function element(address, answer) {
  const bytes = Buffer.isBuffer(answer) ? answer : Buffer.from(JSON.stringify(answer));
  return `<script type="application/octet-stream" data-address="${address}">${gzipSync(bytes).toString('base64')}</script>\n`;
}

function addresses(view) {
  const list = ['timeline.json', 'groups.u32', 'names.json', 'details.json', 'geometry.u32', 'shapes.json', 'shape/0', 'shape/1', 'shape/2'];
  for (let f = 0; f < view.frames; ++f) {
    list.push(`frame/${f}.json`, `frame/${f}.f32`, `poses/${f}.f32`, `partners/${f}.u32`, `classes/${f}.u8`, `levels/${f}.u8`, `pairs/${f}.u32`,
      `began/${f}.u32`,      `ended/${f}.u32`, `octants/${f}.json`, `collisions/${f}.json`);
    for (let level = 0; level < 4; ++level) list.push(`octants/${f}/${level}.bin`);
  }
  return list.filter(address => view.has.shapes || !/^(geometry|shape|poses)/.test(address));
}

export function exportPage(scene, page, output) {
  const view = scene.view();
  view.has = {...view.has, search: false, near: false};
  const worst = new URLSearchParams({sort: 'worst'});
  const elements = addresses(view).map(address => [address, scene.answer(address, worst)]).filter(([, answer]) => answer !== null)
    .map(([address, answer]) => element(address, answer));
  const marker = '<!-- data -->';
  const [before, after] = readFileSync(page, 'utf8').split(marker);
  writeFileSync(output, before + element('view.json', view) + elements.join('') + marker + after);
}
