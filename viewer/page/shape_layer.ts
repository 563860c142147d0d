// Draws the shapes of the objects: one mesh for each shape, with an instance for each row that has it.
import * as THREE from 'three';
import {type SharedUniforms} from './box_material.ts';
import {screenDoor} from './box_texture.ts';
import type {SceneModel} from './scene_model.ts';
import type {Source} from './source.ts';

const vertexShader = `
precision highp float;
uniform mat4 projectionMatrix;
uniform mat4 viewMatrix;
in vec3 position;
in vec3 poseX;
in vec3 poseY;
in vec3 poseZ;
in vec3 poseAt;
in vec4 tintOfRow;
flat out vec4 tint;
out vec3 world;
void main() {
  tint = tintOfRow;
  world = poseX * position.x + poseY * position.y + poseZ * position.z + poseAt;
  gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
  if (tint.a == 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}
`;

const fragmentShader = `
precision highp float;
precision highp int;
uniform vec3 eye;
uniform vec3 cutLow;
uniform vec3 cutHigh;
uniform vec3 shadeLow;
uniform vec3 shadeHigh;
flat in vec4 tint;
in vec3 world;
out vec4 colour;
${screenDoor}
void main() {
  if (any(lessThan(world, cutLow)) || any(greaterThan(world, cutHigh))) discard;
  screenDoor(tint.a);
  vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
  normal = faceforward(normal, world - eye, normal);
  vec3 weight = normal * normal;
  vec3 shade = mix(shadeLow, shadeHigh, step(0.0, normal));
  colour = vec4(tint.rgb * dot(weight, shade), 1.0);
}
`;

export interface Shape {
  vertices: Float32Array;
  triangles: Uint32Array;
}

interface Part {
  rows: Uint32Array;
  mesh: THREE.Mesh;
  poses: THREE.InstancedInterleavedBuffer;
  tints: THREE.InstancedBufferAttribute;
}

export const shapeLimit = 4000;
export const triangleLimit = 4_000_000;

export class ShapeLayer {
  readonly group = new THREE.Group();
  readonly shapes = new Map<number, Shape>();
  leftOut = 0;
  // Instances that are not hidden.
  visible = 0;
  private readonly parts: Part[] = [];
  private readonly material: THREE.RawShaderMaterial;
  private poses: Float32Array | null = null;
  private colours: Uint8Array = new Uint8Array(0);

  constructor(shared: SharedUniforms) {
    this.material = new THREE.RawShaderMaterial({glslVersion: THREE.GLSL3, vertexShader, fragmentShader, side: THREE.DoubleSide, uniforms: shared});
  }

  // Reads all shapes that rows have, as far as the limits allow, and calls `arrived` now and then.
  async load(source: Source, model: SceneModel, arrived: (done: number) => void): Promise<void> {
    const {shapes} = await source.json<{shapes: {vertices: number; triangles: number}[]}>('shapes.json');
    const rows = rowsByShape(model.geometry!);
    let triangles = 0;
    const wanted = [...rows.keys()].sort((a, b) => a - b).filter(k => {
      triangles += (shapes[k]?.triangles ?? 0) * rows.get(k)!.length;
      return k < shapes.length && triangles <= triangleLimit;
    }).slice(0, shapeLimit);
    this.leftOut = rows.size - wanted.length;
    let next = 0;
    const reader = async (): Promise<void> => {
      while (next < wanted.length) {
        const k = wanted[next++]!;
        this.add(k, shapes[k]!.vertices, await source.bytes(`shape/${k}`), Uint32Array.from(rows.get(k)!));
        if (next % 20 === 0) arrived(next / wanted.length);
      }
    };
    await Promise.all(Array.from({length: 6}, reader));
    arrived(1);
  }

  // Draws a share of the instances while the camera moves. Shapes with one instance are drawn or left out as a whole.
  choose(share: number): void {
    this.parts.forEach((part, k) => {
      const count = share === 1 ? part.rows.length : Math.floor(part.rows.length * share + 0.618 * k % 1);
      part.mesh.visible = count > 0;
      (part.mesh.geometry as THREE.InstancedBufferGeometry).instanceCount = count;
    });
  }

  setPoses(poses: Float32Array | null): void {
    this.poses = poses;
    for (const part of this.parts) this.place(part);
  }

  setColours(colours: Uint8Array): void {
    this.colours = colours;
    this.visible = 0;
    for (const part of this.parts) this.tint(part);
  }

  private add(k: number, vertexCount: number, bytes: ArrayBuffer, rows: Uint32Array): void {
    const shape = {vertices: new Float32Array(bytes, 0, 3 * vertexCount), triangles: new Uint32Array(bytes, 12 * vertexCount)};
    this.shapes.set(k, shape);
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(shape.vertices, 3));
    geometry.setIndex(new THREE.BufferAttribute(shape.triangles, 1));
    geometry.instanceCount = rows.length;
    const poses = new THREE.InstancedInterleavedBuffer(new Float32Array(12 * rows.length), 12);
    ['poseX', 'poseY', 'poseZ', 'poseAt'].forEach((name, at) => geometry.setAttribute(name, new THREE.InterleavedBufferAttribute(poses, 3, 3 * at)));
    const tints = new THREE.InstancedBufferAttribute(new Uint8Array(4 * rows.length), 4, true);
    geometry.setAttribute('tintOfRow', tints);
    const mesh = new THREE.Mesh(geometry, this.material);
    mesh.frustumCulled = false;
    const part = {rows, mesh, poses, tints};
    this.parts.push(part);
    this.group.add(mesh);
    this.place(part);
    this.tint(part);
  }

  private place(part: Part): void {
    if (!this.poses) return;
    part.rows.forEach((row, k) => (part.poses.array as Float32Array).set(this.poses!.subarray(12 * row, 12 * row + 12), 12 * k));
    part.poses.needsUpdate = true;
  }

  private tint(part: Part): void {
    if (!this.colours.length) return;
    part.rows.forEach((row, k) => {
      (part.tints.array as Uint8Array).set(this.colours.subarray(4 * row, 4 * row + 4), 4 * k);
      if (this.colours[4 * row + 3]) this.visible += 1;
    });
    part.tints.needsUpdate = true;
  }
}

function rowsByShape(geometry: Uint32Array): Map<number, number[]> {
  const rows = new Map<number, number[]>();
  geometry.forEach((shape, row) => {
    if (shape === 0xffffffff) return;
    const list = rows.get(shape);
    if (list) list.push(row);
    else rows.set(shape, [row]);
  });
  return rows;
}
