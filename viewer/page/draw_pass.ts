// The passes of a picture. While something is selected, the rest is drawn first, as ghosts. The selection is then drawn over the ghosts, so
// nothing hides it. An object that encloses its partner is drawn last, as glass. The opacity of a row says to which pass it belongs.
import * as THREE from 'three';

export const Pass = {solid: 0, ghost: 1, glass: 2} as const;

// Opacities from 0 to 255 with a meaning of their own. Others are the opacity of a row in the solid pass.
export const ghostOpacity = 1;
export const glassOpacity = 2;

// The pass of a row with this opacity, or -1 if the row is hidden.
export function passOf(opacity: number): number {
  return opacity === 0 ? -1 : opacity === ghostOpacity ? Pass.ghost : opacity === glassOpacity ? Pass.glass : Pass.solid;
}

// GLSL that tells whether a row with this opacity (0 to 1) is drawn in the present pass.
export const inPass = `
uniform int drawPass;
bool inPass(float opacity) {
  int byte = int(opacity * 255.0 + 0.5);
  return byte > 0 && (byte < 3 ? byte : 0) == drawPass;
}
`;

// Makes a material blend with what is behind it, without hiding it, or not.
export function setBlending(material: THREE.Material, blend: boolean): void {
  material.transparent = blend;
  material.depthWrite = !blend;
}
