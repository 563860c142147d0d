// The small picture of the whole scene that says where the selected pair and the other worst collisions are. A click zooms to all objects.
import type * as THREE from 'three';
import {type Colour, css} from './colours.ts';
import {byId, later} from './dom.ts';
import type {Focus} from './focus.ts';
import type {Stage} from './stage.ts';

export interface Place {
  focus: Focus;
  // The places of other collisions.
  others: readonly THREE.Vector3[];
  view: {yaw: number; pitch: number};
  colour: Colour;
}

export class Overview {
  private readonly drawSoon = later(() => this.draw(), 200);
  private readonly host = byId('overview');
  private readonly canvas = byId<HTMLCanvasElement>('overview-canvas');

  constructor(private readonly stage: Stage, private readonly place: () => Place | null, zoomAll: () => void) {
    this.host.addEventListener('click', zoomAll);
  }

  // Draws soon, but not for each frame of a scene that plays.
  changed(): void {
    if (!this.place()) this.host.hidden = true;
    this.drawSoon();
  }

  draw(): void {
    const place = this.place();
    this.host.hidden = place === null;
    if (!place) return;
    const [[x, y], ...others] = this.stage.drawOverview(this.canvas, {yaw: place.view.yaw, pitch: 0.5}, [place.focus.mark, ...place.others]) as
      [[number, number], ...[number, number][]];
    const context = this.canvas.getContext('2d')!;
    const ratio = this.canvas.width / this.canvas.clientWidth;
    context.fillStyle = css(place.colour);
    for (const [left, top] of others) {
      context.beginPath();
      context.arc(left, top, 1.7 * ratio, 0, 2 * Math.PI);
      context.fill();
    }
    for (const [width, colour] of [[4.5, 'white'], [2.5, css(place.colour)]] as const) {
      context.beginPath();
      context.arc(x, y, 9 * ratio, 0, 2 * Math.PI);
      context.lineWidth = width * ratio;
      context.strokeStyle = colour;
      context.stroke();
    }
    this.stage.invalidate();
  }
}
