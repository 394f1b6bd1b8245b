/** Segments and masks of a frame as a picture that is laid over the camera's picture. */
import { colourOfId, paleColourOfId } from "./colours";
import type { SegmentRuns } from "./picture_codec";

export interface OverlayChoice {
  segments: boolean; // every segment in a pale colour of its own
  masks: boolean; // segments that a detection covers, in the colour of its class
}

/** r, g, b, a for each pixel of the segments' image; where nothing is to be drawn a = 0. */
export function overlayPixels(segments: SegmentRuns, choice: OverlayChoice): Uint8ClampedArray<ArrayBuffer> {
  const size = segments.width * segments.height;
  const pixels = new Uint8ClampedArray(4 * size);
  let at = 0;
  for (let i = 0; i + 1 < segments.runs.length && at < size; i += 2) {
    const index = segments.runs[i]!;
    const end = Math.min(size, at + Math.max(0, segments.runs[i + 1]!));
    const colour = colourOf(segments, index, choice);
    for (; at < end; ++at) if (colour) pixels.set(colour, 4 * at);
  }
  return pixels;
}

function colourOf(segments: SegmentRuns, index: number, choice: OverlayChoice): number[] | null {
  const segment = segments.list[index];
  if (!segment) return null;
  const detected = segment.detection >= 0 || segment.classId > 0;
  if (detected && choice.masks) return [...colourOfId(segment.classId), 150];
  return choice.segments ? [...paleColourOfId(index + 1), 120] : null;
}

/** What the detector saw, in words: "chair 91 %, cup 60 %". */
export function detectionsText(segments: SegmentRuns | null): string {
  const best = new Map<string, number>();
  for (const { classId, className, score } of segments?.list ?? []) {
    if (classId > 0) best.set(className, Math.max(score, best.get(className) ?? 0));
  }
  return [...best].map(([name, score]) => `${name} ${Math.round(100 * score)} %`).join(", ");
}
