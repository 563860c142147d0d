// The keys and their list in the help dialog. Keys do nothing while a text is typed.
import {byId, make} from './dom.ts';

export interface Command {
  keys: readonly string[];
  text: string;
  run(key: string): void;
}

const names: Record<string, string> = {' ': 'Space', ArrowLeft: '←', ArrowRight: '→', ArrowUp: '↑', ArrowDown: '↓', Escape: 'Esc'};

export class Keyboard {
  private readonly byKey = new Map<string, Command>();

  constructor(private readonly commands: readonly Command[]) {
    for (const command of commands) for (const key of command.keys) this.byKey.set(key, command);
    document.addEventListener('keydown', event => this.press(event));
    this.fillHelp();
  }

  private press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || isForElement(event)) return;
    const dialog = byId<HTMLDialogElement>('help');
    if (dialog.open && event.key !== '?') return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const command = this.byKey.get(key);
    if (!command) return;
    event.preventDefault();
    command.run(key);
  }

  private fillHelp(): void {
    const rows = this.commands.map(command => {
      const row = make('tr');
      const keys = make('td');
      for (const key of command.keys) keys.append(make('kbd', names[key] ?? (/^[a-z]$/.test(key) ? key.toUpperCase() : key)), ' ');
      row.append(keys, make('td', command.text));
      return row;
    });
    byId('help-rows').replaceChildren(...rows);
  }
}

// Whether the key belongs to the element that has the focus.
function isForElement(event: KeyboardEvent): boolean {
  const target = event.target;
  if (!(target instanceof HTMLElement) || event.key === 'Escape') return false;
  if (target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement || target.isContentEditable) return true;
  const moves = event.key.startsWith('Arrow');
  if (target instanceof HTMLInputElement) return !['checkbox', 'range', 'button'].includes(target.type) || moves || event.key === ' ';
  if (target instanceof HTMLButtonElement || target.tagName === 'SUMMARY' || target instanceof HTMLAnchorElement) {
    return event.key === ' ' || event.key === 'Enter' || (moves && target.getAttribute('role') === 'tab');
  }
  return false;
}
