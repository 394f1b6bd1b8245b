import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";

const { parseMessage, Timeline, clockText, markText, MomentWatch, Hold } = await load("protocol", "timeline_data", "moment_watch", "hold");

const text = JSON.stringify({
  kind: "timeline", total: 40, read: 30, mapped: 29, done: false, message: "", stride: 4,
  frames: [4, 8, 12, 28], utimes: [1000000, 400000, 400000, 1600000],
  marks: [
    { frames: 8, utime: 1400000, id: "7", name: "chair", appeared: true },
    { frames: 28, utime: 3400000, id: "7", name: "chair", appeared: false },
  ],
});
const timeline = new Timeline(parseMessage(text));

test("Utimes are told as differences", () => {
  assert.deepEqual(timeline.message.utimes, [1000000, 1400000, 1800000, 3400000]);
});

test("A moment is the newest one not after what is wanted", () => {
  assert.deepEqual([-5, 0, 4, 7, 8, 27, 28, 1000].map((frames) => timeline.at(frames)), [4, 4, 4, 4, 8, 12, 28, 28]);
  assert.deepEqual([0, 1399999, 1400000, 9e9].map((utime) => timeline.atTime(utime)), [4, 4, 8, 28]);
});

test("Steps end at the first and the last moment", () => {
  assert.deepEqual([timeline.step(8, 1), timeline.step(8, -1), timeline.step(8, -9), timeline.step(12, 9)], [12, 4, 4, 28]);
});

test("The slider reaches over frames that may still come, and no further when all is mapped", () => {
  assert.equal(timeline.end, 40);
  assert.equal(new Timeline({ ...timeline.message, done: true }).end, 28);
});

test("Marks before and after a moment, and at it", () => {
  assert.equal(timeline.markFrom(8, true).frames, 28);
  assert.equal(timeline.markFrom(8, false), null);
  assert.equal(timeline.markFrom(28, false).frames, 8);
  assert.deepEqual(timeline.marksAt(8).map(markText), ["chair 7 appears"]);
  assert.deepEqual(timeline.marksAt(12), []);
  assert.deepEqual(timeline.marksAt(28).map(markText), ["chair 7 disappears"]);
});

test("A timeline without moments and one with nonsense are no error", () => {
  const empty = new Timeline(parseMessage('{"kind":"timeline","frames":"x","marks":[3]}'));
  assert.deepEqual([empty.length, empty.first, empty.at(7), empty.step(7, 1), empty.secondsOf(3)], [0, 0, 0, 0, 0]);
});

test("Times are minutes and seconds", () => {
  assert.deepEqual([0, 9.96, 65.25, 600].map(clockText), ["0:00.0", "0:10.0", "1:05.3", "10:00.0"]);
});

test("The watch measures from the last wish to the drawing of exactly that moment", () => {
  const watch = new MomentWatch();
  watch.ask(5, 100);
  watch.ask(9, 200);
  assert.equal(watch.has(5, true), false, "an earlier wish");
  assert.equal(watch.has(9, false), false, "blocks are missing");
  watch.drawn(250);
  assert.equal(watch.isDone, false);
  assert.equal(watch.has(9, true), true);
  assert.equal(watch.has(9, true), false, "asks for a drawing once");
  watch.drawn(320);
  assert.deepEqual([watch.durations, watch.shown, watch.isDone], [[120], 9, true]);
});

const block = (key, look) => ({ key, look });
const map = (revision, rest = {}) => parseMessage(JSON.stringify({ kind: "map", map_id: "m", revision, ...rest }));

test("While paused the newest of everything waits, and what is not about the map goes on", () => {
  const hold = new Hold();
  hold.begin("m", 10);
  assert.equal(hold.keeps(parseMessage('{"kind":"notice","text":"x"}')), false);
  assert.equal(hold.keeps(map(11)), true);
  assert.equal(hold.keeps(map(13)), true);
  assert.equal(hold.behind, 3);
  for (const from of [4, 6]) hold.keeps(parseMessage(JSON.stringify({ kind: "trajectory", camera_id: 1, from, positions: [] })));
  for (const [key, look] of [["a", 1], ["b", 1], ["a", 2]]) hold.keepBlock(block(key, look));
  const released = hold.release();
  assert.equal(released.isReset, false);
  assert.deepEqual(released.blocks, [block("a", 2), block("b", 1)]);
  assert.deepEqual(released.messages.map((m) => [m.kind, m.from ?? m.revision]), [["trajectory", 4], ["trajectory", 6]]);
  assert.equal(released.map.revision, 13);
  const empty = hold.release();
  assert.deepEqual([empty.map, empty.blocks, empty.messages], [null, [], []]);
});

test("A reset during the pause forgets the blocks that wait, and is told once", () => {
  const hold = new Hold();
  hold.begin("m", 10);
  hold.keepBlock(block("a", 1));
  hold.keeps(map(1, { reset: true }));
  hold.keepBlock(block("b", 1));
  hold.keeps(map(2));
  const released = hold.release();
  assert.equal(released.isReset, true);
  assert.deepEqual(released.blocks.map((b) => b.key), ["b"]);
  assert.deepEqual([released.map.revision, released.map.reset], [2, false]);
  assert.equal(hold.release().isReset, false);
});
