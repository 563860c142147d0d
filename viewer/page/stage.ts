// The canvas with all layers. It draws only on request, and draws less while the camera moves on a slow machine.
import * as THREE from 'three';
import {sharedUniforms} from './box_material.ts';
import {BoxLayer, type Scale} from './box_layer.ts';
import {Camera} from './camera.ts';
import {CapLayer, type Cut} from './cap_layer.ts';
import type {Palette} from './colours.ts';
import {ContactLayer} from './contact_layer.ts';
import {Pass} from './draw_pass.ts';
import {EdgeLayer} from './edge_layer.ts';
import {OctantLayer} from './octant_layer.ts';
import {isSoftware, Pace} from './pace.ts';
import {PairLayer} from './pair_layer.ts';
import type {Values} from './settings.ts';
import {ShapeLayer} from './shape_layer.ts';
import type {Point} from './types.ts';

const restMilliseconds = 180;

// A section across an axis, at a coordinate. `high`: the part with the higher coordinates is cut off.
export interface ContactCut {
  axis: number;
  at: number;
  reach: number;
  high: boolean;
}

export class Stage {
  readonly camera = new Camera();
  readonly shared = sharedUniforms();
  readonly boxes = new BoxLayer(this.shared);
  readonly near = new BoxLayer(this.shared);
  readonly shapes = new ShapeLayer(this.shared);
  readonly octants = new OctantLayer(this.shared);
  readonly pairs = new PairLayer(this.shared);
  readonly contacts = new ContactLayer(this.shared);
  readonly caps = new CapLayer(this.shared);
  readonly outlines = new EdgeLayer(this.shared, false);
  readonly cut = new THREE.Box3();
  // Boxes are drawn as outlines, since they only surround what is known of their objects.
  hollow = false;
  // Whether some rows are drawn as ghosts, and some as glass.
  ghosts = false;
  glass = false;
  // The section through the contact of the selection, or null.
  contactCut: ContactCut | null = null;
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
  private withShapes = false;
  private readonly overlays: readonly {group: THREE.Group}[];

  readonly canvas: HTMLCanvasElement;

  constructor(canvas: HTMLCanvasElement) {
    const {renderer, software} = createRenderer(canvas);
    this.renderer = renderer;
    this.canvas = renderer.domElement;
    this.renderer.sortObjects = false;
    this.pace = new Pace(this.renderer.getContext() as WebGL2RenderingContext, () => this.again && this.invalidate());
    for (const layer of [this.boxes, this.near]) layer.pointPixels = software ? 6 : 3;
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.renderer.autoClear = false;
    this.overlays = [this.caps, this.octants.edges, this.pairs.lines, this.outlines, this.contacts.lines, this.contacts.points];
    for (const part of [this.boxes, this.near, this.shapes, ...this.overlays]) this.scene.add(part.group);
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
    this.shared.background.value.set(r / 255, g / 255, b / 255);
    this.shared.edgeColour.value.set(palette.edge[0] / 255, palette.edge[1] / 255, palette.edge[2] / 255);
    this.invalidate();
  }

  // Takes over the settings that only change how the layers are drawn.
  apply(values: Values, min: Point, max: Point): void {
    const withShapes = this.shapes.shapes.size > 0;
    this.withShapes = values.style !== 'boxes';
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

  // The plane of the present section, or null.
  section(): Cut | null {
    const far = 1e38;
    for (let axis = 0; axis < 3; ++axis) {
      for (const at of [this.cut.min.getComponent(axis), this.cut.max.getComponent(axis)]) if (Math.abs(at) < far) return {axis, at};
    }
    return null;
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

  // The colour of a pixel of the page, from a whole picture that is drawn now. While the camera moves, pictures leave out boxes.
  pixel(clientX: number, clientY: number): [number, number, number] {
    this.lastMove = 0;
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
    this.shared.middle.value.copy(this.camera.sceneMiddle);
    this.shared.radius.value = this.camera.radius();
    this.shared.gridStep.value = 10 ** Math.floor(Math.log10(0.4 * this.camera.radius()));
    this.shared.smallest.value = 2 * this.renderer.getPixelRatio();
    const share = performance.now() - this.lastMove < restMilliseconds ? this.pace.share : 1;
    this.partial = share < 1;
    this.drawPasses(this.camera, {pixelsPerUnit: this.pixelsPerUnit(), share}, true);
    this.pace.drew(share);
    for (const listener of this.drawListeners) listener();
  }

  // Draws the ghosts, then over them what is solid, then glass. The last pass has the lines and marks.
  private drawPasses(view: Camera, size: {pixelsPerUnit: number; share: number}, marks: boolean): void {
    const passes = [...(this.ghosts ? [Pass.ghost] : []), Pass.solid, ...(this.glass ? [Pass.glass] : [])];
    const camera = view.three;
    const frustum = new THREE.Frustum().setFromProjectionMatrix(
      new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    this.shared.eye.value.copy(camera.position);
    const scale: Scale = {...size, ghosts: new THREE.Sphere(view.target, 4 * view.distance)};
    this.shared.scale.value = scale.pixelsPerUnit;
    this.shared.target.value.copy(view.target);
    this.shared.fadeReach.value = scale.ghosts.radius;
    this.drawn = this.withShapes && this.boxes.fill === null ? this.shapes.visible : 0;
    this.shapes.choose(scale.share);
    this.renderer.clear();
    passes.forEach((pass, k) => {
      for (const layer of [this.boxes, this.near]) {
        layer.choose(frustum, camera.position, scale, pass);
        this.drawn += layer.drawn;
      }
      this.shapes.setPass(pass);
      this.shared.drawPass.value = pass;
      this.shapes.group.visible = this.withShapes;
      for (const part of this.overlays) part.group.visible = marks && k === passes.length - 1;
      this.renderer.render(this.scene, camera);
      if (pass === Pass.ghost) this.renderer.clearDepth();
    });
  }

  // Draws the whole scene small into another canvas, from a direction. Returns where points are there.
  drawOverview(target: HTMLCanvasElement, view: {yaw: number; pitch: number}, points: readonly THREE.Vector3[]): [number, number][] {
    const ratio = this.renderer.getPixelRatio();
    const [width, height] = [Math.min(target.clientWidth, this.canvas.clientWidth), Math.min(target.clientHeight, this.canvas.clientHeight)];
    const camera = this.camera.forOverview(view, width / height);
    this.renderer.setViewport(0, 0, width, height);
    this.renderer.setScissor(0, 0, width, height);
    this.renderer.setScissorTest(true);
    this.drawPasses(camera, {pixelsPerUnit: this.pixelsPerUnit() * height / this.canvas.clientHeight, share: 1}, false);
    this.renderer.setScissorTest(false);
    this.renderer.setViewport(0, 0, this.canvas.clientWidth, this.canvas.clientHeight);
    [target.width, target.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    const size = [target.width, target.height] as const;
    target.getContext('2d')!.drawImage(this.canvas, 0, this.canvas.height - target.height, ...size, 0, 0, ...size);
    return points.map(point => {
      const at = point.clone().project(camera.three);
      return [0.5 * (at.x + 1) * target.width, 0.5 * (1 - at.y) * target.height];
    });
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
    if (values.section === 'contact') {
      if (this.contactCut) this.cutAtContact(this.contactCut, values);
    } else if (values.section !== 'none') {
      const axis = 'xyz'.indexOf(values.section);
      const at = min[axis]! + values.cut * (max[axis]! - min[axis]!);
      (values.flip ? this.cut.min : this.cut.max).setComponent(axis, at);
    }
    this.shared.cutLow.value.copy(this.cut.min);
    this.shared.cutHigh.value.copy(this.cut.max);
  }

  // Cuts in front of the contact, or beside it: the slider moves the section by the size of the contact's surroundings.
  private cutAtContact({axis, at, reach, high}: ContactCut, values: Values): void {
    (values.flip === high ? this.cut.min : this.cut.max).setComponent(axis, at + (2 * values.cut - 1) * reach + (high ? 1e-4 : -1e-4) * reach);
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
  const attributes = {alpha: true, depth: true, stencil: true, antialias: false, powerPreference: 'high-performance'} as const;
  const context = canvas.getContext('webgl2', attributes) as WebGL2RenderingContext | null;
  if (context && isSoftware(context)) return {renderer: new THREE.WebGLRenderer({canvas, context}), software: true};
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  const other = canvas.cloneNode(false) as HTMLCanvasElement;
  canvas.replaceWith(other);
  return {renderer: new THREE.WebGLRenderer({canvas: other, antialias: true, stencil: true, powerPreference: 'high-performance'}), software: false};
}
