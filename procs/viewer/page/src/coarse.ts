/** A coarser surface of the same vertices, for drawing while the view moves on a slow computer. */

/** How vertices are joined: in cubes of the edge `cell`, except where they lie within `rim` of a face of the `box` [m]. */
export interface Coarseness {
  cell: number;
  box: { min: number[]; max: number[] };
  rim: number; // so that surfaces of neighbouring boxes still meet
}

/**
 * Joins the vertices of a cube to the one nearest to its centre, and leaves out triangles that become lines or points, or
 * that are there already. The result names vertices of the same arrays.
 */
export function coarseIndices(positions: Float32Array, indices: Uint32Array, coarseness: Coarseness): Uint32Array {
  const joined = joinedVertices(positions, coarseness);
  const out = new Uint32Array(indices.length);
  const seen = new Set<number>();
  const n = positions.length / 3;
  let size = 0;
  for (let t = 0; t < indices.length; t += 3) {
    const [i, j, k] = [indices[t]!, indices[t + 1]!, indices[t + 2]!];
    const a = joined[i]!;
    let [b, c] = [joined[j]!, joined[k]!];
    if (a === b || b === c || c === a) continue;
    if (facesAway(positions, [i, j, k], [a, b, c])) [b, c] = [c, b];
    const key = triangleKey(a, b, c, n);
    if (seen.has(key)) continue;
    seen.add(key);
    out[size++] = a;
    out[size++] = b;
    out[size++] = c;
  }
  return out.slice(0, size);
}

/** For each vertex the one that stands for it. */
function joinedVertices(positions: Float32Array, { cell, box, rim }: Coarseness): Uint32Array {
  const n = positions.length / 3;
  const keys = new Float64Array(n);
  const best = new Map<number, { vertex: number; distance: number }>();
  for (let v = 0; v < n; ++v) {
    let key = 0;
    let distance = 0;
    let inside = true;
    for (let axis = 0; axis < 3; ++axis) {
      const p = positions[3 * v + axis]!;
      inside &&= p - box.min[axis]! > rim && box.max[axis]! - p > rim;
      const steps = (p - box.min[axis]!) / cell;
      key = key * 1024 + Math.min(1023, Math.max(0, Math.floor(steps)));
      distance += (steps - Math.floor(steps) - 0.5) ** 2;
    }
    keys[v] = inside ? key : -1;
    if (!inside) continue;
    const known = best.get(key);
    if (!known) best.set(key, { vertex: v, distance });
    else if (distance < known.distance) Object.assign(known, { vertex: v, distance });
  }
  return Uint32Array.from(keys, (key, v) => (key < 0 ? v : best.get(key)!.vertex));
}

type Corners = [number, number, number];

/** The normal of a triangle, its length twice the area. */
function normalOf(positions: Float32Array, [a, b, c]: Corners): Corners {
  const at = (v: number, axis: number): number => positions[3 * v + axis]! - positions[3 * a + axis]!;
  return [
    at(b, 1) * at(c, 2) - at(b, 2) * at(c, 1),
    at(b, 2) * at(c, 0) - at(b, 0) * at(c, 2),
    at(b, 0) * at(c, 1) - at(b, 1) * at(c, 0),
  ];
}

function facesAway(positions: Float32Array, before: Corners, after: Corners): boolean {
  const [n, m] = [normalOf(positions, before), normalOf(positions, after)];
  return n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < 0;
}

/** A number for a triangle that does not depend on which corner comes first. A clash leaves out one triangle. */
function triangleKey(a: number, b: number, c: number, n: number): number {
  if (b < a && b < c) return (b * n + c) * n + a;
  if (c < a && c < b) return (c * n + a) * n + b;
  return (a * n + b) * n + c;
}
