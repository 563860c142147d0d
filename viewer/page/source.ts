// Reads the addresses of the protocol, from the server or from the elements of an exported page. Callers see no difference.
import {isAbort} from './dom.ts';
import type {Collision, CollisionQuery, Collisions} from './types.ts';

export class Missing extends Error {}
export class StillLoading extends Error {}
export class Unreachable extends Error {}

export interface Source {
  readonly exported: boolean;
  bytes(address: string, signal?: AbortSignal): Promise<ArrayBuffer>;
  json<T>(address: string, signal?: AbortSignal): Promise<T>;
  collisions(frame: number, query: CollisionQuery, signal?: AbortSignal): Promise<Collisions>;
  // The worst rows of a frame, as many as the page can have (protocol.md).
  all(frame: number, signal?: AbortSignal): Promise<Collisions>;
}

export type ByteCounter = (address: string, got: number, total: number) => void;

export class ServerSource implements Source {
  readonly exported = false;

  constructor(private readonly count: ByteCounter = () => undefined) {}

  async bytes(address: string, signal?: AbortSignal): Promise<ArrayBuffer> {
    const answer = await fetch(address, {signal, credentials: 'same-origin'}).catch((error: unknown) => {
      throw isAbort(error) ? error : new Unreachable('The program does not answer.');
    });
    if (answer.status === 503) throw new StillLoading('the scene is still loading');
    if (answer.status === 404) throw new Missing(`${address}: not found`);
    if (!answer.ok) throw new Error(`${address}: the server answered ${answer.status}`);
    return this.collect(address, answer);
  }

  async json<T>(address: string, signal?: AbortSignal): Promise<T> {
    return JSON.parse(new TextDecoder().decode(await this.bytes(address, signal))) as T;
  }

  collisions(frame: number, query: CollisionQuery, signal?: AbortSignal): Promise<Collisions> {
    const parameters = new URLSearchParams({from: String(query.from), count: String(query.count), sort: query.sort});
    for (const name of ['object', 'with'] as const) if (query[name] !== undefined) parameters.set(name, String(query[name]));
    if (query.q) parameters.set('q', query.q);
    return this.json(`collisions/${frame}.json?${parameters}`, signal);
  }

  all(frame: number, signal?: AbortSignal): Promise<Collisions> {
    return this.collisions(frame, {from: 0, count: 200_000, sort: 'worst'}, signal);
  }

  // Reads the body piece by piece only if it is large, so that progress can be shown.
  private async collect(address: string, answer: Response): Promise<ArrayBuffer> {
    const total = Number(answer.headers.get('Content-Length') ?? 0);
    if (!answer.body || total < 500_000) return answer.arrayBuffer();
    const reader = answer.body.getReader();
    const pieces: Uint8Array[] = [];
    let got = 0;
    for (let piece = await reader.read(); !piece.done; piece = await reader.read()) {
      pieces.push(piece.value);
      got += piece.value.length;
      this.count(address, got, Math.max(total, got));
    }
    const all = new Uint8Array(got);
    let at = 0;
    for (const piece of pieces) {
      all.set(piece, at);
      at += piece.length;
    }
    return all.buffer;
  }
}

export class ExportSource implements Source {
  readonly exported = true;
  private readonly tables = new Map<number, Promise<Collisions>>();

  constructor(private readonly elements: Map<string, Element>) {}

  async bytes(address: string): Promise<ArrayBuffer> {
    const element = this.elements.get(address);
    if (!element) throw new Missing(`${address}: not in this page`);
    const packed = Uint8Array.from(atob((element.textContent ?? '').trim()), letter => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
    return new Response(stream).arrayBuffer();
  }

  async json<T>(address: string): Promise<T> {
    return JSON.parse(new TextDecoder().decode(await this.bytes(address))) as T;
  }

  all(frame: number): Promise<Collisions> {
    let table = this.tables.get(frame);
    if (!table) this.tables.set(frame, table = this.json<Collisions>(`collisions/${frame}.json`));
    return table;
  }

  // The rows of an object or a pair, or all, the worst first, which is their order in the page.
  async collisions(frame: number, {object, with: other, from, count}: CollisionQuery): Promise<Collisions> {
    const {total, rows} = await this.all(frame);
    const has = (row: Collision, which: number | undefined): boolean => which === undefined || row.a === which || row.b === which;
    const kept = rows.filter(row => has(row, object) && has(row, other));
    return {total: object === undefined ? total : kept.length, rows: kept.slice(from, from + count), partial: total > rows.length};
  }
}

// The elements of an exported page, if it is one.
export function findSource(count: ByteCounter): Source {
  const elements = new Map<string, Element>();
  for (const element of document.querySelectorAll('script[data-address]')) {
    elements.set(element.getAttribute('data-address') ?? '', element);
  }
  return elements.size ? new ExportSource(elements) : new ServerSource(count);
}
