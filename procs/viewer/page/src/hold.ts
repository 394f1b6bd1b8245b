/** While the page is paused: what comes waits here, the newest of everything, until it goes on. */
import type { Block } from "./block_codec";
import type { ServerMessage, MapMessage } from "./protocol";

/** Messages that go to the page also while it is paused, since they are not about the map. */
const kAtOnce = new Set<ServerMessage["kind"]>(["hello", "notice", "processes", "navigation", "timeline"]);

export class Hold {
  private readonly blocks = new Map<string, Block>();
  private readonly newest = new Map<string, ServerMessage>(); // by kind, without that about the map
  private map: MapMessage | null = null; // the newest one
  private readonly paths: ServerMessage[] = [];
  private isReset = false;
  private shown = 0; // revision that was shown when it began
  private came = 0; // revision of the newest map
  private mapId = ""; // of the newest map; "" = not known

  /** Begins to hold; the page shows this revision of this map. */
  begin(mapId: string, revision: number): void {
    this.mapId = mapId;
    this.shown = this.came = revision;
  }

  /** How many updates of the map the page lacks. */
  get behind(): number {
    return Math.max(0, this.came - this.shown);
  }

  /** Whether the message waits here now. */
  keeps(message: ServerMessage): boolean {
    if (kAtOnce.has(message.kind)) return false;
    if (message.kind === "trajectory") this.paths.push(message);
    else if (message.kind === "map") this.keepMap(message);
    else this.newest.set(message.kind, message);
    return true;
  }

  keepBlock(block: Block): void {
    this.blocks.set(block.key, block);
  }

  /** All blocks that the page has are wrong. */
  reset(): void {
    this.isReset = true;
    this.blocks.clear();
  }

  /** Hands over all that waits. The blocks belong to `map` when it is not null. */
  release(): { isReset: boolean; map: MapMessage | null; blocks: Block[]; messages: ServerMessage[] } {
    const map = this.map;
    const messages = [...this.paths, ...this.newest.values()];
    const released = { isReset: this.isReset, map, blocks: [...this.blocks.values()], messages };
    this.map = null;
    this.isReset = false;
    this.blocks.clear();
    this.newest.clear();
    this.paths.length = 0;
    return released;
  }

  private keepMap(message: MapMessage): void {
    const isOther = this.mapId !== "" && message.mapId !== this.mapId;
    if (message.reset || isOther) this.reset();
    this.mapId = message.mapId;
    this.came = message.revision;
    this.map = { ...message, reset: false };
  }
}
