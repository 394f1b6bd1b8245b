/** Paints the vertices of a chunk: r, g, b by the chosen colouring, and alpha = 255 where the selected object is. */
import type { Chunk } from "./chunk_store";
import { colourOfId, kStructure, kUnknown, paleColourOfId, ramp, shareOfSightings, type Rgb } from "./colours";
import type { MapObject, ObjectIndex } from "./objects";

export const kColourings = ["instance", "class", "rgb", "height", "seen"] as const;
export type Colouring = (typeof kColourings)[number];

export interface Paint {
  colouring: Colouring;
  objects: ObjectIndex;
  up: [number, number, number];
  heights: [number, number]; // lowest and highest [m], along up
}

type PaintVertex = (v: number) => Rgb;

/** Remembers the last answer, since neighbouring vertices mostly have the same owner. */
function remembered(key: (v: number) => number, colour: (v: number) => Rgb): PaintVertex {
  let lastKey = Number.NaN;
  let last: Rgb = kUnknown;
  return (v) => {
    const now = key(v);
    if (now !== lastKey) {
      lastKey = now;
      last = colour(v);
    }
    return last;
  };
}

function ownerKey(chunk: Chunk): (v: number) => number {
  return (v) => (chunk.instances[v]! > 0 ? chunk.instances[v]! : -1 - chunk.segments[v]!);
}

function byInstance(chunk: Chunk, objects: ObjectIndex): PaintVertex {
  return remembered(ownerKey(chunk), (v) => {
    if (chunk.instances[v]! > 0) return colourOfId(chunk.instances[v]!);
    const object = objects.at(0, chunk.segments[v]!);
    if (!object) return kUnknown;
    return object.group === "structure" ? kStructure : paleColourOfId(object.segments[0] ?? 0);
  });
}

function byClass(chunk: Chunk): PaintVertex {
  return remembered(
    (v) => chunk.classes[v]!,
    (v) => (chunk.classes[v]! > 0 ? colourOfId(chunk.classes[v]!) : kUnknown),
  );
}

function byColour(chunk: Chunk): PaintVertex {
  return (v) => [chunk.colours[4 * v]!, chunk.colours[4 * v + 1]!, chunk.colours[4 * v + 2]!];
}

function byHeight(chunk: Chunk, paint: Paint): PaintVertex {
  const [low, high] = paint.heights;
  const span = Math.max(high - low, 1e-3);
  const table = Array.from({ length: 256 }, (_, i) => ramp(i / 255));
  const p = chunk.positions;
  return (v) => {
    const height = p[3 * v]! * paint.up[0] + p[3 * v + 1]! * paint.up[1] + p[3 * v + 2]! * paint.up[2];
    return table[Math.round(255 * Math.min(1, Math.max(0, (height - low) / span)))]!;
  };
}

function bySightings(chunk: Chunk): PaintVertex {
  const table = Array.from({ length: 256 }, (_, i) => (i === 0 ? kUnknown : ramp(shareOfSightings(i))));
  return (v) => table[chunk.colours[4 * v + 3]!]!;
}

function painter(chunk: Chunk, paint: Paint): PaintVertex {
  switch (paint.colouring) {
    case "instance":
      return byInstance(chunk, paint.objects);
    case "class":
      return byClass(chunk);
    case "rgb":
      return byColour(chunk);
    case "height":
      return byHeight(chunk, paint);
    case "seen":
      return bySightings(chunk);
  }
}

/** Writes r, g, b of all vertices into `out` (4 per vertex) and leaves alpha as it is. */
export function paintChunk(chunk: Chunk, paint: Paint, out: Uint8Array): void {
  const colour = painter(chunk, paint);
  for (let v = 0; v < chunk.segments.length; ++v) {
    const [r, g, b] = colour(v);
    out[4 * v] = r;
    out[4 * v + 1] = g;
    out[4 * v + 2] = b;
  }
}

/** Tells which vertices of a chunk belong to an object. */
export function belongsTo(chunk: Chunk, object: MapObject): (v: number) => boolean {
  if (object.instance > 0) return (v) => chunk.instances[v] === object.instance;
  const segments = new Set(object.segments);
  return (v) => chunk.instances[v] === 0 && segments.has(chunk.segments[v]!);
}

/** Sets alpha: 255 where a vertex belongs to the object, 0 elsewhere. Returns whether any has changed. */
export function markSelected(chunk: Chunk, object: MapObject | null, out: Uint8Array): boolean {
  const inside = object ? belongsTo(chunk, object) : () => false;
  let changed = false;
  for (let v = 0; v < chunk.segments.length; ++v) {
    const alpha = inside(v) ? 255 : 0;
    if (out[4 * v + 3] !== alpha) {
      out[4 * v + 3] = alpha;
      changed = true;
    }
  }
  return changed;
}
