// How long pictures take, and so which share of the boxes can be drawn while the camera moves.

// A picture that takes longer makes motion look jerky.
const wantedMilliseconds = 60;
const leastShare = 0.02;

export class Pace {
  share = 1;
  busy = false;

  constructor(private readonly gl: WebGL2RenderingContext, private readonly free: () => void) {}

  // A picture with this share of all boxes was handed to the graphics.
  drew(share: number): void {
    const fence = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (!fence) return;
    this.gl.flush();
    this.busy = true;
    this.poll(fence, performance.now(), share);
  }

  private poll(fence: WebGLSync, began: number, share: number): void {
    const state = this.gl.getSyncParameter(fence, this.gl.SYNC_STATUS);
    const took = performance.now() - began;
    if (state !== this.gl.SIGNALED && took < 10_000 && !this.gl.isContextLost()) {
      setTimeout(() => this.poll(fence, began, share), 3);
      return;
    }
    this.gl.deleteSync(fence);
    this.busy = false;
    // A part of the time does not depend on the share, so it is approached step by step.
    const change = share === 1 ? 1 : 1.5;
    this.share = Math.min(1, Math.max(leastShare, share * Math.min(change, wantedMilliseconds / Math.max(took, 1))));
    this.free();
  }
}

// Whether the processor draws instead of a graphics card.
export function isSoftware(): boolean {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl) return false;
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}
