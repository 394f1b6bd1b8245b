import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";
import { arrayBuffer, blockBytes, vertex } from "./page_bytes.mjs";

const { ChunkStore, blocksPerChunk, decodeBlock, Digest, sameDigest, Staleness } = await load(
  "chunk_store", "block_codec", "digest", "staleness");

function block(index, hash, count = 1, edge = 0.4) {
  const vertices = Array.from({ length: 3 * count }, (_, i) => vertex([i, 2 * i, 3 * i], { segment: i }));
  const triangles = Array.from({ length: count }, (_, i) => [3 * i, 3 * i + 1, 3 * i + 2]);
  return decodeBlock(arrayBuffer(blockBytes({ index, edge, hash, vertices, triangles })));
}
const deletion = (index) => decodeBlock(arrayBuffer(blockBytes({ index, edge: 0.4 })));

function takeAll(store) {
  const keys = [];
  for (let taken = store.takeDirty(); taken !== null; taken = store.takeDirty()) keys.push(taken.key);
  return keys.sort();
}

test("Chunks are near one metre, a power of two of blocks, at most 16", () => {
  assert.equal(blocksPerChunk(0.08), 16);
  assert.equal(blocksPerChunk(0.4), 2);
  assert.equal(blocksPerChunk(0.008), 16);
  assert.equal(blocksPerChunk(8), 2);
});

test("Blocks of one cube become one chunk, with shifted indices", () => {
  const store = new ChunkStore();
  store.put(block([0, 0, 0], 1n, 2));
  store.put(block([-1, -1, -1], 2n, 1));
  store.put(block([1, 0, 0], 4n, 1));
  assert.deepEqual(takeAll(store), ["0,0,0", "1,0,0"]);
  const chunk = store.merge("0,0,0");
  assert.equal(chunk.blocks, 2);
  assert.equal(chunk.triangles, 3);
  assert.deepEqual([...chunk.indices], [0, 1, 2, 3, 4, 5, 6, 7, 8]);
  assert.deepEqual([...chunk.segments], [0, 1, 2, 3, 4, 5, 0, 1, 2]);
  assert.equal(store.blockCount, 3);
  assert.equal(store.triangles, 4);
});

test("A newer block takes the place of the older one; a deletion takes it away", () => {
  const store = new ChunkStore();
  store.put(block([0, 0, 0], 10n, 2));
  store.put(block([0, 0, 0], 11n, 1));
  assert.equal(store.triangles, 1);
  assert.equal(store.digestText, "000000000000000b");
  takeAll(store);
  store.put(deletion([0, 0, 0]));
  assert.deepEqual(takeAll(store), ["0,0,0"]);
  assert.equal(store.merge("0,0,0"), null);
  assert.deepEqual([store.blockCount, store.triangles, store.digestText], [0, 0, "0".repeat(16)]);
});

test("A chunk knows when the first block came that changed it", () => {
  const store = new ChunkStore();
  store.put(block([0, 0, 0], 1n), 1000);
  store.put(block([-1, 0, 0], 2n), 1500);
  assert.deepEqual(store.takeDirty(), { key: "0,0,0", arrivedAt: 1000 });
  assert.equal(store.takeDirty(), null);
  store.put(deletion([0, 0, 0]), 2000);
  assert.equal(store.takeDirty().arrivedAt, 2000);
  assert.equal(store.merge("0,0,0", 2000).arrivedAt, 2000);
});

test("After clear every chunk has changed and is empty", () => {
  const store = new ChunkStore();
  store.put(block([0, 0, 0], 1n));
  store.put(block([5, 0, 0], 2n));
  takeAll(store);
  store.clear();
  assert.deepEqual(takeAll(store), ["0,0,0", "3,0,0"]);
  assert.equal(store.blockCount, 0);
});

test("Random puts and deletions: counts and digest are those of the blocks that are left", () => {
  const store = new ChunkStore();
  const left = new Map();
  let state = 12345;
  const random = (n) => (state = (state * 1103515245 + 12345) % 2147483648) % n;
  for (let i = 0; i < 500; ++i) {
    const index = [random(4) - 2, random(4) - 2, random(3)];
    if (random(3) === 0) {
      store.put(deletion(index));
      left.delete(index.join());
    } else {
      const hash = (BigInt(random(2 ** 30)) << 34n) + BigInt(random(2 ** 30));
      const triangles = 1 + random(3);
      store.put(block(index, hash, triangles));
      left.set(index.join(), { hash, triangles });
    }
  }
  let sum = 0n;
  let triangles = 0;
  for (const entry of left.values()) {
    sum += entry.hash;
    triangles += entry.triangles;
  }
  assert.equal(store.blockCount, left.size);
  assert.equal(store.triangles, triangles);
  assert.equal(BigInt(`0x${store.digestText}`), BigInt.asUintN(64, sum));
  const merged = takeAll(store).map((key) => store.merge(key)).filter((chunk) => chunk !== null);
  assert.equal(merged.reduce((total, chunk) => total + chunk.blocks, 0), left.size);
});

test("The digest wraps at 64 bits and does not depend on the order", () => {
  const [a, b] = [new Digest(), new Digest()];
  for (const hash of [2n ** 64n - 1n, 5n, 77n]) a.add(hash);
  for (const hash of [77n, 2n ** 64n - 1n, 5n]) b.add(hash);
  assert.equal(a.text(), b.text());
  assert.equal(a.text(), (81n).toString(16).padStart(16, "0"));
  assert.ok(sameDigest("0x0051", "51"));
  assert.ok(!sameDigest("51", "52"));
});

test("Each time that asking for all blocks did not help, the patience doubles, up to 5 minutes", () => {
  const theirs = { blocks: 2, digest: "ff", waiting: 0 };
  const ours = { blocks: 1, digest: "0f" };
  const staleness = new Staleness();
  const asked = [];
  for (let now = 0; now < 2e6; now += 1000) if (staleness.check(now, ours, theirs)) asked.push(now);
  const pauses = asked.slice(1).map((time, i) => time - asked[i]);
  assert.ok(pauses[0] >= 6000 && pauses[0] <= 8000, `the first pause is ${pauses[0]} ms`);
  assert.ok(pauses.every((pause, i) => i === 0 || pause >= pauses[i - 1]));
  assert.ok(pauses.at(-1) >= 300000 && pauses.at(-1) <= 302000, `the last pause is ${pauses.at(-1)} ms`);
  assert.equal(staleness.check(3e6, theirs, theirs), false);
  assert.equal(staleness.check(3e6 + 1, ours, theirs), false);
  assert.equal(staleness.check(3e6 + 3001, ours, theirs), true, "patience is short again");
});

test("All blocks are asked for again only when the surface differs for 3 s and nothing comes", () => {
  const theirs = { blocks: 2, digest: "ff", waiting: 0 };
  const ours = { blocks: 1, digest: "0f" };
  const staleness = new Staleness();
  assert.equal(staleness.check(0, ours, theirs), false);
  assert.equal(staleness.check(2900, ours, theirs), false);
  staleness.blockCame(2950);
  assert.equal(staleness.check(5900, ours, theirs), false, "a block came meanwhile");
  assert.equal(staleness.check(7000, ours, { ...theirs, waiting: 3 }), false, "more blocks are on their way");
  assert.equal(staleness.check(8000, ours, theirs), false, "the waiting begins anew");
  assert.equal(staleness.check(11000, ours, theirs), true);
  assert.equal(staleness.check(11001, ours, theirs), false, "not at once again");
  assert.equal(staleness.check(20000, { blocks: 2, digest: "00ff" }, theirs), false);
});
