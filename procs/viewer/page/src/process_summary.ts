/** What the table of processes shows of a process, worked out from its counters and timings. */
import type { Process, Timing } from "./protocol";

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

const kDelay = /^detections of camera (\d+)$/; // not work of the process, but what it waits for
const kNoWork = /^(detections of camera|waiting) /;

export type Stage = Timing & { name: string };

/** The stage that takes longest, by its p50 of the last minute or, where that is not known, by its median. */
export function slowestStage(process: Process): Stage | null {
  const middle = (stage: Stage): number => stage.p50 ?? stage.median ?? 0;
  return stagesOf(process).filter((stage) => !kNoWork.test(stage.name)).sort((a, b) => middle(b) - middle(a))[0] ?? null;
}

export function stagesOf(process: Process): Stage[] {
  return Object.entries(process.timings).map(([name, timing]) => ({ name, ...timing }));
}

/** How long after the frames of each camera their detections come. */
export function detectionDelays(processes: Process[]): Map<number, Timing> {
  const delays = new Map<number, Timing>();
  for (const stage of processes.flatMap(stagesOf)) {
    const camera = kDelay.exec(stage.name)?.[1];
    if (camera !== undefined) delays.set(Number(camera), stage);
  }
  return delays;
}

/** "140 ms (p50 of the last minute 138 ms, p95 160 ms)"; "" when nothing is known. */
export function delayText(delay: Timing | undefined): string {
  if (!delay) return "";
  const ms = (value: number): string => `${value.toFixed(0)} ms`;
  const shares = [["p50", delay.p50], ["p95", delay.p95]] as const;
  const minute = shares.flatMap(([name, value]) => (value === null ? [] : [`${name} ${ms(value)}`])).join(", ");
  if (delay.median === null) return minute === "" ? "" : `in the last minute ${minute}`;
  return ms(delay.median) + (minute === "" ? "" : ` (in the last minute ${minute})`);
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
