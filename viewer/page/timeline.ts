// The plot of pairs, began and ended over the frames, and the controls that step and play.
import uPlot from 'uplot';
import {byId, count, seconds} from './dom.ts';
import type {Timeline as Numbers} from './types.ts';

export interface TimelineActions {
  go(frame: number): Promise<void>;
  pause(paused: boolean): void;
  failed(error: unknown): void;
}

const livePoints = 5000;
// The steps between the numbers of the axis, since frames are whole numbers.
const frameSteps = [1, 10, 100, 1e3, 1e4, 1e5, 1e6].flatMap(k => [k, 2 * k, 5 * k]);

export class Timeline {
  playing = false;
  paused = false;
  frame = 0;
  // The frame that was asked for last. It differs from `frame` while frames are read.
  private wanted = 0;
  private reading: Promise<void> | null = null;
  // Frames that can be shown: all, until the program says how many it has computed.
  done = 0;
  private plot: uPlot | null = null;
  // Frames, pairs, began, ended. In the first frame all pairs are new, so it has no events to compare with those of others.
  private data: [number[], number[], (number | null)[], (number | null)[]] = [[], [], [], []];
  private runs = 0;
  private readonly slider = byId<HTMLInputElement>('frame-slider');
  private readonly play = byId<HTMLButtonElement>('play');

  constructor(private readonly live: boolean, private readonly frames: number, private readonly actions: TimelineActions) {
    byId('time').hidden = false;
    this.done = frames;
    this.slider.max = String(Math.max(0, frames - 1));
    this.play.addEventListener('click', () => this.toggle());
    byId('step-back').addEventListener('click', () => this.step(-1));
    byId('step-forward').addEventListener('click', () => this.step(1));
    this.slider.addEventListener('input', () => void this.go(Number(this.slider.value)));
    for (const id of ['step-back', 'step-forward', 'frame-slider', 'speed-label']) byId(id).hidden = live;
    this.label();
    this.tellReading();
    new ResizeObserver(() => this.draw()).observe(byId('plot'));
  }

  setNumbers(numbers: Numbers): void {
    this.done = numbers.done;
    const column = (values: number[] = []): number[] => values.slice(0, numbers.done);
    const events = (values: number[] = []): (number | null)[] => column(values).map((value, k) => k === 0 ? null : value);
    this.data = [Array.from({length: numbers.done}, (_, k) => k), column(numbers.pairs), events(numbers.began), events(numbers.ended)];
    this.slider.max = String(Math.max(0, numbers.done - 1));
    this.draw();
    this.show(this.frame);
  }

  // Adds the numbers of a live frame.
  append(frame: number, pairs: number, began: number, ended: number, stepSeconds: number): void {
    const first = this.data[0].length === 0;
    [frame, pairs, first ? null : began, first ? null : ended].forEach((value, k) => (this.data[k] as (number | null)[]).push(value));
    if (this.data[0].length > livePoints) this.data = this.data.map(column => column.filter((_, k) => k % 2 === 0)) as typeof this.data;
    this.frame = frame;
    byId('frame-text').textContent = `frame ${count(frame)}, step ${seconds(stepSeconds)}`;
    this.draw();
  }

  // The ranges of the plot, for tests.
  ranges(): Record<string, [number, number]> {
    const of = (name: string): [number, number] => [this.plot?.scales[name]?.min ?? NaN, this.plot?.scales[name]?.max ?? NaN];
    return {pairs: of('pairs'), events: of('events')};
  }

  setTheme(): void {
    this.plot?.destroy();
    this.plot = null;
    this.draw();
  }

  show(frame: number): void {
    this.frame = frame;
    if (!this.reading) this.wanted = frame;
    this.slider.value = String(this.wanted);
    const waiting = this.done < this.frames ? `, ${count(this.done)} computed` : '';
    if (!this.live) byId('frame-text').textContent = `frame ${count(frame)} of ${count(this.frames)}${waiting}`;
    this.plot?.redraw(false);
  }

  step(by: number): void {
    if (!this.live) void this.go(this.wanted + by);
  }

  toggle(): void {
    if (this.live) {
      this.paused = !this.paused;
      this.actions.pause(this.paused);
    } else {
      this.playing = !this.playing;
      if (this.playing) void this.run();
    }
    this.label();
  }

  private label(): void {
    const runs = this.live ? !this.paused : this.playing;
    this.play.textContent = runs ? 'Pause' : 'Play';
  }

  // Shows a frame after the one that is being read. Of the frames that were asked for meanwhile, only the last is read.
  private go(frame: number): Promise<void> {
    if (!Number.isFinite(frame)) return Promise.resolve();
    this.wanted = Math.min(Math.max(frame, 0), Math.max(this.done - 1, 0));
    this.slider.value = String(this.wanted);
    this.reading ??= this.readWanted().finally(() => {
      this.reading = null;
      this.show(this.frame);
      this.tellReading();
    });
    this.tellReading();
    return this.reading;
  }

  private async readWanted(): Promise<void> {
    try {
      while (this.wanted !== this.frame) await this.actions.go(this.wanted);
    } catch (error) {
      this.playing = false;
      this.label();
      this.actions.failed(error);
    }
  }

  // Tests wait until the shown frame is final.
  private tellReading(): void {
    document.documentElement.dataset.reading = String(this.reading !== null);
  }

  private async run(): Promise<void> {
    const run = ++this.runs;
    while (this.playing && run === this.runs) {
      const began = performance.now();
      const next = this.wanted + 1 >= this.done ? 0 : this.wanted + 1;
      if (next === 0 && this.done < this.frames) await pause(300);
      else await this.go(next);
      const interval = 1000 / Number(byId<HTMLSelectElement>('speed').value);
      await pause(Math.max(5, interval - (performance.now() - began)));
    }
  }

  private draw(): void {
    const host = byId('plot');
    const [width, height] = [host.clientWidth, host.clientHeight];
    if (width < 40 || height < 30 || this.data[0].length === 0) return;
    if (!this.plot) this.plot = this.makePlot(host, width, height);
    else {
      if (this.plot.width !== width || this.plot.height !== height) this.plot.setSize({width, height});
      this.plot.setData(this.data);
    }
  }

  private makePlot(host: HTMLElement, width: number, height: number): uPlot {
    const style = getComputedStyle(document.documentElement);
    const of = (name: string): string => style.getPropertyValue(name).trim();
    const axis = {stroke: of('--muted'), grid: {stroke: of('--line'), width: 1}, ticks: {show: false}, font: '11px system-ui, sans-serif'};
    const texts = (_: uPlot, ticks: number[]): string[] => ticks.map(tick => Number.isInteger(tick) ? shortTick(tick) : '');
    const numbers = {...axis, size: 52, space: 22, values: texts};
    const series = (label: string, name: string, scale: string): uPlot.Series =>
      ({label, scale, stroke: of(name), width: 1.5, points: {show: false}});
    const plot = new uPlot({
      width, height, legend: {show: false},
      // Few of many pairs begin or end in a frame, so events have a scale of their own.
      scales: {x: {time: false}, pairs: {range: (_, low, high) => pairRange(low, high)},
        events: {range: (_, __, high) => [0, Math.max(1, 1.1 * (high ?? 0))]}},
      axes: [{...axis, size: 22, space: 60, incrs: frameSteps}, {...numbers, scale: 'pairs', stroke: of('--pairs')},
        {...numbers, scale: 'events', side: 1, grid: {show: false}, stroke: of('--began')}],
      series: [{label: 'frame'}, series('pairs', '--pairs', 'pairs'), series('began', '--began', 'events'), series('ended', '--ended', 'events')],
      cursor: {points: {show: false}, drag: {x: false, y: false}, y: false},
      hooks: {draw: [u => this.drawMark(u, of('--accent'))]},
    }, this.data, host);
    plot.over.addEventListener('click', event => {
      const box = plot.over.getBoundingClientRect();
      if (!this.live) void this.go(Math.round(plot.posToVal(event.clientX - box.left, 'x')));
    });
    return plot;
  }

  // A line at the present frame.
  private drawMark(plot: uPlot, colour: string): void {
    const x = Math.round(plot.valToPos(this.frame, 'x', true));
    const {ctx, bbox} = plot;
    ctx.save();
    ctx.fillStyle = colour;
    ctx.fillRect(x - 1, bbox.top, 2, bbox.height);
    ctx.restore();
  }
}

// From the least to the largest number of pairs. A change of less than a tenth is not made larger than it is.
function pairRange(low: number | null, high: number | null): [number, number] {
  const [least, most] = [low ?? 0, high ?? 1];
  const spread = Math.max(most - least, 0.1 * most, 1);
  const middle = 0.5 * (least + most);
  const bottom = Math.max(0, middle - 0.6 * spread);
  return [bottom, bottom + 1.2 * spread];
}

function shortTick(value: number): string {
  if (value >= 1e6) return `${value / 1e6}M`;
  return value >= 1e4 ? `${value / 1e3}k` : String(value);
}

function pause(milliseconds: number): Promise<void> {
  return new Promise(done => setTimeout(done, milliseconds));
}
