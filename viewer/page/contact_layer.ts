// Contacts of collisions: a point, an arrow along the normal as long as the depth, and the places of the depths' labels.
import * as THREE from 'three';
import type {SharedUniforms} from './box_material.ts';
import type {Colour} from './colours.ts';
import {LineLayer, VertexList} from './line_layer.ts';
import type {SceneModel} from './scene_model.ts';
import type {Collision, Point} from './types.ts';

export interface DepthLabel {
  at: THREE.Vector3;
  depth: number;
}

const labelLimit = 12;

export class ContactLayer {
  readonly points: LineLayer;
  readonly arrows: LineLayer;
  labels: DepthLabel[] = [];
  count = 0;

  constructor(shared: SharedUniforms) {
    this.points = new LineLayer(shared, 8);
    this.arrows = new LineLayer(shared);
  }

  // `least` is the shortest arrow that can be seen in this scene.
  show(model: SceneModel, rows: readonly Collision[], colour: Colour, least: number): void {
    const contacts = rows.flatMap(row => row.contacts ?? []);
    const points = new VertexList();
    const arrows = new VertexList();
    this.labels = [];
    for (const contact of contacts) {
      const at = model.toRelative(contact.point);
      points.add(...at, colour);
      if (contact.normal === undefined || contact.depth === undefined) continue;
      addArrow(arrows, contact.normal, contact.depth, new THREE.Vector3(...at), colour, least);
      if (this.labels.length < labelLimit) this.labels.push({at: new THREE.Vector3(...at), depth: contact.depth});
    }
    this.count = contacts.length;
    this.points.set(points);
    this.arrows.set(arrows);
  }
}

function addArrow(list: VertexList, along: Point, depth: number, from: THREE.Vector3, colour: Colour, least: number): void {
  const normal = new THREE.Vector3(...along).normalize();
  const length = Math.max(Math.abs(depth), least);
  const tip = from.clone().addScaledVector(normal, length);
  const right = new THREE.Vector3(Math.abs(normal.z) < 0.9 ? 0 : 1, 0, Math.abs(normal.z) < 0.9 ? 1 : 0).cross(normal).normalize();
  const sides = [right, right.clone().cross(normal)];
  const line = (p: THREE.Vector3, q: THREE.Vector3): void => {
    list.add(p.x, p.y, p.z, colour);
    list.add(q.x, q.y, q.z, colour);
  };
  line(from, tip);
  const base = tip.clone().addScaledVector(normal, -0.25 * length);
  for (const side of sides) for (const sign of [-1, 1]) line(tip, base.clone().addScaledVector(side, sign * 0.12 * length));
}
