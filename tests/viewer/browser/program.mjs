// Runs the program for tests of its pages: commands that end, pages that are served, and scripts of Python.
import {execFileSync, spawn} from 'node:child_process';
import {once} from 'node:events';
import {readFileSync} from 'node:fs';

// Runs a command of the program to its end. Returns its standard output.
export function run(program, words) {
  return execFileSync(program, words, {encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'], maxBuffer: 1 << 28});
}

// A process whose lines of standard output are awaited one by one.
export class Child {
  errors = '';
  #lines = [];
  #waiting = [];
  #rest = '';

  constructor(command, words, options = {}) {
    this.process = spawn(command, words, {stdio: ['pipe', 'pipe', 'pipe'], ...options});
    this.ended = once(this.process, 'exit').then(([code, signal]) => {
      for (const {fail} of this.#waiting.splice(0)) fail(new Error(`${command} ended with ${code ?? signal}: ${this.errors}`));
      return code;
    });
    this.process.stdout.setEncoding('utf8').on('data', text => this.#receive(text));
    this.process.stderr.setEncoding('utf8').on('data', text => this.errors += text);
  }

  // Returns the next line. Throws if the process ends first.
  line(timeout = 60_000) {
    if (this.#lines.length) return Promise.resolve(this.#lines.shift());
    if (this.process.exitCode !== null) return Promise.reject(new Error(`ended with ${this.process.exitCode}: ${this.errors}`));
    return new Promise((done, fail) => {
      const timer = setTimeout(() => fail(new Error('no line came in time')), timeout);
      const settle = action => value => {
        clearTimeout(timer);
        action(value);
      };
      this.#waiting.push({done: settle(done), fail: settle(fail)});
    });
  }

  write(text) {
    this.process.stdin.write(text);
  }

  async stop(signal = 'SIGINT') {
    if (this.process.exitCode === null && this.process.signalCode === null) this.process.kill(signal);
    return this.ended;
  }

  #receive(text) {
    const lines = (this.#rest + text).split('\n');
    this.#rest = lines.pop();
    for (const line of lines) {
      const next = this.#waiting.shift();
      if (next) next.done(line);
      else this.#lines.push(line);
    }
  }
}

// Starts `octopair view` and waits for its address.
export async function view(program, words) {
  const child = new Child(program, ['view', ...words, '--no-browser', '--quiet']);
  const line = await child.line();
  const match = /https?:\/\/\S+/.exec(line);
  if (!match) throw new Error(`octopair view wrote no address: ${line}`);
  child.address = match[0];
  return child;
}

// Reads an array of numbers from a .npy file: its shape and its values.
export function readNpy(path) {
  const bytes = readFileSync(path);
  const length = bytes[6] === 1 ? bytes.readUInt16LE(8) : bytes.readUInt32LE(8);
  const start = (bytes[6] === 1 ? 10 : 12) + length;
  const header = bytes.toString('latin1', start - length, start);
  const kinds = {'<f4': Float32Array, '<f8': Float64Array, '<u4': Uint32Array};
  const kind = kinds[/'descr': *'([^']+)'/.exec(header)[1]];
  const shape = /'shape': *\(([^)]*)\)/.exec(header)[1].split(',').filter(text => text.trim()).map(Number);
  const copy = bytes.buffer.slice(bytes.byteOffset + start, bytes.byteOffset + bytes.length);
  return {shape, values: new kind(copy, 0, shape.reduce((product, count) => product * count, 1))};
}

// Writes boxes, rows of six numbers, as float64.
export function npyOfBoxes(boxes) {
  const head = `{'descr': '<f8', 'fortran_order': False, 'shape': (${boxes.length}, 6), }`;
  const padded = head.padEnd(128 - 10 - 1) + '\n';
  const start = Buffer.from([0x93, ...Buffer.from('NUMPY'), 1, 0, padded.length & 255, padded.length >> 8]);
  return Buffer.concat([start, Buffer.from(padded), Buffer.from(new Float64Array(boxes.flat()).buffer)]);
}
