/** Decides when all blocks must be asked for again: the server's surface differs from ours, and nothing comes any more. */
import { sameDigest } from "./digest";

const kPatience = 3000; // [ms]; doubles with each time that asking did not help
const kMostPatience = 300000; // [ms]

export class Staleness {
  private lastBlock = 0;
  private differsSince: number | null = null;
  private patience = kPatience;

  /** A block came at this time [ms]. */
  blockCame(now: number): void {
    this.lastBlock = now;
    this.differsSince = null;
  }

  /** Compares with what the server says that it has; true = ask for all blocks now. */
  check(now: number, ours: { blocks: number; digest: string }, theirs: { blocks: number; digest: string; waiting: number }): boolean {
    const level = ours.blocks === theirs.blocks && sameDigest(ours.digest, theirs.digest);
    if (level) this.patience = kPatience;
    if (theirs.digest === "" || theirs.waiting > 0 || level) {
      this.differsSince = null;
      return false;
    }
    this.differsSince ??= now;
    if (now - Math.max(this.differsSince, this.lastBlock) < this.patience) return false;
    this.differsSince = null;
    this.lastBlock = now;
    this.patience = Math.min(2 * this.patience, kMostPatience);
    return true;
  }
}
