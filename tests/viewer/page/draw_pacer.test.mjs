import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";

const { DrawPacer } = await load("draw_pacer");
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** A pacer, and when it drew [ms since it was made]. */
function watched() {
  const begin = performance.now();
  const drawings = [];
  return { drawings, pacer: new DrawPacer(() => drawings.push(performance.now() - begin)) };
}

test("Many changes are one drawing", async () => {
  const { drawings, pacer } = watched();
  for (let i = 0; i < 10; ++i) pacer.soon();
  await pause(50);
  assert.equal(drawings.length, 1);
});

test("After a slow drawing the next one waits four times as long as it took", async () => {
  const { drawings, pacer } = watched();
  const now = performance.now();
  pacer.drawn(now - 50, now);
  pacer.soon();
  await pause(120);
  assert.deepEqual(drawings, []);
  await pause(150);
  assert.equal(drawings.length, 1);
});

test("What comes between two moments of a log is not drawn, and the moment at once", async () => {
  const { drawings, pacer } = watched();
  pacer.soon();
  pacer.hold(10000);
  pacer.soon();
  await pause(60);
  assert.deepEqual(drawings, []);
  pacer.release();
  assert.equal(drawings.length, 1);
  await pause(60);
  assert.equal(drawings.length, 1, "the wish from before is fulfilled");
  pacer.soon();
  await pause(60);
  assert.equal(drawings.length, 2, "nothing is held any more");
});

test("Moments that are wanted all the time do not hold back drawings for ever", async () => {
  const { drawings, pacer } = watched();
  for (let i = 0; i < 12; ++i) {
    pacer.hold(200);
    pacer.soon();
    await pause(25);
  }
  assert.ok(drawings.length >= 1, "the first wish holds for 200 ms, and the later ones do not extend that");
});
