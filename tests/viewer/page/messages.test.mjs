import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";

const { parseMessage, readObject, matches, sizeText, ageText, ObjectIndex } = await load("protocol", "objects");

test("A map message is read, and what is missing gets a default", () => {
  const message = parseMessage('{"kind":"map","map_id":"m1","revision":5,"digest":"ab","up":[0,0,1],"waiting":2,"bytes":{"tsdf":7,"x":"y"}}');
  assert.equal(message.revision, 5);
  assert.deepEqual(message.up, [0, 0, 1]);
  assert.deepEqual(message.bytes, { tsdf: 7 });
  assert.equal(message.waiting, 2);
  assert.equal(message.reset, false);
  assert.equal(parseMessage('{"kind":"map","up":[0,null,1]}').up, null);
  assert.equal(parseMessage('{"kind":"map"}').revision, -1);
});

test("Unknown kinds are ignored, broken text is an error", () => {
  assert.equal(parseMessage('{"kind":"of another version"}'), null);
  assert.throws(() => parseMessage("[1]"), /no JSON object/);
  assert.throws(() => parseMessage("{"), SyntaxError);
});

test("Cameras without a whole pose are left out", () => {
  const pose = Array.from({ length: 16 }, (_, i) => i);
  const message = parseMessage(JSON.stringify({ kind: "cameras", cameras: [{ camera_id: 1, T_W_C: pose, had_detections: true, n_detections: 4 }, { camera_id: 2, T_W_C: [1] }, 7] }));
  assert.deepEqual(message.cameras.map((camera) => camera.id), [1]);
  assert.equal(message.cameras[0].detections, 4);
});

test("Processes keep counters, rates and timings that are numbers", () => {
  const [process] = parseMessage(JSON.stringify({
    kind: "processes",
    processes: [{ source: "map-server", counters: { frames: 3, name: "x" }, rates: { frames: 1.5 }, timings: { integrate: { median_ms: 2, max_ms: 9 }, mesh: { p50_ms: 3, p95_ms: 4 } }, findings: ["late"] }],
  })).processes;
  assert.deepEqual(process.counters, { frames: 3 });
  assert.deepEqual(process.timings, { integrate: { median: 2, max: 9, p50: null, p95: null }, mesh: { median: null, max: null, p50: 3, p95: 4 } });
  assert.deepEqual(process.findings, ["late"]);
});

const chair = readObject({ instance: 7, class: 62, class_name: "chair", score: 0.83, segments: [3, 4], center: [1, 2, 3], size: [0.4, 0.9, 0.5], orientation: [0, 0, 0, 1], state: "present" });
const thing = readObject({ instance: 0, class_name: "unknown", segments: [12, 13], structure: false, discovered: true });
const floor = readObject({ instance: 0, segments: [1], structure: true, kind: "floor" });
const gone = readObject({ instance: 9, class_name: "cup", segments: [3], state: "removed" });

test("Objects fall into four groups with lasting ids", () => {
  assert.deepEqual([chair, thing, floor, gone].map((o) => [o.id, o.group, o.name]), [
    ["7", "named", "chair"], ["s12", "discovered", "thing"], ["s1", "structure", "floor"], ["9", "removed", "cup"],
  ]);
  assert.equal(gone.box, null);
});

test("The filter wants all words, in name, id or group", () => {
  assert.ok(matches(chair, "CHA 7"));
  assert.ok(matches(floor, "structure"));
  assert.ok(!matches(chair, "chair 8"));
});

test("Sizes and times are in plain units", () => {
  assert.equal(sizeText(chair.box), "0.90×0.50×0.40");
  assert.equal(ageText(9_500_000, 10_000_000), "now");
  assert.equal(ageText(0, 42_000_000), "42 s");
  assert.equal(ageText(0, 600_000_000), "10 min");
  assert.equal(ageText(0, 36_000_000_000), "10 h");
});

test("Surface finds its object by instance, then by segment; removed ones own nothing", () => {
  const index = new ObjectIndex([chair, thing, floor, gone]);
  assert.equal(index.at(7, 99), chair);
  assert.equal(index.at(0, 13), thing);
  assert.equal(index.at(0, 3), null, "the chair's surface has its instance");
  assert.equal(index.at(9, 3), null);
  assert.equal(index.get("9"), gone);
});
