// Draws boxes, block by block: invisible blocks are left out, and boxes of few pixels are drawn as points.
import * as THREE from 'three';
import {facesMaterial, pointsMaterial, type SharedUniforms} from './box_material.ts';
import {blockRows, BoxTexture} from './box_texture.ts';
import {Pass, passOf, setBlending} from './draw_pass.ts';

export interface Scale {
  pixelsPerUnit: number;
  // The part of each block that is drawn while the camera moves.
  share: number;
  // Where ghosts are drawn.
  ghosts: THREE.Sphere;
}

interface Block {
  start: number;
  count: number;
  visible: number;
  // The number of rows in each pass.
  inPass: number[];
  box: THREE.Box3;
}

export class BoxLayer {
  readonly group = new THREE.Group();
  drawn = 0;
  // Null: solid boxes. Otherwise their edges, and their faces with this opacity.
  fill: number | null = null;
  // Boxes below this size are points.
  pointPixels = 3;
  rows = 0;
  blocks: Block[] = [];
  // Slots are the rows of a block in the order of their size, largest first.
  rowOfSlot = new Uint32Array(0);
  private sizes = new Float32Array(0);
  private texture: BoxTexture | null = null;
  private faces: THREE.Mesh | null = null;
  private points: THREE.Points | null = null;

  constructor(private readonly shared: SharedUniforms) {}

  // Takes the boxes of all rows. `sort` is false if boxes only moved: then the order of the slots is kept.
  setBoxes(boxes: Float32Array, rows: number, sort = true): void {
    if (!this.texture || this.texture.capacity < rows) this.allocate(rows);
    if (sort || rows !== this.rows || this.hasGrown(boxes)) this.arrange(boxes, rows);
    this.rows = rows;
    const data = this.texture!.boundsData;
    for (let slot = 0; slot < rows; ++slot) {
      const row = 6 * this.rowOfSlot[slot]!;
      const to = 6 * slot;
      if (Number.isNaN(boxes[row]!)) data.fill(0, to, to + 6);
      else for (let k = 0; k < 6; ++k) data[to + k] = boxes[row + k]!;
    }
    this.texture!.bounds.needsUpdate = true;
    for (const block of this.blocks) this.bound(block, boxes);
  }

  setColours(colours: Uint8Array): void {
    if (!this.texture) return;
    const from = new Uint32Array(colours.buffer, colours.byteOffset, this.rows);
    const to = new Uint32Array(this.texture.colourData.buffer);
    for (const block of this.blocks) {
      block.visible = 0;
      block.inPass.fill(0);
      for (let slot = block.start; slot < block.start + block.count; ++slot) {
        const row = this.rowOfSlot[slot]!;
        to[slot] = from[row]!;
        const pass = passOf(colours[4 * row + 3]!);
        if (pass < 0) continue;
        block.visible += 1;
        block.inPass[pass]! += 1;
      }
    }
    this.texture.colours.needsUpdate = true;
  }

  setOutline(fill: number | null): void {
    this.fill = fill;
    if (!this.faces) return;
    const material = (this.faces.material as THREE.RawShaderMaterial[])[0]!;
    material.uniforms.fill!.value = fill ?? -1;
    material.uniforms.faces!.value = fill === null ? 3 : 6;
  }

  // Chooses what to draw in a pass.
  choose(frustum: THREE.Frustum, eye: THREE.Vector3, {pixelsPerUnit, share, ghosts}: Scale, pass: number): void {
    this.drawn = 0;
    if (!this.faces || !this.points) return;
    const material = (this.faces.material as THREE.RawShaderMaterial[])[0]!;
    setBlending(material, pass !== Pass.solid || (this.fill !== null && this.fill > 0));
    const perBox = 6 * (material.uniforms.faces!.value as number);
    this.faces.geometry.clearGroups();
    this.points.geometry.clearGroups();
    for (const block of this.blocks) {
      const rows = block.inPass[pass]!;
      if (!rows || !frustum.intersectsBox(block.box) || (pass === Pass.ghost && !ghosts.intersectsBox(block.box))) continue;
      const least = this.pointPixels * block.box.distanceToPoint(eye) / pixelsPerUnit;
      const large = this.countLarger(block, least);
      const asBoxes = Math.ceil(large * share);
      const asPoints = Math.ceil((block.count - large) * share);
      append(this.faces.geometry, block.start * perBox, asBoxes * perBox);
      append(this.points.geometry, block.start + large, asPoints);
      this.drawn += Math.round(rows * (asBoxes + asPoints) / block.count);
    }
  }

  dispose(): void {
    this.texture?.dispose();
    for (const part of [this.faces, this.points]) part?.geometry.dispose();
    this.group.clear();
  }

  private allocate(rows: number): void {
    this.dispose();
    this.texture = new BoxTexture(rows);
    this.faces = new THREE.Mesh(endless(), [facesMaterial(this.shared, this.texture)]);
    this.points = new THREE.Points(endless(), [pointsMaterial(this.shared, this.texture)]);
    for (const part of [this.faces, this.points]) {
      part.frustumCulled = false;
      this.group.add(part);
    }
  }

  private arrange(boxes: Float32Array, rows: number): void {
    const size = new Float32Array(rows);
    for (let row = 0; row < rows; ++row) {
      size[row] = extent(boxes, row);
    }
    this.rowOfSlot = Uint32Array.from({length: rows}, (_, row) => row);
    this.blocks = [];
    for (let start = 0; start < rows; start += blockRows) {
      const count = Math.min(blockRows, rows - start);
      this.rowOfSlot.subarray(start, start + count).sort((a, b) => size[b]! - size[a]! || a - b);
      this.blocks.push({start, count, visible: count, inPass: [count, 0, 0], box: new THREE.Box3()});
    }
    this.sizes = this.rowOfSlot.length ? Float32Array.from(this.rowOfSlot, row => size[row]!) : size;
  }

  // Whether a box is far larger than its slot says, so that it may not be a point any more.
  private hasGrown(boxes: Float32Array): boolean {
    for (let slot = 0; slot < this.rows; ++slot) if (extent(boxes, this.rowOfSlot[slot]!) > 2 * this.sizes[slot]!) return true;
    return false;
  }

  private bound(block: Block, boxes: Float32Array): void {
    const {min, max} = block.box.makeEmpty();
    for (let row = block.start; row < block.start + block.count; ++row) {
      const k = 6 * row;
      if (Number.isNaN(boxes[k]!)) continue;
      min.set(Math.min(min.x, boxes[k]!), Math.min(min.y, boxes[k + 1]!), Math.min(min.z, boxes[k + 2]!));
      max.set(Math.max(max.x, boxes[k + 3]!), Math.max(max.y, boxes[k + 4]!), Math.max(max.z, boxes[k + 5]!));
    }
  }

  private countLarger(block: Block, least: number): number {
    let low = 0;
    let high = block.count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.sizes[block.start + middle]! >= least) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

// A geometry without attributes: its groups alone say which vertices are drawn.
export function endless(): THREE.BufferGeometry {
  const geometry = new THREE.BufferGeometry();
  geometry.setDrawRange(0, 0x7fffffff);
  return geometry;
}

// The longest edge of a box, 0 if the object does not exist.
function extent(boxes: Float32Array, row: number): number {
  const k = 6 * row;
  const longest = Math.max(boxes[k + 3]! - boxes[k]!, boxes[k + 4]! - boxes[k + 1]!, boxes[k + 5]! - boxes[k + 2]!);
  return Number.isNaN(longest) ? 0 : longest;
}

function append(geometry: THREE.BufferGeometry, start: number, count: number): void {
  if (!count) return;
  const last = geometry.groups[geometry.groups.length - 1];
  if (last && last.start + last.count === start) last.count += count;
  else geometry.addGroup(start, count, 0);
}
