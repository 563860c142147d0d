// The WebSocket: events of the server, and live frames, each asked for when the last one was drawn.
import type {SocketEvent} from './types.ts';

const magic = 0x4f504c56;
const headerWords = 16;
const none = 0xffffffff;

export interface LiveFrame {
  frame: number;
  base: number;
  whole: boolean;
  objects: number;
  shown: number;
  began: number;
  ended: number;
  pairs: number;
  listed: number;
  existing: number;
  stepSeconds: number;
  // Objects of the rows. Only a whole frame has them.
  shownObjects: Uint32Array | null;
  // All boxes of a whole frame, or those of `movedRows`.
  boxes: Float32Array;
  movedRows: Uint32Array;
  pairList: Uint32Array;
  beganList: Uint32Array;
  endedList: Uint32Array;
}

export interface FeedActions {
  event(event: SocketEvent): void;
  frame(frame: LiveFrame): void;
  lost(): void;
}

export function parseFrame(bytes: ArrayBuffer): LiveFrame {
  const words = new Uint32Array(bytes, 0, headerWords);
  if (words[0] !== magic) throw new Error('a live frame has a wrong header');
  const [, frame, base, objects, shown, moved, began, ended, low, high, listed, micros, existing] = words as unknown as number[];
  let at = 4 * headerWords;
  const take = (count: number): number => {
    const from = at;
    at += 4 * count;
    if (at > bytes.byteLength) throw new Error('a live frame is too short');
    return from;
  };
  const integers = (count: number): Uint32Array => new Uint32Array(bytes, take(count), count);
  const floats = (count: number): Float32Array => new Float32Array(bytes, take(count), count);
  const empty = new Uint32Array(0);
  const head = {
    frame: frame!, base: base!, whole: base === none, objects: objects!, shown: shown!, began: began!, ended: ended!,
    pairs: high! * 4294967296 + low!, listed: listed!, existing: existing!, stepSeconds: micros! / 1e6,
  };
  if (head.whole) {
    const shownObjects = shown! < objects! ? integers(shown!) : null;
    return {...head, shownObjects, movedRows: empty, boxes: floats(6 * shown!), pairList: integers(2 * listed!), beganList: empty, endedList: empty};
  }
  const movedRows = integers(moved!);
  const boxes = floats(6 * moved!);
  // A difference without lists only changes the counts.
  const lists = bytes.byteLength - at >= 8 * (began! + ended!);
  const beganList = lists ? integers(2 * began!) : empty;
  return {...head, shownObjects: null, movedRows, boxes, pairList: empty, beganList, endedList: lists ? integers(2 * ended!) : empty};
}

export class LiveFeed {
  private socket: WebSocket | null = null;
  private ended = false;
  private last = -1;
  private paused = false;
  private asked = false;
  private live = false;
  private tries = 0;

  constructor(private readonly actions: FeedActions) {
    this.connect();
  }

  // Whether the WebSocket is open or opens.
  connects(): boolean {
    return this.socket !== null && this.socket.readyState <= WebSocket.OPEN;
  }

  // Live frames are wanted from now on.
  start(): void {
    this.live = true;
    this.want();
  }

  pause(paused: boolean): void {
    this.paused = paused;
    this.want();
  }

  // Asks for the next frame, when the page has drawn the last one.
  want(): void {
    if (!this.live || this.paused || this.asked || this.socket?.readyState !== WebSocket.OPEN) return;
    this.asked = true;
    this.socket.send(JSON.stringify({want: this.last}));
  }

  private connect(): void {
    const address = new URL('socket', document.baseURI);
    address.protocol = address.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = new WebSocket(address);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    socket.addEventListener('open', () => {
      this.tries = 0;
      this.asked = false;
      this.want();
    });
    socket.addEventListener('message', message => this.receive(message.data));
    socket.addEventListener('close', () => this.closed());
  }

  private receive(data: unknown): void {
    if (typeof data === 'string') {
      const event = JSON.parse(data) as SocketEvent;
      if (event.event === 'closed' || event.event === 'failed') this.ended = true;
      return this.actions.event(event);
    }
    const frame = parseFrame(data as ArrayBuffer);
    this.asked = false;
    if (!frame.whole && frame.base !== this.last) {
      this.last = -1;
      return this.want();
    }
    this.last = frame.frame;
    return this.actions.frame(frame);
  }

  private closed(): void {
    if (this.ended) return;
    this.last = -1;
    if (++this.tries > 5) {
      this.ended = true;
      return this.actions.lost();
    }
    setTimeout(() => this.connect(), 500 * this.tries);
  }
}
