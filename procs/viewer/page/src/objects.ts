/** The objects of the map as the list shows them. */
import { asList, asNumber, asNumbers, asText, asVector, type Json } from "./json";

export type Group = "named" | "discovered" | "structure" | "removed";

export interface Box {
  centre: number[]; // [m] in W
  size: number[]; // [m]
  orientation: number[]; // R_W_B as x, y, z, w
}

export interface MapObject {
  id: string; // "7" for an instance, "s12" for what has none
  name: string;
  group: Group;
  instance: number; // 0 = none
  segments: number[];
  classId: number;
  score: number; // probability of its class
  probabilities: Record<string, number>;
  box: Box | null;
  frames: number;
  points: number;
  area: number; // [m^2]
  firstUtime: number;
  lastUtime: number;
}

export function readObject(json: Json): MapObject {
  const instance = asNumber(json.instance);
  const segments = asList(json.segments).map((label) => asNumber(label));
  const group = groupOf(json, instance);
  const kind = asText(json.kind);
  return {
    id: asText(json.id) || (instance > 0 ? String(instance) : `s${segments[0] ?? 0}`),
    name: group === "structure" && kind !== "" ? kind : instance > 0 ? asText(json.class_name, "object") : "thing",
    group,
    instance,
    segments,
    classId: asNumber(json.class),
    score: asNumber(json.score),
    probabilities: asNumbers(json.class_probabilities),
    box: readBox(json),
    frames: asNumber(json.frames),
    points: asNumber(json.points),
    area: asNumber(json.area),
    firstUtime: asNumber(json.first_utime),
    lastUtime: asNumber(json.last_utime),
  };
}

function groupOf(json: Json, instance: number): Group {
  if (json.removed === true || json.state === "removed") return "removed";
  if (json.structure === true) return "structure";
  return json.discovered === true || instance === 0 ? "discovered" : "named";
}

function readBox(json: Json): Box | null {
  const centre = asVector(json.center, 3);
  const size = asVector(json.size, 3);
  const orientation = asVector(json.orientation, 4) ?? [0, 0, 0, 1];
  return centre && size ? { centre, size, orientation } : null;
}

/** Whether all words of the text stand in the object's name, class, id or group. */
export function matches(object: MapObject, text: string): boolean {
  const where = `${object.name} ${object.id} #${object.id} ${object.group}`.toLowerCase();
  return text
    .toLowerCase()
    .split(/\s+/)
    .every((word) => where.includes(word));
}

/** "0.90×0.44×0.44", longest side first [m]. */
export function sizeText(box: Box | null): string {
  const sides = [...(box?.size ?? [])].sort((a, b) => b - a);
  return sides.map((side) => side.toFixed(2)).join("×");
}

/** How long before the newest frame, in the largest unit that fits: "now", "42 s". */
export function ageText(utime: number, now: number): string {
  const seconds = Math.max(0, (now - utime) / 1e6);
  if (seconds < 1) return "now";
  if (seconds < 100) return `${Math.round(seconds)} s`;
  if (seconds < 6000) return `${Math.round(seconds / 60)} min`;
  return `${Math.round(seconds / 3600)} h`;
}

/** Finds the object that a piece of surface belongs to. */
export class ObjectIndex {
  private readonly byInstance = new Map<number, MapObject>();
  private readonly bySegment = new Map<number, MapObject>();
  private readonly byId = new Map<string, MapObject>();

  /** The same for two lists that give all surface the same colours. */
  readonly signature: string;

  constructor(readonly all: MapObject[]) {
    const nameless = all.filter((object) => object.instance === 0);
    this.signature = nameless.map((object) => `${object.group}:${object.segments.join()}`).join(" ");
    for (const object of all) {
      this.byId.set(object.id, object);
      if (object.group === "removed") continue;
      if (object.instance > 0) this.byInstance.set(object.instance, object);
      else for (const segment of object.segments) this.bySegment.set(segment, object);
    }
  }

  get(id: string): MapObject | null {
    return this.byId.get(id) ?? null;
  }

  /** The object of a vertex; null for surface that is no object. */
  at(instance: number, segment: number): MapObject | null {
    return (instance > 0 ? this.byInstance.get(instance) : this.bySegment.get(segment)) ?? null;
  }
}
