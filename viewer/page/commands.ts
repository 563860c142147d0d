// All commands of the keyboard.
import type {App} from './app.ts';
import {byId} from './dom.ts';
import type {Command} from './keyboard.ts';
import {switchTheme, toggleOpen} from './layout.ts';
import {say} from './panel.ts';
import {choices, type Name, type Settings} from './settings.ts';

export function openHelp(): void {
  const dialog = byId<HTMLDialogElement>('help');
  if (dialog.open) dialog.close();
  else dialog.showModal();
}

function toggle(settings: Settings, name: 'edges' | 'octants' | 'flip'): void {
  settings.set(name, !settings.values[name]);
}

function changeLevel(app: App, by: number): void {
  const {settings} = app;
  if (!settings.values.octants) settings.set('octants', true);
  else settings.set('level', Math.min(Math.max(settings.values.level + by, -1), Math.max(app.deepest(), 0)));
}

function changeCut(settings: Settings, by: number): void {
  if (settings.values.section === 'none') settings.set('section', 'x');
  settings.set('cut', Math.min(Math.max(settings.values.cut + by, 0), 1));
}

function cycle(app: App, name: Name & keyof typeof choices, keep: readonly string[]): void {
  app.settings.next(name, keep);
  say(`${name}: ${app.settings.values[name]}`);
}

function moveCommands(app: App): Command[] {
  const {camera} = app.stage;
  const step = 0.06;
  const moves: Record<string, readonly [number, number, number]> = {
    w: [0, 0, step], s: [0, 0, -step], a: [-step, 0, 0], d: [step, 0, 0], e: [0, step, 0], q: [0, -step, 0],
  };
  const turns: Record<string, readonly [number, number]> = {
    ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.08], ArrowDown: [0, -0.08],
  };
  const looks: Record<string, readonly [number, number]> = {1: [0, 0], 2: [Math.PI / 2, 0], 3: [-Math.PI / 2, Math.PI / 2], 4: [-0.9, 0.5]};
  const moved = (action: () => void) => (): void => {
    action();
    app.stage.moved();
  };
  return [
    {keys: Object.keys(moves), text: 'Move forward, back, left, right, up, down', run: key => moved(() => camera.move(...moves[key]!))()},
    {keys: Object.keys(turns), text: 'Turn', run: key => moved(() => camera.rotate(...turns[key]!))()},
    {keys: ['+', '='], text: 'Zoom in', run: moved(() => camera.zoom(0.8))},
    {keys: ['-'], text: 'Zoom out', run: moved(() => camera.zoom(1.25))},
    {keys: Object.keys(looks), text: 'Look along an axis, or from a corner', run: key => moved(() => camera.look(...looks[key]!))()},
    {keys: ['h'], text: 'Zoom to all', run: () => app.zoomAll()},
    {keys: ['f'], text: 'Zoom to the contact, or to the selected object', run: () => app.zoomToSelection()},
  ];
}

function selectCommands(app: App): Command[] {
  return [
    {keys: ['/'], text: 'Search', run: () => app.search.focus()},
    {keys: ['n'], text: 'Next collision in the table, the worst first', run: () => app.table.step(1)},
    {keys: ['p'], text: 'Collision before', run: () => app.table.step(-1)},
    {keys: ['j'], text: 'Only the selected objects, or all', run: () => app.toggleOnlySelection()},
    {keys: ['Escape'], text: 'Clear the selection: all objects in their colours', run: () => void app.clearSelection()},
  ];
}

function viewCommands(app: App): Command[] {
  const {settings} = app;
  const {has, kind} = app.model.view;
  const colours = choices.colour.filter(name => (name !== 'group' || has.groups) && (name !== 'level' || kind !== 'live'));
  const styles = has.shapes ? choices.style : ['boxes'];
  return [
    {keys: ['c'], text: 'Colour by state, group, level or pairs', run: () => cycle(app, 'colour', colours)},
    {keys: ['b'], text: 'Draw boxes, shapes or both', run: () => cycle(app, 'style', styles)},
    {keys: ['v'], text: 'Show all, colliding or selected objects', run: () => cycle(app, 'show', choices.show)},
    {keys: ['g'], text: 'Edges of boxes', run: () => toggle(settings, 'edges')},
    {keys: ['l'], text: 'Lines of pairs', run: () => cycle(app, 'lines', choices.lines)},
    {keys: ['k'], text: 'Contacts', run: () => cycle(app, 'contacts', choices.contacts)},
    {keys: ['o'], text: 'Octants', run: () => toggle(settings, 'octants')},
    {keys: ['[', ']'], text: 'Level of the octants', run: key => changeLevel(app, key === ']' ? 1 : -1)},
    {keys: ['x'], text: 'Section through the contact, or across an axis', run: () =>
      cycle(app, 'section', choices.section.filter(name => name !== 'contact' || app.hasContact()))},
    {keys: ['PageUp', 'PageDown'], text: 'Move the section', run: key => changeCut(settings, key === 'PageUp' ? 0.02 : -0.02)},
    {keys: ['r'], text: 'Other side of the section', run: () => toggle(settings, 'flip')},
    {keys: ['u'], text: 'Axis that is up', run: () => cycle(app, 'up', choices.up)},
    {keys: ['i'], text: 'Orbit or fly', run: () => cycle(app, 'camera', choices.camera)},
  ];
}

function pageCommands(app: App): Command[] {
  return [
    {keys: [' '], text: 'Play or pause', run: () => app.timeline?.toggle()},
    {keys: [',', '.'], text: 'Frame before, next frame', run: key => app.timeline?.step(key === '.' ? 1 : -1)},
    {keys: ['z'], text: 'Panel of objects', run: () => toggleOpen('side')},
    {keys: ['m'], text: 'Panel of view settings', run: () => toggleOpen('options')},
    {keys: ['t'], text: 'Light or dark', run: () => switchTheme(app.settings)},
    {keys: ['y'], text: 'Copy a link to this view', run: () => void app.copyLink()},
    {keys: ['?'], text: 'This help', run: openHelp},
  ];
}

export function commands(app: App): Command[] {
  return [...moveCommands(app), ...selectCommands(app), ...viewCommands(app), ...pageCommands(app)];
}
