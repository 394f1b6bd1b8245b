import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";
import { arrayBuffer } from "./page_bytes.mjs";

const { decodeSlice, stateAt, pixelsOf, axesOf, contourLines, labelPlaces, distancesTo, kFree, kOccupied, kNotSeen } = await load(
  "slice_data", "contours", "distance", "colours");

function sliceBytes(about, cells, metres = []) {
  const text = JSON.stringify(about);
  const padded = text.padEnd(Math.ceil(text.length / 4) * 4);
  const head = Buffer.alloc(4);
  head.writeUInt32LE(padded.length);
  const gap = Buffer.alloc(metres.length > 0 ? (4 - (cells.length % 4)) % 4 : 0);
  return arrayBuffer(Buffer.concat([head, Buffer.from(padded), Buffer.from(cells), gap, Buffer.from(Float32Array.from(metres).buffer)]));
}
const about = { axis: "z", at_m: 1, cell_m: 0.5, origin: [-1, 2], width: 3, height: 2, axes: ["x", "y"] };
const cells = [0, 1, 2, 1, 1, 0];

test("A slice tells the state of each cell at its place, and nothing outside", () => {
  const slice = decodeSlice(sliceBytes(about, cells));
  assert.equal(stateAt(slice, [-0.9, 2.1, 1]), "unknown");
  assert.equal(stateAt(slice, [0.3, 2.4, 1]), "occupied");
  assert.equal(stateAt(slice, [-0.9, 2.6, 1]), "free");
  assert.equal(stateAt(slice, [0.6, 2.1, 1]), null);
  assert.equal(stateAt(slice, [-0.9, 1.9, 1]), null);
});

test("Across x the slice lies in y and z, across y in x and z", () => {
  assert.deepEqual(axesOf("x"), { u: 1, v: 2, across: 0 });
  assert.deepEqual(axesOf("y"), { u: 0, v: 2, across: 1 });
  const slice = decodeSlice(sliceBytes({ ...about, axis: "x" }, cells));
  assert.equal(stateAt(slice, [77, 0.3, 2.4]), "occupied");
});

test("Free, occupied and unknown cells have their colours, unknown ones the least opaque", () => {
  const pixels = pixelsOf(decodeSlice(sliceBytes(about, cells)), 1);
  assert.deepEqual([...pixels.subarray(0, 3)], kNotSeen);
  assert.deepEqual([...pixels.subarray(4, 8)], [...kFree, 255]);
  assert.deepEqual([...pixels.subarray(8, 12)], [...kOccupied, 255]);
  assert.ok(pixels[3] < 255 && pixels[3] > 50);
});

test("Distances to occupied cells are those of trying all cells", () => {
  const [width, height] = [23, 17];
  let state = 7;
  const random = (n) => (state = (state * 1103515245 + 12345) % 2147483648) % n;
  const grid = Uint8Array.from({ length: width * height }, () => (random(20) === 0 ? 2 : random(4) === 0 ? 0 : 1));
  const distances = distancesTo(grid, width, height, (cell) => cell === 2, (cell) => cell === 1);
  const occupied = [...grid.keys()].filter((i) => grid[i] === 2).map((i) => [i % width, Math.floor(i / width)]);
  assert.ok(occupied.length > 5);
  grid.forEach((cell, i) => {
    const nearest = Math.min(...occupied.map(([u, v]) => Math.hypot(u - (i % width), v - Math.floor(i / width))));
    if (cell !== 1) assert.ok(Number.isNaN(distances[i]));
    else assert.ok(Math.abs(distances[i] - nearest) < 1e-5, `cell ${i}: ${distances[i]}, not ${nearest}`);
  });
});

test("Without anything occupied there are no distances", () => {
  assert.ok(distancesTo(new Uint8Array(6).fill(1), 3, 2, (cell) => cell === 2, (cell) => cell === 1).every(Number.isNaN));
});

test("A slice that is cut off or has no size is an error with a sentence", () => {
  assert.throws(() => decodeSlice(new ArrayBuffer(2)), /4 bytes/);
  assert.throws(() => decodeSlice(sliceBytes(about, cells.slice(1))), /cut off/);
  assert.throws(() => decodeSlice(sliceBytes({ ...about, cell_m: 0 }, cells)), /cells of 0 m/);
  assert.throws(() => decodeSlice(sliceBytes({ ...about, width: 1e9, height: 1e9 }, cells)), /cells of/);
});

test("Contours of the distance to a point are circles of the level's radius", () => {
  const [width, height] = [41, 37];
  const values = new Float32Array(width * height);
  for (let v = 0; v < height; ++v) for (let u = 0; u < width; ++u) values[v * width + u] = Math.hypot(u - 20, v - 18);
  const lines = contourLines(values, width, height, 10.3);
  assert.ok(lines.length > 4 * 40);
  let length = 0;
  for (let i = 0; i < lines.length; i += 4) {
    const [a, b, c, d] = lines.slice(i, i + 4);
    for (const [u, v] of [[a, b], [c, d]]) assert.ok(Math.abs(Math.hypot(u - 20.5, v - 18.5) - 10.3) < 0.02);
    length += Math.hypot(a - c, b - d);
  }
  assert.ok(Math.abs(length - 2 * Math.PI * 10.3) < 0.5, `the pieces are ${length} long together`);
});

test("Contours end where values are not known", () => {
  const values = Float32Array.from([0, 1, Number.NaN, 0, 1, 1]);
  assert.deepEqual(contourLines(values, 3, 2, 0.5), [1, 0.5, 1, 1.5]);
});

test("Distances of the map come behind the cells; without them there are none", () => {
  const metres = [0.5, 1, Number.NaN, 0.25, 2, 0];
  assert.deepEqual([...decodeSlice(sliceBytes({ ...about, distances: true }, cells, metres)).distances], metres);
  assert.equal(decodeSlice(sliceBytes({ ...about, distances: false }, cells)).distances, null);
  assert.throws(() => decodeSlice(sliceBytes({ ...about, distances: true }, cells, metres.slice(1))), /distances .* cut off/);
});

test("Labels of a level stand on its lines, apart from each other, and are not too many", () => {
  const lines = Array.from({ length: 500 }, (_, i) => [i, 3, i + 1, 5]).flat();
  const places = labelPlaces(lines, 10);
  assert.deepEqual(places.slice(0, 2), [[0.5, 4], [10.5, 4]]);
  assert.equal(places.length, 24);
  assert.deepEqual(labelPlaces([], 10), []);
  assert.deepEqual(labelPlaces(lines, 10, [[0.5, 5]])[0], [5.5, 4], "not beside the label of another level");
});
