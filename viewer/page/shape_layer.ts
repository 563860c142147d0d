// Draws the shapes of the objects: one mesh for each shape, with an instance for each row that has it.
import * as THREE from 'three';
import {type SharedUniforms} from './box_material.ts';
import {screenDoor} from './box_texture.ts';
import {inPass, Pass, passOf, setBlending} from './draw_pass.ts';
import type {SceneModel} from './scene_model.ts';
import {surfaceOf} from './shape_surface.ts';
import type {Source} from './source.ts';

// GLSL that places a vertex by the pose of its instance, and hides instances whose colour is transparent.
const placing = `
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
${inPass}
void place() {
  tint = tintOfRow;
  world = poseX * position.x + poseY * position.y + poseZ * position.z + poseAt;
  gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
  if (!inPass(tint.a)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}
`;

// GLSL that leaves out what the section cuts off.
const cutting = `
precision highp float;
precision highp int;
uniform vec3 eye;
uniform vec3 cutLow;
uniform vec3 cutHigh;
uniform int drawPass;
uniform vec3 target;
uniform float fadeReach;
flat in vec4 tint;
in vec3 world;
out vec4 colour;
${screenDoor}
// How much of a ghost is seen: many in front of each other, far from what the camera looks at, would hide it.
float ghostShare(float reach) {
  return 1.0 - smoothstep(0.1, reach, distance(world, target) / fadeReach);
}
void cutOff() {
  if (any(lessThan(world, cutLow)) || any(greaterThan(world, cutHigh))) discard;
  if (drawPass == 0) screenDoor(tint.a);
}
`;

const vertexShader = `${placing}
in vec3 normal;
out vec3 bent;
void main() {
  place();
  bent = cross(poseY, poseZ) * normal.x + cross(poseZ, poseX) * normal.y + cross(poseX, poseY) * normal.z;
}
`;

// Without normals of the vertices, the normal is that of the flat face.
const fragmentShader = `${cutting}
uniform vec3 shadeLow;
uniform vec3 shadeHigh;
in vec3 bent;
void main() {
  vec3 face = cross(dFdx(world), dFdy(world));
  cutOff();
  vec3 normal = normalize(dot(bent, bent) > 0.0 ? bent : face);
  normal = faceforward(normal, world - eye, normal);
  if (drawPass > 0) {
    // Like glass: faint where the surface faces the eye, and strong at its outline.
    float turned = pow(1.0 - abs(dot(normal, normalize(eye - world))), 2.5);
    colour = drawPass == 1 ? vec4(tint.rgb, (0.04 + 0.18 * turned) * ghostShare(0.8)) : vec4(tint.rgb, 0.1 + 0.5 * turned);
    return;
  }
  vec3 weight = normal * normal;
  vec3 shade = mix(shadeLow, shadeHigh, step(0.0, normal));
  colour = vec4(tint.rgb * dot(weight, shade), 1.0);
}
`;

const edgeVertex = `${placing}
uniform float edges;
void main() {
  place();
  if (edges == 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}
`;

const edgeFragment = `${cutting}
uniform vec3 edgeColour;
void main() {
  cutOff();
  colour = vec4(mix(tint.rgb, edgeColour, 0.4), drawPass == 0 ? 1.0 : drawPass == 1 ? 0.13 * ghostShare(0.32) : 0.1 + 0.3 * ghostShare(0.25));
}
`;

// Planes are endless, so they are drawn as a grid that fades away from the scene. Their own coordinates are x and y.
const planeVertex = `${placing}
in vec2 across;
out vec2 grid;
void main() {
  place();
  grid = across;
}
`;

const planeFragment = `${cutting}
uniform vec3 middle;
uniform float radius;
uniform float gridStep;
uniform vec3 edgeColour;
in vec2 grid;
float lines(float step) {
  vec2 at = grid / step, width = fwidth(at);
  vec2 near = abs(fract(at - 0.5) - 0.5) / max(width, vec2(1e-6));
  return (1.0 - smoothstep(0.3, 1.2, min(near.x, near.y))) * (1.0 - smoothstep(0.15, 0.5, max(width.x, width.y)));
}
void main() {
  float line = max(0.45 * lines(gridStep), 0.8 * lines(10.0 * gridStep));
  cutOff();
  float fade = 1.0 - smoothstep(0.8, 1.45, distance(world, middle) / radius);
  colour = vec4(tint.rgb, fade * (0.1 + 0.5 * line));
}
`;

export interface Shape {
  vertices: Float32Array;
  triangles: Uint32Array;
}

interface Part {
  kind: string;
  shape: Shape;
  // Those of the solid pass, then those of glass, then ghosts, then hidden ones. So a pass draws only the first instances.
  rows: Uint32Array;
  // The faces, and later the edges.
  objects: (THREE.Mesh | THREE.LineSegments)[];
  poses: THREE.InstancedInterleavedBuffer;
  tints: THREE.InstancedBufferAttribute;
  // The number of rows in each pass.
  inPass: number[];
  // The rows up to the last one of each pass.
  upTo: number[];
  // The most instances that a picture draws.
  limit: number;
}

const passOrder = [Pass.solid, Pass.glass, Pass.ghost];
export const shapeLimit = 4000;
export const triangleLimit = 4_000_000;
// Normals and edges of more triangles take too long.
const surfaceLimit = 400_000;
const roundKinds = ['sphere', 'capsule', 'cylinder', 'cone', 'ellipsoid'];

export class ShapeLayer {
  readonly group = new THREE.Group();
  readonly shapes = new Map<number, Shape>();
  leftOut = 0;
  // Instances that are not hidden.
  visible = 0;
  instances = 0;
  private readonly parts: Part[] = [];
  private readonly faces: THREE.RawShaderMaterial;
  private readonly lines: THREE.RawShaderMaterial;
  private readonly planes: THREE.RawShaderMaterial;
  private poses: Float32Array | null = null;
  private colours: Uint8Array = new Uint8Array(0);

  constructor(shared: SharedUniforms) {
    const common = {glslVersion: THREE.GLSL3, side: THREE.DoubleSide, uniforms: shared} as const;
    // Faces are moved back a little, so that the edges on them are in front.
    this.faces = new THREE.RawShaderMaterial({...common, vertexShader, fragmentShader, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1});
    this.lines = new THREE.RawShaderMaterial({...common, vertexShader: edgeVertex, fragmentShader: edgeFragment});
    this.planes = new THREE.RawShaderMaterial({...common, vertexShader: planeVertex, fragmentShader: planeFragment, transparent: true, depthWrite: false});
  }

  // Reads all shapes that rows have, as far as the limits allow, and calls `arrived` now and then.
  async load(source: Source, model: SceneModel, arrived: (done: number) => void): Promise<void> {
    const {shapes} = await source.json<{shapes: {kind: string; vertices: number; triangles: number}[]}>('shapes.json');
    const rows = rowsByShape(model.geometry!);
    let triangles = 0;
    const collides = (k: number): boolean => rows.get(k)!.some(row => model.frame.partners[row]);
    const wanted = [...rows.keys()].sort((a, b) => Number(collides(b)) - Number(collides(a)) || a - b).filter(k => {
      triangles += (shapes[k]?.triangles ?? 0) * rows.get(k)!.length;
      return k < shapes.length && triangles <= triangleLimit;
    }).slice(0, shapeLimit);
    this.leftOut = rows.size - wanted.length;
    let next = 0;
    const reader = async (): Promise<void> => {
      while (next < wanted.length) {
        const k = wanted[next++]!;
        const bytes = await source.bytes(`shape/${k}`);
        const {kind, vertices} = shapes[k]!;
        this.add(k, kind, {vertices: new Float32Array(bytes, 0, 3 * vertices), triangles: new Uint32Array(bytes, 12 * vertices)}, rows.get(k)!);
        if (next % 20 === 0) arrived(next / wanted.length);
      }
    };
    await Promise.all(Array.from({length: 6}, reader));
    arrived(1);
    await this.refine();
    arrived(1);
  }

  // Gives the shapes smooth normals and edges, as far as the limit allows. The page stays responsive.
  private async refine(): Promise<void> {
    let triangles = 0;
    let paused = performance.now();
    for (const part of this.parts) {
      triangles += part.shape.triangles.length / 3;
      if (part.kind === 'plane' || roundKinds.includes(part.kind) || triangles > surfaceLimit) continue;
      this.bend(part);
      if (performance.now() - paused < 30) continue;
      await new Promise(done => setTimeout(done));
      paused = performance.now();
    }
  }

  private bend(part: Part): void {
    const {positions, normals, edges} = surfaceOf(part.shape.vertices, part.shape.triangles);
    const mesh = part.objects[0]!;
    mesh.geometry.dispose();
    mesh.geometry = this.geometry(part, positions);
    mesh.geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3));
    if (!edges.length) return;
    const lines = new THREE.LineSegments(this.geometry(part, edges), this.lines);
    lines.frustumCulled = false;
    part.objects.push(lines);
    this.group.add(lines);
  }

  // Chooses the shapes of a pass.
  setPass(pass: number): void {
    for (const part of this.parts) {
      for (const object of part.objects) (object.geometry as THREE.InstancedBufferGeometry).instanceCount = Math.min(part.upTo[pass]!, part.limit);
    }
    for (const material of [this.faces, this.lines]) setBlending(material, pass !== Pass.solid);
    // Glass with its far side would be too dim.
    this.faces.side = pass === Pass.glass ? THREE.FrontSide : THREE.DoubleSide;
    for (const part of this.parts) for (const object of part.objects) object.visible = part.inPass[pass]! > 0;
  }

  // Draws a share of the instances while the camera moves. Shapes with one instance are drawn or left out as a whole.
  choose(share: number): void {
    this.parts.forEach((part, k) => {
      part.limit = share === 1 ? part.rows.length : Math.floor(part.rows.length * share + 0.618 * k % 1);
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

  private add(k: number, kind: string, shape: Shape, rowList: number[]): void {
    this.shapes.set(k, shape);
    const rows = Uint32Array.from(rowList);
    const poses = new THREE.InstancedInterleavedBuffer(new Float32Array(12 * rows.length), 12);
    const tints = new THREE.InstancedBufferAttribute(new Uint8Array(4 * rows.length), 4, true);
    const part: Part = {kind, shape, rows, objects: [], poses, tints, inPass: [rows.length, 0, 0], upTo: [rows.length, 0, 0], limit: rows.length};
    this.instances += rows.length;
    const geometry = this.geometry(part, shape.vertices);
    geometry.setIndex(new THREE.BufferAttribute(shape.triangles, 1));
    if (kind === 'plane') geometry.setAttribute('across', planeCoordinates(shape.vertices));
    const mesh = new THREE.Mesh(geometry, kind === 'plane' ? this.planes : this.faces);
    mesh.frustumCulled = false;
    part.objects.push(mesh);
    if (roundKinds.includes(kind)) this.bend(part);
    this.parts.push(part);
    this.group.add(mesh);
    this.place(part);
    this.tint(part);
  }

  private geometry(part: Part, positions: Float32Array): THREE.InstancedBufferGeometry {
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
    geometry.instanceCount = part.rows.length;
    ['poseX', 'poseY', 'poseZ', 'poseAt'].forEach((name, at) => geometry.setAttribute(name, new THREE.InterleavedBufferAttribute(part.poses, 3, 3 * at)));
    geometry.setAttribute('tintOfRow', part.tints);
    return geometry;
  }

  private place(part: Part): void {
    if (!this.poses) return;
    part.rows.forEach((row, k) => (part.poses.array as Float32Array).set(this.poses!.subarray(12 * row, 12 * row + 12), 12 * k));
    part.poses.needsUpdate = true;
  }

  private tint(part: Part): void {
    if (!this.colours.length) return;
    part.inPass.fill(0);
    this.arrange(part);
    part.rows.forEach((row, k) => {
      (part.tints.array as Uint8Array).set(this.colours.subarray(4 * row, 4 * row + 4), 4 * k);
      const pass = passOf(this.colours[4 * row + 3]!);
      if (pass < 0) return;
      this.visible += 1;
      part.inPass[pass]! += 1;
    });
    part.tints.needsUpdate = true;
    let before = 0;
    for (const pass of passOrder) part.upTo[pass] = before += part.inPass[pass]!;
  }

  // Puts the rows into the order of their passes.
  private arrange(part: Part): void {
    if (part.rows.length === 1) return;
    const passes: number[][] = [[], [], [], []];
    for (const row of part.rows) {
      const at = passOrder.indexOf(passOf(this.colours[4 * row + 3]!) as 0 | 1 | 2);
      passes[at < 0 ? 3 : at]!.push(row);
    }
    const sorted = Uint32Array.from(passes.flat());
    if (sorted.every((row, k) => row === part.rows[k])) return;
    part.rows = sorted;
    this.place(part);
  }
}

// Places in the plane: the first corner is the origin, and the edges that begin there are the axes.
function planeCoordinates(corners: Float32Array): THREE.BufferAttribute {
  const corner = (k: number): THREE.Vector3 => new THREE.Vector3().fromArray(corners, 3 * (k % 4));
  const axes = [corner(1).sub(corner(0)).normalize(), corner(3).sub(corner(0)).normalize()];
  const middle = corner(0).add(corner(2)).multiplyScalar(0.5);
  const places = Array.from({length: corners.length / 3}, (_, k) => axes.map(axis => axis.dot(corner(k).sub(middle))));
  return new THREE.BufferAttribute(Float32Array.from(places.flat()), 2);
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
