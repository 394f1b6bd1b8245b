/** What has happened when the server shows another map, or an earlier state of the same one. */
import { count } from "./dom";
import type { MapMessage } from "./protocol";

/** A map that was shown. */
export interface ShownMap {
  mapId: string;
  revision: number;
  serverStart: number; // when the map server was started [us]; 0 = not known
}

export interface MapChange {
  /** All that is known of the map before is wrong, not only its surface. */
  kind: "other map" | "went back";
  text: string;
}

export function shownMap(map: MapMessage): ShownMap {
  return { mapId: map.mapId, revision: map.revision, serverStart: map.serverStart };
}

function framesText(revision: number): string {
  return `${count(revision)} ${revision === 1 ? "frame" : "frames"}`;
}

/** null while the map is the same one and grows. `before` is null as long as there was none. */
export function mapChange(before: ShownMap | null, now: ShownMap): MapChange | null {
  if (before === null || before.mapId === "" || now.mapId === "" || now.revision < 0) return null;
  if (now.mapId === before.mapId) {
    if (now.revision >= before.revision) return null;
    return { kind: "went back", text: `The map was corrected: it went back from ${framesText(before.revision)} to ${framesText(now.revision)}.` };
  }
  const restarted = before.serverStart > 0 && now.serverStart > 0 && before.serverStart !== now.serverStart;
  if (restarted && now.revision === 0) return { kind: "other map", text: "The map server was started again, and its map is empty." };
  if (restarted) return { kind: "other map", text: `The map server was started again; its map has ${framesText(now.revision)}.` };
  if (now.revision === 0) return { kind: "other map", text: "The map was reset: it is empty now and begins anew." };
  return { kind: "other map", text: `There is another map now: it was loaded, or the old one was reset. It has ${framesText(now.revision)}.` };
}
