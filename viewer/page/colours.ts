// Colours of boxes by state, group, level or number of pairs, in the light and the dark theme, and the entries of their legend.
import {classWords} from './collision.ts';
import {counted} from './dom.ts';
import {glassOpacity, ghostOpacity} from './draw_pass.ts';
import type {SceneModel} from './scene_model.ts';
import {State} from './states.ts';
import type {Values} from './settings.ts';

export type Colour = readonly [number, number, number];

export interface Palette {
  background: Colour;
  states: Record<number, Colour>;
  // The objects that are not selected, while others are.
  ghost: Colour;
  edge: Colour;
  octant: Colour;
  // The contacts of objects that overlap, and those of others, such as objects that touch.
  contact: Colour;
  calmContact: Colour;
}

export interface LegendEntry {
  text: string;
  colour: Colour;
  // A sign in place of a patch of the colour.
  mark?: string;
}

const light: Palette = {
  background: [243, 245, 247],
  states: {
    [State.free]: [176, 188, 200], [State.clearance]: [164, 190, 176], [State.touching]: [118, 156, 196], [State.colliding]: [222, 88, 50],
    [State.began]: [240, 176, 40], [State.ended]: [42, 157, 143], [State.partner]: [148, 96, 214], [State.selected]: [28, 110, 235],
    [State.second]: [240, 140, 20],
  },
  ghost: [132, 146, 160], edge: [40, 50, 60], octant: [70, 90, 120], contact: [190, 0, 70], calmContact: [48, 72, 104],
};

const dark: Palette = {
  background: [19, 23, 29],
  states: {
    [State.free]: [104, 118, 133], [State.clearance]: [96, 128, 110], [State.touching]: [88, 126, 168], [State.colliding]: [238, 104, 64],
    [State.began]: [246, 190, 70], [State.ended]: [60, 184, 168], [State.partner]: [172, 128, 240], [State.selected]: [78, 150, 255],
    [State.second]: [250, 160, 50],
  },
  ghost: [120, 136, 152], edge: [10, 12, 16], octant: [150, 170, 200], contact: [255, 80, 150], calmContact: [170, 196, 226],
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

// How objects are shown: `ghosts` if all but the selection are ghosts, and the object that is glass, or -1.
export interface Look {
  ghosts: boolean;
  glass: number;
}

export interface Style {
  values: Values;
  palette: Palette;
  look: Look;
}

// Writes RGBA of all rows. The last byte is the opacity: 0 hides a row.
export function paint(model: SceneModel, states: Uint8Array, style: Style, out: Uint8Array): void {
  const {values, palette, look} = style;
  const colourOf = chooser(model, states, values, palette);
  const glass = look.glass < 0 ? -1 : model.rowOf(look.glass);
  for (let row = 0; row < model.rows; ++row) {
    const opacity = row === glass ? glassOpacity : opacityOf(states[row]!, values, look.ghosts);
    const colour = opacity === ghostOpacity ? palette.ghost : colourOf(row);
    out[4 * row] = colour[0];
    out[4 * row + 1] = colour[1];
    out[4 * row + 2] = colour[2];
    out[4 * row + 3] = opacity;
  }
}

export function opacityOf(state: number, {show, others}: Values, ghosts: boolean): number {
  if (state === State.absent) return 0;
  if (state >= State.partner) return 255;
  if (show === 'selection' || (show === 'colliding' && state === State.free)) return 0;
  if (ghosts) return ghostOpacity;
  return state === State.free ? Math.round(255 * others) : 255;
}

const markTexts: readonly (readonly [number, string])[] = [[State.selected, 'selected'], [State.partner, 'partner of selected']];
const stateTexts: readonly (readonly [number, string])[] = [
  [State.free, 'not colliding'], [State.clearance, 'apart, within the margin'], [State.touching, 'touching'],
  [State.colliding, 'colliding'], [State.began, 'began'], [State.ended, 'ended'],
];

// The words for what is drawn as colliding: the classes that occur, if exact tests found them.
function collidingText(model: SceneModel, states: Uint8Array): string {
  const {classes} = model.frame;
  if (!classes) return 'colliding';
  const found = new Set<number>();
  for (let row = 0; row < model.rows; ++row) if (states[row] === State.colliding) found.add(classes[row]!);
  const words = [4, 5, 6, 7].filter(code => found.has(code)).map(code => classWords[code]);
  return found.size === words.length && words.length ? words.join(', ') : 'colliding';
}

// The entries of the selection, then those of the other rows. `names`: the two objects of a selected pair.
export function legend(model: SceneModel, states: Uint8Array, style: Style, names: readonly string[] | null): LegendEntry[] {
  const {values, palette, look} = style;
  const of = (text: string, state: number): LegendEntry => ({text, colour: palette.states[state]!});
  const marks = names ? [of(names[0]!, State.selected), of(names[1]!, State.second)] :
    markTexts.filter(([state]) => states.includes(state)).map(([state, text]) => of(text, state));
  if (values.show === 'selection') return marks;
  return [...marks, ...(look.ghosts ? [{text: 'other objects', colour: palette.ghost}] : colourLegend(model, states, style))];
}

// The entries of what rows are coloured by.
function colourLegend(model: SceneModel, states: Uint8Array, {values, palette}: Style): LegendEntry[] {
  const {levels, partners} = model.frame;
  if (values.colour === 'group' && model.groups) {
    const kinds = [...new Set(model.groups.subarray(0, 20000))].sort((a, b) => a - b).slice(0, 8);
    return kinds.map(kind => ({text: `groups ${kind}`, colour: groupColour(kind)}));
  }
  if (values.colour === 'level' && levels) {
    const most = Math.max(largest(levels), 1);
    const steps = [...new Set([0, 0.25, 0.5, 0.75, 1].map(part => Math.round(part * most)))];
    return steps.map(level => ({text: `level ${level}`, colour: rampColour(level / most)}));
  }
  if (values.colour === 'pairs') {
    const most = largest(partners);
    const steps = [...new Set([1, Math.round(Math.sqrt(most)), most])].filter(count => count > 0);
    const texts = steps.map(count => ({text: counted(count, 'pair', 'pairs'), colour: rampColour(pairsPart(count, most))}));
    return [{text: 'no pairs', colour: palette.states[State.free]!}, ...texts];
  }
  return stateTexts.filter(([state]) => states.includes(state))
    .map(([state, text]) => ({text: state === State.colliding ? collidingText(model, states) : text, colour: palette.states[state]!}));
}

export function css(colour: Colour): string {
  return `rgb(${colour[0]}, ${colour[1]}, ${colour[2]})`;
}
