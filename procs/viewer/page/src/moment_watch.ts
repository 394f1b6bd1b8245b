/** How long it takes from the wish for a moment until exactly that is drawn. */

const kKept = 500;

export class MomentWatch {
  readonly durations: number[] = []; // [ms]
  shown: number | null = null; // the moment that is drawn exactly
  private wanted: number | null = null;
  private askedAt = 0;
  private isLevel = false;

  /** A person wants this moment now [ms]. */
  ask(frames: number, now: number): void {
    this.wanted = frames;
    this.askedAt = now;
    this.isLevel = false;
  }

  /** Whether the last wish is fulfilled, or there was none. */
  get isDone(): boolean {
    return this.wanted === null;
  }

  /** How long the last wish has been waiting [ms]. */
  waiting(now: number): number {
    return this.wanted === null ? 0 : now - this.askedAt;
  }

  /** The page has all of this moment, or not yet all. Answers whether it must be drawn for the watch's sake. */
  has(frames: number, level: boolean): boolean {
    if (!level) return false;
    if (this.wanted === null) this.shown = frames;
    if (this.wanted !== frames || this.isLevel) return false;
    this.isLevel = true;
    return true;
  }

  /** All that the page has is drawn. */
  drawn(now: number): void {
    if (!this.isLevel || this.wanted === null) return;
    this.shown = this.wanted;
    this.wanted = null;
    this.isLevel = false;
    this.durations.push(now - this.askedAt);
    if (this.durations.length > kKept) this.durations.shift();
  }

  summary(): { count: number; last: number; p50: number; p95: number; max: number } {
    const sorted = [...this.durations].sort((a, b) => a - b);
    const at = (share: number): number => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
    return { count: sorted.length, last: this.durations.at(-1) ?? 0, p50: at(0.5), p95: at(0.95), max: sorted.at(-1) ?? 0 };
  }
}
