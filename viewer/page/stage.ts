// The canvas with all layers. It draws only on request, and draws less while the camera moves on a slow machine.
import * as THREE from 'three';
import {sharedUniforms} from './box_material.ts';
import {BoxLayer} from './box_layer.ts';
import {Camera} from './camera.ts';
import type {Palette} from './colours.ts';
import {ContactLayer} from './contact_layer.ts';
import {EdgeLayer} from './edge_layer.ts';
import {OctantLayer} from './octant_layer.ts';
import {isSoftware, Pace} from './pace.ts';
import {PairLayer} from './pair_layer.ts';
import type {Values} from './settings.ts';
import {ShapeLayer} from './shape_layer.ts';
import type {Point} from './types.ts';

const restMilliseconds = 180;

export class Stage {
  readonly camera = new Camera();
  readonly shared = sharedUniforms();
  readonly boxes = new BoxLayer(this.shared);
  readonly near = new BoxLayer(this.shared);
  readonly shapes = new ShapeLayer(this.shared);
  readonly octants = new OctantLayer(this.shared);
  readonly pairs = new PairLayer(this.shared);
  readonly contacts = new ContactLayer(this.shared);
  readonly outlines = new EdgeLayer(this.shared, false);
  readonly cut = new THREE.Box3();
  // Boxes are drawn as outlines, since they only surround what is known of their objects.
  hollow = false;
  drawn = 0;
  private readonly scene = new THREE.Scene();
  private readonly renderer: THREE.WebGLRenderer;
  private readonly drawListeners: (() => void)[] = [];
  private readonly restListeners: (() => void)[] = [];
  private pending = false;
  private restTimer = 0;
  private lastMove = 0;
  private again = false;
  private partial = false;
  private readonly pace: Pace;

  readonly canvas: HTMLCanvasElement;

  constructor(canvas: HTMLCanvasElement) {
    const {renderer, software} = createRenderer(canvas);
    this.renderer = renderer;
    this.canvas = renderer.domElement;
    this.renderer.sortObjects = false;
    this.pace = new Pace(this.renderer.getContext() as WebGL2RenderingContext, () => this.again && this.invalidate());
    for (const layer of [this.boxes, this.near]) layer.pointPixels = software ? 6 : 3;
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    for (const part of [this.boxes, this.near, this.shapes, this.octants.edges, this.pairs.lines, this.outlines, this.contacts.arrows,
      this.contacts.points]) this.scene.add(part.group);
    new ResizeObserver(() => this.resize()).observe(this.canvas.parentElement!);
    this.resize();
    // The shaders are compiled while the data come.
    this.boxes.setBoxes(new Float32Array(6), 1);
    this.renderer.compile(this.scene, this.camera.three);
    this.boxes.setBoxes(new Float32Array(0), 0);
  }

  onDraw(listener: () => void): void {
    this.drawListeners.push(listener);
  }

  // Called when the camera has not moved for a moment.
  onRest(listener: () => void): void {
    this.restListeners.push(listener);
  }

  invalidate(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      if (!this.pending) return;
      this.pending = false;
      this.again = this.pace.busy;
      if (!this.again) this.draw();
    });
  }

  // The camera moves: pictures may be partial until it rests.
  moved(): void {
    this.lastMove = performance.now();
    clearTimeout(this.restTimer);
    this.restTimer = window.setTimeout(() => this.rest(), restMilliseconds);
    this.invalidate();
  }

  setTheme(palette: Palette): void {
    const [r, g, b] = palette.background;
    this.renderer.setClearColor(new THREE.Color().setRGB(r / 255, g / 255, b / 255, THREE.LinearSRGBColorSpace));
    this.shared.edgeColour.value.set(palette.edge[0] / 255, palette.edge[1] / 255, palette.edge[2] / 255);
    this.invalidate();
  }

  // Takes over the settings that only change how the layers are drawn.
  apply(values: Values, min: Point, max: Point): void {
    const withShapes = this.shapes.shapes.size > 0;
    this.shapes.group.visible = values.style !== 'boxes';
    this.boxes.setOutline(this.hollow ? values.others : values.style === 'both' && withShapes ? 0 : null);
    this.shared.edges.value = values.edges ? 1 : 0;
    this.camera.fly = values.camera === 'fly';
    this.camera.up = values.up;
    const isUpZ = values.up === 'z';
    this.shared.shadeHigh.value.set(0.86, isUpZ ? 0.78 : 1, isUpZ ? 1 : 0.78);
    this.shared.shadeLow.value.set(0.8, isUpZ ? 0.72 : 0.62, isUpZ ? 0.62 : 0.72);
    this.applyCut(values, min, max);
    this.invalidate();
  }

  ray(clientX: number, clientY: number): THREE.Ray {
    const [x, y] = this.toClip(clientX, clientY);
    const caster = new THREE.Raycaster();
    this.camera.place();
    caster.setFromCamera(new THREE.Vector2(x, y), this.camera.three);
    return caster.ray;
  }

  // From pixels of the page to -1 to 1 on the canvas.
  toClip(clientX: number, clientY: number): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    return [2 * (clientX - box.left) / box.width - 1, 1 - 2 * (clientY - box.top) / box.height];
  }

  // From a relative point to pixels of the page, and whether it is in front of the camera.
  project(point: THREE.Vector3): {x: number; y: number; front: boolean} {
    const box = this.canvas.getBoundingClientRect();
    this.camera.place();
    const at = point.clone().project(this.camera.three);
    return {x: box.left + 0.5 * (at.x + 1) * box.width, y: box.top + 0.5 * (1 - at.y) * box.height, front: at.z < 1};
  }

  // Pixels for a unit of length at distance 1.
  pixelsPerUnit(): number {
    return this.canvas.height / (2 * Math.tan(THREE.MathUtils.degToRad(this.camera.three.fov / 2)));
  }

  // Draws all at once, and waits until the picture is done.
  drawNow(): void {
    this.pending = false;
    this.lastMove = 0;
    this.draw();
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  // The colour of a pixel of the page, from a picture that is drawn now.
  pixel(clientX: number, clientY: number): [number, number, number] {
    this.draw();
    const gl = this.renderer.getContext();
    const [x, y] = this.toClip(clientX, clientY);
    const out = new Uint8Array(4);
    gl.readPixels(Math.floor(0.5 * (x + 1) * this.canvas.width), Math.floor(0.5 * (y + 1) * this.canvas.height), 1, 1, gl.RGBA,
      gl.UNSIGNED_BYTE, out);
    return [out[0]!, out[1]!, out[2]!];
  }

  private draw(): void {
    this.again = false;
    this.camera.place();
    const camera = this.camera.three;
    const pixels = this.pixelsPerUnit();
    this.shared.eye.value.copy(camera.position);
    this.shared.middle.value.copy(this.camera.sceneMiddle);
    this.shared.radius.value = this.camera.radius();
    this.shared.gridStep.value = 10 ** Math.floor(Math.log10(0.4 * this.camera.radius()));
    this.shared.scale.value = pixels;
    this.shared.smallest.value = 2 * this.renderer.getPixelRatio();
    const frustum = new THREE.Frustum().setFromProjectionMatrix(
      new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    const share = performance.now() - this.lastMove < restMilliseconds ? this.pace.share : 1;
    this.partial = share < 1;
    this.drawn = 0;
    this.shapes.choose(share);
    for (const layer of [this.boxes, this.near]) {
      layer.choose(frustum, camera.position, pixels, share);
      this.drawn += layer.drawn;
    }
    if (this.shapes.group.visible && this.boxes.fill === null) this.drawn += this.shapes.visible;
    this.renderer.render(this.scene, camera);
    this.pace.drew(share);
    for (const listener of this.drawListeners) listener();
  }

  private rest(): void {
    this.lastMove = 0;
    if (this.partial) this.invalidate();
    for (const listener of this.restListeners) listener();
  }

  private applyCut(values: Values, min: Point, max: Point): void {
    const far = 3e38;
    this.cut.min.set(-far, -far, -far);
    this.cut.max.set(far, far, far);
    if (values.section !== 'none') {
      const axis = 'xyz'.indexOf(values.section);
      const at = min[axis]! + values.cut * (max[axis]! - min[axis]!);
      (values.flip ? this.cut.min : this.cut.max).setComponent(axis, at);
    }
    this.shared.cutLow.value.copy(this.cut.min);
    this.shared.cutHigh.value.copy(this.cut.max);
  }

  // The width of a panel that lies on the left of a wide canvas.
  private covered(): number {
    const panel = document.getElementById('options');
    const {clientWidth} = this.canvas.parentElement!;
    return panel && panel.offsetParent && clientWidth > 700 ? panel.offsetLeft + panel.offsetWidth : 0;
  }

  // The height of a drawer that lies on the lower part of a narrow canvas.
  private below(): number {
    const box = this.canvas.parentElement!.getBoundingClientRect();
    if (box.width > 700) return 0;
    const heights = ['options', 'side'].map(id => document.getElementById(id)).filter(panel => panel && getComputedStyle(panel).display !== 'none')
      .map(panel => box.bottom - Math.max(panel!.getBoundingClientRect().top, box.top));
    return Math.min(Math.max(0, ...heights), 0.7 * box.height);
  }

  resize(): void {
    const {clientWidth, clientHeight} = this.canvas.parentElement!;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.resize(clientWidth, clientHeight, this.covered(), this.below());
    this.invalidate();
  }
}

// Creates the renderer. Only a graphics card smooths edges, because the processor is too slow for that. Without a card, a context
// takes up to 0.2 s, so only a card gets a second one.
function createRenderer(canvas: HTMLCanvasElement): {renderer: THREE.WebGLRenderer; software: boolean} {
  const attributes = {alpha: true, depth: true, stencil: false, antialias: false, powerPreference: 'high-performance'} as const;
  const context = canvas.getContext('webgl2', attributes) as WebGL2RenderingContext | null;
  if (context && isSoftware(context)) return {renderer: new THREE.WebGLRenderer({canvas, context}), software: true};
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  const other = canvas.cloneNode(false) as HTMLCanvasElement;
  canvas.replaceWith(other);
  return {renderer: new THREE.WebGLRenderer({canvas: other, antialias: true, powerPreference: 'high-performance'}), software: false};
}
