/** GET requests to vismap-viewer. They never throw: what went wrong is a sentence in `error`. */
import { asText, isObject } from "./json";

export type Answer<T> = { value: T; error: null } | { value: null; error: string };

const kPatience = 15000; // [ms]

let frames: number | null = null; // of the moment of a log that is shown; null = there is no log

/** Questions are about the map after so many frames of a log from now on. */
export function askAbout(moment: number): void {
  frames = moment;
}

/** Whether the page shows a log. */
export function isLog(): boolean {
  return frames !== null;
}

/** The address of a question about what is shown now. */
export function atMoment(path: string): string {
  return frames === null ? path : `${path}${path.includes("?") ? "&" : "?"}frames=${frames}`;
}

async function get<T>(question: string, read: (response: Response) => Promise<T>): Promise<Answer<T>> {
  const path = atMoment(question);
  try {
    const response = await fetch(path, { signal: AbortSignal.timeout(kPatience), cache: "no-store" });
    if (response.ok) return { value: await read(response), error: null };
    return { value: null, error: await errorOf(response) };
  } catch (error) {
    const late = error instanceof DOMException && error.name === "TimeoutError";
    return { value: null, error: late ? "The server did not answer in time." : "The server cannot be reached." };
  }
}

async function errorOf(response: Response): Promise<string> {
  const text = await response.text();
  try {
    const json: unknown = JSON.parse(text);
    if (isObject(json) && asText(json.error) !== "") return asText(json.error);
  } catch {
    // No JSON: the status has to say it.
  }
  return `The server answered with status ${response.status}.`;
}

export function getJson(path: string): Promise<Answer<unknown>> {
  return get(path, async (response) => (await response.json()) as unknown);
}

export function getBytes(path: string): Promise<Answer<ArrayBuffer>> {
  return get(path, (response) => response.arrayBuffer());
}
