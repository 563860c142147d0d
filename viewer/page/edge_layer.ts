// Draws the twelve edges of boxes as lines: octants, and the outlines of selected boxes.
import * as THREE from 'three';
import {endless} from './box_layer.ts';
import type {SharedUniforms} from './box_material.ts';
import {BoxTexture, readBox} from './box_texture.ts';
import type {Colour} from './colours.ts';

const vertexShader = `
precision highp float;
precision highp int;
uniform mat4 projectionMatrix;
uniform mat4 viewMatrix;
uniform vec3 cutLow;
uniform vec3 cutHigh;
flat out vec4 tint;
${readBox}
void main() {
  int vertex = gl_VertexID % 24;
  vec3 low, high;
  readBox(gl_VertexID / 24, low, high, tint);
  low = max(low, cutLow);
  high = min(high, cutHigh);
  int edge = vertex / 2, axis = edge / 4;
  vec3 at = vec3(vertex & 1, edge & 1, (edge >> 1) & 1);
  at = axis == 0 ? at : axis == 1 ? at.zxy : at.yzx;
  gl_Position = projectionMatrix * viewMatrix * vec4(mix(low, high, at), 1.0);
  if (tint.a == 0.0 || any(greaterThan(low, high))) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}
`;

const fragmentShader = `
precision highp float;
flat in vec4 tint;
out vec4 colour;
void main() {
  colour = vec4(tint.rgb, 1.0);
}
`;

export class EdgeLayer {
  readonly group = new THREE.Group();
  count = 0;
  private texture: BoxTexture | null = null;
  private lines: THREE.LineSegments | null = null;

  // Without a depth test, the lines are seen through all that is in front of them.
  constructor(private readonly shared: SharedUniforms, private readonly depthTest = true) {}

  set(bounds: Float32Array, count: number, colourOf: (k: number) => Colour): void {
    if (!this.texture || this.texture.capacity < count) this.allocate(Math.max(count, 1));
    this.texture!.boundsData.set(bounds.subarray(0, 6 * count));
    for (let k = 0; k < count; ++k) this.texture!.colourData.set([...colourOf(k), 255], 4 * k);
    this.texture!.upload();
    this.count = count;
    this.lines!.geometry.clearGroups();
    if (count) this.lines!.geometry.addGroup(0, 24 * count, 0);
  }

  clear(): void {
    this.count = 0;
    this.lines?.geometry.clearGroups();
  }

  private allocate(count: number): void {
    this.texture?.dispose();
    this.lines?.geometry.dispose();
    this.group.clear();
    this.texture = new BoxTexture(Math.ceil(count * 1.2));
    const uniforms = {...this.shared, bounds: {value: this.texture.bounds}, colours: {value: this.texture.colours}};
    const material = new THREE.RawShaderMaterial({glslVersion: THREE.GLSL3, vertexShader, fragmentShader, uniforms, depthTest: this.depthTest,
      transparent: true});
    this.lines = new THREE.LineSegments(endless(), [material]);
    this.lines.frustumCulled = false;
    this.group.add(this.lines);
  }
}
