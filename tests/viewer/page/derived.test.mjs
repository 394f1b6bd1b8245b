// What the page works out of messages: coarse surface, overlay of pictures, table of processes.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";

const { coarseIndices, overlayPixels, detectionsText, colourOfId, paleColourOfId, mainRate, lostCount, waitingCount, slowestStage,
  isStale, stateText, detectionDelays, delayText, TimingHistory, Latency } = await load("coarse", "overlay", "colours", "process_summary", "timings_chart", "latency");

/** A square of `side` x `side` vertices at every centimetre, its middle raised by `bump` [m]. */
function plane(side, bump = 0) {
  const positions = new Float32Array(3 * side * side);
  for (let i = 0; i < side; ++i) for (let j = 0; j < side; ++j) {
    const z = 0.1 + bump * Math.sin(i * 0.7) * Math.sin(j * 0.9);
    positions.set([0.01 * i + 0.005, 0.01 * j + 0.005, z], 3 * (i * side + j));
  }
  const indices = [];
  for (let i = 0; i + 1 < side; ++i) for (let j = 0; j + 1 < side; ++j) {
    const a = i * side + j;
    indices.push(a, a + side, a + 1, a + 1, a + side, a + side + 1);
  }
  return { positions, indices: Uint32Array.from(indices) };
}

const kWide = { min: [-1, -1, -1], max: [2, 2, 2] };

test("The coarse surface of a plane has one vertex for each cell, keeps its front and covers the same area but for its rim", () => {
  const { positions, indices } = plane(39); // three vertices for each cell, one of them at its middle
  const coarse = coarseIndices(positions, indices, { cell: 0.03, box: { min: [0, 0, 0], max: [1, 1, 1] }, rim: -1 });
  assert.equal(new Set(coarse).size, 169);
  assert.equal(coarse.length / 3, 288);
  const at = (v, axis) => positions[3 * v + axis];
  let area = 0;
  for (let t = 0; t < coarse.length; t += 3) {
    const [a, b, c] = coarse.subarray(t, t + 3);
    const twice = (at(b, 0) - at(a, 0)) * (at(c, 1) - at(a, 1)) - (at(c, 0) - at(a, 0)) * (at(b, 1) - at(a, 1));
    assert.ok(twice > 0, "the front stays the front");
    area += twice / 2;
  }
  assert.ok(Math.abs(area - 0.36 ** 2) < 1e-6, `the area is ${area}`);
});

test("Vertices at the faces of the box stay, so that neighbours meet", () => {
  const { positions, indices } = plane(40);
  const coarse = coarseIndices(positions, indices, { cell: 0.04, box: { min: [0, -1, -1], max: [1, 2, 2] }, rim: 0.012 });
  const used = new Set(coarse);
  for (let j = 0; j < 40; ++j) assert.ok(used.has(j), `vertex ${j} of the first row`);
  assert.ok(coarse.length < indices.length / 4);
});

test("On a rough surface no coarse triangle shows its back where the fine one shows its front", () => {
  const { positions, indices } = plane(40, 0.002);
  const coarse = coarseIndices(positions, indices, { cell: 0.04, box: kWide, rim: 0 });
  const at = (v, axis) => positions[3 * v + axis];
  let backs = 0;
  for (let t = 0; t < coarse.length; t += 3) {
    const [a, b, c] = coarse.subarray(t, t + 3);
    if ((at(b, 0) - at(a, 0)) * (at(c, 1) - at(a, 1)) < (at(c, 0) - at(a, 0)) * (at(b, 1) - at(a, 1))) ++backs;
  }
  assert.equal(backs, 0);
});

test("Two sides of a thin wall stay apart: triangles of opposite fronts are both kept", () => {
  const positions = Float32Array.from([0, 0, 0, 1, 0, 0, 0, 1, 0]);
  const both = coarseIndices(positions, Uint32Array.from([0, 1, 2, 0, 2, 1]), { cell: 0.1, box: kWide, rim: 0 });
  assert.deepEqual([...both], [0, 1, 2, 0, 2, 1]);
});

test("Vertices outside the box stay", () => {
  const positions = Float32Array.from([5, 0, 0, 5.01, 0, 0, 5, 0.01, 0, 0, 0, 0, 0.01, 0, 0, 0, 0.01, 0]);
  const coarse = coarseIndices(positions, Uint32Array.from([0, 1, 2, 3, 4, 5]), { cell: 0.1, box: kWide, rim: 0 });
  assert.deepEqual([...coarse], [0, 1, 2]);
});

const segments = {
  width: 4, height: 2,
  runs: [-1, 2, 0, 2, 1, 3, 9, 1],
  list: [{ classId: 62, className: "chair", score: 0.9, detection: 0 }, { classId: 0, className: "", score: 0, detection: -1 }],
};

test("Masks have the colour of their class, segments pale ones, the rest is clear", () => {
  const rgba = (pixels, i) => [...pixels.subarray(4 * i, 4 * i + 4)];
  const masks = overlayPixels(segments, { masks: true, segments: false });
  assert.deepEqual(rgba(masks, 1), [0, 0, 0, 0]);
  assert.deepEqual(rgba(masks, 2).slice(0, 3), colourOfId(62));
  assert.deepEqual(rgba(masks, 4), [0, 0, 0, 0]);
  const both = overlayPixels(segments, { masks: true, segments: true });
  assert.deepEqual(rgba(both, 4).slice(0, 3), paleColourOfId(2));
  assert.deepEqual(rgba(both, 7), [0, 0, 0, 0], "an index that is not in the list");
});

test("Runs that are too long or negative never write outside the picture", () => {
  const pixels = overlayPixels({ ...segments, runs: [0, -5, 0, 1e9, 1, 3] }, { masks: true, segments: true });
  assert.equal(pixels.length, 32);
  assert.ok(pixels[31] > 0);
});

test("Detections are told once for each class, with the best score", () => {
  const list = [...segments.list, { classId: 62, className: "chair", score: 0.95, detection: 1 }];
  assert.equal(detectionsText({ ...segments, list }), "chair 95 %");
  assert.equal(detectionsText(null), "");
});

const process = {
  source: "map-server", age: 0.5,
  counters: { frames_integrated: 90, frames_waiting: 2, requests_waiting: 1, waiting_bytes: 4096, "FRAMES.rejected": 3, frames_dropped: 4, dropped_on_purpose: 50 },
  rates: { "FRAMES.received": 31, frames_integrated: 29.5 },
  timings: {
    mesh: { median: 80, max: 90, p50: 8, p95: 14 }, integrate: { median: 12, max: 31, p50: null, p95: null }, objects: { median: null, max: null, p50: 9, p95: 10 },
    "detections of camera 3": { median: 140, max: 200, p50: 138.4, p95: 190 },
  },
};

test("The table shows frames per second, the slowest stage, what waits and what was lost", () => {
  assert.deepEqual(mainRate(process), { name: "frames_integrated", rate: 29.5 });
  assert.equal(slowestStage(process).name, "integrate", "waiting is no work, and the last minute counts more than the last second");
  assert.equal(waitingCount(process), 3);
  assert.equal(lostCount(process), 7);
  assert.equal(mainRate({ ...process, rates: {} }), null);
});

test("The detector's delay is told by camera, as far as it is known", () => {
  const delays = detectionDelays([process, { ...process, timings: {} }]);
  assert.deepEqual([...delays.keys()], [3]);
  assert.equal(delayText(delays.get(3)), "140 ms (in the last minute p50 138 ms, p95 190 ms)");
  assert.equal(delayText({ median: 20, max: 30, p50: null, p95: null }), "20 ms");
  assert.equal(delayText({ median: null, max: null, p50: 7, p95: null }), "in the last minute p50 7 ms");
  assert.equal(delayText(undefined), "");
});

test("A process that was not heard for three seconds is stale", () => {
  assert.ok(!isStale({ ...process, age: 2.9 }));
  assert.ok(isStale({ ...process, age: 3.1 }));
  assert.equal(stateText({ ...process, state: "running", age: 3.1 }), "silent");
  assert.ok(!isStale({ ...process, state: "stopping", age: 3.1 }), "it said that it would stop");
  assert.equal(stateText({ ...process, state: "stopping", age: 3.1 }), "ended");
});

test("Stage times are kept for 300 s; a stage that comes later has no times before", () => {
  const history = new TimingHistory();
  for (let second = 0; second < 310; ++second) {
    const timings = second < 305 ? { mesh: { median: second, max: 0 } } : { mesh: { median: second, max: 0 }, late: { median: 1, max: 1 } };
    history.add(second, { ...process, timings });
    history.add(second, { ...process, timings });
  }
  assert.equal(history.seconds.length, 300);
  assert.equal(history.seconds[0], 10);
  assert.deepEqual(history.stages.get("late").slice(-6), [null, 1, 1, 1, 1, 1]);
  assert.equal(history.stages.get("mesh").at(-1), 309);
});

test("Latencies: percentiles of what was drawn, each arrival once", () => {
  const latency = new Latency();
  assert.deepEqual(latency.summary(), { count: 0, p50: 0, p95: 0, max: 0 });
  for (let i = 1; i <= 100; ++i) {
    latency.arrived(1000);
    latency.drawn(1000 + i);
    latency.drawn(9000);
  }
  assert.deepEqual(latency.summary(), { count: 100, p50: 51, p95: 96, max: 100 });
});
