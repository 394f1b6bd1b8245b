/** The moments of a log: which there are, and which one is meant by a place, a time or a step. */
import { asList, asNumber, asObject, asText, type Json } from "./json";

/** An object has come, or has gone. */
export interface Mark {
  frames: number;
  utime: number; // [us]
  id: string;
  name: string;
  appeared: boolean;
}

export interface TimelineMessage {
  kind: "timeline";
  total: number; // frames of the log
  read: number; // of these, mapped or left out
  mapped: number; // frames in the map
  done: boolean;
  message: string; // what a person should know
  stride: number; // frames from one moment to the next
  frames: number[]; // of the map at each moment, ascending
  utimes: number[]; // of its newest frame [us]
  marks: Mark[];
}

export function readTimeline(json: Json): TimelineMessage {
  const frames = asList(json.frames).map((value) => asNumber(value));
  let utime = 0;
  const utimes = asList(json.utimes).map((step) => (utime += asNumber(step)));
  const length = Math.min(frames.length, utimes.length);
  return {
    kind: "timeline",
    total: asNumber(json.total),
    read: asNumber(json.read),
    mapped: asNumber(json.mapped),
    done: json.done === true,
    message: asText(json.message),
    stride: Math.max(1, asNumber(json.stride, 1)),
    frames: frames.slice(0, length),
    utimes: utimes.slice(0, length),
    marks: asList(json.marks).map(asObject).map(readMark),
  };
}

function readMark(json: Json): Mark {
  return {
    frames: asNumber(json.frames),
    utime: asNumber(json.utime),
    id: asText(json.id),
    name: asText(json.name, "object"),
    appeared: json.appeared === true,
  };
}

/** The index of the last value of an ascending list that is at most `limit`; 0 when all are larger. */
function lastUpTo(values: number[], limit: number): number {
  let low = 0;
  let high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle]! <= limit) low = middle + 1;
    else high = middle;
  }
  return Math.max(0, low - 1);
}

export class Timeline {
  constructor(readonly message: TimelineMessage) {}

  get length(): number {
    return this.message.frames.length;
  }

  get first(): number {
    return this.message.frames[0] ?? 0;
  }

  get last(): number {
    return this.message.frames.at(-1) ?? 0;
  }

  /** How far the slider reaches: over all frames that may still come. */
  get end(): number {
    const { done, total } = this.message;
    return done ? this.last : Math.max(this.last, total);
  }

  /** The newest moment of at most so many frames, else the first one. */
  at(frames: number): number {
    return this.message.frames[lastUpTo(this.message.frames, frames)] ?? 0;
  }

  /** The newest moment that is not later than this [us]. */
  atTime(utime: number): number {
    return this.message.frames[lastUpTo(this.message.utimes, utime)] ?? 0;
  }

  /** So many moments after one, or before it. */
  step(frames: number, steps: number): number {
    const index = lastUpTo(this.message.frames, frames) + steps;
    return this.message.frames[Math.min(Math.max(0, index), this.length - 1)] ?? 0;
  }

  /** Time of a moment [us]. */
  utimeOf(frames: number): number {
    return this.message.utimes[lastUpTo(this.message.frames, frames)] ?? 0;
  }

  /** Seconds from the first moment to one. */
  secondsOf(frames: number): number {
    return (this.utimeOf(frames) - (this.message.utimes[0] ?? 0)) / 1e6;
  }

  /** The next mark after a moment, or the one before it; null when there is none. */
  markFrom(frames: number, forward: boolean): Mark | null {
    const { marks } = this.message;
    if (forward) return marks.find((mark) => mark.frames > frames) ?? null;
    return marks.filter((mark) => mark.frames < frames).at(-1) ?? null;
  }

  /** The marks at a moment: those since the moment before. */
  marksAt(frames: number): Mark[] {
    const before = this.step(frames, -1);
    return this.message.marks.filter((mark) => mark.frames <= frames && (mark.frames > before || before === frames));
  }
}

/** "1:05.3", minutes and seconds. */
export function clockText(seconds: number): string {
  const tenths = Math.round(10 * Math.max(0, seconds));
  const minutes = Math.floor(tenths / 600);
  return `${minutes}:${((tenths % 600) / 10).toFixed(1).padStart(4, "0")}`;
}

/** "chair 7 appears" */
export function markText(mark: Mark): string {
  return `${mark.name} ${mark.id} ${mark.appeared ? "appears" : "disappears"}`;
}
