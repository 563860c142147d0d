// Fills the two objects of a pair where a section cuts them, and marks what both have in common there.
// The stencil buffer counts the far and the near sides of an object behind the section: more far sides mean that the section is inside it.
import * as THREE from 'three';
import type {SharedUniforms} from './box_material.ts';
import type {Colour} from './colours.ts';
import type {Part} from './focus.ts';
import type {Shape} from './shape_layer.ts';
import {isClosed} from './shape_surface.ts';

const vertexShader = `
precision highp float;
uniform mat4 projectionMatrix;
uniform mat4 viewMatrix;
in vec3 position;
out vec3 world;
void main() {
  world = position;
  gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
}
`;

const sidesFragment = `
precision highp float;
uniform vec3 cutLow;
uniform vec3 cutHigh;
in vec3 world;
out vec4 colour;
void main() {
  if (any(lessThan(world, cutLow)) || any(greaterThan(world, cutHigh))) discard;
  colour = vec4(0.0);
}
`;

const fillFragment = `
precision highp float;
uniform vec3 tint;
out vec4 colour;
void main() {
  colour = vec4(tint, 1.0);
}
`;

// The stencil has this bit where the first object is filled. The lower bits count the sides of the second one.
const firstFilled = 128;

export interface Cut {
  axis: number;
  at: number;
}

export class CapLayer {
  readonly group = new THREE.Group();
  private parts: readonly Part[] = [];
  private shapes: (THREE.BufferGeometry | null)[] = [];
  private rectangle: THREE.BufferGeometry | null = null;
  private readonly sides: readonly THREE.RawShaderMaterial[];
  // The materials that fill the first part, the second one, and the space inside both.
  private readonly fills: readonly THREE.RawShaderMaterial[] = [
    fillMaterial({stencilRef: 0, stencilFuncMask: 0xff, stencilFunc: THREE.NotEqualStencilFunc}),
    fillMaterial({stencilRef: 0, stencilFuncMask: firstFilled - 1, stencilFunc: THREE.NotEqualStencilFunc}),
    fillMaterial({stencilRef: firstFilled, stencilFuncMask: 0xff, stencilFunc: THREE.LessStencilFunc}),
  ];
  private readonly mark = markMaterial();

  constructor(shared: SharedUniforms) {
    this.sides = [THREE.BackSide, THREE.FrontSide].map(side => sidesMaterial(shared, side));
  }

  // Whether a picture shows the space inside both parts.
  get hasCommon(): boolean {
    return this.rectangle !== null && this.shapes.every(shape => shape);
  }

  clear(): void {
    this.group.clear();
    this.rectangle?.dispose();
    this.rectangle = null;
  }

  // `colours`: of the first part, of the second one, and of the space inside both.
  show(parts: readonly [Part, Part], cut: Cut, colours: readonly [Colour, Colour, Colour]): void {
    this.clear();
    if (parts !== this.parts) this.setParts(parts);
    const rectangle = this.rectangle = sectionOf(parts, cut);
    this.fills.forEach((fill, k) => (fill.uniforms.tint!.value as THREE.Vector3).fromArray(colours[k]!).divideScalar(255));
    this.shapes.forEach((shape, k) => {
      if (!shape) return;
      for (const side of this.sides) this.add(shape, side);
      this.add(rectangle, this.fills[k]!);
      if (k === 0) this.add(rectangle, this.mark);
    });
    if (this.hasCommon) this.add(rectangle, this.fills[2]!);
  }

  private setParts(parts: readonly [Part, Part]): void {
    for (const shape of this.shapes) shape?.dispose();
    this.parts = parts;
    this.shapes = parts.map(geometryOf);
  }

  private add(geometry: THREE.BufferGeometry, material: THREE.Material): void {
    const mesh = new THREE.Mesh(geometry, material);
    mesh.frustumCulled = false;
    this.group.add(mesh);
  }
}

// Counts the far sides up and the near sides down.
function sidesMaterial(shared: SharedUniforms, side: THREE.Side): THREE.RawShaderMaterial {
  const step = side === THREE.BackSide ? THREE.IncrementWrapStencilOp : THREE.DecrementWrapStencilOp;
  return new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3, vertexShader, fragmentShader: sidesFragment, uniforms: shared, side, transparent: true, colorWrite: false,
    depthTest: false, depthWrite: false, stencilWrite: true, stencilWriteMask: firstFilled - 1, stencilZPass: step,
  });
}

// Fills where the stencil fits. It is a little nearer than the sides of boxes, which end at the section, too.
function fillMaterial(stencil: THREE.MaterialParameters): THREE.RawShaderMaterial {
  return new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3, vertexShader, fragmentShader: fillFragment, uniforms: {tint: {value: new THREE.Vector3()}}, side: THREE.DoubleSide,
    transparent: true, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -4, stencilWrite: true, stencilWriteMask: 0, ...stencil,
  });
}

// Sets the bit where the first object was counted, and clears its count.
function markMaterial(): THREE.RawShaderMaterial {
  const material = fillMaterial({stencilRef: firstFilled, stencilFuncMask: firstFilled - 1, stencilFunc: THREE.NotEqualStencilFunc});
  return Object.assign(material, {colorWrite: false, depthTest: false, depthWrite: false, stencilWriteMask: 0xff, stencilZPass: THREE.ReplaceStencilOp});
}

// The triangles of a part in the scene, or null if it has no inside.
function geometryOf(part: Part): THREE.BufferGeometry | null {
  const {min, max} = part.box;
  if (!part.shape) {
    const size = max.clone().sub(min);
    return new THREE.BoxGeometry(size.x, size.y, size.z).translate(...min.clone().addScaledVector(size, 0.5).toArray());
  }
  const {shape, pose} = part.shape;
  return isClosed(shape.vertices, shape.triangles) ? placed(shape, pose) : null;
}

function placed({vertices, triangles}: Shape, pose: Float32Array): THREE.BufferGeometry {
  const positions = new Float32Array(vertices.length);
  for (let v = 0; v < vertices.length; v += 3) {
    const [x, y, z] = [vertices[v]!, vertices[v + 1]!, vertices[v + 2]!];
    for (let k = 0; k < 3; ++k) positions[v + k] = pose[k]! * x + pose[3 + k]! * y + pose[6 + k]! * z + pose[9 + k]!;
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
  return geometry;
}

// The rectangle of a section that covers both parts.
function sectionOf([a, b]: readonly [Part, Part], {axis, at}: Cut): THREE.BufferGeometry {
  const box = a.box.clone().union(b.box);
  const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
  const corners = [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]].map(([p, q]) => {
    const corner = new THREE.Vector3().setComponent(axis, at);
    const end = (high: number | undefined, k: number): number => (high ? box.max : box.min).getComponent(k);
    return corner.setComponent(u, end(p, u)).setComponent(v, end(q, v));
  });
  return new THREE.BufferGeometry().setFromPoints(corners);
}
