// Which object is under a point of the page, and where the box of any object is.
import * as THREE from 'three';
import type {App} from './app.ts';
import {pickRow} from './pick.ts';
import type {Shape} from './shape_layer.ts';

export class Picker {
  constructor(private readonly app: App) {}

  // The object at a point of the page, or -1.
  pick(x: number, y: number): number {
    const {stage, model, near, settings} = this.app;
    const ray = stage.ray(x, y);
    const slack = 1.2 / stage.pixelsPerUnit();
    const asShapes = settings.values.style !== 'boxes' && stage.shapes.shapes.size > 0;
    const hit = pickRow({
      boxes: model.frame.boxes, layer: stage.boxes, shapeOf: asShapes ? row => this.shapeOf(row) : null,
      visible: row => this.app.visible(row), cut: stage.cut, slack,
    }, ray);
    if (!near.shown) return hit.row < 0 ? -1 : model.objectOf(hit.row);
    const {boxes, objects} = near.shown;
    const nearHit = pickRow({boxes, layer: stage.near, shapeOf: null, visible: row => this.app.nearVisible(row), cut: stage.cut, slack}, ray);
    if (nearHit.at < hit.at) return objects[nearHit.row]!;
    return hit.row < 0 ? -1 : model.objectOf(hit.row);
  }

  // Adds the box of an object, if it is known.
  addBox(to: THREE.Box3, object: number): THREE.Box3 {
    const {model, near, selection} = this.app;
    const row = model.rowOf(object);
    const nearRow = near.shown?.objects.indexOf(object) ?? -1;
    const add = (boxes: Float32Array, k: number): void => {
      to.expandByPoint(new THREE.Vector3().fromArray(boxes, 6 * k));
      to.expandByPoint(new THREE.Vector3().fromArray(boxes, 6 * k + 3));
    };
    if (row >= 0) {
      if (model.exists(row)) add(model.frame.boxes, row);
    } else if (nearRow >= 0) add(near.shown!.boxes, nearRow);
    else if (selection.info?.index === object && selection.info.box) {
      to.expandByPoint(new THREE.Vector3(...model.toRelative(selection.info.box.min)));
      to.expandByPoint(new THREE.Vector3(...model.toRelative(selection.info.box.max)));
    }
    return to;
  }

  private shapeOf(row: number): {shape: Shape; pose: Float32Array} | null {
    const {model, stage} = this.app;
    const shape = stage.shapes.shapes.get(model.geometry?.[row] ?? -1);
    const poses = model.frame.poses;
    return shape && poses ? {shape, pose: poses.subarray(12 * row, 12 * row + 12)} : null;
  }
}
