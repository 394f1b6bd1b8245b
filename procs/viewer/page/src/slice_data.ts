/** A slice through free, occupied and unknown space: the binary answer of /api/slice. */
import { kFree, kNotSeen, kOccupied, type Rgb } from "./colours";
import { asNumber, asObject, asText, asVector } from "./json";

export type Axis = "x" | "y" | "z";
export const kAxes: Axis[] = ["x", "y", "z"];

export interface Slice {
  axis: Axis; // across the slice
  at: number; // [m] along it
  cell: number; // edge of a cell [m]
  origin: [number, number]; // corner of the first cell along the two other axes [m]
  width: number;
  height: number;
  cells: Uint8Array; // kStates, row by row
  /** Of each cell to the nearest obstacle of the map, in all directions [m]; NaN = not known. Null: the server has none. */
  distances: Float32Array | null;
}

export const kStates = ["unknown", "free", "occupied"] as const;
const kColours: Rgb[] = [kNotSeen, kFree, kOccupied];
const kMaxCells = 1 << 24;

/** Decodes an answer; throws an Error with a sentence when it is malformed. */
export function decodeSlice(bytes: ArrayBuffer): Slice {
  if (bytes.byteLength < 4) throw new Error(`A slice needs a header of 4 bytes; ${bytes.byteLength} came.`);
  const size = new DataView(bytes).getUint32(0, true);
  const start = 4 + Math.ceil(size / 4) * 4;
  if (start > bytes.byteLength) throw new Error(`A slice says that its text has ${size} bytes; ${bytes.byteLength} came in all.`);
  const about = asObject(JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, size))));
  const [width, height] = [asNumber(about.width), asNumber(about.height)];
  const origin = asVector(about.origin, 2) ?? [0, 0];
  const axis = kAxes.find((name) => name === asText(about.axis)) ?? "z";
  const count = width * height;
  if (!Number.isInteger(count) || count < 0 || count > kMaxCells || !(asNumber(about.cell_m) > 0)) {
    throw new Error(`A slice has ${width} x ${height} cells of ${asNumber(about.cell_m)} m.`);
  }
  if (start + count > bytes.byteLength) throw new Error(`A slice of ${width} x ${height} cells is cut off.`);
  return {
    axis,
    at: asNumber(about.at_m),
    cell: asNumber(about.cell_m),
    origin: [origin[0]!, origin[1]!],
    width,
    height,
    cells: new Uint8Array(bytes, start, count),
    distances: about.distances === true ? readDistances(bytes, start + count, count) : null,
  };
}

function readDistances(bytes: ArrayBuffer, end: number, count: number): Float32Array {
  const start = Math.ceil(end / 4) * 4;
  if (start + 4 * count > bytes.byteLength) throw new Error(`The distances of a slice of ${count} cells are cut off.`);
  return new Float32Array(bytes, start, count);
}

/** The numbers (0 to 2 for x to z) of the two axes in the slice, and of the one across it. */
export function axesOf(axis: Axis): { u: number; v: number; across: number } {
  const across = kAxes.indexOf(axis);
  const [u, v] = [0, 1, 2].filter((other) => other !== across);
  return { u: u!, v: v!, across };
}

/** r, g, b, a of each cell. */
export function pixelsOf(slice: Slice, opacity: number): Uint8Array<ArrayBuffer> {
  const pixels = new Uint8Array(4 * slice.cells.length);
  slice.cells.forEach((state, i) => {
    const colour = kColours[state] ?? kNotSeen;
    pixels.set(colour, 4 * i);
    pixels[4 * i + 3] = Math.round(255 * (state === 0 ? 0.5 * opacity : opacity));
  });
  return pixels;
}

/** The state of the cell at a point of W [m]; null outside the slice. */
export function stateAt(slice: Slice, point: number[]): (typeof kStates)[number] | null {
  const { u, v } = axesOf(slice.axis);
  const column = Math.floor((point[u]! - slice.origin[0]) / slice.cell);
  const row = Math.floor((point[v]! - slice.origin[1]) / slice.cell);
  if (column < 0 || row < 0 || column >= slice.width || row >= slice.height) return null;
  return kStates[slice.cells[row * slice.width + column]!] ?? "unknown";
}
