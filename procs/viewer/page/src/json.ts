/** Reads values out of JSON that came from outside: what is missing or of the wrong type becomes a default. */

export type Json = Record<string, unknown>;

export function isObject(value: unknown): value is Json {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

export function asObject(value: unknown): Json {
  return isObject(value) ? value : {};
}

export function asNumber(value: unknown, otherwise = 0): number {
  return typeof value === "number" && Number.isFinite(value) ? value : otherwise;
}

export function asNumberOrNull(value: unknown): number | null {
  return typeof value === "number" && Number.isFinite(value) ? value : null;
}

export function asText(value: unknown, otherwise = ""): string {
  return typeof value === "string" ? value : otherwise;
}

export function asList(value: unknown): unknown[] {
  return Array.isArray(value) ? value : [];
}

/** A list of numbers of exactly this length, or null. */
export function asVector(value: unknown, length: number): number[] | null {
  const list = asList(value);
  if (list.length !== length) return null;
  return list.every((v) => typeof v === "number" && Number.isFinite(v)) ? (list as number[]) : null;
}

/** {name: number}, without the members that are no numbers. */
export function asNumbers(value: unknown): Record<string, number> {
  const numbers: Record<string, number> = {};
  for (const [name, entry] of Object.entries(asObject(value))) {
    if (typeof entry === "number" && Number.isFinite(entry)) numbers[name] = entry;
  }
  return numbers;
}
