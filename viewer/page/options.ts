// The view settings as a lil-gui panel, with names that screen readers can read.
import GUI, {type Controller} from 'lil-gui';
import {byId} from './dom.ts';
import type {SceneModel} from './scene_model.ts';
import {choices, type Name, type Settings, type Values} from './settings.ts';

export class Options {
  private readonly gui: GUI;
  private readonly controllers = new Map<Name, Controller>();
  private level: Controller | null = null;

  constructor(private readonly settings: Settings, model: SceneModel) {
    const {has, kind} = model.view;
    this.gui = new GUI({container: byId('options'), title: 'View', width: 236});
    this.choice('colour', 'Colour by', choices.colour.filter(name => (name !== 'group' || has.groups) && (name !== 'level' || kind !== 'live')));
    if (has.shapes) this.choice('style', 'Draw', choices.style);
    this.choice('show', 'Show', choices.show);
    this.toggle('ghosts', 'Ghost others');
    this.number('others', 'Opacity', 0.1, 1, 0.05);
    this.toggle('edges', 'Edges');
    this.choice('lines', 'Pair lines', choices.lines);
    if (has.contacts) this.choice('contacts', 'Contacts', choices.contacts);
    this.toggle('octants', 'Octants');
    this.number('level', 'Level, −1 leaves', -1, 21, 1);
    this.level = this.controllers.get('level')!;
    this.choice('section', 'Section', choices.section);
    this.number('cut', 'Section at', 0, 1, 0.005);
    this.toggle('flip', 'Other side');
    this.choice('up', 'Up', choices.up);
    this.choice('camera', 'Camera', choices.camera);
    this.choice('theme', 'Theme', choices.theme);
    settings.listen(name => this.refresh(name));
    for (const name of this.controllers.keys()) this.refresh(name);
    this.nameInputs();
  }

  // The deepest level that has octants.
  setLevels(count: number): void {
    this.level?.max(Math.max(count - 1, 0));
    this.nameInputs();
  }

  private choice<K extends Name & keyof typeof choices>(name: K, label: string, values: readonly string[]): void {
    this.watch(name, this.gui.add(this.settings.values, name, [...values]), label);
  }

  private toggle(name: Name, label: string): void {
    this.watch(name, this.gui.add(this.settings.values, name), label);
  }

  private number(name: 'others' | 'level' | 'cut', label: string, low: number, high: number, step: number): void {
    this.watch(name, this.gui.add(this.settings.values, name, low, high, step), label);
  }

  private watch(name: Name, controller: Controller, label: string): void {
    controller.name(label).onChange(() => this.settings.changed(name));
    this.controllers.set(name, controller);
  }

  private refresh(name: Name): void {
    const values: Values = this.settings.values;
    this.controllers.get(name)?.updateDisplay();
    this.controllers.get('level')?.show(values.octants);
    for (const part of ['cut', 'flip'] as const) this.controllers.get(part)?.show(values.section !== 'none');
  }

  // lil-gui connects only some of its inputs with their labels.
  private nameInputs(): void {
    for (const [name, controller] of this.controllers) {
      const label = controller.domElement.querySelector('.lil-name, .name')?.textContent ?? name;
      for (const input of controller.domElement.querySelectorAll('input, select')) {
        input.removeAttribute('aria-labelledby');
        input.setAttribute('aria-label', label);
      }
    }
  }
}
