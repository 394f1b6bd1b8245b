/** The messages of vismap-viewer in text, as the page uses them. */
import { asList, asNumber, asNumberOrNull, asNumbers, asObject, asText, asVector, isObject, type Json } from "./json";
import { readTimeline, type TimelineMessage } from "./timeline_data";

export interface HelloMessage {
  kind: "hello";
  protocol: number;
  version: string;
  mode: string; // "live" or "log"
  control: boolean;
  source: string;
  classNames: Record<string, string>; // by class id
}

export interface MapMessage {
  kind: "map";
  mapId: string;
  revision: number;
  utime: number; // of the newest frame [us]
  frames: number;
  blocks: number;
  triangles: number;
  digest: string;
  voxelSize: number; // [m]
  age: number; // since the server has heard of the map [s]
  reset: boolean; // forget all blocks
  up: [number, number, number] | null;
  bytes: Record<string, number>; // memory of the map, by layer
  waiting: number; // blocks that the server has still to send to this page
  inSync: boolean; // the server has all that the map server sent
  serverStart: number; // when the map server was started [us]; 0 = not known
}

export interface ObjectsMessage {
  kind: "objects";
  utime: number;
  objects: Json[];
}

/** Durations of a stage [ms]; null = not known. */
export interface Timing {
  median: number | null; // since the last status
  max: number | null;
  p50: number | null; // of the last minute
  p95: number | null;
}

export interface Process {
  source: string;
  process: string;
  host: string;
  state: string;
  message: string;
  age: number; // since its last status [s]
  version: string;
  counters: Record<string, number>;
  rates: Record<string, number>; // of the counters, per second
  timings: Record<string, Timing>; // by stage
  findings: string[];
}

export interface ProcessesMessage {
  kind: "processes";
  utime: number;
  processes: Process[];
}

export interface CameraState {
  id: number;
  utime: number;
  pose: number[]; // T_W_C, 16 numbers row by row
  width: number;
  height: number;
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  picture: number; // revision of the newest picture, 0 = none
  detections: number | null; // in its newest frame; null = no detector looked
  positions: number; // of its path that belong to what is shown; -1 = all
}

export interface CamerasMessage {
  kind: "cameras";
  cameras: CameraState[];
}

export interface TrajectoryMessage {
  kind: "trajectory";
  cameraId: number;
  from: number; // number of the first position of this message
  positions: number[][];
}

export interface NoticeMessage {
  kind: "notice";
  level: "info" | "warning" | "error";
  text: string;
  id: string; // "" = goes away by itself
}

export interface NavigationMessage {
  kind: "navigation";
  message: string;
  inSync: boolean;
}

export type ServerMessage =
  | HelloMessage
  | MapMessage
  | ObjectsMessage
  | ProcessesMessage
  | CamerasMessage
  | TrajectoryMessage
  | NoticeMessage
  | NavigationMessage
  | TimelineMessage;

/** Reads a message; null when it is of a kind that this page does not know. Throws when it is no JSON object. */
export function parseMessage(text: string): ServerMessage | null {
  const json: unknown = JSON.parse(text);
  if (!isObject(json)) throw new Error("A message of the server is no JSON object.");
  switch (json.kind) {
    case "hello":
      return readHello(json);
    case "map":
      return readMap(json);
    case "objects":
      return { kind: "objects", utime: asNumber(json.utime), objects: asList(json.objects).filter(isObject) };
    case "processes":
      return { kind: "processes", utime: asNumber(json.now_utime), processes: asList(json.processes).map(readProcess) };
    case "cameras":
      return { kind: "cameras", cameras: asList(json.cameras).flatMap(readCamera) };
    case "trajectory":
      return readTrajectory(json);
    case "notice":
      return { kind: "notice", level: readLevel(json.level), text: asText(json.text), id: asText(json.id) };
    case "navigation":
      return { kind: "navigation", message: asText(json.message), inSync: json.in_sync !== false };
    case "timeline":
      return readTimeline(json);
    default:
      return null;
  }
}

function readHello(json: Json): HelloMessage {
  return {
    kind: "hello",
    protocol: asNumber(json.protocol),
    version: asText(json.version),
    mode: asText(json.mode, "live"),
    control: json.control === true,
    source: asText(json.source),
    classNames: Object.fromEntries(Object.entries(asObject(json.class_names)).map(([id, name]) => [id, asText(name)])),
  };
}

function readMap(json: Json): MapMessage {
  const up = asVector(json.up, 3);
  return {
    kind: "map",
    mapId: asText(json.map_id),
    revision: asNumber(json.revision, -1),
    utime: asNumber(json.utime),
    frames: asNumber(json.frames),
    blocks: asNumber(json.blocks),
    triangles: asNumber(json.triangles),
    digest: asText(json.digest),
    voxelSize: asNumber(json.voxel_size_m),
    age: asNumber(json.age_s),
    reset: json.reset === true,
    up: up ? [up[0]!, up[1]!, up[2]!] : null,
    bytes: asNumbers(json.bytes),
    waiting: asNumber(json.waiting),
    inSync: json.in_sync !== false,
    serverStart: asNumber(json.server_start_utime),
  };
}

function readProcess(value: unknown): Process {
  const json = asObject(value);
  const timings: Process["timings"] = {};
  for (const [name, entry] of Object.entries(asObject(json.timings))) {
    const timing = asObject(entry);
    const [median, max, p50, p95] = [timing.median_ms, timing.max_ms, timing.p50_ms, timing.p95_ms].map(asNumberOrNull);
    timings[name] = { median: median!, max: max!, p50: p50!, p95: p95! };
  }
  return {
    source: asText(json.source),
    process: asText(json.process),
    host: asText(json.host),
    state: asText(json.state),
    message: asText(json.message),
    age: asNumber(json.age_s),
    version: asText(json.version),
    counters: asNumbers(json.counters),
    rates: asNumbers(json.rates),
    timings,
    findings: asList(json.findings).map((entry) => asText(entry)),
  };
}

function readCamera(value: unknown): CameraState[] {
  const json = asObject(value);
  const pose = asVector(json.T_W_C, 16);
  if (!pose) return [];
  return [
    {
      id: asNumber(json.camera_id),
      utime: asNumber(json.utime),
      pose,
      width: asNumber(json.width, 640),
      height: asNumber(json.height, 480),
      fx: asNumber(json.fx, 500),
      fy: asNumber(json.fy, 500),
      cx: asNumber(json.cx, 320),
      cy: asNumber(json.cy, 240),
      picture: asNumber(json.picture),
      detections: json.had_detections === true ? asNumber(json.n_detections) : null,
      positions: asNumber(json.positions, -1),
    },
  ];
}

function readTrajectory(json: Json): TrajectoryMessage {
  const positions = asList(json.positions).flatMap((entry) => {
    const position = asVector(entry, 3);
    return position ? [position] : [];
  });
  return { kind: "trajectory", cameraId: asNumber(json.camera_id), from: asNumber(json.from), positions };
}

function readLevel(value: unknown): NoticeMessage["level"] {
  return value === "error" || value === "warning" ? value : "info";
}
