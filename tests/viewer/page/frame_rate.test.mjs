import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";

const { FrameRate } = await load("frame_rate");
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

test("A fast computer draws all pixels and triangles, moving or not", async () => {
  const seen = [];
  const rate = new FrameRate(false, (quality) => seen.push(quality));
  rate.moving(true);
  for (let i = 0; i < 20; ++i) rate.drawn(1000 + 16 * i);
  rate.mapChanged();
  rate.moving(false);
  await pause(250);
  assert.deepEqual(seen, []);
  assert.deepEqual(rate.quality, { ratio: 1, coarse: false });
});

test("A slow computer draws coarsely while the view moves, and all of it afterwards", async () => {
  const rate = new FrameRate(true, () => {});
  rate.moving(true);
  assert.deepEqual(rate.quality, { ratio: 0.75, coarse: true });
  rate.moving(false);
  assert.equal(rate.quality.coarse, true, "not at once");
  await pause(300);
  assert.deepEqual(rate.quality, { ratio: 1, coarse: false });
});

test("Slow frames while the view moves make a computer slow; slow frames at rest do not", () => {
  const rate = new FrameRate(false, () => {});
  for (let i = 0; i < 9; ++i) rate.drawn(200 * i);
  assert.equal(rate.quality.coarse, false);
  rate.moving(true);
  for (let i = 9; i < 14; ++i) rate.drawn(200 * i);
  assert.equal(rate.quality.coarse, true);
  rate.moving(false);
});

test("While the map changes a slow computer draws coarsely, until it has been quiet", async () => {
  const rate = new FrameRate(true, () => {});
  rate.mapChanged();
  await pause(500);
  rate.mapChanged();
  await pause(500);
  assert.deepEqual(rate.quality, { ratio: 1, coarse: true });
  await pause(500);
  assert.deepEqual(rate.quality, { ratio: 1, coarse: false });
});
