// Maps for the mock server: a computed room of known counts, or the surface of a folder that vismap-map export wrote.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { blockBytes } from "./page_bytes.mjs";

const kSecond = 1e6;

export class MockMap {
  constructor({ edge, voxel, objects, structure, up = [0, 0, 1] }) {
    Object.assign(this, { mapId: "mock-1", revision: 1, utime: 100 * kSecond, edge, voxel, objects, structure, up, digest: 0n, triangles: 0 });
    this.blocks = new Map(); // key -> {bytes, revision, hash, triangles}
    this.classNames = Object.fromEntries([...objects].filter((o) => o.class > 0).map((o) => [o.class, o.class_name]));
    this.seconds = 0;
    this.age = 0.1;
    this.serverStart = 1000;
  }
  put(index, vertices, triangles, hash) {
    const revision = this.revision;
    const bytes = blockBytes({ index, edge: this.edge, revision, hash, vertices, triangles, wide: vertices.length > 65535 });
    this.remove(index);
    this.blocks.set(index.join(), { bytes, revision, hash, triangles: triangles.length });
    this.digest = BigInt.asUintN(64, this.digest + hash);
    this.triangles += triangles.length;
  }
  remove(index) {
    const before = this.blocks.get(index.join());
    if (!before) return;
    this.digest = BigInt.asUintN(64, this.digest - before.hash);
    this.triangles -= before.triangles;
    this.blocks.delete(index.join());
  }
  deletionOf(key) { return blockBytes({ index: key.split(",").map(Number), edge: this.edge, revision: this.revision }); }
  second() { ++this.seconds; this.utime += kSecond; }
  summary() {
    return {
      kind: "map", map_id: this.mapId, revision: this.revision, utime: this.utime, frames: this.revision, blocks: this.blocks.size,
      triangles: this.triangles, digest: this.digest.toString(16).padStart(16, "0"), voxel_size_m: this.voxel, block_edge_m: this.edge,
      age_s: this.age, in_sync: true, waiting: 0, up: this.up, server_start_utime: this.serverStart, bytes: { distances: 31e6, labels: 8e6, free_space: 2.4e6, packed: 0 },
    };
  }
  objectsMessage() { return { kind: "objects", map_id: this.mapId, revision: this.revision, utime: this.utime, objects: this.objects }; }
  camera(id) {
    const angle = (this.still ? 0 : this.seconds / 8) + 2 * id;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    // z forward to the middle, y down, x right
    const [x, y] = [1.2 * c, 1.2 * s];
    return { camera_id: id, utime: this.utime, T_W_C: [-s, 0, -c, x, c, 0, -s, y, 0, -1, 0, 1.4, 0, 0, 0, 1], width: 640, height: 480,
      fx: 525, fy: 525, cx: 320, cy: 240, picture: this.jpeg ? this.seconds + 1 : 0, had_detections: true, n_detections: 2 };
  }
  camerasMessage() { return { kind: "cameras", cameras: [this.camera(0), this.camera(1)] }; }
  trajectoryMessage() {
    const positions = Array.from({ length: 60 }, (_, i) => [1.2 * Math.cos((i - 60) / 8), 1.2 * Math.sin((i - 60) / 8), 1.4]);
    return { kind: "trajectory", camera_id: 0, from: 0, positions };
  }
  picture(id) {
    if (!this.jpeg) return null;
    const runs = Array.from({ length: 240 }, (_, v) => (v > 60 && v < 160 ? [-1, 90, 0, 100, 1, 40, -1, 90] : [-1, 320])).flat();
    const list = [
      { pixels: 1, class_id: 62, class_name: "chair", score: 0.91, overlap: 0.9, detection: 0 },
      { pixels: 1, class_id: 0, class_name: "", score: 0, overlap: 0, detection: -1 },
    ];
    return { json: { camera_id: id, utime: this.utime, width: 640, height: 480, segments: { width: 320, height: 240, runs, list } }, jpeg: this.jpeg };
  }
  processesMessage() {
    const t = this.seconds;
    const base = { host: "robot", state: "running", message: "", age_s: 0.4, version: "mock", findings: [] };
    return {
      kind: "processes", now_utime: this.utime,
      processes: [
        { ...base, source: "map-server", process: "map-server", counters: { frames_integrated: 30 * t, frames_waiting: 2, "FRAMES.received": 31 * t, "FRAMES.rejected": 0, map_bytes: 41e6 },
          rates: { frames_integrated: 29.4 }, timings: { integrate: { median_ms: 12 + 3 * Math.sin(t), max_ms: 31, p50_ms: 12.3, p95_ms: 28.6 }, associate: { median_ms: 5 + Math.cos(t), max_ms: 9 }, mesh: { p50_ms: 8, p95_ms: 14 } } },
        { ...base, source: "depth-segmenter", process: "depth-segmenter", state: "waiting", message: "waits for detections of the frame at 12.40 s", counters: { frames_sent: 30 * t, frames_dropped: 4, frames_waiting: 9 },
          rates: { frames_sent: 28.9 }, timings: { segment: { median_ms: 21, max_ms: 40, p50_ms: 20, p95_ms: 37 }, "detections of camera 0": { median_ms: 140, max_ms: 210, p50_ms: 138, p95_ms: 190 } } },
        { ...base, source: "detector", process: "detector", age_s: 17.2, message: "the model could not be read", counters: { detections: 12 }, rates: { detections: 0 }, timings: { detection: { median_ms: 140, max_ms: 210 } }, findings: ["frames arrive later than 100 ms after they were taken"] },
      ],
    };
  }
}

/** A block with one wall of a grid of quads: `at` along `axis`, both as steps of a block. */
function wall(map, index, axis, over, hash) {
  const side = 6;
  const steps = Array.from({ length: side }, (_, i) => Math.round(16384 + (i / (side - 1)) * 32767));
  const [u, v] = [0, 1, 2].filter((a) => a !== axis);
  const vertices = [];
  for (const a of steps) for (const b of steps) {
    const p = [0, 0, 0];
    p[axis] = 32768;
    p[u] = a;
    p[v] = b;
    const n = [0, 0, 0];
    n[axis] = 127;
    vertices.push({ p, n, c: [200, 180 - 20 * axis, 120, 30], segment: 1, instance: 0, cls: 0, ...over });
  }
  const triangles = [];
  for (let i = 0; i + 1 < side; ++i) for (let j = 0; j + 1 < side; ++j) {
    const a = i * side + j;
    const quad = [[a, a + side, a + 1], [a + 1, a + side, a + side + 1]];
    triangles.push(...(axis === 1 ? quad.map(([x, y, z]) => [x, z, y]) : quad));
  }
  map.put(index, vertices, triangles, hash);
}

/** A floor of 10 x 10 blocks with a "chair" (instance 7) of one block, a discovered thing, and one removed object. */
export function computedMap() {
  const times = { frames: 40, points: 900, area: 0.5, first_utime: kSecond, last_utime: 97 * kSecond };
  const chair = { instance: 7, class: 62, class_name: "chair", score: 0.83, segments: [5], center: [0.2, 0.2, 0.6], size: [0.4, 0.4, 0.1], orientation: [0, 0, 0, 1], state: "present", class_probabilities: { 62: 0.83, 63: 0.17 }, ...times };
  const thing = { instance: 0, class: 0, class_name: "unknown", score: 0, segments: [12], center: [-1.4, 1.0, 0.6], size: [0.4, 0.4, 0.1], orientation: [0, 0, 0, 1], state: "present", discovered: true, ...times };
  const gone = { instance: 3, class: 47, class_name: "cup", score: 0.7, segments: [4], state: "removed", removed: true, removed_utime: 50 * kSecond, ...times };
  const floor = { instance: 0, class: 0, class_name: "unknown", score: 0, segments: [1], center: [0, 0, 0.2], size: [4, 4, 0.02], orientation: [0, 0, 0, 1], state: "present", structure: true, kind: "floor", ...times };
  const map = new MockMap({ edge: 0.4, voxel: 0.05, objects: [chair, thing, gone], structure: [floor] });
  let hash = 0x9e3779b97f4a7c15n;
  const next = () => (hash = BigInt.asUintN(64, hash * 6364136223846793005n + 1442695040888963407n));
  for (let i = -5; i < 5; ++i) for (let j = -5; j < 5; ++j) wall(map, [i, j, 0], 2, {}, next());
  wall(map, [0, 0, 1], 2, { segment: 5, instance: 7, cls: 62 }, next());
  wall(map, [-4, 2, 1], 2, { segment: 12 }, next());
  return map;
}

/** The surface in FOLDER/mesh.ply and the objects in FOLDER/objects.json; blocks of 8 cm. */
export function mapOfFolder(folder) {
  const objects = JSON.parse(readFileSync(join(folder, "objects.json")));
  const all = [...objects.objects, ...objects.discovered.map((o) => ({ ...o, discovered: true })), ...objects.removed];
  const map = new MockMap({ edge: 0.08, voxel: 0.01, objects: all, structure: objects.structure, up: objects.up.direction });
  const bytes = readFileSync(join(folder, "mesh.ply"));
  const end = bytes.indexOf("end_header\n") + 11;
  const head = bytes.subarray(0, end).toString();
  const n = Number(/element vertex (\d+)/.exec(head)[1]);
  const m = Number(/element face (\d+)/.exec(head)[1]);
  const stride = 24 + 3 + 10;
  const faces = end + n * stride;
  const blocks = new Map();
  for (let f = 0; f < m; ++f) {
    const corners = [0, 1, 2].map((i) => bytes.readUInt32LE(faces + 13 * f + 1 + 4 * i));
    const at = end + corners[0] * stride;
    const key = [0, 4, 8].map((o) => Math.floor(bytes.readFloatLE(at + o) / map.edge)).join();
    const block = blocks.get(key) ?? { index: key.split(",").map(Number), numbers: new Map(), triangles: [] };
    blocks.set(key, block);
    block.triangles.push(corners.map((c) => {
      if (!block.numbers.has(c)) block.numbers.set(c, block.numbers.size);
      return block.numbers.get(c);
    }));
  }
  let hash = 1n;
  for (const { index, numbers, triangles } of blocks.values()) {
    const vertices = [...numbers.keys()].map((v) => {
      const at = end + v * stride;
      const p = [0, 1, 2].map((a) => Math.min(65535, Math.max(0, Math.round(((bytes.readFloatLE(at + 4 * a) / map.edge - index[a] + 0.5) / 2) * 65535))));
      const normal = [0, 1, 2].map((a) => Math.round(127 * bytes.readFloatLE(at + 12 + 4 * a)));
      return { p, n: normal, c: [...bytes.subarray(at + 24, at + 27), 1 + (v % 200)], segment: bytes.readUInt32LE(at + 27), instance: bytes.readUInt32LE(at + 31), cls: bytes.readUInt16LE(at + 35) };
    });
    map.put(index, vertices, triangles, (hash = BigInt.asUintN(64, hash * 6364136223846793005n + 1442695040888963407n)));
  }
  return map;
}
