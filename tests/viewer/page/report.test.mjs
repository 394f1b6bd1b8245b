// The surface of a report. The test tests/pictures/report_test.cc holds the C++ side to the same text.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";

const { decodeReport, paintReport, kNoOwner, colourOfId, kUnknown, ramp } = await load("report_mesh", "colours");

const surface = "AAAAAAAA//8AAAAAAAD//wAAAQIDBAUGBwgJAAAAAQD//wAAAAAAAAEAAAACAAAA";
const about = {
  vertices: 3, triangles: 1, low: [0, 0, 0], high: [1, 2, 1e-6], up: [0, 1, 0], colored: true,
  objects: [
    { id: "s3", name: "wall", instance: 0, class: 0, structure: true },
    { id: "7", name: "</script>", instance: 7, class: 62, structure: false },
  ],
};
const mesh = decodeReport(JSON.stringify(about), surface);
const bytes = (painted) => [0, 1, 2].map((v) => [...painted.subarray(3 * v, 3 * v + 3)].map((c) => Math.round(255 * c)));

test("Positions, colours, owners and corners are those that were written", () => {
  assert.deepEqual([...mesh.positions].map((x) => Math.round(1000 * x) / 1000), [0, 0, 0, 1, 0, 0, 0, 2, 0]);
  assert.deepEqual([...mesh.colours], [1, 2, 3, 4, 5, 6, 7, 8, 9]);
  assert.deepEqual([...mesh.owners], [0, 1, kNoOwner]);
  assert.deepEqual([...mesh.corners], [0, 1, 2]);
  assert.equal(mesh.objects[1].name, "</script>");
});

test("Vertices have the colour of their object, class or height, or as seen", () => {
  assert.deepEqual(bytes(paintReport(mesh, "instance", -1)).slice(1), [colourOfId(7), kUnknown]);
  assert.deepEqual(bytes(paintReport(mesh, "class", -1))[1], colourOfId(62));
  assert.deepEqual(bytes(paintReport(mesh, "rgb", -1)), [[1, 2, 3], [4, 5, 6], [7, 8, 9]]);
  assert.deepEqual(bytes(paintReport(mesh, "height", -1)), [ramp(0), ramp(0), ramp(1)]);
});

test("What is not chosen gets darker", () => {
  const chosen = bytes(paintReport(mesh, "rgb", 1));
  assert.deepEqual(chosen[1], [4, 5, 6]);
  assert.deepEqual(chosen[2], [4, 5, 5]);
});

test("A surface that is cut off is an error", () => {
  assert.throws(() => decodeReport(JSON.stringify(about), surface.slice(0, -4)), /45 bytes instead of 48/);
  assert.throws(() => decodeReport(JSON.stringify({ ...about, vertices: 4 }), surface), /bytes instead of/);
});
