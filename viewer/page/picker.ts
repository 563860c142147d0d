// Which object is under a point of the page, and where the box of any object is.
import * as THREE from 'three';
import type {App} from './app.ts';
import {pickRow} from './pick.ts';
import {Pass} from './draw_pass.ts';
import type {Part} from './focus.ts';
import type {Shape} from './shape_layer.ts';

export class Picker {
  constructor(private readonly app: App) {}

  // The object at a point of the page, or -1. Ghosts are behind all others.
  pick(x: number, y: number): number {
    const front = this.pickAmong(x, y, pass => pass === Pass.solid || pass === Pass.glass);
    return front < 0 && this.app.stage.ghosts ? this.pickAmong(x, y, pass => pass === Pass.ghost) : front;
  }

  private pickAmong(x: number, y: number, shown: (pass: number) => boolean): number {
    const {stage, model, near, settings} = this.app;
    const ray = stage.ray(x, y);
    const slack = 1.2 / stage.pixelsPerUnit();
    const asShapes = settings.values.style !== 'boxes' && stage.shapes.shapes.size > 0;
    const hit = pickRow({
      boxes: model.frame.boxes, layer: stage.boxes, shapeOf: asShapes ? row => this.shapeOf(row) : null,
      visible: row => shown(this.app.passOf(row)), cut: stage.cut, slack,
    }, ray);
    if (!near.shown) return hit.row < 0 ? -1 : model.objectOf(hit.row);
    const {boxes, objects} = near.shown;
    const nearHit = pickRow({boxes, layer: stage.near, shapeOf: null, visible: row => shown(this.app.nearPassOf(row)), cut: stage.cut, slack}, ray);
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
    else {
      const {info, collision} = selection;
      const which = [collision?.a, collision?.b].indexOf(object);
      const box = info?.index === object ? info.box : collision?.boxes?.[which];
      for (const corner of box ? [box.min, box.max] : []) to.expandByPoint(new THREE.Vector3(...model.toRelative(corner)));
    }
    return to;
  }

  // The box of an object, and its shape if shapes are drawn.
  part(object: number): Part {
    const row = this.app.model.rowOf(object);
    const asShape = row >= 0 && this.app.settings.values.style !== 'boxes';
    return {box: this.addBox(new THREE.Box3(), object), shape: asShape ? this.shapeOf(row) : null};
  }

  private shapeOf(row: number): {shape: Shape; pose: Float32Array} | null {
    const {model, stage} = this.app;
    const shape = stage.shapes.shapes.get(model.geometry?.[row] ?? -1);
    const poses = model.frame.poses;
    return shape && poses ? {shape, pose: poses.subarray(12 * row, 12 * row + 12)} : null;
  }
}
