/** How long it takes from the arrival of a block to its drawing: the newest values, and their percentiles. */

const kKept = 1000;

export class Latency {
  private readonly values: number[] = [];
  private next = 0;
  private waiting: number[] = [];

  /** Something that arrived at this time [ms since 1970] will be drawn next. */
  arrived(at: number): void {
    this.waiting.push(at);
  }

  /** All that arrived was drawn at this time. */
  drawn(at: number): void {
    for (const arrival of this.waiting) {
      this.values[this.next] = at - arrival;
      this.next = (this.next + 1) % kKept;
    }
    this.waiting = [];
  }

  summary(): { count: number; p50: number; p95: number; max: number } {
    const sorted = [...this.values].sort((a, b) => a - b);
    const at = (share: number): number => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
    return { count: sorted.length, p50: at(0.5), p95: at(0.95), max: sorted.at(-1) ?? 0 };
  }
}
