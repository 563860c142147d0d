// The settings of the view: their values, their choices, and who is told of a change.

export interface Values {
  theme: 'system' | 'light' | 'dark';
  colour: 'state' | 'group' | 'level' | 'pairs';
  style: 'boxes' | 'shapes' | 'both';
  show: 'all' | 'colliding' | 'selection';
  others: number;
  edges: boolean;
  octants: boolean;
  level: number;
  lines: 'none' | 'selection' | 'all';
  contacts: 'none' | 'selection' | 'all';
  section: 'none' | 'x' | 'y' | 'z';
  cut: number;
  flip: boolean;
  up: 'y' | 'z';
  camera: 'orbit' | 'fly';
}

export const defaults: Values = {
  theme: 'system', colour: 'state', style: 'boxes', show: 'all', others: 1, edges: true, octants: false, level: -1, lines: 'selection',
  contacts: 'selection', section: 'none', cut: 0.5, flip: false, up: 'z', camera: 'orbit',
};

export const choices = {
  theme: ['system', 'light', 'dark'],
  colour: ['state', 'group', 'level', 'pairs'],
  style: ['boxes', 'shapes', 'both'],
  show: ['all', 'colliding', 'selection'],
  lines: ['none', 'selection', 'all'],
  contacts: ['none', 'selection', 'all'],
  section: ['none', 'x', 'y', 'z'],
  up: ['y', 'z'],
  camera: ['orbit', 'fly'],
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

  // Sets a value from the text of a link; a text that is no valid value is ignored.
  read(name: Name, text: string): void {
    const known = (choices as Record<string, readonly string[] | undefined>)[name];
    const old = this.values[name];
    if (known ? known.includes(text) : false) this.set(name, text as never);
    else if (typeof old === 'boolean') this.set(name, (text === '1') as never);
    else if (typeof old === 'number' && text !== '' && Number.isFinite(Number(text))) this.set(name, Number(text) as never);
  }
}
