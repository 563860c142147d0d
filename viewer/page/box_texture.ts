// Boxes in two textures: bounds (two texels a box) and colours. Shaders read them by gl_VertexID, so no instances are needed.
import * as THREE from 'three';

export const blockRows = 2048;

export class BoxTexture {
  readonly bounds: THREE.DataTexture;
  readonly colours: THREE.DataTexture;
  readonly boundsData: Float32Array;
  readonly colourData: Uint8Array;

  constructor(readonly capacity: number) {
    const height = Math.max(1, Math.ceil(capacity / blockRows));
    this.boundsData = new Float32Array(2 * 3 * blockRows * height);
    this.colourData = new Uint8Array(4 * blockRows * height);
    // The types of three.js know no RGB format any more, but WebGL 2 and three.js itself do.
    this.bounds = new THREE.DataTexture(this.boundsData as never, 2 * blockRows, height, THREE.RGBFormat as never, THREE.FloatType);
    this.bounds.internalFormat = 'RGB32F';
    this.colours = new THREE.DataTexture(this.colourData as never, blockRows, height, THREE.RGBAFormat, THREE.UnsignedByteType);
    for (const texture of [this.bounds, this.colours]) {
      texture.minFilter = texture.magFilter = THREE.NearestFilter;
      texture.generateMipmaps = false;
      texture.unpackAlignment = 4;
    }
  }

  upload(): void {
    this.bounds.needsUpdate = true;
    this.colours.needsUpdate = true;
  }

  dispose(): void {
    this.bounds.dispose();
    this.colours.dispose();
  }
}

// GLSL that reads box `slot` into `low`, `high` and `colour`.
export const readBox = `
uniform highp sampler2D bounds;
uniform highp sampler2D colours;
void readBox(int slot, out vec3 low, out vec3 high, out vec4 colour) {
  ivec2 at = ivec2(slot & ${blockRows - 1}, slot >> ${Math.log2(blockRows)});
  low = texelFetch(bounds, ivec2(2 * at.x, at.y), 0).xyz;
  high = texelFetch(bounds, ivec2(2 * at.x + 1, at.y), 0).xyz;
  colour = texelFetch(colours, at, 0);
}
`;

// GLSL that leaves out fragments in a regular pattern, so that any order of drawing shows what is behind.
export const screenDoor = `
void screenDoor(float opacity) {
  ivec2 at = ivec2(gl_FragCoord.xy) & 3;
  int rank = ((at.x ^ at.y) & 1) * 8 + (at.x & 1) * 4 + (((at.x ^ at.y) >> 1) & 1) * 2 + (at.x >> 1);
  if (opacity < (float(rank) + 0.5) / 16.0) discard;
}
`;
