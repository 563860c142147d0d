// Contacts of collisions: points, arrows along the normals as long as the depths, and the places of the labels.
import * as THREE from 'three';
import type {SharedUniforms} from './box_material.ts';
import {measureOf} from './collision.ts';
import type {Colour, Palette} from './colours.ts';
import {significant} from './dom.ts';
import type {Focus} from './focus.ts';
import {LineLayer, VertexList} from './line_layer.ts';
import type {SceneModel} from './scene_model.ts';
import type {Collision, Contact} from './types.ts';

export interface ContactLabel {
  at: THREE.Vector3;
  text: string;
}

export interface SelectedPair {
  row: Collision;
  focus: Focus;
}

export interface ContactStyle {
  palette: Palette;
  least: number;
}

const labelLimit = 12;

export class ContactLayer {
  readonly points: LineLayer;
  readonly lines: LineLayer;
  labels: ContactLabel[] = [];
  count = 0;

  constructor(shared: SharedUniforms) {
    this.points = new LineLayer(shared, 11);
    this.lines = new LineLayer(shared);
  }

  // Shows the contacts of rows. Those of the selected pair, the last row, have one label: the depth of the pair. Without a selected pair,
  // contacts have labels of their own. `least` is the shortest arrow that can be seen.
  show(model: SceneModel, rows: readonly Collision[], pair: SelectedPair | null, {palette, least}: ContactStyle): void {
    const points = new VertexList();
    const lines = new VertexList();
    this.labels = [];
    this.count = 0;
    for (const row of rows) {
      const chosen = row === pair?.row;
      const colour = chosen || !pair ? contactColour(row, palette) : palette.calmContact;
      this.count += row.contacts?.length ?? 0;
      row.contacts?.forEach((contact, k) => {
        const at = new THREE.Vector3(...model.toRelative(contact.point));
        points.add(at.x, at.y, at.z, colour);
        if (!contact.normal || contact.depth === undefined || (pair && (k > 0 || !chosen))) return;
        addArrow(lines, at, new THREE.Vector3(...contact.normal).setLength(Math.max(Math.abs(contact.depth), least)), colour);
        if (!pair) this.label(at, contact);
      });
      if (chosen && row.nearest) for (const point of row.nearest) lines.add(...model.toRelative(point), colour);
    }
    if (pair) this.labels = [{at: pair.focus.mark, text: pairText(pair.row, model.view.unit)}];
    this.points.set(points);
    this.lines.set(lines);
  }

  private label(at: THREE.Vector3, contact: Contact): void {
    if (this.labels.length < labelLimit) this.labels.push({at, text: `contact, depth ${significant(contact.depth!)}`});
  }
}

// Touching is calmer than penetrating.
export function contactColour(row: Collision | null, palette: Palette): Colour {
  return row?.class === 'touching' || row?.class === 'clearance' ? palette.calmContact : palette.contact;
}

// The label of a pair: how deep it is, or at least its class.
function pairText(row: Collision, unit: string): string {
  const measure = row.class === 'touching' ? null : measureOf(row);
  return measure ? `${measure.kind} ${measure.short}${unit ? ` ${unit}` : ''}` : row.class ?? 'collision';
}

function addArrow(list: VertexList, from: THREE.Vector3, along: THREE.Vector3, colour: Colour): void {
  const length = along.length();
  const normal = along.clone().normalize();
  const tip = from.clone().add(along);
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
