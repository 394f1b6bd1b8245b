import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";

const { paintChunk, markSelected, kColourings, ObjectIndex, readObject, colourOfId, paleColourOfId, kStructure, kUnknown, ramp,
  kFree, kOccupied, kNotSeen } = await load("painting", "objects", "colours");

const chunk = {
  key: "0,0,0", blocks: 1, triangles: 1,
  positions: new Float32Array([0, 0, 0, 0, 0, 1, 0, 0, 2, 5, 5, 1]),
  normals: new Int8Array(16),
  colours: new Uint8Array([1, 2, 3, 0, 4, 5, 6, 1, 7, 8, 9, 255, 9, 9, 9, 9]),
  segments: new Uint32Array([5, 12, 1, 99]),
  instances: new Uint32Array([7, 0, 0, 0]),
  classes: new Uint16Array([62, 0, 0, 0]),
  indices: new Uint32Array([0, 1, 2]),
};
const chair = readObject({ instance: 7, class: 62, segments: [5] });
const thing = readObject({ instance: 0, segments: [12, 13], discovered: true });
const floor = readObject({ instance: 0, segments: [1], structure: true, kind: "floor" });
const objects = new ObjectIndex([chair, thing, floor]);

function painted(colouring) {
  const out = new Uint8Array(16);
  paintChunk(chunk, { colouring, objects, up: [0, 0, 1], heights: [0, 2] }, out);
  return [0, 1, 2, 3].map((v) => [...out.subarray(4 * v, 4 * v + 3)]);
}

test("By object: instances bright, discovered things pale, structure and the rest grey", () => {
  assert.deepEqual(painted("instance"), [colourOfId(7), paleColourOfId(12), kStructure, kUnknown]);
});

test("By class, by the camera's colours, by height, by sightings", () => {
  assert.deepEqual(painted("class"), [colourOfId(62), kUnknown, kUnknown, kUnknown]);
  assert.deepEqual(painted("rgb"), [[1, 2, 3], [4, 5, 6], [7, 8, 9], [9, 9, 9]]);
  const heights = painted("height");
  assert.deepEqual(heights[0], ramp(0));
  assert.deepEqual(heights[2], ramp(1));
  assert.deepEqual(heights[1], heights[3], "only height counts");
  const seen = painted("seen");
  assert.deepEqual(seen[0], kUnknown);
  assert.deepEqual(seen[2], ramp(1));
});

test("Every colouring leaves the mark of the selected object alone", () => {
  for (const colouring of kColourings) {
    const out = new Uint8Array(16);
    assert.ok(markSelected(chunk, thing, out));
    paintChunk(chunk, { colouring, objects, up: [0, 0, 1], heights: [0, 2] }, out);
    assert.deepEqual([3, 7, 11, 15].map((i) => out[i]), [0, 255, 0, 0]);
    assert.ok(!markSelected(chunk, thing, out), "nothing has changed");
    assert.ok(markSelected(chunk, chair, out));
    assert.deepEqual([3, 7, 11, 15].map((i) => out[i]), [255, 0, 0, 0]);
    assert.ok(markSelected(chunk, null, out));
  }
});

// Viénot, Brettel and Mollon (1999): what people without red or without green cones see, in linear RGB.
const kDichromats = {
  protanope: [[0.11238, 0.88762, 0], [0.11238, 0.88762, 0], [0.00401, -0.00401, 1]],
  deuteranope: [[0.29275, 0.70725, 0], [0.29275, 0.70725, 0], [-0.02234, 0.02234, 1]],
};
const linear = (c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4);

/** CIE L*a*b* (D65) of linear RGB. */
function lab([r, g, b]) {
  const xyz = [0.4124 * r + 0.3576 * g + 0.1805 * b, 0.2126 * r + 0.7152 * g + 0.0722 * b, 0.0193 * r + 0.1192 * g + 0.9505 * b];
  const [x, y, z] = xyz.map((v, i) => v / [0.9505, 1, 1.089][i]).map((t) => (t > 0.008856 ? Math.cbrt(t) : 7.787 * t + 16 / 116));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

test("The colour-blind tell free, occupied and unknown space apart", () => {
  for (const [kind, matrix] of Object.entries(kDichromats)) {
    const seen = [kFree, kOccupied, kNotSeen].map((colour) => {
      const rgb = colour.map(linear);
      return lab(matrix.map((row) => row.reduce((sum, share, i) => sum + share * rgb[i], 0)));
    });
    for (const [a, b] of [[0, 1], [0, 2], [1, 2]]) {
      const distance = Math.hypot(...seen[a].map((value, i) => value - seen[b][i]));
      assert.ok(distance > 20, `${kind}: colours ${a} and ${b} are ${distance.toFixed(1)} apart`);
    }
  }
});

test("Neighbouring ids have colours far apart", () => {
  for (let id = 1; id < 200; ++id) {
    const [a, b] = [colourOfId(id), colourOfId(id + 1)];
    assert.ok(Math.hypot(...a.map((c, i) => c - b[i])) > 60, `ids ${id} and ${id + 1}: ${a} and ${b}`);
  }
});
