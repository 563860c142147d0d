// Bundles the page into one HTML file: node build.mjs OUTPUT. The same sources give the same bytes.
// With --check, writes nothing, but fails if OUTPUT is not this page.
import {createHash} from 'node:crypto';
import {existsSync, readdirSync, readFileSync, writeFileSync} from 'node:fs';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {gzipSync} from 'node:zlib';
import {build, transform} from 'esbuild';

const folder = dirname(fileURLToPath(import.meta.url));
const limits = {bytes: 900_000, gzip: 300_000};

async function bundleScript() {
  const result = await build({
    entryPoints: [join(folder, 'page/main.ts')], bundle: true, minify: true, format: 'iife', target: 'es2021', charset: 'utf8',
    legalComments: 'none', write: false, absWorkingDir: folder, logLevel: 'warning',
  });
  return result.outputFiles[0].text.trimEnd();
}

async function bundleStyle() {
  const parts = ['node_modules/uplot/dist/uPlot.min.css', 'page/page.css'].map(name => readFileSync(join(folder, name), 'utf8'));
  const result = await transform(parts.join('\n'), {loader: 'css', minify: true, legalComments: 'none'});
  return result.code.trimEnd();
}

// In an exported page, the script is compressed, and this one starts it.
const loader = `(async()=>{const bytes=Uint8Array.from(atob(document.getElementById("packed").textContent),letter=>letter.charCodeAt(0)),` +
  `script=document.createElement("script");script.textContent=await new Response(new Blob([bytes]).stream().pipeThrough(` +
  `new DecompressionStream("gzip"))).text();document.body.append(script)})()`;

function policy(scripts) {
  const hashes = scripts.map(script => `'sha256-${createHash('sha256').update(script, 'utf8').digest('base64')}'`);
  return `default-src 'none'; script-src ${hashes.join(' ')}; style-src 'unsafe-inline'; connect-src 'self'; img-src data: blob:; font-src data:; ` +
    `base-uri 'none'; form-action 'none'`;
}

// The licences of the libraries in the page ask for their texts.
function licences() {
  const texts = ['three', 'lil-gui', 'uplot'].map(name => {
    const folderOf = join(folder, 'node_modules', name);
    const file = readdirSync(folderOf).find(entry => /^licen[cs]e/i.test(entry));
    return `${name} ${JSON.parse(readFileSync(join(folderOf, 'package.json'), 'utf8')).version}\n\n${readFileSync(join(folderOf, file), 'utf8').trim()}`;
  });
  return `<!--\n${texts.join('\n\n').replace(/\r/g, '').replace(/--+/g, '-')}\n-->`;
}

const script = await bundleScript();
const parts = {policy: policy([script, loader]), style: await bundleStyle(), licences: licences(), script, loader};
const template = readFileSync(join(folder, 'page/page.html'), 'utf8');
const page = template.replace(/\{\{(\w+)\}\}/g, (_, name) => parts[name]);
for (const mark of ['<!-- data -->', '<!-- loader ', '<!-- script -->']) {
  if (page.split(mark).length !== 2) throw new Error(`the page must have the mark ${mark} once`);
}
const bytes = Buffer.from(page, 'utf8');
const gzip = gzipSync(bytes, {level: 9}).length;
if (bytes.length > limits.bytes || gzip > limits.gzip) throw new Error(`the page is too large: ${bytes.length} bytes, ${gzip} with gzip`);
const [output, check] = process.argv.slice(2);
if (!output || (check && check !== '--check')) throw new Error('usage: node build.mjs OUTPUT [--check]');
if (!check) {
  writeFileSync(resolve(output), bytes);
  console.log(`${output}: ${bytes.length} bytes, ${gzip} with gzip`);
} else if (!existsSync(output) || !readFileSync(output).equals(bytes)) {
  console.error(`${output}: is not the page that the sources in viewer/ give; renew it: cmake --build build/release --target octopair_renew_page`);
  process.exit(1);
}
