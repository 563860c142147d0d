// The panel that describes the selection: an object and its partners, or a pair and its contacts.
import {measureOf} from './collision.ts';
import {byId, button, count, counted, definitions, make, plain, significant, tail} from './dom.ts';
import type {SceneModel} from './scene_model.ts';
import type {Collision, ObjectInfo, Point} from './types.ts';

export interface PanelActions {
  select(objects: number[]): void;
  clear(): void;
  zoom(): void;
  onlySelection(): void;
  section(): void;
  // The place of the selected pair.
  place(): Point | null;
}

export interface PairView {
  objects: readonly [number, number];
  names: readonly [string, string];
  // Null if the two do not collide in this frame, or if an exported page left out their row.
  row: Collision | null;
  // Whether the page has the rows of all collisions of the frame.
  listed: boolean;
}

const buttonLimit = 200;

export class SelectionPanel {
  private readonly host = byId('selection');
  private contactsOpen = false;

  constructor(private readonly model: SceneModel, private readonly actions: PanelActions) {}

  clear(): void {
    this.host.hidden = true;
    this.host.replaceChildren();
  }

  showObject(info: ObjectInfo): void {
    this.fill([this.head(tail(info.name ?? '') || `Object ${info.index}`), definitions(this.entries(info)), this.partnerList(info)]);
  }

  showPair({objects, names, row, listed}: PairView): void {
    const word = row ? row.class ?? 'collision' : listed ? 'no collision in this frame' : 'not among the collisions of this page';
    const list = make('ul', '', 'pair');
    objects.forEach((object, k) => {
      const item = make('li');
      const name = names[k]!;
      const choose = button(tail(name) || `Object ${object}`, () => this.actions.select([object]), `Select object ${object} ${name}`.trim());
      choose.title = name;
      item.append(make('span', '', `swatch ${k === 0 ? 'first' : 'second'}`), choose, make('span', String(object), 'index'));
      list.append(item);
    });
    const tools = make('div', '', 'pair-tools');
    tools.append(button('Only these two', () => this.actions.onlySelection(), 'Only these two, or all objects (key J)'),
      button('Section', () => this.actions.section(), 'Section through the contact (key X)'));
    const about = row ? [definitions(this.pairEntries(row)), tools, this.contactList(row)] : [];
    this.fill([this.head(word.charAt(0).toUpperCase() + word.slice(1)), list, ...about]);
  }

  private fill(parts: readonly HTMLElement[]): void {
    this.host.hidden = false;
    this.host.replaceChildren(...parts);
  }

  private head(title: string): HTMLElement {
    const head = make('div', '', 'head');
    head.append(make('h2', title), button('Zoom', () => this.actions.zoom(), 'Zoom to the selection'),
      button('×', () => this.actions.clear(), 'Clear the selection'));
    return head;
  }

  private pairEntries(row: Collision): [string, string][] {
    const entries: [string, string][] = [];
    const measure = measureOf(row, this.model.view.unit);
    if (measure) entries.push([measure.kind, measure.long]);
    const place = this.actions.place();
    const contacts = row.contacts?.length ?? 0;
    if (place) entries.push([contacts > 1 ? 'deepest at' : 'at', pointText(row)(place)]);
    if (row.change && this.model.frame.info.frame > 0) entries.push(['change', row.change]);
    return entries;
  }

  // The contacts with their own depths, which are not that of the pair.
  private contactList(row: Collision): HTMLElement {
    const contacts = row.contacts ?? [];
    if (contacts.length === 0) return make('div');
    const box = make('details');
    box.open = this.contactsOpen;
    box.addEventListener('toggle', () => this.contactsOpen = box.open);
    box.append(make('summary', contacts.length === 1 ? '1 contact, with its own depth' :
      `${count(contacts.length)} contacts${row.more_contacts ? ' of more' : ''}, each with its own depth`));
    const place = pointText(row);
    const table = make('table');
    for (const contact of contacts) {
      const line = make('tr');
      line.append(make('td', place(contact.point)), make('td', contact.depth === undefined ? '' : significant(contact.depth), 'number'));
      table.append(line);
    }
    box.append(table);
    return box;
  }

  private entries(info: ObjectInfo): [string, string][] {
    const entries: [string, string][] = [['index', String(info.index)]];
    const place = placeText(info);
    if (info.name && tail(info.name) !== info.name) entries.push(['name', info.name]);
    for (const [name, value] of Object.entries(info.details ?? {})) entries.push([name, plain(value)]);
    if (info.box) entries.push(['min', place(info.box.min)], ['max', place(info.box.max)]);
    if (info.code) entries.push(['octal code', info.code]);
    if (info.level !== undefined) entries.push(['level', String(info.level)]);
    if (info.groups !== undefined) entries.push(['groups', `0x${info.groups.toString(16)}`]);
    if (info.row < 0) entries.push(['drawn', 'only near the target']);
    return entries;
  }

  private partnerList(info: ObjectInfo): HTMLElement {
    const box = make('div');
    const listed = Math.min(info.partners.length, buttonLimit);
    const rest = info.partner_count > listed ? `, ${count(listed)} listed` : '';
    box.append(make('h3', info.partner_count === 0 ? 'No partners' : counted(info.partner_count, 'partner', 'partners') + rest));
    const list = make('ul', '', 'chips');
    for (const partner of info.partners.slice(0, listed)) {
      const item = make('li');
      const name = this.model.nameOf(partner);
      const title = name ? `${partner} ${tail(name)}` : String(partner);
      item.append(button(title, () => this.actions.select([partner]), `Select object ${title}`));
      list.append(item);
    }
    if (listed) box.append(list);
    return box;
  }
}

// Coordinates with as many digits as a size needs, also far from the origin.
function coordinates(size: number): (point: readonly number[]) => string {
  const decimals = Math.min(Math.max(3 - Math.floor(Math.log10(size)), 0), 12);
  return point => point.map(value => value.toLocaleString('en-US', {maximumFractionDigits: decimals})).join(', ');
}

function placeText(info: ObjectInfo): (point: readonly number[]) => string {
  const {min, max} = info.box ?? {min: [0, 0, 0], max: [0, 0, 0]};
  return coordinates(Math.max(...max.map((value, k) => value - min[k]!)) || Math.max(...max.map(Math.abs)) || 1);
}

function pointText(row: Collision): (point: readonly number[]) => string {
  const points = (row.contacts ?? []).map(contact => contact.point);
  const spread = Math.max(0, ...[0, 1, 2].map(k => Math.max(...points.map(point => point[k]!)) - Math.min(...points.map(point => point[k]!))));
  return coordinates(Math.max(spread, row.depth ?? Math.abs(row.overlap ?? 0)) || Math.max(...(points[0] ?? [1]).map(Math.abs)) || 1);
}
