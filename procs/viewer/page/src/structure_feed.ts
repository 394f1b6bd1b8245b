/** Structure and the upward direction, which do not come over the bus: asked for now and then. */
import { getJson, isLog } from "./api";
import { asList, asObject, asVector, isObject } from "./json";
import { readObject, type MapObject } from "./objects";

const kInterval = 30000; // [ms]
const kLogInterval = 500; // [ms] of a log, whose viewer has the answers

export class StructureFeed {
  private asked = -Infinity;
  private revision = -2;
  private upRevision = -1; // of a log: going back turns no view, and less is known there
  private asking = false;
  private map = 0; // counts the maps

  constructor(private readonly onAnswer: (structure: MapObject[], up: [number, number, number] | null) => void) {}

  /** Asks if the map has changed, the page is looked at, and the last time was long ago. */
  async refresh(revision: number): Promise<void> {
    const now = performance.now();
    if (this.asking || revision < 0 || revision === this.revision || document.hidden || now - this.asked < (isLog() ? kLogInterval : kInterval)) return;
    this.asking = true;
    this.asked = now;
    const map = this.map;
    const answer = await getJson("api/objects");
    this.asking = false;
    if (answer.error !== null || map !== this.map) return;
    this.revision = revision;
    const json = asObject(answer.value);
    const up = asVector(asObject(json.up).direction, 3);
    const structure = asList(json.structure).filter(isObject).map((entry) => readObject({ ...entry, structure: true }));
    const turns = up !== null && (!isLog() || revision >= this.upRevision);
    if (turns) this.upRevision = revision;
    this.onAnswer(structure, turns ? [up[0]!, up[1]!, up[2]!] : null);
  }

  /** Another map: what was known is no longer true. */
  reset(): void {
    ++this.map;
    this.asked = -Infinity;
    this.revision = -2;
    this.upRevision = -1;
  }
}
