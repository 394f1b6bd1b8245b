/** A coarser surface of the same vertices, for drawing while the view moves on a slow computer. */

/** How vertices are joined: in cubes of the edge `cell`, except where they lie within `rim` of a face of the `box` [m]. */
export interface Coarseness {
  cell: number;
  box: { min: number[]; max: number[] };
  rim: number; // so that surfaces of neighbouring boxes still meet
}

/**
 * Joins the vertices of a cube to the one nearest to its centre, and leaves out triangles that become lines or points. The
 * result names vertices of the same arrays.
 */
export function coarseIndices(positions: Float32Array, indices: Uint32Array, coarseness: Coarseness): Uint32Array {
  const joined = joinedVertices(positions, coarseness);
  const out = new Uint32Array(indices.length);
  let size = 0;
  for (let t = 0; t < indices.length; t += 3) {
    const [i, j, k] = [indices[t]!, indices[t + 1]!, indices[t + 2]!];
    const a = joined[i]!;
    let [b, c] = [joined[j]!, joined[k]!];
    if (a === b || b === c || c === a) continue;
    if (facesAway(positions, [i, j, k], [a, b, c])) [b, c] = [c, b];
    out[size++] = a;
    out[size++] = b;
    out[size++] = c;
  }
  return out.slice(0, size);
}

/** For each vertex the one that stands for it. */
function joinedVertices(positions: Float32Array, { cell, box, rim }: Coarseness): Uint32Array {
  const n = positions.length / 3;
  const side = box.min.map((low, axis) => Math.max(1, Math.ceil((box.max[axis]! - low) / cell)));
  const best = new Int32Array(side[0]! * side[1]! * side[2]!).fill(-1); // the vertex that stands for a cell
  const distances = new Float32Array(best.length);
  const joined = new Uint32Array(n);
  const cells = new Int32Array(n);
  for (let v = 0; v < n; ++v) {
    let at = 0;
    let distance = 0;
    for (let axis = 0; axis < 3 && at >= 0; ++axis) {
      const p = positions[3 * v + axis]!;
      const steps = (p - box.min[axis]!) / cell;
      const step = Math.floor(steps);
      const inside = p - box.min[axis]! > rim && box.max[axis]! - p > rim && step >= 0 && step < side[axis]!;
      at = inside ? at * side[axis]! + step : -1;
      distance += (steps - step - 0.5) ** 2;
    }
    cells[v] = at;
    if (at < 0 || (best[at]! >= 0 && distances[at]! <= distance)) continue;
    best[at] = v;
    distances[at] = distance;
  }
  for (let v = 0; v < n; ++v) joined[v] = cells[v]! < 0 ? v : best[cells[v]!]!;
  return joined;
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
