// The shaders of boxes: shaded faces with edges, and points for boxes of few pixels. Ghosts fade with their distance from the target:
// many ghosts in front of each other would hide all behind them.
import * as THREE from 'three';
import {type BoxTexture, readBox, screenDoor} from './box_texture.ts';
import {inPass} from './draw_pass.ts';

// GLSL that tells how much of a ghost is seen, from 0 to 1.
const fading = `
uniform vec3 target;
uniform float fadeReach;
float fadeOf(vec3 low, vec3 high) {
  return drawPass == 1 ? 1.0 - smoothstep(0.5, 1.0, distance(clamp(target, low, high), target) / fadeReach) : 1.0;
}
`;

const facesVertex = `
precision highp float;
precision highp int;
uniform mat4 projectionMatrix;
uniform mat4 viewMatrix;
uniform vec3 eye;
uniform vec3 cutLow;
uniform vec3 cutHigh;
uniform vec3 shadeLow;
uniform vec3 shadeHigh;
uniform int faces;
flat out vec4 tint;
flat out float fade;
out vec2 place;
${readBox}
${inPass}
${fading}
void main() {
  int vertex = gl_VertexID % (6 * faces);
  vec3 low, high;
  readBox(gl_VertexID / (6 * faces), low, high, tint);
  fade = fadeOf(low, high);
  low = max(low, cutLow);
  high = min(high, cutHigh);
  if (!inPass(tint.a) || fade == 0.0 || any(greaterThan(low, high))) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  int face = vertex / 6, axis = face % 3, corner = vertex % 6;
  vec3 near = step(0.5 * (low + high), eye);
  vec2 uv = vec2(corner == 1 || corner == 2 || corner == 4, corner == 2 || corner == 4 || corner == 5);
  float side = axis == 0 ? near.x : axis == 1 ? near.y : near.z;
  if (face > 2) side = 1.0 - side;
  vec3 at = axis == 0 ? vec3(side, uv) : axis == 1 ? vec3(uv.y, side, uv.x) : vec3(uv, side);
  float dark = axis == 0 ? mix(shadeLow.x, shadeHigh.x, side) : axis == 1 ? mix(shadeLow.y, shadeHigh.y, side) : mix(shadeLow.z, shadeHigh.z, side);
  tint.rgb *= dark;
  place = uv;
  gl_Position = projectionMatrix * viewMatrix * vec4(mix(low, high, at), 1.0);
}
`;

const facesFragment = `
precision highp float;
precision highp int;
uniform vec3 edgeColour;
uniform vec3 background;
uniform float edges;
uniform float fill;
uniform int drawPass;
flat in vec4 tint;
flat in float fade;
in vec2 place;
out vec4 colour;
${screenDoor}
void main() {
  if (fill < 0.0 && drawPass == 0) screenDoor(tint.a);
  vec2 width = max(fwidth(place), vec2(1e-6));
  vec2 near = min(place, 1.0 - place) / width;
  float edge = 1.0 - smoothstep(0.6, 1.6, min(near.x, near.y));
  float pixels = 1.0 / max(width.x, width.y);
  if (fill >= 0.0) {
    if (fill == 0.0 && edge < 0.4) discard;
    colour = vec4(tint.rgb, fill == 0.0 ? 1.0 : max(fill, edge));
    return;
  }
  edge *= edges * smoothstep(5.0, 24.0, pixels);
  if (drawPass == 1) {
    colour = vec4(mix(background, tint.rgb, 0.4 + 0.4 * edge), fade * (0.16 + 0.44 * edge));
    return;
  }
  if (drawPass == 2) {
    colour = vec4(tint.rgb, 0.25 + 0.5 * edge);
    return;
  }
  colour = vec4(mix(tint.rgb, edgeColour, 0.55 * edge), 1.0);
}
`;

const pointsVertex = `
precision highp float;
precision highp int;
uniform mat4 projectionMatrix;
uniform mat4 viewMatrix;
uniform vec3 cutLow;
uniform vec3 cutHigh;
uniform vec3 shadeLow;
uniform vec3 shadeHigh;
uniform float scale;
uniform float smallest;
flat out vec4 tint;
flat out vec3 shades;
flat out float fade;
${readBox}
${inPass}
${fading}
void main() {
  vec3 low, high;
  readBox(gl_VertexID, low, high, tint);
  vec3 middle = 0.5 * (low + high);
  fade = fadeOf(low, high);
  gl_Position = projectionMatrix * viewMatrix * vec4(middle, 1.0);
  vec3 size = high - low;
  gl_PointSize = clamp(scale * max(size.x, max(size.y, size.z)) / gl_Position.w, smallest, 64.0);
  shades = vec3(max(shadeHigh.y, shadeHigh.z), shadeLow.x, min(shadeLow.y, shadeLow.z));
  bool isCut = any(lessThan(middle, cutLow)) || any(greaterThan(middle, cutHigh));
  if (!inPass(tint.a) || fade == 0.0 || isCut) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}
`;

const pointsFragment = `
precision highp float;
precision highp int;
flat in vec4 tint;
flat in vec3 shades;
flat in float fade;
uniform vec3 background;
uniform int drawPass;
out vec4 colour;
${screenDoor}
void main() {
  if (drawPass == 0) screenDoor(tint.a);
  // A point looks like a small box: a bright top and two sides.
  float shade = gl_PointCoord.y < 0.34 ? shades.x : gl_PointCoord.x < 0.5 ? shades.y : shades.z;
  colour = drawPass == 1 ? vec4(mix(background, tint.rgb * shade, 0.3), fade) : vec4(tint.rgb * shade, 1.0);
}
`;

export interface SharedUniforms {
  [name: string]: THREE.IUniform;
  eye: THREE.IUniform<THREE.Vector3>;
  cutLow: THREE.IUniform<THREE.Vector3>;
  cutHigh: THREE.IUniform<THREE.Vector3>;
  shadeLow: THREE.IUniform<THREE.Vector3>;
  shadeHigh: THREE.IUniform<THREE.Vector3>;
  edgeColour: THREE.IUniform<THREE.Vector3>;
  background: THREE.IUniform<THREE.Vector3>;
  target: THREE.IUniform<THREE.Vector3>;
  fadeReach: THREE.IUniform<number>;
  drawPass: THREE.IUniform<number>;
  edges: THREE.IUniform<number>;
  scale: THREE.IUniform<number>;
  smallest: THREE.IUniform<number>;
  middle: THREE.IUniform<THREE.Vector3>;
  radius: THREE.IUniform<number>;
  gridStep: THREE.IUniform<number>;
}

export function sharedUniforms(): SharedUniforms {
  const vector = (x: number, y: number, z: number): THREE.IUniform<THREE.Vector3> => ({value: new THREE.Vector3(x, y, z)});
  const far = 3e38;
  return {
    eye: vector(0, 0, 0), cutLow: vector(-far, -far, -far), cutHigh: vector(far, far, far), shadeLow: vector(0.8, 0.72, 0.62),
    shadeHigh: vector(0.86, 0.78, 1), edgeColour: vector(0, 0, 0), background: vector(1, 1, 1), target: vector(0, 0, 0),
    fadeReach: {value: 1}, drawPass: {value: 0}, edges: {value: 1}, scale: {value: 1}, smallest: {value: 2}, middle: vector(0, 0, 0),
    radius: {value: 1}, gridStep: {value: 1},
  };
}

function material(shared: SharedUniforms, texture: BoxTexture, vertexShader: string, fragmentShader: string): THREE.RawShaderMaterial {
  return new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3, vertexShader, fragmentShader, side: THREE.DoubleSide,
    uniforms: {...shared, bounds: {value: texture.bounds}, colours: {value: texture.colours}, faces: {value: 3}, fill: {value: -1}},
  });
}

export function facesMaterial(shared: SharedUniforms, texture: BoxTexture): THREE.RawShaderMaterial {
  return material(shared, texture, facesVertex, facesFragment);
}

export function pointsMaterial(shared: SharedUniforms, texture: BoxTexture): THREE.RawShaderMaterial {
  return material(shared, texture, pointsVertex, pointsFragment);
}
