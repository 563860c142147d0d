// Mouse and touch on the canvas: turn, shift, zoom, click and hover.
import type {Stage} from './stage.ts';

export interface PointerActions {
  click(x: number, y: number, add: boolean): void;
  doubleClick(x: number, y: number): void;
  hover(x: number, y: number): void;
  leave(): void;
}

// A press that moves less is a click.
const clickPixels = 5;

interface Touch {
  x: number;
  y: number;
}

export class Pointer {
  private readonly touches = new Map<number, Touch>();
  private travelled = 0;
  private hoverTimer = 0;

  constructor(private readonly stage: Stage, private readonly actions: PointerActions) {
    const canvas = stage.canvas;
    canvas.addEventListener('pointerdown', event => this.down(event));
    canvas.addEventListener('pointermove', event => this.move(event));
    canvas.addEventListener('pointerup', event => this.up(event));
    canvas.addEventListener('pointercancel', event => this.touches.delete(event.pointerId));
    canvas.addEventListener('pointerleave', () => this.leave());
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('dblclick', event => actions.doubleClick(event.clientX, event.clientY));
    canvas.addEventListener('wheel', event => this.wheel(event), {passive: false});
  }

  private down(event: PointerEvent): void {
    this.stage.canvas.setPointerCapture(event.pointerId);
    this.stage.canvas.focus({preventScroll: true});
    if (this.touches.size === 0) this.travelled = 0;
    this.touches.set(event.pointerId, {x: event.clientX, y: event.clientY});
    this.leave();
  }

  private move(event: PointerEvent): void {
    const touch = this.touches.get(event.pointerId);
    if (!touch) return this.delayHover(event);
    const [dx, dy] = [event.clientX - touch.x, event.clientY - touch.y];
    this.travelled += Math.abs(dx) + Math.abs(dy);
    if (this.travelled < clickPixels) return;
    if (this.touches.size === 2) this.pinch(event, touch, dx, dy);
    else if (event.shiftKey || event.ctrlKey || event.buttons & 6) this.shift(dx, dy);
    else this.stage.camera.rotate(-0.006 * dx, 0.006 * dy);
    touch.x = event.clientX;
    touch.y = event.clientY;
    this.stage.moved();
  }

  private up(event: PointerEvent): void {
    const known = this.touches.delete(event.pointerId);
    if (known && this.travelled < clickPixels && event.button === 0) {
      this.actions.click(event.clientX, event.clientY, event.shiftKey || event.ctrlKey || event.metaKey);
    }
  }

  private shift(dx: number, dy: number): void {
    const height = this.stage.canvas.clientHeight;
    this.stage.camera.move(-dx / height, dy / height, 0);
  }

  // Two fingers: their distance zooms, and their middle shifts.
  private pinch(event: PointerEvent, touch: Touch, dx: number, dy: number): void {
    const other = [...this.touches.entries()].find(([id]) => id !== event.pointerId)![1];
    const before = Math.hypot(touch.x - other.x, touch.y - other.y);
    const after = Math.hypot(event.clientX - other.x, event.clientY - other.y);
    if (before > 0 && after > 0) this.stage.camera.zoom(before / after);
    this.shift(0.5 * dx, 0.5 * dy);
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 20 : 1;
    const change = Math.max(-200, Math.min(200, event.deltaY * lines));
    this.stage.camera.zoom(Math.exp(0.0016 * change), this.stage.toClip(event.clientX, event.clientY));
    this.stage.moved();
  }

  private delayHover(event: PointerEvent): void {
    clearTimeout(this.hoverTimer);
    this.hoverTimer = window.setTimeout(() => this.actions.hover(event.clientX, event.clientY), 60);
  }

  private leave(): void {
    clearTimeout(this.hoverTimer);
    this.actions.leave();
  }
}
