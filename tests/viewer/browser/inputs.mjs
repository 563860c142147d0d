// Makes the inputs of the tests in a folder: scenes of the generator, and small files that are written here.
import {existsSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {npyOfBoxes, run} from './program.mjs';

export const hostileName = '<img src=x onerror=alert(1)>';

const shapes = {
  ball: {type: 'sphere', radius: 0.6}, block: {type: 'box', half_extents: [0.5, 0.4, 0.6]}, pill: {type: 'capsule', radius: 0.35, length: 0.8},
  drum: {type: 'cylinder', radius: 0.5, length: 1}, hat: {type: 'cone', radius: 0.6, length: 1.2}, egg: {type: 'ellipsoid', radii: [0.7, 0.45, 0.5]},
  gem: {type: 'convex_hull', points: [[-0.6, 0, 0], [0.6, 0, 0], [0, -0.6, 0], [0, 0.6, 0], [0, 0, -0.7], [0, 0, 0.7]]},
  wedge: {
    type: 'mesh', vertices: [[-0.5, -0.5, -0.5], [0.5, -0.5, -0.5], [0.5, 0.5, -0.5], [-0.5, 0.5, -0.5], [-0.5, -0.5, 0.5], [-0.5, 0.5, 0.5]],
    triangles: [[0, 2, 1], [0, 3, 2], [0, 1, 4], [2, 3, 5], [0, 4, 3], [3, 4, 5], [1, 2, 5], [1, 5, 4]],
  },
};

// Every kind of shape: eight in a row, where neighbours overlap in the second half, above a plane that nothing else meets.
export function shapesScene() {
  const kinds = Object.keys(shapes);
  const objects = kinds.map((shape, k) => ({name: `${shape} ${k}`, shape, position: [k < 4 ? 2 * k : 6.9 + 0.9 * (k - 3), 0, 1.5]}));
  objects[1].name = hostileName;
  objects.push({name: 'floor', shape: {type: 'plane', normal: [0, 0, 1], offset: 0}});
  return {shapes, objects};
}

// A box alone at the front, and two that overlap behind it.
export const threeBoxes = [[0, -3, 0, 1, -2, 1], [-1, 1, 0, 0.2, 2, 1], [0, 1.2, 0, 1.2, 2.2, 1]];

const plain = {
  'three.npy': () => npyOfBoxes(threeBoxes),
  'none.npy': () => npyOfBoxes([]),
  'one.npy': () => npyOfBoxes([[0, 0, 0, 1, 2, 3]]),
  'same.npy': () => npyOfBoxes(Array.from({length: 40}, () => [1, 1, 1, 2, 2, 2])),
  // 244,650 pairs.
  'many.npy': () => npyOfBoxes(Array.from({length: 700}, () => [1, 1, 1, 2, 2, 2])),
  'far.npy': () => npyOfBoxes(threeBoxes.map(box => box.map((value, k) => value + [1e7, -1e7, 1e7][k % 3]))),
  'nan.npy': () => npyOfBoxes([[0, 0, 0, 1, 1, 1], [0, NaN, 0, 1, 1, 1]]),
  'shapes.json': () => JSON.stringify(shapesScene()),
};

const generated = {
  '10.npy': ['uniform', '10', '--seed', '3'], '10k.npy': ['uniform', '10000'], '100k.npy': ['uniform', '100000'], '1m.npy': ['uniform', '1000000'],
  'moving.npy': ['brownian', '300', '--frames', '25'],
};

export class Inputs {
  constructor(folder, program) {
    this.folder = folder;
    this.program = program;
  }

  path(name) {
    return join(this.folder, name);
  }

  // Returns the path of an input, which is made at its first use.
  get(name) {
    const path = this.path(name);
    if (existsSync(path)) return path;
    if (plain[name]) writeFileSync(path, plain[name]());
    else {
      const [kind, objects, ...more] = generated[name];
      run(this.program, ['generate', kind, '--objects', objects, ...more, '--output', path, '--quiet']);
    }
    return path;
  }

  // Runs `octopair detect` and returns the path of its result.
  detect(input, ending, ...more) {
    const output = this.path(`${input}.${more.join('_').replace(/\W/g, '')}${ending}`);
    if (!existsSync(output)) run(this.program, ['detect', this.get(input), ...more, '--output', output, '--quiet']);
    return output;
  }
}
