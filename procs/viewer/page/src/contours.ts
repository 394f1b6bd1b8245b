/** Lines of equal value on a grid: marching squares. */

// For each of the 16 cases which edges of a square a line joins: 0 = lower, 1 = right, 2 = upper, 3 = left.
const kLines: number[][] = [
  [], [3, 0], [0, 1], [3, 1], [1, 2], [3, 2, 0, 1], [0, 2], [3, 2],
  [2, 3], [2, 0], [2, 1, 0, 3], [2, 1], [1, 3], [1, 0], [0, 3], [],
];

/**
 * Pieces of the lines at which a grid of values (row by row) crosses `level`: four numbers each, u and v of both ends, in
 * cells, where the value of cell (0, 0) is at (0.5, 0.5). Squares with a value that is no number have none.
 */
export function contourLines(values: Float32Array, width: number, height: number, level: number): number[] {
  const lines: number[] = [];
  for (let v = 0; v + 1 < height; ++v) {
    for (let u = 0; u + 1 < width; ++u) {
      const i = v * width + u;
      const corners = [values[i]!, values[i + 1]!, values[i + width + 1]!, values[i + width]!];
      if (corners.some(Number.isNaN)) continue;
      const which = corners.reduce((bits, value, corner) => bits | (value >= level ? 1 << corner : 0), 0);
      for (const edge of kLines[which]!) lines.push(...crossing(corners, edge, level, u + 0.5, v + 0.5));
    }
  }
  return lines;
}

/** Where the level lies on an edge of a square whose first corner is at (u, v). */
function crossing(corners: number[], edge: number, level: number, u: number, v: number): [number, number] {
  const [a, b] = [corners[edge]!, corners[(edge + 1) % 4]!];
  const share = a === b ? 0.5 : (level - a) / (b - a);
  switch (edge) {
    case 0:
      return [u + share, v];
    case 1:
      return [u + 1, v + share];
    case 2:
      return [u + 1 - share, v + 1];
    default:
      return [u, v + 1 - share];
  }
}

const kMostLabels = 24;

/**
 * Where a level is written: middles of pieces of its lines (as of contourLines), at least `apart` cells from each other and
 * half of it from the `others`.
 */
export function labelPlaces(lines: number[], apart: number, others: [number, number][] = []): [number, number][] {
  const places: [number, number][] = [];
  for (let i = 0; i + 3 < lines.length && places.length < kMostLabels; i += 4) {
    const [u, v] = [(lines[i]! + lines[i + 2]!) / 2, (lines[i + 1]! + lines[i + 3]!) / 2];
    const isFree = (taken: [number, number][], least: number): boolean => taken.every(([a, b]) => Math.hypot(a - u, b - v) >= least);
    if (isFree(places, apart) && isFree(others, apart / 2)) places.push([u, v]);
  }
  return places;
}
