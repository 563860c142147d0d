// Colours of boxes by state, group, level or number of pairs, in the light and the dark theme, and the entries of their legend.
import type {SceneModel} from './scene_model.ts';
import {State} from './states.ts';
import type {Values} from './settings.ts';

export type Colour = readonly [number, number, number];

export interface Palette {
  background: Colour;
  states: Record<number, Colour>;
  edge: Colour;
  octant: Colour;
  contact: Colour;
}

export interface LegendEntry {
  text: string;
  colour: Colour;
}

const light: Palette = {
  background: [243, 245, 247],
  states: {
    [State.free]: [176, 188, 200], [State.colliding]: [222, 88, 50], [State.began]: [240, 176, 40], [State.ended]: [42, 157, 143],
    [State.partner]: [148, 96, 214], [State.selected]: [28, 110, 235],
  },
  edge: [40, 50, 60], octant: [70, 90, 120], contact: [190, 20, 90],
};

const dark: Palette = {
  background: [19, 23, 29],
  states: {
    [State.free]: [104, 118, 133], [State.colliding]: [238, 104, 64], [State.began]: [246, 190, 70], [State.ended]: [60, 184, 168],
    [State.partner]: [172, 128, 240], [State.selected]: [78, 150, 255],
  },
  edge: [10, 12, 16], octant: [150, 170, 200], contact: [255, 110, 170],
};

const groupColours: Colour[] = [
  [78, 121, 167], [242, 142, 43], [89, 161, 79], [225, 87, 89], [118, 183, 178], [237, 201, 72], [176, 122, 161], [255, 157, 167],
  [156, 117, 95], [150, 150, 150],
];

const ramp: Colour[] = [[68, 60, 140], [52, 104, 150], [38, 145, 145], [60, 180, 110], [160, 205, 60], [245, 215, 60]];

export function paletteOf(isDark: boolean): Palette {
  return isDark ? dark : light;
}

// A colour of the ramp for a part from 0 to 1.
export function rampColour(part: number): Colour {
  const at = Math.min(Math.max(part, 0), 1) * (ramp.length - 1);
  const low = Math.min(Math.floor(at), ramp.length - 2);
  const mix = (k: 0 | 1 | 2): number => Math.round(ramp[low]![k] + (ramp[low + 1]![k] - ramp[low]![k]) * (at - low));
  return [mix(0), mix(1), mix(2)];
}

// A part from 0 to 1 for a number of pairs: a logarithm, since few objects have very many.
function pairsPart(count: number, most: number): number {
  return most <= 1 ? 0 : Math.log(count) / Math.log(most);
}

function groupColour(groups: number): Colour {
  const bit = 31 - Math.clz32(groups & -groups);
  return groupColours[(groups === 0 ? 9 : bit) % groupColours.length]!;
}

function largest(values: ArrayLike<number>): number {
  let most = 0;
  for (let k = 0; k < values.length; ++k) if (values[k]! > most) most = values[k]!;
  return most;
}

// The function from a row to its colour.
function chooser(model: SceneModel, states: Uint8Array, values: Values, palette: Palette): (row: number) => Colour {
  const byState = (row: number): Colour => palette.states[states[row]!] ?? palette.states[State.free]!;
  const marked = (other: (row: number) => Colour) => (row: number): Colour => states[row]! >= State.partner ? byState(row) : other(row);
  const {levels, partners} = model.frame;
  if (values.colour === 'group' && model.groups) return marked(row => groupColour(model.groups![row]!));
  if (values.colour === 'level' && levels) {
    const most = Math.max(largest(levels), 1);
    return marked(row => rampColour(levels[row]! / most));
  }
  if (values.colour === 'pairs') {
    const most = largest(partners);
    return marked(row => partners[row] ? rampColour(pairsPart(partners[row]!, most)) : palette.states[State.free]!);
  }
  return byState;
}

// Writes RGBA of all rows. The last byte is the opacity: 0 hides a row.
export function paint(model: SceneModel, states: Uint8Array, values: Values, palette: Palette, out: Uint8Array): void {
  const colourOf = chooser(model, states, values, palette);
  const others = Math.round(255 * values.others);
  for (let row = 0; row < model.rows; ++row) {
    const colour = colourOf(row);
    out[4 * row] = colour[0];
    out[4 * row + 1] = colour[1];
    out[4 * row + 2] = colour[2];
    out[4 * row + 3] = opacity(states[row]!, values.show, others);
  }
}

function opacity(state: number, show: string, others: number): number {
  if (state === State.absent) return 0;
  if (state >= State.partner) return 255;
  if (show === 'selection' || (show === 'colliding' && state === State.free)) return 0;
  return state === State.free ? others : 255;
}

export function legend(model: SceneModel, values: Values, palette: Palette, selected: boolean): LegendEntry[] {
  const of = (text: string, state: number): LegendEntry => ({text, colour: palette.states[state]!});
  const marks = selected ? [of('selected', State.selected), of('partner of selected', State.partner)] : [];
  const {levels, partners} = model.frame;
  if (values.colour === 'group' && model.groups) {
    const kinds = [...new Set(model.groups.subarray(0, 20000))].sort((a, b) => a - b).slice(0, 8);
    return [...kinds.map(kind => ({text: `groups ${kind}`, colour: groupColour(kind)})), ...marks];
  }
  if (values.colour === 'level' && levels) {
    const most = Math.max(largest(levels), 1);
    const steps = [...new Set([0, 0.25, 0.5, 0.75, 1].map(part => Math.round(part * most)))];
    return [...steps.map(level => ({text: `level ${level}`, colour: rampColour(level / most)})), ...marks];
  }
  if (values.colour === 'pairs') {
    const most = largest(partners);
    const steps = [...new Set([1, Math.round(Math.sqrt(most)), most])].filter(count => count > 0);
    return [of('no pairs', State.free), ...steps.map(count => ({text: count === 1 ? '1 pair' : `${count} pairs`,
      colour: rampColour(pairsPart(count, most))})), ...marks];
  }
  const events = model.view.has.events || model.view.kind === 'live' ? [of('began', State.began), of('ended', State.ended)] : [];
  return [of('not colliding', State.free), of('colliding', State.colliding), ...events, ...marks];
}

export function css(colour: Colour): string {
  return `rgb(${colour[0]}, ${colour[1]}, ${colour[2]})`;
}
