// The table of collisions: pages of rows, sorted and filtered by the source.
import {classTone, measureOf} from './collision.ts';
import {byId, count, counted, isAbort, make, tail} from './dom.ts';
import type {Source} from './source.ts';
import type {Collision, CollisionQuery, Collisions} from './types.ts';

const pageRows = 100;

// The rows that the table begins with.
export const firstQuery: CollisionQuery = {from: 0, count: pageRows, sort: 'worst'};

export interface TableActions {
  frame(): number;
  selected(): readonly number[];
  open(row: Collision): void;
  failed(error: unknown): void;
}

export class Table {
  rows: Collision[] = [];
  total = 0;
  private from = 0;
  private abort = new AbortController();
  private readonly body = byId('rows');
  private readonly sort = byId<HTMLSelectElement>('sort');
  private readonly only = byId<HTMLInputElement>('only-selected');
  private readonly text = byId<HTMLInputElement>('filter');

  constructor(private readonly source: Source, private readonly actions: TableActions, hasEvents: boolean) {
    byId('previous-page').addEventListener('click', () => this.turn(-1));
    byId('next-page').addEventListener('click', () => this.turn(1));
    for (const control of [this.sort, this.only]) control.addEventListener('change', () => void this.load(0));
    let timer = 0;
    this.text.addEventListener('input', () => {
      clearTimeout(timer);
      timer = window.setTimeout(() => void this.load(0), 200);
    });
    this.sort.querySelector<HTMLOptionElement>('[value=began]')!.hidden = !hasEvents;
  }

  turn(step: number): void {
    const from = this.from + step * pageRows;
    if (from >= 0 && from < this.total) void this.load(from);
  }

  async load(from = this.from): Promise<void> {
    this.abort.abort();
    this.abort = new AbortController();
    const {signal} = this.abort;
    const first = this.actions.selected()[0];
    const object = this.only.checked && first !== undefined ? first : undefined;
    const query: CollisionQuery = {from, count: pageRows, sort: this.sort.value, object, q: this.text.value.trim()};
    try {
      const answer = await this.source.collisions(this.actions.frame(), query, signal);
      if (!signal.aborted) this.use(answer, from);
    } catch (error) {
      if (!isAbort(error)) this.actions.failed(error);
    }
  }

  // Shows rows that were read, and returns the first one.
  use(answer: Collisions, from: number): Collision | null {
    this.from = from;
    this.total = answer.total;
    this.rows = answer.rows;
    this.show();
    return this.rows[0] ?? null;
  }

  // The worst collision of the frame, if the rows begin with it.
  get worst(): Collision | null {
    const all = this.sort.value === 'worst' && !this.only.checked && !this.text.value.trim() && this.from === 0;
    return all ? this.rows[0] ?? null : null;
  }

  // The selection changed: marks its row, and reads other rows if only those of the selection are shown.
  selectionChanged(): void {
    if (this.only.checked) void this.load(0);
    this.mark();
    this.body.querySelector('.marked')?.scrollIntoView({block: 'nearest'});
  }

  // Opens the row after or before the marked one.
  step(by: number): void {
    const at = this.rows.findIndex(row => this.isSelected(row));
    const next = this.rows[at < 0 ? 0 : (at + by + this.rows.length) % this.rows.length];
    if (next) this.actions.open(next);
  }

  private isSelected(row: Collision): boolean {
    const [a, b] = this.actions.selected();
    return (row.a === a && row.b === b) || (row.a === b && row.b === a);
  }

  private show(): void {
    const last = Math.min(this.from + this.rows.length, this.total);
    byId('table-totals').textContent = this.total === 0 ? 'No collisions' :
      `${count(this.from + 1)} to ${count(last)} of ${counted(this.total, 'collision', 'collisions')}`;
    byId<HTMLButtonElement>('previous-page').disabled = this.from === 0;
    byId<HTMLButtonElement>('next-page').disabled = last >= this.total;
    const kinds = new Set(this.rows.map(row => measureOf(row)?.kind).filter(kind => kind));
    const column = byId('depth-column');
    column.hidden = kinds.size === 0 && !this.rows.some(row => row.class);
    column.textContent = kinds.size === 0 ? 'depth' : ['depth', 'overlap', 'gap'].filter(kind => kinds.has(kind)).join(', ');
    byId('state-column').hidden = !this.rows.some(row => this.changeText(row));
    const none = byId('no-rows');
    none.hidden = this.rows.length > 0;
    none.textContent = this.text.value.trim() || this.only.checked ? 'No collision has these objects.' : 'No objects collide.';
    this.body.replaceChildren(...this.rows.map(row => this.makeRow(row)));
    this.mark();
  }

  private makeRow(row: Collision): HTMLElement {
    const line = make('tr');
    line.tabIndex = 0;
    line.append(cell(row.a, row.name_a), cell(row.b, row.name_b));
    if (!byId('depth-column').hidden) line.append(depthCell(row));
    if (!byId('state-column').hidden) line.append(make('td', this.changeText(row), row.change ?? ''));
    line.addEventListener('click', () => this.actions.open(row));
    line.addEventListener('keydown', event => this.press(event, line, row));
    return line;
  }

  // In the first frame, all collisions are new.
  private changeText(row: Collision): string {
    return (this.actions.frame() > 0 && row.change) || '';
  }

  private press(event: KeyboardEvent, line: HTMLElement, row: Collision): void {
    const other = event.key === 'ArrowDown' ? line.nextElementSibling : event.key === 'ArrowUp' ? line.previousElementSibling : null;
    if (event.key === 'Enter' || event.key === ' ') this.actions.open(row);
    else if (event.key === 'ArrowDown' || event.key === 'ArrowUp') (other as HTMLElement | null)?.focus();
    else return;
    event.preventDefault();
  }

  private mark(): void {
    this.rows.forEach((row, k) => {
      const line = this.body.children[k];
      if (!line) return;
      const selected = this.isSelected(row);
      line.classList.toggle('marked', selected);
      // The colours that the two objects have in the picture.
      for (const [k, object] of [row.a, row.b].entries()) {
        const which = selected ? this.actions.selected().indexOf(object) : -1;
        line.children[k]!.className = which < 0 ? '' : which === 0 ? 'first' : 'second';
      }
      if (selected) line.setAttribute('aria-current', 'true');
      else line.removeAttribute('aria-current');
    });
  }
}

// The depth, and below it the class.
function depthCell(row: Collision): HTMLElement {
  const measure = measureOf(row);
  const element = make('td', '', 'number');
  element.append(make('span', measure?.short ?? '', 'measure'));
  if (measure) element.title = `${measure.kind} ${measure.long}`;
  if (row.class && row.class !== 'unknown') element.append(make('span', row.class, `class ${classTone(row)}`));
  return element;
}

function cell(object: number, name = ''): HTMLElement {
  const element = make('td', String(object));
  if (name) {
    element.append(make('span', tail(name), 'name'));
    element.title = name;
  }
  return element;
}
