/** Frames in which an object was seen, as /api/evidence tells of them. */
import type { Rgb } from "./colours";
import { asList, asNumber, asObject, asText, asVector } from "./json";

export interface EvidenceFrame {
  cameraId: number;
  utime: number; // [us]
  pixels: number; // of the object in the picture, about
  share: number; // of the object's pixels that nothing hides, 0 to 1
  said: string; // what a detector said of it in this frame; "" = nothing
  pose: number[]; // T_W_C, 16 numbers row by row
  width: number;
  height: number;
  url: string; // of the picture with the mask, relative to the page
}

export interface EvidenceList {
  frames: EvidenceFrame[];
  why: string; // why there is none
}

export function readEvidence(value: unknown): EvidenceList {
  const json = asObject(value);
  return { frames: asList(json.frames).flatMap(readFrame), why: asText(json.why) };
}

function readFrame(value: unknown): EvidenceFrame[] {
  const json = asObject(value);
  const url = asText(json.url).replace(/^\//, "");
  const pose = asVector(json.T_W_C, 16);
  if (!url.startsWith("api/frame/") || !pose) return [];
  const detection = asObject(json.detection);
  const name = asText(detection.class_name);
  return [
    {
      cameraId: asNumber(json.camera_id),
      utime: asNumber(json.utime),
      pixels: asNumber(json.pixels),
      share: asNumber(json.share),
      said: name === "" ? "" : `${name} ${Math.round(100 * asNumber(detection.score))} %`,
      pose,
      width: asNumber(json.width, 640),
      height: asNumber(json.height, 480),
      url,
    },
  ];
}

export interface PictureChoice {
  mask: boolean;
  colour: Rgb; // of the mask
  width?: number; // of a smaller picture [px]
}

/** The address of a frame's picture. */
export function pictureUrl(frame: EvidenceFrame, { mask, colour, width }: PictureChoice): string {
  const [path, query] = frame.url.split("?") as [string, string?];
  const given = new URLSearchParams(mask ? query : "");
  if (mask) given.set("color", colour.map((level) => Math.round(level).toString(16).padStart(2, "0")).join(""));
  if (width) given.set("width", String(width));
  return given.size > 0 ? `${path}?${given}` : path;
}

/** "camera 0, 12.34 s" */
export function frameName(frame: EvidenceFrame): string {
  return `camera ${frame.cameraId}, ${(frame.utime / 1e6).toFixed(2)} s`;
}
