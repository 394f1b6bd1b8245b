// Writes the binary messages of vismap-viewer, independently of the page's decoder.

/** vertices: [{p: [x, y, z] steps of 0..65535, n: [..] of -127..127, c: [r, g, b, seen], segment, instance, cls}]; triangles: [[a, b, c]]. */
export function blockBytes({ index, edge, revision = 1, hash = 0n, vertices = [], triangles = [], wide = false }) {
  const n = vertices.length;
  const m = triangles.length;
  const padded = (size) => Math.ceil(size / 4) * 4;
  const bytes = Buffer.alloc(48 + 24 * n + padded(2 * n) + padded((wide ? 12 : 6) * m));
  bytes.writeUInt8(1, 0);
  bytes.writeUInt16LE(wide ? 1 : 0, 2);
  index.forEach((i, axis) => bytes.writeInt32LE(i, 4 + 4 * axis));
  bytes.writeFloatLE(edge, 16);
  bytes.writeUInt32LE(revision, 20);
  bytes.writeUInt32LE(n, 24);
  bytes.writeUInt32LE(m, 28);
  bytes.writeBigUInt64LE(hash, 32);
  let at = 48;
  for (const { p } of vertices) for (const step of [...p, 0]) at = bytes.writeUInt16LE(step, at);
  for (const { n: normal } of vertices) for (const step of [...normal, 0]) at = bytes.writeInt8(step, at);
  for (const { c } of vertices) for (const level of c) at = bytes.writeUInt8(level, at);
  for (const { segment } of vertices) at = bytes.writeUInt32LE(segment, at);
  for (const { instance } of vertices) at = bytes.writeUInt32LE(instance, at);
  for (const { cls } of vertices) at = bytes.writeUInt16LE(cls, at);
  at = padded(at);
  for (const corner of triangles.flat()) at = wide ? bytes.writeUInt32LE(corner, at) : bytes.writeUInt16LE(corner, at);
  return bytes;
}

/** A picture message with this JSON. */
export function pictureBytes(cameraId, json, jpeg) {
  const text = Buffer.from(JSON.stringify(json));
  const head = Buffer.alloc(8);
  head.writeUInt8(2, 0);
  head.writeUInt8(cameraId, 1);
  head.writeUInt32LE(text.length, 4);
  return Buffer.concat([head, text, Buffer.alloc(Math.ceil(text.length / 4) * 4 - text.length), jpeg]);
}

/** The bytes as an ArrayBuffer of their own, as a WebSocket gives them. */
export function arrayBuffer(bytes) {
  return bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
}

/** A corner of a block with plain values; `over` replaces some. */
export function vertex(p, over = {}) {
  return { p, n: [0, 0, 127], c: [10, 20, 30, 40], segment: 5, instance: 0, cls: 0, ...over };
}
