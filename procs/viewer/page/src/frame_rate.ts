/** Chooses how finely to draw: all pixels and triangles when frames are fast, fewer while the view moves when they are slow. */

const kSlow = 60; // [ms] that a frame takes
const kFramesToJudge = 3;
const kMovingRatio = 0.75; // pixels that are drawn while the view moves on a slow computer
const kRest = 180; // [ms] after a movement until all is drawn again
const kQuiet = 800; // [ms] without a change of the map until all of it is drawn

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
  private quietTimer: ReturnType<typeof setTimeout> | null = null;

  /** `apply` is called with each new quality. */
  constructor(
    private slow: boolean,
    private readonly apply: (quality: Quality) => void,
  ) {
    this.now = this.wanted();
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
    this.update();
  }

  /** The map has changed: on a slow computer it is drawn coarsely until it stays as it is. */
  mapChanged(): void {
    if (!this.slow) return;
    if (this.quietTimer) clearTimeout(this.quietTimer);
    this.quietTimer = setTimeout(() => {
      this.quietTimer = null;
      this.update();
    }, kQuiet);
    this.update();
  }

  /** The view begins or ends to move. */
  moving(now: boolean): void {
    this.slowFrames = 0;
    if (this.restTimer) clearTimeout(this.restTimer);
    this.restTimer = null;
    if (now) {
      this.inMovement = true;
      this.update();
      return;
    }
    this.restTimer = setTimeout(() => {
      this.restTimer = null;
      this.inMovement = false;
      this.update();
    }, kRest);
  }

  private wanted(): Quality {
    if (!this.slow) return { ratio: Math.min(2, globalThis.devicePixelRatio || 1), coarse: false };
    if (this.inMovement) return { ratio: kMovingRatio, coarse: true };
    return { ratio: 1, coarse: this.quietTimer !== null };
  }

  private update(): void {
    const quality = this.wanted();
    if (quality.ratio === this.now.ratio && quality.coarse === this.now.coarse) return;
    this.now = quality;
    this.apply(quality);
  }
}
