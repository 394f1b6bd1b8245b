/** When to draw what the map has changed: not too often on a slow computer, and a moment of a log only when it is complete. */

const kDrawingShare = 4; // such drawings take at most one part in so many of the time

export class DrawPacer {
  private drawnAt = 0; // [ms]
  private cost = 0; // of the last drawing [ms]
  private heldUntil = 0; // [ms]
  private timer: ReturnType<typeof setTimeout> | null = null;

  constructor(
    private readonly draw: () => void,
    private readonly now: () => number = () => performance.now(),
  ) {}

  /** A drawing has begun and ended at these times [ms]. */
  drawn(begin: number, end: number): void {
    this.drawnAt = end;
    this.cost = end - begin;
  }

  /** Asks for a drawing as soon as it may be. */
  soon(): void {
    if (this.timer) return;
    const wait = Math.max(this.drawnAt + kDrawingShare * this.cost, this.heldUntil) - this.now();
    this.timer = setTimeout(() => {
      this.timer = null;
      this.draw();
    }, Math.max(0, wait));
  }

  /** The map is on its way to another moment, and what lies between is not worth a drawing for so long [ms]. */
  hold(most: number): void {
    if (this.now() < this.heldUntil) return; // or a slider that moves would hold it for ever
    this.heldUntil = this.now() + most;
    if (!this.timer) return;
    clearTimeout(this.timer);
    this.timer = null;
    this.soon();
  }

  /** The map is there: draws at once. */
  release(): void {
    this.heldUntil = 0;
    if (this.timer) clearTimeout(this.timer);
    this.timer = null;
    this.draw();
  }
}
