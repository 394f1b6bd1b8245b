/** A coarser surface of the same vertices, for drawing while the view moves on a slow computer. */

/**
 * Joins vertices that lie in one cube of the edge `cell` [m] to the first of them, and leaves out triangles that become
 * lines or points, or that are there already. The result names vertices of the same arrays.
 */
export function coarseIndices(positions: Float32Array, indices: Uint32Array, cell: number): Uint32Array {
  const first = firstOfCells(positions, cell);
  const out = new Uint32Array(indices.length);
  const seen = new Set<number>();
  const n = positions.length / 3;
  let size = 0;
  for (let t = 0; t < indices.length; t += 3) {
    const a = first[indices[t]!]!;
    const b = first[indices[t + 1]!]!;
    const c = first[indices[t + 2]!]!;
    if (a === b || b === c || c === a) continue;
    const key = triangleKey(a, b, c, n);
    if (seen.has(key)) continue;
    seen.add(key);
    out[size++] = a;
    out[size++] = b;
    out[size++] = c;
  }
  return out.slice(0, size);
}

/** The first vertex of the cell of each vertex. */
function firstOfCells(positions: Float32Array, cell: number): Uint32Array {
  const n = positions.length / 3;
  const first = new Uint32Array(n);
  const cells = new Map<number, number>();
  const at = (v: number, axis: number): number => Math.floor(positions[3 * v + axis]! / cell) + (1 << 16);
  for (let v = 0; v < n; ++v) {
    // 17 bits for each axis: exact in a double.
    const key = ((at(v, 0) & 0x1ffff) * 0x20000 + (at(v, 1) & 0x1ffff)) * 0x20000 + (at(v, 2) & 0x1ffff);
    const known = cells.get(key);
    first[v] = known ?? v;
    if (known === undefined) cells.set(key, v);
  }
  return first;
}

/** A number for a triangle that does not depend on which corner comes first. Near enough to exact: a clash leaves out one triangle. */
function triangleKey(a: number, b: number, c: number, n: number): number {
  if (b < a && b < c) return (b * n + c) * n + a;
  if (c < a && c < b) return (c * n + a) * n + b;
  return (a * n + b) * n + c;
}
