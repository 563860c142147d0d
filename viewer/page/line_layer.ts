// Line segments with a colour for each: pairs and contacts.
import * as THREE from 'three';
import type {SharedUniforms} from './box_material.ts';
import type {Colour} from './colours.ts';

const vertexShader = `
precision highp float;
uniform mat4 projectionMatrix;
uniform mat4 viewMatrix;
uniform float pointSize;
uniform vec3 cutLow;
uniform vec3 cutHigh;
in vec3 position;
in vec3 color;
out vec3 tint;
void main() {
  tint = color;
  gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0);
  gl_PointSize = pointSize;
  if (pointSize > 0.0 && (any(lessThan(position, cutLow)) || any(greaterThan(position, cutHigh)))) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}
`;

const fragmentShader = `
precision highp float;
uniform float pointSize;
in vec3 tint;
out vec4 colour;
void main() {
  // A point is a disc in a white ring, which is seen on any colour.
  float radius = pointSize > 0.0 ? length(gl_PointCoord - 0.5) : 0.0;
  if (radius > 0.5) discard;
  colour = vec4(radius > 0.34 ? vec3(1.0) : tint, 1.0);
}
`;

// Collects positions and colours of vertices.
export class VertexList {
  readonly positions: number[] = [];
  readonly colours: number[] = [];

  add(x: number, y: number, z: number, colour: Colour): void {
    this.positions.push(x, y, z);
    this.colours.push(colour[0], colour[1], colour[2]);
  }
}

export class LineLayer {
  readonly group = new THREE.Group();
  private readonly material: THREE.RawShaderMaterial;
  private object: THREE.LineSegments | THREE.Points | null = null;

  // With a point size the vertices are drawn as round points instead of lines.
  constructor(shared: SharedUniforms, private readonly pointSize = 0, depthTest = false) {
    // As something transparent, it is drawn after all that is solid and after glass.
    const uniforms = {...shared, pointSize: {value: pointSize}};
    this.material = new THREE.RawShaderMaterial({glslVersion: THREE.GLSL3, vertexShader, fragmentShader, uniforms, depthTest, transparent: true});
  }

  set(list: VertexList): void {
    this.object?.geometry.dispose();
    this.group.clear();
    this.object = null;
    if (!list.positions.length) return;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(list.positions), 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(new Uint8Array(list.colours), 3, true));
    this.object = this.pointSize ? new THREE.Points(geometry, this.material) : new THREE.LineSegments(geometry, this.material);
    this.object.frustumCulled = false;
    this.group.add(this.object);
  }
}
