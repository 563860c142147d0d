// The panel that describes the selection: an object and its partners, or a pair and its contacts.
import {contactsText, explanations, measureOf, thicknessOf} from './collision.ts';
import {byId, button, copyText, count, counted, definitions, make, pathBefore, plain, significant, tail} from './dom.ts';
import {say} from './panel.ts';
import {isGone} from './row_list.ts';
import {type DetailName, type SceneModel} from './scene_model.ts';
import type {Collision, ObjectInfo, Point} from './types.ts';

export interface PanelActions {
  select(objects: number[]): void;
  clear(): void;
  zoom(): void;
  onlySelection(): void;
  section(): void;
  copyLink(): void;
  // The place of the selected pair.
  place(): Point | null;
}

export interface PairView {
  objects: readonly [number, number];
  // Null if the two do not collide in this frame, or if an exported page left out their row.
  row: Collision | null;
  // Whether the page has the rows of all collisions of the frame.
  listed: boolean;
}

const buttonLimit = 200;

export class SelectionPanel {
  private readonly host = byId('selection');
  private moreOpen = false;

  constructor(private readonly model: SceneModel, private readonly actions: PanelActions) {}

  clear(): void {
    this.host.hidden = true;
    this.host.replaceChildren();
  }

  showObject(info: ObjectInfo): void {
    this.fill([this.head(this.model.labelOf(info.index, info.name), true), definitions(this.entries(info)), this.partnerList(info)]);
  }

  showPair({objects, row, listed}: PairView): void {
    const word = row ? row.class ?? 'collision' : listed ? 'no collision in this frame' : 'not among the collisions of this page';
    const gone = row !== null && isGone(row);
    const list = make('ul', '', 'pair');
    objects.forEach((object, k) => list.append(gone ? this.goneItem(row, k === 0 ? 'a' : 'b') : this.objectItem(object, k, row)));
    const measure = row && measureOf(row, this.model.view.unit);
    const title = `${gone ? 'gone: ' : ''}${word}${measure ? `, ${measure.kind} ${measure.long}` : ''}`;
    const parts: HTMLElement[] = [this.head(title.charAt(0).toUpperCase() + title.slice(1), !gone), list];
    if (row) parts.push(definitions(this.pairEntries(row)));
    if (!gone) parts.push(this.tools(row !== null));
    if (row) parts.push(this.more(row));
    this.fill(parts);
  }

  private fill(parts: readonly HTMLElement[]): void {
    this.host.hidden = false;
    this.host.replaceChildren(...parts);
  }

  private head(title: string, canZoom: boolean): HTMLElement {
    const head = make('div', '', 'head');
    head.append(make('h2', title), ...(canZoom ? [button('Zoom', () => this.actions.zoom(), 'Zoom to the selection')] : []),
      button('×', () => this.actions.clear(), 'Clear the selection'));
    return head;
  }

  private tools(collides: boolean): HTMLElement {
    const tools = make('div', '', 'pair-tools');
    tools.append(button('Only these two', () => this.actions.onlySelection(), 'Only these two, or all objects (key J)'));
    if (collides) tools.append(button('Section', () => this.actions.section(), 'Section through the contact (key X)'));
    tools.append(button('Copy link', () => this.actions.copyLink(), 'Copy link to this collision'));
    return tools;
  }

  // One object of a pair: what it is called, and below it what the file says of it.
  private objectItem(object: number, which: number, row: Collision | null): HTMLElement {
    const {model} = this;
    const side = row && row.a !== object ? 'b' : 'a';
    const name = row?.[`name_${side}`] || model.nameOf(object);
    const label = row ? model.sideLabel(row, side) : model.labelOf(object);
    const choose = button(label, () => this.actions.select([object]), `Select ${label}`);
    choose.title = name;
    const item = make('li');
    const known = (['type', 'level'] as const).map(detail => model.detailOf(object, detail));
    const number = /(^object |#)\d+$/.test(label) ? '' : `#${model.numberOf(object)}`;
    const parent = known.some(text => text) ? '' : tail(pathBefore(name), 2);
    const about = make('small', [...known, parent, model.fileOf(object), number].filter(text => text).join(' · '));
    item.append(make('span', '', `swatch ${which === 0 ? 'first' : 'second'}`), choose, about);
    return item;
  }

  private goneItem(row: Collision, side: 'a' | 'b'): HTMLElement {
    const item = make('li');
    item.append(make('span', '', 'swatch'), make('strong', this.model.sideLabel(row, side)), make('small', [row[`type_${side}`], row[`name_${side}`]].filter(text => text).join(' · ')));
    return item;
  }

  private pairEntries(row: Collision): [string, string][] {
    const entries: [string, string][] = [];
    const {unit} = this.model.view;
    const thickness = thicknessOf(row);
    if (thickness) entries.push(['overlap thickness', unit ? `${thickness} ${unit}` : thickness]);
    const place = isGone(row) ? null : this.actions.place();
    if (place) entries.push(['where', [this.common(row, 'level').join(' and '), `${pointText(row)(place)}${unit ? ` ${unit}` : ''}`].filter(text => text).join(', at ')]);
    if (row.time !== undefined) entries.push(['time', plain(row.time)]);
    if (row.change && (this.model.frame.info.frame > 0 || row.change !== 'began')) entries.push(['change', row.change]);
    if (row.status) entries.push(['status', row.status]);
    if (row.comment) entries.push(['comment', row.comment]);
    return entries;
  }

  // The texts of a detail of both objects, each once.
  private common(row: Collision, detail: DetailName): string[] {
    return [...new Set([row.a, row.b].map(object => this.model.detailOf(object, detail)))].filter(text => text);
  }

  // What few readers need: what the class and the bounds mean, the contacts, and the further details of the objects.
  private more(row: Collision): HTMLElement {
    const box = make('details');
    box.open = this.moreOpen;
    box.addEventListener('toggle', () => this.moreOpen = box.open);
    box.append(make('summary', row.contacts?.length ? `More: ${contactsText(row)}` : 'More'), ...explanations(row).map(text => make('p', text)));
    for (const [k, object] of [row.a, row.b].entries()) {
      for (const detail of ['id', 'material'] as const) {
        const text = object < 0 ? '' : this.model.detailOf(object, detail);
        if (!text) continue;
        const line = make('p', `${k === 0 ? 'First' : 'Second'} object, ${detail}: ${detail === 'id' ? '' : text}`);
        if (detail === 'id') line.append(copyButton(text));
        box.append(line);
      }
    }
    if (row.contacts?.length) box.append(this.contactTable(row));
    return box;
  }

  // The contacts with their own depths, which are not that of the pair.
  private contactTable(row: Collision): HTMLElement {
    const {unit} = this.model.view;
    const place = pointText(row);
    const table = make('table');
    const head = make('tr');
    head.append(make('th', `contact at${unit ? ` (${unit})` : ''}`), make('th', 'own depth', 'number'));
    table.append(head);
    for (const [k, contact] of row.contacts!.entries()) {
      const line = make('tr');
      line.append(make('td', place(contact.point) + (k === 0 && row.contacts!.length > 1 ? ', the deepest' : '')),
        make('td', contact.depth === undefined ? '' : significant(contact.depth), 'number'));
      table.append(line);
    }
    return table;
  }

  private entries(info: ObjectInfo): [string, string][] {
    const file = this.model.fileOf(info.index);
    const entries: [string, string][] = [['index', `${this.model.numberOf(info.index)}${file ? ` of ${file}` : ''}`]];
    const place = placeText(info);
    if (info.name && this.model.labelOf(info.index, info.name) !== info.name) entries.push(['name', info.name]);
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
      const label = this.model.labelOf(partner);
      const title = label.startsWith('object ') ? String(partner) : label;
      item.append(button(title, () => this.actions.select([partner]), `Select object ${title}`));
      list.append(item);
    }
    if (listed) box.append(list);
    return box;
  }
}

function copyButton(text: string): HTMLElement {
  const element = button(text, () => void copyText(text).then(copied => say(copied ? 'Copied' : text)), `Copy the id ${text}`);
  element.className = 'id';
  return element;
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
