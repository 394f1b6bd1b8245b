/** Block of surface: the binary message of kind 1, see procs/viewer. */

/** One block as it came; the arrays look into the message's bytes. */
export interface Block {
  key: string; // "i,j,k"
  index: [number, number, number];
  edge: number; // [m]
  revision: number;
  hash: bigint;
  vertices: number; // 0 = the block has no surface any more
  triangles: number;
  positions: Uint16Array; // x y z 0 of each vertex
  normals: Int8Array; // x y z 0, 127 = 1
  colours: Uint8Array; // r g b, how often it was seen (0 = not known)
  segments: Uint32Array;
  instances: Uint32Array; // 0 = none
  classes: Uint16Array;
  indices: Uint16Array | Uint32Array; // three for each triangle
}

export const kBlockKind = 1;
export const kBatchKind = 3;
const kHeaderBytes = 48;
const kMaxVertices = 1 << 24;

const toFour = (size: number): number => (size + 3) & ~3;

/** Decodes a message; throws an Error with a sentence when it is malformed. */
export function decodeBlock(bytes: ArrayBuffer): Block {
  if (bytes.byteLength < kHeaderBytes) {
    throw new Error(`A block of surface needs ${kHeaderBytes} bytes of header; ${bytes.byteLength} came.`);
  }
  const view = new DataView(bytes);
  if (view.getUint8(0) !== kBlockKind) {
    throw new Error(`A block of surface begins with ${kBlockKind}; this message begins with ${view.getUint8(0)}.`);
  }
  const wide = (view.getUint16(2, true) & 1) !== 0;
  const index: [number, number, number] = [view.getInt32(4, true), view.getInt32(8, true), view.getInt32(12, true)];
  const edge = view.getFloat32(16, true);
  const n = view.getUint32(24, true);
  const m = view.getUint32(28, true);
  if (!(edge > 0) || n > kMaxVertices || m > 2 * kMaxVertices) {
    throw new Error(`A block of surface has an edge of ${edge} m, ${n} vertices and ${m} triangles.`);
  }
  const expected = kHeaderBytes + 24 * n + toFour(2 * n) + (wide ? 12 : 6) * m;
  if (bytes.byteLength < expected) {
    throw new Error(`A block of ${n} vertices and ${m} triangles needs ${expected} bytes; ${bytes.byteLength} came.`);
  }
  let at = kHeaderBytes;
  const take = (size: number): number => {
    const start = at;
    at += toFour(size);
    return start;
  };
  const block: Block = {
    key: index.join(","),
    index,
    edge,
    revision: view.getUint32(20, true),
    hash: view.getBigUint64(32, true),
    vertices: n,
    triangles: m,
    positions: new Uint16Array(bytes, take(8 * n), 4 * n),
    normals: new Int8Array(bytes, take(4 * n), 4 * n),
    colours: new Uint8Array(bytes, take(4 * n), 4 * n),
    segments: new Uint32Array(bytes, take(4 * n), n),
    instances: new Uint32Array(bytes, take(4 * n), n),
    classes: new Uint16Array(bytes, take(2 * n), n),
    indices: wide ? new Uint32Array(bytes, take(12 * m), 3 * m) : new Uint16Array(bytes, take(6 * m), 3 * m),
  };
  for (const vertex of block.indices) {
    if (vertex >= n) throw new Error(`A triangle of block ${block.key} names vertex ${vertex} of ${n}.`);
  }
  return block;
}

/** The blocks of a message that has several, each in memory of its own, so that none keeps the others'. */
export function* blocksOfBatch(bytes: ArrayBuffer): Generator<Block> {
  const view = new DataView(bytes);
  const count = bytes.byteLength >= 8 ? view.getUint32(4, true) : -1;
  let at = 8;
  for (let i = 0; i < count; ++i) {
    const size = at + 4 <= bytes.byteLength ? view.getUint32(at, true) : -1;
    if (size < 0 || at + 4 + size > bytes.byteLength) break;
    yield decodeBlock(bytes.slice(at + 4, at + 4 + size));
    at += 4 + size;
  }
  if (count < 0 || at !== bytes.byteLength) throw new Error(`A message of ${bytes.byteLength} bytes with several blocks has a wrong size.`);
}

/** Writes the positions of a block's vertices [m] in W into `out` from number `from` on, three numbers each. */
export function positionsInto(block: Block, out: Float32Array, from: number): void {
  const scale = (2 * block.edge) / 65535;
  const base = block.index.map((i) => (i - 0.5) * block.edge);
  for (let v = 0; v < block.vertices; ++v) {
    for (let axis = 0; axis < 3; ++axis) {
      out[3 * (from + v) + axis] = base[axis]! + block.positions[4 * v + axis]! * scale;
    }
  }
}
