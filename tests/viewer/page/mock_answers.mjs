// What the mock server answers to GET /api/...
import { deflateSync } from "node:zlib";

const json = (status, value) => ({ status, type: "application/json", body: JSON.stringify(value) });

/** A room with free space of 4 m x 4 m, walls around it and a table in it; unknown outside. */
function stateAt(x, y, z) {
  const edge = Math.max(Math.abs(x), Math.abs(y));
  if (edge > 2.1 || z < -0.1 || z > 2.6) return 0;
  if (edge > 2.0 || z < 0.2) return 2;
  return Math.hypot(x - 0.2, y - 0.2) < 0.3 && z < 0.9 ? 2 : 1;
}

/** Metres to the nearest wall, floor or table in all directions; NaN outside of the room. */
function distanceAt(x, y, z) {
  if (stateAt(x, y, z) === 0) return Number.NaN;
  const sideways = Math.hypot(x - 0.2, y - 0.2) - 0.3;
  const table = Math.hypot(Math.max(0, sideways), Math.max(0, z - 0.9));
  return Math.max(0, Math.min(2.0 - Math.abs(x), 2.0 - Math.abs(y), z - 0.2, table));
}

function slice(map, query) {
  const axis = query.get("axis") ?? "z";
  const at = Number(query.get("at") ?? 1);
  const cell = Number(query.get("res") ?? 0.05);
  if (!["x", "y", "z"].includes(axis) || !Number.isFinite(at)) return json(400, { error: "axis must be x, y or z." });
  const axes = ["x", "y", "z"].filter((a) => a !== axis);
  const origin = axes.map((a) => (a === "z" ? -0.5 : -2.5));
  const size = axes.map((a) => Math.round((a === "z" ? 3.5 : 5) / cell));
  const cells = Buffer.alloc(size[0] * size[1]);
  for (let v = 0; v < size[1]; ++v) for (let u = 0; u < size[0]; ++u) {
    const p = { [axis]: at, [axes[0]]: origin[0] + (u + 0.5) * cell, [axes[1]]: origin[1] + (v + 0.5) * cell };
    cells[v * size[0] + u] = stateAt(p.x, p.y, p.z);
  }
  const wanted = query.get("distance") === "1";
  const distances = wanted && !map.noExporter;
  let head = JSON.stringify({ map_id: "mock-1", revision: 1, axis, at_m: at, cell_m: cell, origin, width: size[0], height: size[1], axes, layer: 3,
    distances, ...(wanted && !distances ? { distances_problem: "no octomap exporter was heard" } : {}) });
  head = head.padEnd(Math.ceil(head.length / 4) * 4);
  const length = Buffer.alloc(4);
  length.writeUInt32LE(head.length);
  const metres = Buffer.alloc(distances ? 4 * cells.length : 0);
  for (let v = 0; distances && v < size[1]; ++v) for (let u = 0; u < size[0]; ++u) {
    const p = { [axis]: at, [axes[0]]: origin[0] + (u + 0.5) * cell, [axes[1]]: origin[1] + (v + 0.5) * cell };
    metres.writeFloatLE(distanceAt(p.x, p.y, p.z), 4 * (v * size[0] + u));
  }
  const padding = Buffer.alloc(distances ? (4 - (cells.length % 4)) % 4 : 0);
  return { status: 200, type: "application/octet-stream", body: Buffer.concat([length, Buffer.from(head), cells, padding, metres]) };
}

function cell(query) {
  const at = (query.get("at") ?? "").split(",").map(Number);
  if (at.length !== 3 || !at.every(Number.isFinite)) return json(400, { error: "at must be three numbers, x,y,z in metres." });
  const state = ["unknown", "free", "occupied"][stateAt(...at)];
  return json(200, { at, state, distance_m: state === "free" ? 0.42 : null, weight: 12.5, observations: 31, block: "voxels", revision: 1,
    labels: [{ label: 5, votes: 12, instance: 7, class: 62, class_name: "chair" }, { label: 1, votes: 3, instance: 0, class: 0, class_name: "" }], last_utime: 97000000 });
}

/** The checksum of a PNG's chunk. */
function crc32(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}

/** A picture of one colour as PNG. */
function png(width, height, colour) {
  const row = Buffer.concat([Buffer.from([0]), Buffer.alloc(3 * width, Buffer.from(colour))]);
  const chunk = (name, data) => {
    const body = Buffer.concat([Buffer.from(name), data]);
    const bytes = Buffer.alloc(body.length + 8);
    bytes.writeUInt32BE(data.length);
    body.copy(bytes, 4);
    bytes.writeUInt32BE(crc32(body), body.length + 4);
    return bytes;
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width);
  head.writeUInt32BE(height, 4);
  head.set([8, 2], 8);
  const pixels = deflateSync(Buffer.concat(Array(height).fill(row)));
  return Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), chunk("IHDR", head), chunk("IDAT", pixels), chunk("IEND", Buffer.alloc(0))]);
}

/** Three frames of the chair, the last of which is no longer kept. */
function evidence(id) {
  if (id === "s12") return json(200, { id, frames: [], why: "no frame is kept yet" });
  if (id !== "7") return json(404, { error: `the map has no surface of the object ${id}` });
  const frames = [0, 1, 2].map((at) => ({
    camera_id: at === 1 ? 1 : 0, utime: (90 + at) * 1e6, pixels: 5200 - 1000 * at, share: 0.92 - 0.1 * at, width: 640, height: 480,
    T_W_C: [1, 0, 0, 0.2, 0, 0, -1, -2 - at, 0, 1, 0, 0.6, 0, 0, 0, 1], // looks along +y
    ...(at === 0 ? { detection: { class: 62, class_name: "chair", score: 0.91, overlap: 0.8 } } : {}),
    url: `/api/frame/${at === 1 ? 1 : 0}/${(90 + at) * 1e6}.jpg?id=7`,
  }));
  return json(200, { id, map_id: "mock-1", revision: 1, frames, kept: { frames: 3, megabytes: 0.2 } });
}

/** Red with the mask, grey without. */
function frame(url) {
  if (url.pathname.endsWith("/92000000.jpg")) return json(404, { error: "the frame of camera 0 and utime 92000000 is not kept, or no longer" });
  const width = Number(url.searchParams.get("width") ?? 640);
  const colour = url.searchParams.has("id") ? [200, 30, 30] : [120, 120, 120];
  return { status: 200, type: "image/png", body: png(width, (width * 3) / 4, colour) };
}

export async function answer(map, url) {
  if (url.pathname.startsWith("/api/frame/")) return frame(url);
  switch (url.pathname) {
    case "/api/objects":
      return json(200, { map_id: map.mapId, up: { direction: map.up, reason: "mock" }, objects: map.objects, discovered: [], structure: map.structure, removed: [] });
    case "/api/slice":
      return slice(map, url.searchParams);
    case "/api/cell":
      return cell(url.searchParams);
    case "/api/leaves":
      if (map.noExporter) return json(503, { error: "no octomap exporter was heard" });
      return json(200, { leaf_m: 0.1, left_out: 0, revision: 1, leaves: [[-1, -1, 1, 0.8, 1], [-1, 1, 1, 0.4, 1], [2.05, 0, 1, 0.1, 2]] });
    case "/api/evidence":
      return evidence(url.searchParams.get("id"));
    default:
      return json(404, { error: `There is no ${url.pathname}.` });
  }
}
