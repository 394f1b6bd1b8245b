import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import { load } from "./load.mjs";
import { arrayBuffer, blockBytes, pictureBytes, vertex } from "./page_bytes.mjs";

const { blocksOfBatch, decodeBlock, positionsInto, decodePicture } = await load("block_codec", "picture_codec");

const triangle = {
  index: [-2, 0, 3],
  edge: 0.4,
  revision: 17,
  hash: 0xfedcba9876543210n,
  vertices: [
    vertex([0, 32768, 65535]),
    vertex([65535, 0, 0], { instance: 7, cls: 62, segment: 9, n: [127, 0, -127] }),
    vertex([16384, 16384, 16384], { c: [255, 0, 1, 0] }),
  ],
  triangles: [[0, 1, 2]],
};

for (const wide of [false, true]) {
  test(`A block keeps all its values, indices of ${wide ? 32 : 16} bits`, () => {
    const block = decodeBlock(arrayBuffer(blockBytes({ ...triangle, wide })));
    assert.equal(block.key, "-2,0,3");
    assert.equal(block.revision, 17);
    assert.equal(block.hash, 0xfedcba9876543210n);
    assert.deepEqual([...block.indices], [0, 1, 2]);
    assert.deepEqual([...block.segments], [5, 9, 5]);
    assert.deepEqual([...block.instances], [0, 7, 0]);
    assert.deepEqual([...block.classes], [0, 62, 0]);
    assert.deepEqual([...block.normals.subarray(4, 8)], [127, 0, -127, 0]);
    assert.deepEqual([...block.colours.subarray(8)], [255, 0, 1, 0]);
  });
}

test("Positions are (index - 0.5 + 2 step / 65535) edges", () => {
  const out = new Float32Array(12);
  positionsInto(decodeBlock(arrayBuffer(blockBytes(triangle))), out, 1);
  const expected = [-2.5, 0.5, 4.5].map((edges) => edges * 0.4);
  assert.deepEqual([...out.subarray(0, 3)], [0, 0, 0]);
  out.subarray(3, 6).forEach((value, axis) => assert.ok(Math.abs(value - expected[axis]) < 2e-5, `${value} near ${expected[axis]}`));
});

test("A block without vertices is a deletion", () => {
  const block = decodeBlock(arrayBuffer(blockBytes({ index: [1, 2, 3], edge: 0.08 })));
  assert.equal(block.vertices, 0);
  assert.equal(block.triangles, 0);
});

test("Every cut and every index out of range is an error with a sentence", () => {
  const bytes = blockBytes(triangle);
  const needed = 48 + 24 * 3 + 8 + 6; // the two bytes after it are padding
  for (let size = 0; size < needed; ++size) {
    assert.throws(() => decodeBlock(arrayBuffer(bytes.subarray(0, size))), /came\.$/, `${size} bytes`);
  }
  assert.throws(() => decodeBlock(arrayBuffer(blockBytes({ ...triangle, triangles: [[0, 1, 3]] }))), /names vertex 3 of 3/);
  const other = Buffer.from(bytes);
  other.writeUInt8(2, 0);
  assert.throws(() => decodeBlock(arrayBuffer(other)), /begins with 2/);
  const huge = Buffer.from(bytes);
  huge.writeUInt32LE(0xffffffff, 24);
  assert.throws(() => decodeBlock(arrayBuffer(huge)), /vertices/);
});

test("A picture keeps its text and its JPEG", () => {
  const about = {
    camera_id: 3, utime: 1700000000000001, width: 640, height: 480,
    segments: { width: 4, height: 2, runs: [-1, 3, 0, 5], list: [{ class_id: 62, class_name: "chair", score: 0.9, detection: 0 }] },
  };
  const jpeg = Buffer.from([0xff, 0xd8, 1, 2, 3]);
  const picture = decodePicture(arrayBuffer(pictureBytes(3, about, jpeg)));
  assert.equal(picture.utime, 1700000000000001);
  assert.deepEqual(picture.segments.runs, [-1, 3, 0, 5]);
  assert.equal(picture.segments.list[0].className, "chair");
  assert.deepEqual([...picture.jpeg], [...jpeg]);
});

test("A picture whose text is cut or no JSON is an error", () => {
  const bytes = pictureBytes(0, { camera_id: 0 }, Buffer.alloc(0));
  assert.throws(() => decodePicture(arrayBuffer(bytes.subarray(0, 6))), /8 bytes of header/);
  assert.throws(() => decodePicture(arrayBuffer(bytes.subarray(0, 12))), /came in all/);
  bytes.write("x", 8);
  assert.throws(() => decodePicture(arrayBuffer(bytes)), SyntaxError);
});

test("The block that the viewer's own test writes is decoded", async () => {
  const block = decodeBlock(arrayBuffer(await readFile(new URL("../block.bin", import.meta.url))));
  assert.deepEqual(block.index, [-1, 2, 3]);
  assert.deepEqual([block.edge, block.revision, block.hash], [0.5, 5, 0x0102030405060708n]);
  assert.deepEqual([block.vertices, block.triangles], [6, 2]);
  assert.deepEqual([...block.indices], [0, 1, 2, 3, 4, 5]);
  for (let v = 0; v < 6; ++v) {
    assert.deepEqual([...block.positions.subarray(4 * v, 4 * v + 4)], [40000 + v, 2 * v, 0, 0]);
    assert.deepEqual([...block.normals.subarray(4 * v, 4 * v + 3)], [-127 + v, v, 0]);
    assert.deepEqual([...block.colours.subarray(4 * v, 4 * v + 4)], [10 + v, 20, 30, 200 + v]);
    assert.deepEqual([block.segments[v], block.instances[v], block.classes[v]], [100000 + v, 7, 62]);
  }
});

function batchOf(...blocks) {
  const parts = [Buffer.from([3, 0, 0, 0, blocks.length, 0, 0, 0])];
  for (const block of blocks) {
    const size = Buffer.alloc(4);
    size.writeUInt32LE(block.length);
    parts.push(size, block);
  }
  return Buffer.concat(parts);
}

test("Several blocks of one message are as if each had come alone, in memory of their own", () => {
  const [first, second] = [blockBytes(triangle), blockBytes({ ...triangle, index: [1, 1, 1], wide: true })];
  const blocks = [...blocksOfBatch(arrayBuffer(batchOf(first, second)))];
  assert.deepEqual(blocks, [decodeBlock(arrayBuffer(first)), decodeBlock(arrayBuffer(second))]);
  assert.equal(blocks[0].positions.buffer.byteLength, first.length);
  assert.deepEqual([...blocksOfBatch(arrayBuffer(batchOf()))], []);
});

test("A message of several blocks that is too short or too long is an error", () => {
  const whole = batchOf(blockBytes(triangle), blockBytes(triangle));
  for (const wrong of [whole.subarray(0, 5), whole.subarray(0, whole.length - 4), Buffer.concat([whole, Buffer.alloc(4)])])
    assert.throws(() => [...blocksOfBatch(arrayBuffer(wrong))], /wrong size/);
});
