// The worker as the window sees it, with a WebSocket that the test plays.
import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";
import { arrayBuffer, blockBytes, vertex } from "./page_bytes.mjs";

const told = [];
const problems = [];
globalThis.self = { postMessage: (message) => (message.kind === "problem" ? problems : told).push(message), onmessage: null };
let socket = null;
globalThis.WebSocket = class {
  static OPEN = 1;
  readyState = 1;
  constructor() {
    socket = this;
  }
  send() {}
};
await load("worker");

const toWorker = (message) => self.onmessage({ data: message });
const text = (json) => socket.onmessage({ data: JSON.stringify(json) });
const map = (mapId, over = {}) => text({ kind: "map", map_id: mapId, revision: 5, blocks: 1, digest: "", ...over });
const block = (x) => {
  const vertices = [vertex([0, 0, 0]), vertex([65535, 0, 0]), vertex([0, 65535, 0])];
  socket.onmessage({ data: arrayBuffer(blockBytes({ index: [x, 0, 0], edge: 0.4, hash: BigInt(1 + x), vertices, triangles: [[0, 1, 2]] })) });
};
/** How many blocks the worker has, as it says when it has merged them. */
async function blocksOfWorker() {
  told.length = 0;
  await new Promise((resolve) => setTimeout(resolve, 200));
  return told.findLast((message) => message.kind === "received").received.blocks;
}

test("A page that goes on after a pause has the blocks that came meanwhile, also of another map", async () => {
  toWorker({ kind: "connect", url: "ws://test/live" });
  socket.onopen();
  map("first", { reset: true });
  block(0);
  block(1);
  assert.equal(await blocksOfWorker(), 2);

  toWorker({ kind: "pause", paused: true });
  block(2);
  map("first", { revision: 6 });
  toWorker({ kind: "pause", paused: false });
  assert.equal(await blocksOfWorker(), 3, "the same map goes on");

  toWorker({ kind: "pause", paused: true });
  block(3);
  map("second", { reset: true });
  block(7);
  block(8);
  map("second");
  toWorker({ kind: "pause", paused: false });
  assert.equal(await blocksOfWorker(), 2, "those of the second map alone");

  toWorker({ kind: "pause", paused: true });
  block(4);
  map("third");
  block(9);
  toWorker({ kind: "pause", paused: false });
  assert.equal(await blocksOfWorker(), 1, "another map empties the surface also without being told to");
  assert.deepEqual(problems, []);
});
