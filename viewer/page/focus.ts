// Where a collision is: the contact with as much of both objects as tells what they are, and from where it is seen best.
import * as THREE from 'three';
import type {Camera} from './camera.ts';
import {lastHit} from './pick.ts';
import type {Shape} from './shape_layer.ts';
import type {ContactCut} from './stage.ts';
import type {Collision, Point} from './types.ts';

export interface Part {
  box: THREE.Box3;
  shape: {shape: Shape; pose: Float32Array} | null;
}

export interface Focus {
  // The middle and the radius of the ball that the picture shows.
  middle: THREE.Vector3;
  reach: number;
  // The deepest contact, or the middle of the space inside both boxes.
  mark: THREE.Vector3;
  normal: THREE.Vector3 | null;
  // The part that is drawn as glass, since it encloses the other one: 0 or 1, or -1.
  glass: number;
  parts: readonly [Part, Part];
}

// Rays are tested against more triangles only by their boxes.
const rayTriangles = 60_000;

// Returns the space inside both boxes, or the gap between them.
function between(a: THREE.Box3, b: THREE.Box3): THREE.Box3 {
  const [low, high] = [a.min.clone().max(b.min), a.max.clone().min(b.max)];
  return new THREE.Box3(low.clone().min(high), low.clone().max(high));
}

// The part of a box, from 0 to 1, that lies in another one.
function partInside(box: THREE.Box3, other: THREE.Box3): number {
  const [size, common] = [box.getSize(new THREE.Vector3()), box.clone().intersect(other)];
  if (common.isEmpty()) return 0;
  const inside = common.getSize(new THREE.Vector3());
  return [0, 1, 2].reduce((part, k) => part * (size.getComponent(k) > 0 ? inside.getComponent(k) / size.getComponent(k) : 1), 1);
}

// The larger object would hide what of the other lies inside it.
function encloserOf([a, b]: readonly [Part, Part]): number {
  const [larger, smaller] = a.box.getSize(new THREE.Vector3()).length() > b.box.getSize(new THREE.Vector3()).length() ? [a, b] : [b, a];
  return partInside(smaller.box, larger.box) < 0.05 ? -1 : larger === a ? 0 : 1;
}

// The contacts around the deepest one, no farther than half of the smaller object: others may be at its other end.
function contactsNear(points: readonly THREE.Vector3[], size: number): THREE.Box3 {
  const box = new THREE.Box3();
  for (const point of points) if (point.distanceTo(points[0]!) <= 0.5 * size) box.expandByPoint(point);
  return box;
}

// How much around a contact is shown: a few times the contact, but enough of the smaller object to recognize it, and never the whole scene.
function reachOf(extent: number, depth: number, smaller: THREE.Vector3, sceneRadius: number): number {
  const size = smaller.length();
  const sides = smaller.toArray().sort((p, q) => p - q);
  const wanted = Math.max(1.6 * extent, 3 * depth, 1.3 * sides[1]!, 0.5 * sides[2]!);
  return Math.max(Math.min(wanted, Math.max(0.8 * size, 1.6 * extent), 0.6 * sceneRadius), 1e-5 * sceneRadius, 1e-9);
}

export function focusOf(row: Collision | null, parts: readonly [Part, Part], toRelative: (point: Point) => Point, sceneRadius: number): Focus {
  const [a, b] = parts.map(part => part.box.getSize(new THREE.Vector3())) as [THREE.Vector3, THREE.Vector3];
  const smaller = a.length() < b.length() ? a : b;
  const common = between(parts[0].box, parts[1].box);
  const points = (row?.contacts?.map(contact => contact.point) ?? row?.nearest ?? []).map(point => new THREE.Vector3(...toRelative(point)));
  const shown = row?.nearest ? new THREE.Box3().setFromPoints(points) : points.length ? contactsNear(points, smaller.length()) : common;
  const mark = row?.contacts?.length ? points[0]!.clone() : shown.getCenter(new THREE.Vector3());
  const along = row?.contacts?.[0]?.normal;
  return {
    middle: shown.getCenter(new THREE.Vector3()), mark, normal: along ? new THREE.Vector3(...along).normalize() : null, parts,
    reach: reachOf(0.5 * shown.getSize(new THREE.Vector3()).length(), row?.depth ?? 0, smaller, sceneRadius), glass: encloserOf(parts),
  };
}

// How far the surface of a part is from a point inside it, in a direction.
function wayOut(part: Part, ray: THREE.Ray): number {
  if (part.shape && part.shape.shape.triangles.length <= 3 * rayTriangles) return lastHit(part.shape.shape, part.shape.pose, ray);
  const {min, max} = part.box;
  if (!ray.intersectsBox(part.box)) return 0;
  const ways = [0, 1, 2].map(k => {
    const step = ray.direction.getComponent(k);
    return step === 0 ? Infinity : ((step > 0 ? max : min).getComponent(k) - ray.origin.getComponent(k)) / step;
  });
  return Math.max(0, Math.min(...ways));
}

// The angles from which a contact is seen best: little is in front of it, both objects are beside it, and the camera looks down a little.
export function bestView({mark, normal, parts, reach}: Focus, camera: Camera): {yaw: number; pitch: number} {
  const usual = camera.direction(-0.9, 0.5);
  const triangles = parts.reduce((sum, part) => sum + (part.shape?.shape.triangles.length ?? 0) / 3, 0);
  const yaws = triangles > 20_000 ? 8 : 16;
  let best = {yaw: -0.9, pitch: 0.5, cost: Infinity};
  for (const pitch of [0.5, 0.2, 0.9, -0.35]) {
    for (let k = 0; k < yaws; ++k) {
      const yaw = -0.9 + 2 * Math.PI * k / yaws;
      const direction = camera.direction(yaw, pitch);
      const ray = new THREE.Ray(mark, direction);
      const hidden = Math.min(1, Math.max(...parts.map(part => wayOut(part, ray))) / (2 * reach));
      const across = normal ? normal.dot(direction) ** 2 : 0;
      const cost = 0.5 * across + (normal ? 0.8 : 0.4) * hidden + 0.35 * (1 - usual.dot(direction)) + (pitch < 0 ? 0.2 : 0);
      if (cost < best.cost - 1e-9) best = {yaw, pitch, cost};
    }
  }
  return {yaw: best.yaw > Math.PI ? best.yaw - 2 * Math.PI : best.yaw, pitch: best.pitch};
}

// The section that shows both objects side by side: towards the camera, and not between the two objects.
export function sectionOf({mark, normal, reach}: Focus, view: THREE.Vector3): ContactCut {
  const value = (k: number): number => Math.abs(view.getComponent(k)) * (1 - 0.8 * Math.abs(normal?.getComponent(k) ?? 0));
  const axis = [0, 1, 2].reduce((best, k) => value(k) > value(best) ? k : best, 0);
  return {axis, at: mark.getComponent(axis), reach, high: view.getComponent(axis) > 0};
}

// The length of the shortest arrow that can be seen at the mark.
export function leastArrow({reach}: Focus): number {
  return 0.15 * reach;
}
