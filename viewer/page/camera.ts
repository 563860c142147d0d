// The camera: a target, a distance and two angles. It turns around the target, or in fly mode around the eye.
import * as THREE from 'three';
import type {Point} from './types.ts';

const limit = Math.PI / 2 - 0.001;

export class Camera {
  readonly three = new THREE.PerspectiveCamera(45, 1, 0.01, 1000);
  readonly target = new THREE.Vector3();
  distance = 10;
  yaw = -0.9;
  pitch = 0.5;
  up: 'y' | 'z' = 'z';
  fly = false;
  // The bounds that the camera was placed to see last, and the place that it got.
  private fitted: {min: Point; max: Point; at: string} | null = null;
  // The part of the canvas's width, from the left, that a panel covers.
  covered = 0;
  // The part of its height, from below.
  below = 0;
  readonly sceneMiddle = new THREE.Vector3();
  private sceneRadius = 1;
  private sceneMin: Point = [0, 0, 0];
  private sceneMax: Point = [1, 1, 1];

  // Where a camera with these angles looks from, as a direction from the target.
  direction(yaw: number, pitch: number): THREE.Vector3 {
    const flat = Math.cos(pitch);
    const [a, b, c] = [flat * Math.cos(yaw), flat * Math.sin(yaw), Math.sin(pitch)];
    return this.up === 'z' ? new THREE.Vector3(a, b, c) : new THREE.Vector3(b, c, a);
  }

  private outward(): THREE.Vector3 {
    return this.direction(this.yaw, this.pitch);
  }

  eye(): THREE.Vector3 {
    return this.target.clone().addScaledVector(this.outward(), this.distance);
  }

  setScene(min: Point, max: Point): void {
    this.sceneMin = min;
    this.sceneMax = max;
    this.sceneMiddle.set(0.5 * (min[0] + max[0]), 0.5 * (min[1] + max[1]), 0.5 * (min[2] + max[2]));
    this.sceneRadius = Math.max(0.5 * Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]), 1e-6);
  }

  radius(): number {
    return this.sceneRadius;
  }

  // Half the height of what is seen at the target.
  reach(): number {
    return this.distance * Math.tan(THREE.MathUtils.degToRad(this.three.fov / 2));
  }

  fit(min: Point, max: Point): void {
    this.target.set(0.5 * (min[0] + max[0]), 0.5 * (min[1] + max[1]), 0.5 * (min[2] + max[2]));
    this.place();
    const axes = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()] as const;
    this.three.matrixWorld.extractBasis(axes[0], axes[1], axes[2]);
    const slope = 0.9 * Math.tan(THREE.MathUtils.degToRad(this.three.fov / 2));
    const corners = Array.from({length: 8}, (_, k) =>
      new THREE.Vector3(k & 1 ? max[0] : min[0], k & 2 ? max[1] : min[1], k & 4 ? max[2] : min[2]));
    // Near corners look larger, so the middle of the picture is not that of the box.
    const middle = (places: number[]): number => 0.5 * (Math.max(...places) + Math.min(...places)) * this.distance;
    for (let round = 0; round < 4; ++round) {
      const seen = corners.map(corner => corner.clone().sub(this.target)).map(c => axes.map(axis => c.dot(axis)) as Point);
      this.distance = Math.max(1e-5 * this.sceneRadius, 1e-9, ...seen.map(([x, y, z]) =>
        z + Math.max(Math.abs(x) / (this.three.aspect * (1 - this.covered)), Math.abs(y) / (1 - this.below)) / slope));
      this.target.addScaledVector(axes[0], middle(seen.map(([x, , z]) => x / (this.distance - z))));
      this.target.addScaledVector(axes[1], middle(seen.map(([, y, z]) => y / (this.distance - z))));
    }
    this.fitted = {min, max, at: this.toText()};
  }

  fitScene(): void {
    this.fit(this.sceneMin, this.sceneMax);
  }

  // Whether the camera is where fit() placed it.
  get unmoved(): boolean {
    return this.fitted?.at === this.toText();
  }

  rotate(yaw: number, pitch: number): void {
    const eye = this.eye();
    this.yaw = (this.yaw + yaw) % (2 * Math.PI);
    this.pitch = THREE.MathUtils.clamp(this.pitch + pitch, -limit, limit);
    if (this.fly) this.target.copy(eye).addScaledVector(this.outward(), -this.distance);
  }

  look(yaw: number, pitch: number): void {
    this.yaw = yaw;
    this.pitch = THREE.MathUtils.clamp(pitch, -limit, limit);
  }

  // Moves by parts of what is seen: to the right, up and forward.
  move(right: number, up: number, forward: number): void {
    this.place();
    const step = 2 * this.reach();
    const axes = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()] as const;
    this.three.matrixWorld.extractBasis(axes[0], axes[1], axes[2]);
    this.target.addScaledVector(axes[0], right * step).addScaledVector(axes[1], up * step).addScaledVector(axes[2], -forward * step);
  }

  // Changes the distance. The point `at` (from -1 to 1 on the canvas) stays where it is on the screen.
  zoom(factor: number, at: readonly [number, number] = [0, 0]): void {
    if (this.fly) return this.move(0, 0, 0.5 * (1 - factor));
    const old = this.distance;
    this.distance = THREE.MathUtils.clamp(old * factor, 1e-6 * this.sceneRadius, 100 * this.sceneRadius);
    const kept = 0.5 * (1 - this.distance / old);
    const scale = old / this.distance;
    return this.move((at[0] - this.covered) * this.three.aspect * kept * scale, (at[1] - this.below) * kept * scale, 0);
  }

  // Takes the size of the canvas. The target is in the middle of what is not covered on the left and below.
  // A camera that was placed to see something, and was not moved, still sees it.
  resize(width: number, height: number, covered: number, below: number): void {
    const fitted = this.unmoved ? this.fitted : null;
    this.three.aspect = width / Math.max(height, 1);
    this.covered = covered / width;
    this.below = below / height;
    this.three.setViewOffset(width, height, -0.5 * covered, 0.5 * below, width, height);
    if (fitted) this.fit(fitted.min, fitted.max);
  }

  // A camera that sees the whole scene from a direction, for a picture of this aspect.
  forOverview({yaw, pitch}: {yaw: number; pitch: number}, aspect: number): Camera {
    const camera = new Camera();
    camera.up = this.up;
    camera.setScene(this.sceneMin, this.sceneMax);
    camera.three.aspect = aspect;
    camera.look(yaw, pitch);
    camera.fitScene();
    camera.place();
    return camera;
  }

  // Gives the matrices of three.js the present place.
  place(): void {
    const camera = this.three;
    camera.position.copy(this.eye());
    camera.up.set(0, this.up === 'y' ? 1 : 0, this.up === 'z' ? 1 : 0);
    camera.lookAt(this.target);
    const toMiddle = camera.position.distanceTo(this.sceneMiddle);
    camera.far = Math.max(toMiddle + 1.5 * this.sceneRadius, 2 * this.distance);
    camera.near = Math.max(toMiddle - 1.5 * this.sceneRadius, Math.min(0.02 * this.distance, 0.01 * camera.far), 1e-6 * camera.far);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld(true);
  }

  toText(): string {
    const digits = (value: number): string => String(Number(value.toPrecision(7)));
    return [this.target.x, this.target.y, this.target.z, this.distance, this.yaw, this.pitch].map(digits).join('_');
  }

  fromText(text: string): boolean {
    const numbers = text.split('_').map(Number);
    if (numbers.length !== 6 || !numbers.every(Number.isFinite) || numbers[3]! <= 0) return false;
    this.target.set(numbers[0]!, numbers[1]!, numbers[2]!);
    this.distance = numbers[3]!;
    this.look(numbers[4]!, numbers[5]!);
    return true;
  }
}
