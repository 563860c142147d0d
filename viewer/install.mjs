// Makes the libraries of the page, or of octopair-ifc, available: node install.mjs FOLDER [WORK [SOURCES]]
//
// FOLDER  has one folder of installed libraries for each package-lock.json, named by the hash of that file. The libraries are
//         installed with npm if they are missing. Several processes may do this at the same time.
// WORK    gets a link node_modules to the libraries.
// SOURCES has the package-lock.json; without it, it is the page's.
import {spawnSync} from 'node:child_process';
import {createHash} from 'node:crypto';
import {copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, renameSync, rmSync, symlinkSync} from 'node:fs';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

const [folder, work, sources = dirname(fileURLToPath(import.meta.url))] = process.argv.slice(2);
const files = ['package.json', 'package-lock.json'];

function fail(message) {
  console.error(`viewer/install.mjs: ${message}`);
  process.exit(1);
}

// esbuild has a program for each platform, so its folder serves one platform.
function folderName() {
  const hash = createHash('sha256').update(`${process.platform}-${process.arch}\n`);
  for (const name of files) hash.update(readFileSync(join(sources, name)));
  return hash.digest('hex').slice(0, 16);
}

// Installs into a new folder and renames it at the end, so that an installed folder is always complete.
function install(folder, installed) {
  mkdirSync(folder, {recursive: true});
  const part = mkdtempSync(join(folder, 'part-'));
  for (const name of files) copyFileSync(join(sources, name), join(part, name));
  const command = ['ci', '--ignore-scripts', '--prefer-offline', '--no-audit', '--no-fund', '--no-update-notifier', '--loglevel=error'];
  const {status, error} = spawnSync(process.env.OCTOPAIR_NPM || 'npm', command, {cwd: part, stdio: ['ignore', 'ignore', 'inherit']});
  if (!error && status === 0 && !existsSync(installed)) {
    try {
      renameSync(part, installed);
    } catch (failure) {
      if (!existsSync(installed)) throw failure;  // otherwise another process was faster
    }
  }
  rmSync(part, {recursive: true, force: true});
  if (error) fail(`cannot run npm: ${error.message}`);
  if (status !== 0) fail('npm ci failed; it needs its registry once: "scripts/setup viewer_tests ifc" installs the libraries');
}

if (!folder) fail('usage: node install.mjs FOLDER [WORK [SOURCES]]');
if (Number(process.versions.node.split('.')[0]) < 18) fail(`node has version ${process.versions.node}, and the page needs 18 or newer`);
const installed = join(resolve(folder), folderName());
if (!existsSync(installed)) install(resolve(folder), installed);
if (work) {
  const link = join(resolve(work), 'node_modules');
  rmSync(link, {recursive: true, force: true});
  symlinkSync(join(installed, 'node_modules'), link);
}
