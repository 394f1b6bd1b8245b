/** Chooses how finely to draw: all pixels and triangles when frames are fast, fewer while the view moves when they are slow. */

const kSlow = 60; // [ms] that a frame takes
const kFramesToJudge = 3;
const kRest = 180; // [ms] after a movement until all is drawn again

export interface Quality {
  ratio: number; // drawn pixels to CSS pixels
  coarse: boolean; // fewer triangles
}

export class FrameRate {
  private now: Quality;
  private last = 0;
  private inMovement = false;
  private slowFrames = 0;
  private restTimer: ReturnType<typeof setTimeout> | null = null;

  /** `apply` is called with each new quality. */
  constructor(
    private slow: boolean,
    private readonly apply: (quality: Quality) => void,
  ) {
    this.now = this.atRest();
  }

  get quality(): Quality {
    return this.now;
  }

  /** A frame was drawn at this time [ms]. */
  drawn(now: number): void {
    const interval = now - this.last;
    this.last = now;
    if (!this.inMovement || this.slow || interval > 2000) return;
    this.slowFrames = interval > kSlow ? this.slowFrames + 1 : 0;
    if (this.slowFrames < kFramesToJudge) return;
    this.slow = true;
    this.change({ ratio: 1, coarse: true });
  }

  /** The view begins or ends to move. */
  moving(now: boolean): void {
    this.inMovement = now;
    this.slowFrames = 0;
    if (this.restTimer) clearTimeout(this.restTimer);
    this.restTimer = null;
    if (now && this.slow) this.change({ ratio: 0.75, coarse: true });
    if (!now) this.restTimer = setTimeout(() => this.change(this.atRest()), kRest);
  }

  private atRest(): Quality {
    return { ratio: this.slow ? 1 : Math.min(2, globalThis.devicePixelRatio || 1), coarse: false };
  }

  private change(quality: Quality): void {
    if (quality.ratio === this.now.ratio && quality.coarse === this.now.coarse) return;
    this.now = quality;
    this.apply(quality);
  }
}
