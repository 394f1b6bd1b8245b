/** Picture of a camera: the binary message of kind 2. */
import { asList, asNumber, asObject, asText, isObject, type Json } from "./json";

/** The segments of a frame, in an image that may be smaller than the picture. */
export interface SegmentRuns {
  width: number;
  height: number;
  runs: number[]; // index into `list` or -1, length, index, length, ... row by row
  list: PictureSegment[];
}

export interface PictureSegment {
  classId: number; // 0 = no detection covers it
  className: string;
  score: number;
  detection: number; // number of the detection that it belongs to; below 0 = none
}

export interface Picture {
  cameraId: number;
  utime: number;
  width: number;
  height: number;
  segments: SegmentRuns | null;
  problem: string; // why there is no JPEG
  jpeg: Uint8Array; // may be empty
}

export const kPictureKind = 2;
const kMaxPixels = 1 << 24;

/** Decodes a message; throws an Error with a sentence when it is malformed. */
export function decodePicture(bytes: ArrayBuffer): Picture {
  if (bytes.byteLength < 8) throw new Error(`A picture needs 8 bytes of header; ${bytes.byteLength} came.`);
  const size = new DataView(bytes).getUint32(4, true);
  const start = 8 + Math.ceil(size / 4) * 4;
  if (start > bytes.byteLength) {
    throw new Error(`A picture says that its text has ${size} bytes; ${bytes.byteLength} came in all.`);
  }
  const about = asObject(JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 8, size))));
  return {
    cameraId: asNumber(about.camera_id),
    utime: asNumber(about.utime),
    width: asNumber(about.width),
    height: asNumber(about.height),
    segments: isObject(about.segments) ? readRuns(about.segments) : null,
    problem: asText(about.problem),
    jpeg: new Uint8Array(bytes, start),
  };
}

function readRuns(value: Json): SegmentRuns | null {
  const width = asNumber(value.width);
  const height = asNumber(value.height);
  if (width <= 0 || height <= 0 || width * height > kMaxPixels) return null;
  const runs = asList(value.runs).map((entry) => asNumber(entry));
  return { width, height, runs, list: asList(value.list).map(readSegment) };
}

function readSegment(value: unknown): PictureSegment {
  const about = asObject(value);
  const classId = asNumber(about.class_id);
  return {
    classId,
    className: asText(about.class_name, `class ${classId}`),
    score: asNumber(about.score),
    detection: asNumber(about.detection, -1),
  };
}
