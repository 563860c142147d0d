// The settings of the view: their values, their choices, and who is told of a change.

export interface Values {
  theme: 'system' | 'light' | 'dark';
  colour: 'state' | 'group' | 'level' | 'pairs';
  style: 'boxes' | 'shapes' | 'both';
  show: 'all' | 'colliding' | 'selection';
  others: number;
  ghosts: boolean;
  edges: boolean;
  octants: boolean;
  level: number;
  lines: 'none' | 'selection' | 'all';
  contacts: 'none' | 'selection' | 'all';
  section: 'none' | 'contact' | 'x' | 'y' | 'z';
  cut: number;
  flip: boolean;
  up: 'y' | 'z';
  camera: 'orbit' | 'fly';
}

export const defaults: Values = {
  theme: 'system', colour: 'state', style: 'boxes', show: 'all', others: 1, ghosts: true, edges: true, octants: false, level: -1, lines: 'selection',
  contacts: 'selection', section: 'none', cut: 0.5, flip: false, up: 'z', camera: 'orbit',
};

export const choices = {
  theme: ['system', 'light', 'dark'],
  colour: ['state', 'group', 'level', 'pairs'],
  style: ['boxes', 'shapes', 'both'],
  show: ['all', 'colliding', 'selection'],
  lines: ['none', 'selection', 'all'],
  contacts: ['none', 'selection', 'all'],
  section: ['none', 'contact', 'x', 'y', 'z'],
  up: ['y', 'z'],
  camera: ['orbit', 'fly'],
} as const;

export const ranges = {
  others: {low: 0, high: 1, whole: false},
  cut: {low: 0, high: 1, whole: false},
  level: {low: -1, high: 21, whole: true},
} as const;

export type Name = keyof Values;

export class Settings {
  readonly values: Values = {...defaults};
  // The values that a link need not hold: the defaults, adapted to the scene.
  readonly start: Values = {...defaults};
  private readonly listeners: ((name: Name) => void)[] = [];

  listen(listener: (name: Name) => void): void {
    this.listeners.push(listener);
  }

  set<K extends Name>(name: K, value: Values[K]): void {
    if (this.values[name] === value) return;
    this.values[name] = value;
    this.changed(name);
  }

  changed(name: Name): void {
    for (const listener of this.listeners) listener(name);
  }

  // Sets the value that this scene begins with.
  begin<K extends Name>(name: K, value: Values[K]): void {
    this.start[name] = value;
    this.values[name] = value;
  }

  next(name: keyof typeof choices, allowed: readonly string[] = choices[name]): void {
    const at = allowed.indexOf(this.values[name]);
    this.set(name, allowed[(at + 1) % allowed.length] as never);
  }

  // Sets a value from the text of a link. Ignores other texts, and numbers outside of their range.
  read(name: Name, text: string): void {
    const known = (choices as Record<string, readonly string[] | undefined>)[name];
    const old = this.values[name];
    if (known ? known.includes(text) : false) this.set(name, text as never);
    else if (typeof old === 'boolean' && (text === '1' || text === '0')) this.set(name, (text === '1') as never);
    else if (name === 'others' || name === 'cut' || name === 'level') this.readNumber(name, text);
  }

  private readNumber(name: keyof typeof ranges, text: string): void {
    const {low, high, whole} = ranges[name];
    const value = Number(text);
    if (text.trim() !== '' && value >= low && value <= high && (!whole || Number.isInteger(value))) this.set(name, value);
  }
}
