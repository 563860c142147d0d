// The list of collisions, in pages. A page that has all rows of the frame filters, sorts and groups them itself; otherwise the server filters and
// sorts. A served page reads all rows when a filter or a group needs them.
import {measureOf, severityOf, thicknessOf, toneOf} from './collision.ts';
import {byId, count, counted, isAbort, later, make, pathBefore, tail} from './dom.ts';
import {type Filter, filterDetails, type Group, type Grouping, groupings, isGone, type Order, RowList} from './row_list.ts';
import type {SceneModel} from './scene_model.ts';
import type {Source} from './source.ts';
import type {Collision, CollisionQuery, Collisions} from './types.ts';

const pageRows = 100;
// A frame with more collisions has no groups and no filters by class or detail in a served page.
const wholeLimit = 200_000;

// The rows that the table begins with.
export const firstQuery: CollisionQuery = {from: 0, count: pageRows, sort: 'worst'};

export interface TableActions {
  selected(): readonly number[];
  open(row: Collision): void;
  failed(error: unknown): void;
}

// A line of the table: a row, or the head of a group.
interface Line {
  row: Collision | null;
  group: Group | null;
}

interface Column {
  title(unit: string): string;
  style: string;
  text(row: Collision): string;
}

export class Table {
  rows: Collision[] = [];
  total = 0;
  private from = 0;
  private lines: Line[] = [];
  private whole: {frame: number; list: RowList; left: number} | null = null;
  private groups: Group[] | null = null;
  private begun = false;
  // The frame whose numbers the buttons have.
  private controlled = -1;
  private readonly open = new Map<string, number>();
  private abort = new AbortController();
  private readonly body = byId('rows');
  private readonly order = byId<HTMLSelectElement>('sort');
  private readonly grouping = byId<HTMLSelectElement>('group');
  private readonly only = byId<HTMLInputElement>('only-selected');
  private readonly text = byId<HTMLInputElement>('filter');
  private readonly details = new Map(filterDetails.map(detail => [detail, byId<HTMLSelectElement>(`filter-${detail}`)]));
  private readonly depths = (['depth-from', 'depth-to'] as const).map(id => byId<HTMLInputElement>(id));
  private readonly chosen = {classes: new Set<string>(), changes: new Set<string>()};
  private readonly columns: readonly Column[];

  constructor(private readonly source: Source, private readonly model: SceneModel, private readonly actions: TableActions) {
    byId('previous-page').addEventListener('click', () => this.turn(-1));
    byId('next-page').addEventListener('click', () => this.turn(1));
    byId('clear-filters').addEventListener('click', () => this.clearFilters());
    byId('dense').addEventListener('change', () => this.setDense());
    for (const control of [this.order, this.grouping, this.only, ...this.details.values()]) control.addEventListener('change', () => void this.load(0));
    const loadSoon = later(() => void this.load(0), 200);
    for (const field of [this.text, ...this.depths]) field.addEventListener('input', loadSoon);
    this.order.querySelector<HTMLOptionElement>('[value=began]')!.hidden = !model.view.has.events && model.view.kind !== 'live';
    this.columns = [
      {title: () => 'class', style: 'class', text: row => row.class && row.class !== 'unknown' ? row.class : ''},
      {title: unit => this.measureTitle(unit), style: 'number', text: row => measureOf(row)?.short ?? ''},
      {title: unit => `thickness${unit}`, style: 'number thickness', text: thicknessOf},
      {title: () => 'time', style: 'number', text: row => row.time === undefined ? '' : String(Number(row.time.toPrecision(4)))},
      {title: () => 'change', style: 'change', text: row => this.changeText(row)},
      {title: () => 'status', style: 'status', text: row => row.status ?? ''},
    ];
  }

  turn(step: number): void {
    const from = this.from + step * pageRows;
    if (from >= 0 && from < this.lineCount) void this.load(from);
  }

  async load(from = this.from): Promise<void> {
    this.abort.abort();
    this.abort = new AbortController();
    const {signal} = this.abort;
    if (this.controlled !== this.model.frame.info.frame && this.model.view.kind !== 'live') this.fillControls();
    try {
      if (this.source.exported || this.needsAll()) await this.loadAll(from, signal);
      else await this.loadPage(from, signal);
    } catch (error) {
      if (!isAbort(error)) this.actions.failed(error);
    }
  }

  // Shows rows that were read, and returns the first one.
  use(answer: Collisions, from: number): Collision | null {
    this.from = from;
    this.total = answer.total;
    this.groups = null;
    this.show(answer.rows.map(row => ({row, group: null})));
    return this.rows[0] ?? null;
  }

  // Names and details of objects have come.
  namesArrived(): Promise<void> {
    this.whole = null;
    this.fillControls();
    return this.load();
  }

  // The worst collision of the frame, if the rows begin with it.
  get worst(): Collision | null {
    const all = this.order.value === 'worst' && !this.only.checked && !this.text.value.trim() && this.from === 0;
    return all ? this.rows[0] ?? null : null;
  }

  // The worst collisions that the table has, for the places that the small picture marks.
  get known(): readonly Collision[] {
    return this.whole?.list.all ?? this.rows;
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

  private needsAll(): boolean {
    const {view, frame} = this.model;
    if (view.kind === 'live' || frame.info.pairs > wholeLimit) return false;
    const {classes, changes, details, from, to} = this.filter();
    const filtered = classes.size || changes.size || Object.values(details).some(text => text) || from !== null || to !== null;
    return Boolean(filtered) || this.grouping.value !== 'none' || !['worst', 'pair', 'began'].includes(this.order.value);
  }

  private async loadPage(from: number, signal: AbortSignal): Promise<void> {
    const object = this.onlyObject() ?? undefined;
    const query: CollisionQuery = {from, count: pageRows, sort: this.order.value, object, q: this.text.value.trim()};
    const answer = await this.source.collisions(this.model.frame.info.frame, query, signal);
    if (!signal.aborted) this.use(answer, from);
  }

  private async loadAll(from: number, signal: AbortSignal): Promise<void> {
    const {frame} = this.model.frame.info;
    if (this.whole?.frame !== frame) {
      const [{rows, total}, gone] = await Promise.all([this.source.all(frame, signal), this.readGone()]);
      if (signal.aborted) return;
      this.whole = {frame, list: new RowList(this.model, [...rows, ...gone]), left: total - rows.length};
      this.fillChoices();
    }
    const {list} = this.whole;
    const selected = list.select(this.filter(), this.order.value as Order);
    this.groups = this.grouping.value === 'none' ? null : list.group(selected, this.grouping.value as Grouping);
    this.total = selected.length;
    this.from = from;
    this.show(this.groups ? this.groupLines(from) : selected.slice(from, from + pageRows).map(row => ({row, group: null})));
  }

  private async readGone(): Promise<Collision[]> {
    if (!this.model.view.has.gone) return [];
    const rows = await this.source.json<Partial<Collision>[]>('gone.json');
    return rows.map(row => ({...row, a: -1, b: -1, change: 'gone'}));
  }

  // The heads of a page of groups, and the rows of those that are open.
  private groupLines(from: number): Line[] {
    return this.groups!.slice(from, from + pageRows).flatMap(group => {
      const shown = this.open.get(group.key) ?? 0;
      return [{row: null, group}, ...group.rows.slice(0, shown).map(row => ({row, group}))];
    });
  }

  private get lineCount(): number {
    return this.groups?.length ?? this.total;
  }

  private onlyObject(): number | null {
    const first = this.actions.selected()[0];
    return this.only.checked && first !== undefined ? first : null;
  }

  private filter(): Filter {
    const number = (field: HTMLInputElement): number | null => field.value.trim() === '' || Number.isNaN(Number(field.value)) ? null : Number(field.value);
    const details = Object.fromEntries([...this.details].map(([detail, select]) => [detail, select.value])) as Filter['details'];
    const [from, to] = this.depths.map(number) as [number | null, number | null];
    return {words: this.text.value, ...this.chosen, details, from, to, object: this.onlyObject()};
  }

  private clearFilters(): void {
    for (const control of [this.text, ...this.depths, ...this.details.values()]) control.value = '';
    this.only.checked = false;
    for (const set of Object.values(this.chosen)) set.clear();
    this.fillControls();
    void this.load(0);
  }

  // The buttons of classes and changes, each with its number of collisions, and the groups that the objects have.
  private fillControls(): void {
    const {info} = this.model.frame;
    this.controlled = info.frame;
    const canFilter = this.model.view.kind !== 'live' && info.pairs <= wholeLimit;
    const classes = Object.entries(info.classes ?? {}).sort(([p], [q]) => severityOf(q) - severityOf(p));
    const changes = (['new', 'same', 'gone'] as const).filter(word => info[word] !== undefined).map(word => [word, info[word]!] as const);
    const parts = [...classes.map(([word, many]) => this.chip(word, many, this.chosen.classes)),
      ...changes.map(([word, many]) => this.chip(word, many, this.chosen.changes))];
    byId('kinds').hidden = !canFilter || parts.length === 0;
    byId('kinds').replaceChildren(...parts);
    const known = groupings.filter(by => by === 'none' || by === 'object' || this.model.hasDetail(by) || (by === 'parent' && this.hasPaths()));
    for (const option of this.grouping.options) option.hidden = !known.includes(option.value as Grouping);
    this.grouping.hidden = !canFilter;
    byId('filters').hidden = !canFilter || !info.classes;
  }

  private hasPaths(): boolean {
    return this.model.names?.some(name => name.includes('/')) ?? false;
  }

  private chip(word: string, many: number, set: Set<string>): HTMLElement {
    const button = make('button', '', `kind ${toneOf(word)}`);
    button.type = 'button';
    button.append(make('strong', count(many)), ` ${word}`);
    const press = (): void => button.setAttribute('aria-pressed', String(set.has(word)));
    press();
    button.addEventListener('click', () => {
      if (!set.delete(word)) set.add(word);
      press();
      void this.load(0);
    });
    return button;
  }

  // The choices of the filters by detail.
  private fillChoices(): void {
    for (const [detail, select] of this.details) {
      const {value} = select;
      const choices = this.whole!.list.choices(detail);
      select.replaceChildren(new Option('all', ''), ...choices.map(choice => new Option(choice, choice)));
      select.value = choices.includes(value) ? value : '';
      select.parentElement!.hidden = choices.length < 2;
    }
  }

  private setDense(): void {
    byId('table').classList.toggle('dense', byId<HTMLInputElement>('dense').checked);
  }

  // Many rows begin with a line each.
  private beginDense(): void {
    if (this.begun || !this.total) return;
    this.begun = true;
    byId<HTMLInputElement>('dense').checked = this.total > 12;
    this.setDense();
  }

  private isSelected(row: Collision): boolean {
    const [a, b] = this.actions.selected();
    return a !== undefined && ((row.a === a && row.b === b) || (row.a === b && row.b === a));
  }

  private show(lines: Line[]): void {
    this.beginDense();
    this.lines = lines;
    this.rows = lines.flatMap(({row}) => row ? [row] : []);
    const shown = this.groups ? this.groups.slice(this.from, this.from + pageRows).length : this.rows.length;
    byId('table-totals').textContent = this.totalsText(this.from + 1, this.from + shown);
    byId<HTMLButtonElement>('previous-page').disabled = this.from === 0;
    byId<HTMLButtonElement>('next-page').disabled = this.from + shown >= this.lineCount;
    const none = byId('no-rows');
    none.hidden = lines.length > 0;
    none.textContent = this.isFiltered() ? 'No collision passes the filters.' : 'No objects collide.';
    const unit = this.model.view.unit ? ` (${this.model.view.unit})` : '';
    const columns = this.columns.filter(column => this.rows.some(row => column.text(row)) || (column.style === 'class' && this.groups));
    byId('head').replaceChildren(...[['a', ''], ['b', ''], ...columns.map(column => [column.title(unit), column.style])].map(([title, style]) => {
      const cell = make('th', title, style);
      cell.scope = 'col';
      return cell;
    }));
    this.body.replaceChildren(...lines.map((line, k) => line.row ? this.makeRow(line, columns) : this.makeHead(line.group!, k, columns.length + 2)));
    this.mark();
  }

  private isFiltered(): boolean {
    const {words, classes, changes, details, from, to, object} = this.filter();
    return Boolean(words.trim() || classes.size || changes.size || from !== null || to !== null || object !== null) || Object.values(details).some(text => text);
  }

  // Pairs of boxes are not collisions that a test found.
  private totalsText(first: number, last: number): string {
    const [one, many] = this.model.frame.info.classes ? ['collision', 'collisions'] : ['pair', 'pairs'];
    if (this.total === 0) return `No ${many}`;
    const all = counted(this.total, one, many);
    const left = this.whole && this.whole.left > 0 && !this.isFiltered() ? `, ${count(this.whole.left)} less bad left out` : '';
    if (this.groups) return `${count(first)} to ${count(last)} of ${counted(this.groups.length, 'group', 'groups')}, ${all}${left}`;
    return `${count(first)} to ${count(last)} of ${all}${left}`;
  }

  private measureTitle(unit: string): string {
    const kinds = new Set(this.rows.map(row => measureOf(row)?.kind));
    return ['depth', 'overlap', 'gap'].filter(kind => kinds.has(kind)).join(', ') + unit;
  }

  private makeRow({row, group}: Line, columns: readonly Column[]): HTMLElement {
    const line = make('tr', '', group ? 'member' : '');
    line.tabIndex = 0;
    line.dataset.pair = `${row!.a},${row!.b}`;
    line.setAttribute('aria-level', group ? '2' : '1');
    line.append(this.nameCell(row!, 'a'), this.nameCell(row!, 'b'));
    for (const column of columns) {
      const tone = column.style === 'class' ? toneOf(row!.class ?? '') : column.style === 'change' ? row!.change ?? '' : '';
      line.append(make('td', column.text(row!), `${column.style} ${tone}`.trim()));
    }
    line.title = [this.title(row!, 'a'), this.title(row!, 'b'), measureOf(row!, this.model.view.unit)?.long ?? ''].filter(text => text).join('\n');
    line.addEventListener('click', () => this.actions.open(row!));
    return this.withKeys(line, () => this.actions.open(row!));
  }

  private makeHead(group: Group, at: number, columns: number): HTMLElement {
    const line = make('tr', '', 'group');
    const shown = this.open.get(group.key) ?? 0;
    line.tabIndex = 0;
    line.setAttribute('aria-level', '1');
    line.setAttribute('aria-expanded', String(shown > 0));
    const cell = make('td');
    cell.colSpan = columns;
    const kinds = new Map<string, number>();
    for (const row of group.rows) if (row.class) kinds.set(row.class, (kinds.get(row.class) ?? 0) + 1);
    const words = [...kinds].sort(([p], [q]) => severityOf(q) - severityOf(p)).map(([word, many]) => `${count(many)} ${word}`).join(', ');
    cell.append(make('strong', group.title), ' ', make('span', words || counted(group.rows.length, 'pair', 'pairs'), 'kinds'));
    line.append(cell);
    const toggle = (more = shown ? 0 : pageRows): void => {
      this.open.set(group.key, more);
      this.show(this.groupLines(this.from));
      (this.body.children[at] as HTMLElement | undefined)?.focus();
    };
    if (shown && shown < group.rows.length) {
      const more = make('button', `${count(shown)} are listed; list ${count(Math.min(pageRows, group.rows.length - shown))} more`);
      more.type = 'button';
      more.addEventListener('click', event => {
        event.stopPropagation();
        toggle(shown + pageRows);
      });
      cell.append(' ', more);
    }
    line.addEventListener('click', () => toggle());
    return this.withKeys(line, toggle, shown > 0);
  }

  // Up and down move between lines, Enter and the space bar activate. Left and right close and open a group.
  private withKeys(line: HTMLElement, activate: () => void, isOpen: boolean | null = null): HTMLElement {
    line.addEventListener('keydown', event => {
      if (event.target !== line) return;
      const moves: Record<string, Element | null> = {
        ArrowDown: line.nextElementSibling, ArrowUp: line.previousElementSibling, Home: this.body.firstElementChild, End: this.body.lastElementChild,
      };
      if (event.key === 'Enter' || event.key === ' ' || (event.key === 'ArrowRight' && isOpen === false) || (event.key === 'ArrowLeft' && isOpen)) activate();
      else if (event.key === 'ArrowLeft' && line.classList.contains('member')) this.headBefore(line)?.focus();
      else if (event.key in moves) (moves[event.key] as HTMLElement | null)?.focus();
      else return;
      event.preventDefault();
    });
    return line;
  }

  private headBefore(line: Element): HTMLElement | null {
    let at = line.previousElementSibling;
    while (at && !at.classList.contains('group')) at = at.previousElementSibling;
    return at as HTMLElement | null;
  }

  // The label, and below it what else tells what the object is.
  private nameCell(row: Collision, side: 'a' | 'b'): HTMLElement {
    const cell = make('td', '', 'object');
    cell.append(shortened(this.model.sideLabel(row, side)));
    const more = this.moreOf(row, side);
    if (more) cell.append(make('small', more));
    return cell;
  }

  private moreOf(row: Collision, side: 'a' | 'b'): string {
    if (isGone(row)) return row[`type_${side}`] ?? '';
    const object = row[side];
    const level = this.model.detailOf(object, 'level');
    const known = [this.model.detailOf(object, 'type'), level, level ? '' : this.model.detailOf(object, 'parent'), this.model.fileOf(object)];
    if (!known.some(text => text)) known.push(tail(pathBefore(row[`name_${side}`] ?? this.model.nameOf(object)), 2));
    return known.filter(text => text).join(' · ') || (this.model.labelOf(object).startsWith('object ') ? '' : `#${this.model.numberOf(object)}`);
  }

  private title(row: Collision, side: 'a' | 'b'): string {
    const name = row[`name_${side}`] ?? this.model.nameOf(row[side]);
    return `${side}: ${isGone(row) ? '' : `#${this.model.numberOf(row[side])} `}${name || this.model.sideLabel(row, side)}`;
  }

  // In the first frame, all collisions began.
  private changeText(row: Collision): string {
    const {frame} = this.model.frame.info;
    return row.change && (frame > 0 || row.change !== 'began') ? row.change : '';
  }

  private mark(): void {
    this.lines.forEach(({row}, k) => {
      const line = this.body.children[k];
      if (!line || !row) return;
      const selected = this.isSelected(row);
      line.classList.toggle('marked', selected);
      // The colours that the two objects have in the picture.
      for (const [side, object] of [row.a, row.b].entries()) {
        const which = selected ? this.actions.selected().indexOf(object) : -1;
        line.children[side]!.classList.toggle('first', which === 0);
        line.children[side]!.classList.toggle('second', which === 1);
      }
      if (selected) line.setAttribute('aria-current', 'true');
      else line.removeAttribute('aria-current');
    });
  }
}

// A text that loses its middle if it is too long, since its end often tells objects apart.
function shortened(text: string): HTMLElement {
  const letters = Array.from(text);
  const kept = letters.length > 14 ? 8 : 0;
  const label = make('span', '', 'label');
  label.append(make('bdi', letters.slice(0, letters.length - kept).join('')), make('bdi', letters.slice(letters.length - kept).join('')));
  return label;
}
