// The search field of the header: objects by name or index.
import {button, byId, counted, isAbort, later, make} from './dom.ts';
import type {SceneModel} from './scene_model.ts';
import type {Source} from './source.ts';
import type {Found} from './types.ts';

// Largest number of results, the same as in the answers of a server.
const listed = 50;

export class Search {
  private readonly text = byId<HTMLInputElement>('search-text');
  private readonly box = byId('found');
  private abort = new AbortController();
  // The text whose first object opens.
  private opening: string | null = null;

  constructor(private readonly source: Source, private readonly model: SceneModel, private readonly open: (object: number) => void,
    private readonly failed: (error: unknown) => void) {
    byId('search').hidden = false;
    byId('search').addEventListener('submit', event => {
      event.preventDefault();
      this.opening = this.text.value;
      void this.find(true);
    });
    this.text.addEventListener('input', () => this.opening = null);
    // A list that comes later must not end the search that opens an object.
    this.text.addEventListener('input', later(() => {
      if (this.text.value !== this.opening) void this.find(false);
    }, 180));
    byId('search').addEventListener('keydown', event => this.press(event));
    document.addEventListener('pointerdown', event => {
      if (!byId('search').contains(event.target as Node)) this.close();
    });
  }

  focus(): void {
    this.text.focus();
    this.text.select();
  }

  close(): void {
    this.box.hidden = true;
  }

  private async find(openFirst: boolean): Promise<void> {
    const text = this.text.value.trim();
    this.abort.abort();
    this.abort = new AbortController();
    if (!text) return this.close();
    try {
      const found = await this.ask(text, this.abort.signal);
      if (openFirst && found.found[0]) this.choose(found.found[0].index);
      else this.show(found);
    } catch (error) {
      if (!isAbort(error)) this.failed(error);
    }
  }

  // A number that is an index is always found.
  private async ask(text: string, signal: AbortSignal): Promise<Found> {
    const {has, objects} = this.model.view;
    const index = /^\d+$/.test(text) ? Number(text) : -1;
    const known = index >= 0 && index < objects ? [{index, name: this.model.nameOf(index)}] : [];
    const query = new URLSearchParams({q: text, f: String(this.model.frame.info.frame)});
    const answer = has.search ? await this.source.json<Found>(`search.json?${query}`, signal) : this.model.search(text, listed);
    const others = answer.found.filter(entry => entry.index !== index);
    return {total: Math.max(answer.total, known.length), found: [...known, ...others]};
  }

  private show(found: Found): void {
    this.box.hidden = false;
    byId('found-total').textContent = found.total === 0 ? 'Nothing found' : counted(found.total, 'object', 'objects');
    byId('found-list').replaceChildren(...found.found.map(entry => {
      const item = make('li');
      const about = [this.model.detailOf(entry.index, 'type'), this.model.detailOf(entry.index, 'level')].filter(text => text).join(' · ');
      const choose = button(entry.name ? `${this.model.numberOf(entry.index)} ${this.model.labelOf(entry.index, entry.name)}` : String(entry.index),
        () => this.choose(entry.index));
      choose.title = entry.name;
      if (about) choose.append(make('small', about));
      item.append(choose);
      return item;
    }));
  }

  private choose(object: number): void {
    this.close();
    this.open(object);
  }

  private press(event: KeyboardEvent): void {
    if (event.key === 'Escape') {
      event.stopPropagation();
      this.close();
      return byId('view').focus();
    }
    if (event.key !== 'ArrowDown' && event.key !== 'ArrowUp') return;
    event.preventDefault();
    const places = [this.text, ...this.box.querySelectorAll('button')];
    const at = places.indexOf(document.activeElement as HTMLButtonElement);
    places[(at + (event.key === 'ArrowDown' ? 1 : places.length - 1)) % places.length]!.focus();
  }
}
