/** What the table of processes shows of a process, worked out from its counters and timings. */
import type { Process } from "./protocol";

const kStale = 3; // [s] without a status: three times the interval at which processes send it

/** Silent though it did not say that it would stop. */
export function isStale(process: Process): boolean {
  return process.age > kStale && process.state !== "stopping";
}

export function stateText(process: Process): string {
  if (isStale(process)) return "silent";
  return process.age > kStale ? "ended" : process.state;
}

const kLost = /dropped|lost|rejected|refused|unusable|missed|late$|not_integrated/;
const kMeant = /on_purpose/;
const kWaiting = /waiting|queued|held$|frames_held/;
const kWork = ["frames_integrated", "frames_committed", "frames_sent", "detections", "frames", "published", "delivered", "received"];

/** Of the counter that tells best how fast a process works: its name and rate per second. Null when nothing counts. */
export function mainRate(process: Process): { name: string; rate: number } | null {
  const names = Object.keys(process.rates);
  const name = kWork.find((candidate) => names.includes(candidate)) ?? names.find((candidate) => /^frames|\.received$/.test(candidate));
  return name === undefined ? null : { name, rate: process.rates[name]! };
}

/** The stage with the longest median: its name, median and longest time [ms]. */
export function slowestStage(process: Process): { name: string; median: number; max: number } | null {
  const stages = Object.entries(process.timings).map(([name, timing]) => ({ name, ...timing }));
  return stages.sort((a, b) => b.median - a.median)[0] ?? null;
}

/** Sum of the counters of messages and frames that did not get through. */
export function lostCount(process: Process): number {
  return sum(process, (name) => kLost.test(name) && !kMeant.test(name));
}

/** What waits in the process: frames and requests, not bytes. */
export function waitingCount(process: Process): number {
  return sum(process, (name) => kWaiting.test(name) && !name.endsWith("bytes"));
}

function sum(process: Process, counts: (name: string) => boolean): number {
  return Object.entries(process.counters).reduce((total, [name, value]) => total + (counts(name) ? value : 0), 0);
}
