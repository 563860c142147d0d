// The selected objects, one or the two of a pair, and the panel that describes the first.
import {byId, button, counted, definitions, make, plain, short} from './dom.ts';
import {isOpen} from './layout.ts';
import {say, speak} from './panel.ts';
import type {SceneModel} from './scene_model.ts';
import {Missing, type Source, Unreachable} from './source.ts';
import type {ObjectInfo} from './types.ts';

export interface SelectionActions {
  changed(): void;
  zoom(): void;
}

const buttonLimit = 200;

export class Selection {
  objects: number[] = [];
  partners: number[] = [];
  info: ObjectInfo | null = null;
  private readonly panel = byId('selection');
  private request = 0;

  constructor(private readonly source: Source, private readonly model: SceneModel, private readonly actions: SelectionActions) {}

  async select(objects: number[]): Promise<void> {
    this.objects = [...new Set(objects)].filter(k => Number.isInteger(k) && k >= 0 && k < this.model.view.objects).slice(0, 2);
    if (this.objects.length === 0) {
      this.request += 1;
      this.info = null;
      this.partners = [];
      this.panel.hidden = true;
      this.panel.replaceChildren();
      return this.actions.changed();
    }
    this.partners = this.model.partnersOf(this.objects[0]!);
    this.actions.changed();
    await this.refresh();
    if (!this.info) return;
    const names = this.objects.map(k => this.title(k)).join(' and ');
    // With a closed panel nothing else names the selection.
    (isOpen('side') ? speak : say)(`${names} selected, ${counted(this.info.partner_count, 'partner', 'partners')}`);
  }

  // Reads the first object again, for another frame or another selection.
  async refresh(): Promise<void> {
    const first = this.objects[0];
    if (first === undefined) return;
    const request = ++this.request;
    const info = await this.read(first);
    if (request !== this.request) return;
    this.info = info;
    this.partners = info.partners;
    this.show(info);
    this.actions.changed();
  }

  private async read(object: number): Promise<ObjectInfo> {
    if (this.source.exported) return this.model.describe(object);
    try {
      return await this.source.json<ObjectInfo>(`object/${this.model.frame.info.frame}/${object}.json`);
    } catch (error) {
      if (error instanceof Missing || error instanceof Unreachable) return this.model.describe(object);
      throw error;
    }
  }

  private show(info: ObjectInfo): void {
    this.panel.hidden = false;
    const head = make('div', '', 'head');
    head.append(make('h2', info.name || `Object ${info.index}`), button('Zoom', () => this.actions.zoom(), 'Zoom to the selection'),
      button('×', () => void this.select([]), 'Clear the selection'));
    this.panel.replaceChildren(head, definitions(this.entries(info)), this.partnerList(info));
  }

  private entries(info: ObjectInfo): [string, string][] {
    const entries: [string, string][] = [['index', String(info.index)]];
    const point = (p: readonly number[]): string => p.map(short).join(', ');
    const other = this.objects[1];
    if (other !== undefined) entries.push(['with', this.title(other)]);
    for (const [name, value] of Object.entries(info.details ?? {})) entries.push([name, plain(value)]);
    if (info.box) entries.push(['min', point(info.box.min)], ['max', point(info.box.max)]);
    if (info.code) entries.push(['octal code', info.code]);
    if (info.level !== undefined) entries.push(['level', String(info.level)]);
    if (info.groups !== undefined) entries.push(['groups', `0x${info.groups.toString(16)}`]);
    if (info.row < 0) entries.push(['drawn', 'only near the target']);
    return entries;
  }

  private title(object: number): string {
    const name = this.model.nameOf(object);
    return name ? `${object} ${name}` : String(object);
  }

  private partnerList(info: ObjectInfo): HTMLElement {
    const box = make('div');
    const listed = Math.min(info.partners.length, buttonLimit);
    const rest = info.partner_count > listed ? `, ${listed} listed` : '';
    box.append(make('h3', info.partner_count === 0 ? 'No partners' : counted(info.partner_count, 'partner', 'partners') + rest));
    const list = make('ul', '', 'chips');
    for (const partner of info.partners.slice(0, listed)) {
      const item = make('li');
      item.append(button(this.title(partner), () => void this.select([partner]), `Select object ${this.title(partner)}`));
      list.append(item);
    }
    if (listed) box.append(list);
    return box;
  }
}
