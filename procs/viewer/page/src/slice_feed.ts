/** Asks for the slice that is wanted: one request at a time, and the newest wish always wins. */
import { getBytes, getJson } from "./api";
import { count } from "./dom";
import { asList, asNumber, asObject } from "./json";
import { decodeSlice, type Axis, type Slice } from "./slice_data";
import type { Leaf } from "./leaf_boxes";

export interface SliceWish {
  axis: Axis;
  at: number; // [m]
  contours: boolean;
  leaves: LeafLayer | null;
}

/** Octrees: as the map is, or closed as planners get it. */
export type LeafLayer = "raw" | "closed";

const kPause = 80; // [ms] that the slider stands still

export class SliceFeed {
  private wish: SliceWish | null = null;
  private timer: ReturnType<typeof setTimeout> | null = null;
  private asking = false;
  private map = 0; // counts the maps

  constructor(
    private readonly onSlice: (slice: Slice, wish: SliceWish, leaves: Leaf[]) => void,
    private readonly onError: (text: string) => void,
    /** The leaves that were wanted have come; else the reason. */
    private readonly onLeaves: (problem: string) => void,
  ) {}

  /** null = no slice is wanted any more. */
  want(wish: SliceWish | null): void {
    this.wish = wish;
    if (this.timer) clearTimeout(this.timer);
    this.timer = wish ? setTimeout(() => void this.ask(), kPause) : null;
  }

  /** Another map: answers that are on their way are about the old one. */
  forget(): void {
    ++this.map;
    this.want(null);
  }

  private async ask(): Promise<void> {
    if (this.asking || !this.wish) return;
    this.asking = true;
    const wish = this.wish;
    await this.answer(wish);
    this.asking = false;
    if (this.wish !== wish && this.wish !== null) await this.ask();
  }

  private async answer(wish: SliceWish): Promise<void> {
    const map = this.map;
    const where = `axis=${wish.axis}&at=${wish.at.toFixed(4)}`;
    const answer = await getBytes(`api/slice?${where}${wish.contours ? "&distance=1" : ""}`);
    if (map !== this.map) return;
    if (answer.error !== null) {
      if (this.wish) this.onError(answer.error);
      return;
    }
    const leaves = wish.leaves ? await leavesAt(`${where}&layer=${wish.leaves}`) : { leaves: [], problem: null };
    if (map !== this.map || this.wish?.axis !== wish.axis) return;
    try {
      this.onSlice(decodeSlice(answer.value), wish, leaves.leaves);
      this.onLeaves(leaves.problem ?? "");
    } catch (error) {
      this.onError(error instanceof Error ? error.message : String(error));
    }
  }
}

async function leavesAt(where: string): Promise<{ leaves: Leaf[]; problem: string | null }> {
  const answer = await getJson(`api/leaves?${where}`);
  if (answer.error !== null) return { leaves: [], problem: answer.error };
  const leftOut = asNumber(asObject(answer.value).left_out);
  const problem = leftOut > 0 ? `${count(leftOut)} small leaves are not drawn.` : null;
  const leaves = asList(asObject(answer.value).leaves).map((entry) => {
    const [x, y, z, size, state] = asList(entry).map((value) => asNumber(value));
    return { centre: [x ?? 0, y ?? 0, z ?? 0], size: size ?? 0, occupied: state === 2 };
  });
  return { leaves, problem };
}
