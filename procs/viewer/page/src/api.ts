/** GET requests to vismap-viewer. They never throw: what went wrong is a sentence in `error`. */
import { asText, isObject } from "./json";

export type Answer<T> = { value: T; error: null } | { value: null; error: string };

const kPatience = 15000; // [ms]

async function get<T>(path: string, read: (response: Response) => Promise<T>): Promise<Answer<T>> {
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
