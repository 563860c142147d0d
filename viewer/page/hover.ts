// Labels over the canvas: what is under the pointer, and the labels of contacts.
import * as THREE from 'three';
import {byId, count, counted, make, significant} from './dom.ts';
import type {Octant} from './octant_layer.ts';
import type {Stage} from './stage.ts';

export function showLabel(stage: Stage, text: string, clientX: number, clientY: number): void {
  const label = byId('label');
  const box = stage.canvas.getBoundingClientRect();
  label.textContent = text;
  label.hidden = !text;
  label.style.left = `${Math.min(clientX - box.left + 14, Math.max(0, box.width - label.offsetWidth - 4))}px`;
  label.style.top = `${Math.min(clientY - box.top + 14, Math.max(0, box.height - label.offsetHeight - 4))}px`;
}

export function hideLabel(): void {
  byId('label').hidden = true;
}

export function octantText(octant: Octant): string {
  const kind = octant.leaf ? ', leaf' : '';
  return `octant ${octant.code}, level ${octant.level}${kind}\n${counted(octant.entries, 'entry', 'entries')}, ${count(octant.begins)} begin here`;
}

// Places the labels of contacts after a picture was drawn.
export function placeDepths(stage: Stage): void {
  const host = byId('depths');
  const labels = stage.contacts.labels;
  while (host.children.length > labels.length) host.lastChild!.remove();
  while (host.children.length < labels.length) host.append(make('span'));
  if (!labels.length) return;
  const box = stage.canvas.getBoundingClientRect();
  const taken: {x: number; y: number}[] = [];
  labels.forEach((label, k) => {
    const element = host.children[k] as HTMLElement;
    const at = stage.project(new THREE.Vector3().copy(label.at));
    const free = taken.every(other => Math.abs(other.x - at.x) > 100 || Math.abs(other.y - at.y) > 20);
    const {text} = label;
    if (element.textContent !== text) element.textContent = text;
    element.hidden = !at.front || !free;
    if (!element.hidden) taken.push(at);
    element.style.left = `${Math.round(Math.min(at.x - box.left + 8, box.width - 6.5 * text.length - 14))}px`;
    element.style.top = `${Math.round(at.y - box.top + 8)}px`;
  });
}

// A bar as long as a round length at the distance of what the camera looks at.
export function showScale(stage: Stage, unit: string): void {
  const {camera, canvas} = stage;
  const pixels = canvas.clientHeight / (2 * Math.tan(THREE.MathUtils.degToRad(camera.three.fov / 2)) * camera.distance);
  if (!(pixels > 0 && pixels < Infinity)) return;
  const most = 130 / pixels;
  const power = 10 ** Math.floor(Math.log10(most));
  const length = power * (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1);
  byId('scale').hidden = camera.fly;
  const bar = byId('scale').firstElementChild as HTMLElement;
  bar.style.width = `${Math.round(length * pixels)}px`;
  const text = `${significant(length)}${unit ? ` ${unit}` : ''}`;
  if (bar.textContent !== text) bar.textContent = text;
}
