/** Chooses how many pixels are drawn: all of the screen's when frames are fast, fewer when they are slow. */

const kSlow = 60; // [ms] between two frames of a movement
const kFramesToJudge = 4;

export class FrameRate {
  ratio: number;
  private last = 0;
  private inMovement = false;
  private slowFrames = 0;
  private restTimer: ReturnType<typeof setTimeout> | null = null;

  /** `apply` is called with the new ratio of drawn pixels to CSS pixels. */
  constructor(
    private slow: boolean,
    private readonly apply: (ratio: number) => void,
  ) {
    this.ratio = this.restRatio();
  }

  /** A frame was drawn at this time [ms]. */
  drawn(now: number): void {
    const interval = now - this.last;
    this.last = now;
    if (!this.inMovement || interval > 2000) return;
    this.slowFrames = interval > kSlow ? this.slowFrames + 1 : 0;
    if (this.slowFrames >= kFramesToJudge && !this.slow) {
      this.slow = true;
      this.change(1);
    }
  }

  /** The camera begins or ends to be moved. On a slow computer fewer pixels are drawn meanwhile. */
  moving(now: boolean): void {
    this.inMovement = now;
    this.slowFrames = 0;
    if (this.restTimer) clearTimeout(this.restTimer);
    this.restTimer = null;
    if (now && this.slow) this.change(0.6);
    if (!now) this.restTimer = setTimeout(() => this.change(this.restRatio()), 150);
  }

  private restRatio(): number {
    return this.slow ? 1 : Math.min(2, globalThis.devicePixelRatio || 1);
  }

  private change(ratio: number): void {
    if (ratio === this.ratio) return;
    this.ratio = ratio;
    this.apply(ratio);
  }
}
