// Finds the row under a point of the screen: a ray is tested against the blocks, then the boxes, then the triangles of shapes.
import * as THREE from 'three';
import type {BoxLayer} from './box_layer.ts';
import type {Shape} from './shape_layer.ts';

export interface PickScene {
  boxes: Float32Array;
  layer: BoxLayer;
  // The shape and the pose of a row, if shapes are drawn. A row without a shape is a box.
  shapeOf: ((row: number) => {shape: Shape; pose: Float32Array} | null) | null;
  visible: (row: number) => boolean;
  cut: THREE.Box3;
  // How much larger boxes are drawn than they are, for each unit of distance.
  slack: number;
}

export interface Hit {
  row: number;
  at: number;
}

const nothing: Hit = {row: -1, at: Infinity};

export function pickRow(scene: PickScene, ray: THREE.Ray): Hit {
  const hits = hitBoxes(scene, ray);
  if (!scene.shapeOf) return hits.reduce((best, hit) => hit.at < best.at ? hit : best, nothing);
  hits.sort((a, b) => a.at - b.at);
  let best = nothing;
  for (const hit of hits) {
    if (hit.at > best.at) break;
    const at = hitShape(scene, hit, ray);
    if (at < best.at) best = {row: hit.row, at};
  }
  return best;
}

function hitBoxes(scene: PickScene, ray: THREE.Ray): Hit[] {
  const hits: Hit[] = [];
  const {boxes} = scene;
  const box = new THREE.Box3();
  const where = new THREE.Vector3();
  for (const block of scene.layer.blocks) {
    box.copy(block.box).expandByScalar(scene.slack * ray.origin.distanceTo(block.box.max));
    if (!block.visible || !ray.intersectsBox(box)) continue;
    for (let row = block.start; row < block.start + block.count; ++row) {
      if (!scene.visible(row)) continue;
      const k = 6 * row;
      box.min.set(boxes[k]!, boxes[k + 1]!, boxes[k + 2]!);
      box.max.set(boxes[k + 3]!, boxes[k + 4]!, boxes[k + 5]!);
      box.intersect(scene.cut);
      if (box.isEmpty()) continue;
      box.expandByScalar(scene.slack * ray.origin.distanceTo(box.min));
      if (!box.containsPoint(ray.origin) && ray.intersectBox(box, where)) hits.push({row, at: where.distanceTo(ray.origin)});
    }
  }
  return hits;
}

// The distance to the row's shape, or to its box if it has none.
function hitShape(scene: PickScene, hit: Hit, ray: THREE.Ray): number {
  const found = scene.shapeOf!(hit.row);
  if (!found) return hit.at;
  let best = Infinity;
  forEachHit(found.shape, found.pose, ray, where => {
    if (scene.cut.containsPoint(where)) best = Math.min(best, where.distanceTo(ray.origin));
  });
  return best;
}

// The distance to the last triangle of a shape that a ray hits, or 0.
export function lastHit(shape: Shape, pose: Float32Array, ray: THREE.Ray): number {
  let last = 0;
  forEachHit(shape, pose, ray, where => last = Math.max(last, where.distanceTo(ray.origin)));
  return last;
}

function forEachHit(shape: Shape, p: Float32Array, ray: THREE.Ray, use: (where: THREE.Vector3) => void): void {
  const pose = new THREE.Matrix4().set(p[0]!, p[3]!, p[6]!, p[9]!, p[1]!, p[4]!, p[7]!, p[10]!, p[2]!, p[5]!, p[8]!, p[11]!, 0, 0, 0, 1);
  const inside = ray.clone().applyMatrix4(pose.clone().invert());
  const corners = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()] as const;
  const where = new THREE.Vector3();
  for (let k = 0; k + 2 < shape.triangles.length; k += 3) {
    corners.forEach((corner, c) => corner.fromArray(shape.vertices, 3 * shape.triangles[k + c]!));
    if (!inside.intersectTriangle(corners[0], corners[1], corners[2], false, where)) continue;
    use(where.applyMatrix4(pose));
  }
}
