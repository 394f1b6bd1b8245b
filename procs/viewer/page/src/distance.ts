/** Exact Euclidean distances on a grid, after Felzenszwalb and Huttenlocher (2012): lower envelopes of parabolas. */

/** Squared distances along one line of a grid, in place: f[start + i * step] for i < n. */
function transformLine(f: Float64Array, start: number, step: number, n: number): void {
  const value = (i: number): number => f[start + i * step]!;
  const places: number[] = []; // of the parabolas of the envelope
  const from: number[] = []; // where each begins to be the lowest
  for (let q = 0; q < n; ++q) {
    if (!Number.isFinite(value(q))) continue;
    let s = -Infinity;
    while (places.length > 0) {
      const p = places.at(-1)!;
      s = (value(q) + q * q - value(p) - p * p) / (2 * (q - p));
      if (s > from.at(-1)!) break;
      places.pop();
      from.pop();
      s = -Infinity;
    }
    places.push(q);
    from.push(s);
  }
  if (places.length === 0) return;
  const out = new Float64Array(n);
  for (let i = 0, k = 0; i < n; ++i) {
    while (k + 1 < places.length && from[k + 1]! < i) ++k;
    out[i] = (i - places[k]!) ** 2 + value(places[k]!);
  }
  for (let i = 0; i < n; ++i) f[start + i * step] = out[i]!;
}

/**
 * For each cell of a grid (row by row) the distance in cells between its centre and that of the nearest cell for which
 * `isTarget` holds; NaN where `isShown` does not hold, and everywhere when there is no target.
 */
export function distancesTo(
  cells: Uint8Array,
  width: number,
  height: number,
  isTarget: (cell: number) => boolean,
  isShown: (cell: number) => boolean,
): Float32Array {
  const squared = Float64Array.from(cells, (cell) => (isTarget(cell) ? 0 : Infinity));
  for (let v = 0; v < height; ++v) transformLine(squared, v * width, 1, width);
  for (let u = 0; u < width; ++u) transformLine(squared, u, width, height);
  return Float32Array.from(squared, (value, i) => (isShown(cells[i]!) && Number.isFinite(value) ? Math.sqrt(value) : Number.NaN));
}
