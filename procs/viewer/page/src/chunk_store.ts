/** The surface as it was received, merged into chunks: cubes of blocks that are drawn with one call. */
import { positionsInto, type Block } from "./block_codec";
import { coarseIndices, type Coarseness } from "./coarse";
import { Digest } from "./digest";

/** Merged surface of the blocks of one cube. */
export interface Chunk {
  key: string;
  blocks: number;
  triangles: number;
  positions: Float32Array; // 3 n [m], in W
  normals: Int8Array; // 4 n, 127 = 1
  colours: Uint8Array; // 4 n, see Block
  segments: Uint32Array;
  instances: Uint32Array;
  classes: Uint16Array;
  indices: Uint32Array;
  coarse: Uint32Array; // fewer triangles of the same vertices
  arrivedAt: number; // when the first block came that changed it [ms since 1970]
}

const kChunkEdge = 1.0; // [m], roughly
const kCoarseCells = 2; // cells of the coarse surface along an edge of a block
const kRim = 3 / 16; // of a block's edge: one and a half voxels

/** How many blocks a chunk has along each axis: a power of two, so that chunks stay near kChunkEdge. */
export function blocksPerChunk(blockEdge: number): number {
  return 2 ** Math.min(4, Math.max(1, Math.round(Math.log2(kChunkEdge / blockEdge))));
}

export class ChunkStore {
  private readonly blocks = new Map<string, Block>();
  private readonly members = new Map<string, Set<string>>();
  private readonly dirty = new Map<string, number>(); // chunk to the time of its first change
  private readonly digest = new Digest();
  private triangleCount = 0;

  get blockCount(): number {
    return this.blocks.size;
  }

  get triangles(): number {
    return this.triangleCount;
  }

  get digestText(): string {
    return this.digest.text();
  }

  get dirtyCount(): number {
    return this.dirty.size;
  }

  /** Takes a block in place of the one that was there; one without vertices only removes it. */
  put(block: Block, now = Date.now()): void {
    const chunk = chunkOf(block);
    const before = this.blocks.get(block.key);
    if (before) this.forget(before, now);
    if (block.vertices > 0) {
      this.blocks.set(block.key, block);
      this.digest.add(block.hash);
      this.triangleCount += block.triangles;
      const members = this.members.get(chunk) ?? new Set<string>();
      this.members.set(chunk, members.add(block.key));
    }
    this.touch(chunk, now);
  }

  /** Forgets all blocks. Every chunk has changed then. */
  clear(): void {
    for (const key of this.members.keys()) this.touch(key, Date.now());
    this.blocks.clear();
    this.members.clear();
    this.digest.clear();
    this.triangleCount = 0;
  }

  /** A chunk that has changed since it was taken last, and when the first change came; or null. */
  takeDirty(): { key: string; arrivedAt: number } | null {
    for (const [key, arrivedAt] of this.dirty) {
      this.dirty.delete(key);
      return { key, arrivedAt };
    }
    return null;
  }

  /** The merged surface of a chunk; null when it has none. */
  merge(key: string, arrivedAt = 0): Chunk | null {
    const blocks = [...(this.members.get(key) ?? [])].map((name) => this.blocks.get(name)!);
    return blocks.length > 0 ? { ...mergeBlocks(key, blocks), arrivedAt } : null;
  }

  private touch(chunk: string, now: number): void {
    if (!this.dirty.has(chunk)) this.dirty.set(chunk, now);
  }

  private forget(block: Block, now: number): void {
    const chunk = chunkOf(block);
    this.blocks.delete(block.key);
    this.digest.remove(block.hash);
    this.triangleCount -= block.triangles;
    this.touch(chunk, now);
    const members = this.members.get(chunk);
    members?.delete(block.key);
    if (members?.size === 0) this.members.delete(chunk);
  }
}

function chunkOf(block: Block): string {
  return chunkIndexOf(block).join(",");
}

/** Chunks are half a chunk beside the origin, since floors are often at 0 and would lie in two chunks. */
function chunkIndexOf(block: Block): number[] {
  const side = blocksPerChunk(block.edge);
  return block.index.map((i) => Math.floor(i / side + 0.5));
}

/** How to make the surface of a block's chunk coarser. */
function coarsenessOf(block: Block): Coarseness {
  const side = blocksPerChunk(block.edge);
  const min = chunkIndexOf(block).map((i) => (i - 0.5) * side * block.edge);
  const max = min.map((corner) => corner + side * block.edge);
  return { cell: block.edge / kCoarseCells, box: { min, max }, rim: kRim * block.edge };
}

/** All blocks as one set of arrays. */
export function mergeBlocks(key: string, blocks: Block[]): Chunk {
  const n = blocks.reduce((sum, block) => sum + block.vertices, 0);
  const m = blocks.reduce((sum, block) => sum + block.triangles, 0);
  const chunk: Chunk = {
    key,
    blocks: blocks.length,
    triangles: m,
    positions: new Float32Array(3 * n),
    normals: new Int8Array(4 * n),
    colours: new Uint8Array(4 * n),
    segments: new Uint32Array(n),
    instances: new Uint32Array(n),
    classes: new Uint16Array(n),
    indices: new Uint32Array(3 * m),
    coarse: new Uint32Array(0),
    arrivedAt: 0,
  };
  let vertex = 0;
  let index = 0;
  for (const block of blocks) {
    positionsInto(block, chunk.positions, vertex);
    chunk.normals.set(block.normals, 4 * vertex);
    chunk.colours.set(block.colours, 4 * vertex);
    chunk.segments.set(block.segments, vertex);
    chunk.instances.set(block.instances, vertex);
    chunk.classes.set(block.classes, vertex);
    for (const corner of block.indices) chunk.indices[index++] = corner + vertex;
    vertex += block.vertices;
  }
  chunk.coarse = coarseIndices(chunk.positions, chunk.indices, coarsenessOf(blocks[0]!));
  return chunk;
}
