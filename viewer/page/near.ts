// Reads the boxes near the target that the overview leaves out, when the camera rests.
import {isAbort} from './dom.ts';
import type {SceneModel} from './scene_model.ts';
import type {Source} from './source.ts';
import type {Stage} from './stage.ts';
import type {Point} from './types.ts';

export interface NearBoxes {
  min: Point;
  max: Point;
  total: number;
  objects: Uint32Array;
  boxes: Float32Array;
  partners: Uint32Array;
}

// Beyond this part of the scene's size, the overview must do.
const largestPart = 0.4;
const keptAnswers = 8;

export class Near {
  shown: NearBoxes | null = null;
  private answers: NearBoxes[] = [];
  private abort = new AbortController();

  constructor(private readonly source: Source, private readonly model: SceneModel, private readonly stage: Stage,
    private readonly changed: () => void, private readonly failed: (error: unknown) => void) {}

  // A new frame has other boxes.
  forget(): void {
    this.answers = [];
    this.abort.abort();
    this.use(null);
  }

  async update(): Promise<void> {
    if (!this.model.view.has.near || this.source.exported) return;
    const {camera} = this.stage;
    const reach = 1.3 * camera.reach() * Math.max(1, camera.three.aspect);
    if (reach > largestPart * camera.radius()) return this.use(null);
    const known = this.answers.find(answer => this.covers(answer, reach));
    if (known) return this.use(known);
    this.abort.abort();
    this.abort = new AbortController();
    try {
      await this.read(1.5 * reach, this.abort.signal);
    } catch (error) {
      if (!isAbort(error)) this.failed(error);
    }
  }

  private async read(half: number, signal: AbortSignal): Promise<void> {
    const {x, y, z} = this.stage.camera.target;
    const min: Point = [x - half, y - half, z - half];
    const max: Point = [x + half, y + half, z + half];
    const text = (point: Point): string => this.model.toAbsolute(point).join(',');
    const bytes = await this.source.bytes(`near/${this.model.frame.info.frame}.bin?min=${text(min)}&max=${text(max)}`, signal);
    if (signal.aborted) return;
    const [total, count] = new Uint32Array(bytes, 0, 2) as unknown as [number, number];
    const answer = {
      min, max, total, objects: new Uint32Array(bytes, 8, count), boxes: new Float32Array(bytes, 8 + 4 * count, 6 * count),
      partners: new Uint32Array(bytes, 8 + 28 * count, count),
    };
    this.answers = [answer, ...this.answers].slice(0, keptAnswers);
    this.use(answer);
  }

  // An answer is good for a region inside it, if it has all boxes or is not much larger.
  private covers(answer: NearBoxes, reach: number): boolean {
    const at = this.stage.camera.target.toArray();
    const inside = at.every((value, k) => value - reach >= answer.min[k]! && value + reach <= answer.max[k]!);
    return inside && (answer.objects.length === answer.total || answer.max[0] - answer.min[0] <= 5 * reach);
  }

  private use(answer: NearBoxes | null): void {
    if (answer === this.shown) return;
    this.shown = answer;
    this.stage.near.setBoxes(answer?.boxes ?? new Float32Array(0), answer?.objects.length ?? 0);
    this.changed();
  }
}
