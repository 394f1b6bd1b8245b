/** What a person must know at once: connection lost, map reset, notices of the server. Banners go away by themselves. */
import { el, setText } from "./dom";

export type Level = "info" | "warning" | "error";

const kShown = 8000; // [ms]

export class Banners {
  private readonly shown = new Map<string, { element: HTMLElement; timer: ReturnType<typeof setTimeout> | null }>();
  private nextId = 0;

  constructor(private readonly parent: HTMLElement) {}

  /** Shows a banner until it is cleared; one with the same id is replaced. An empty text clears it. */
  hold(id: string, level: Level, text: string): void {
    if (text === "") {
      this.clear(id);
      return;
    }
    const existing = this.shown.get(id)?.element;
    const element = existing ?? el("p", { class: "banner" });
    element.dataset.level = level;
    setText(element, sentence(text));
    if (!existing) {
      this.parent.append(element);
      this.shown.set(id, { element, timer: null });
    }
  }

  /** Shows a banner for some seconds. */
  flash(level: Level, text: string): void {
    const id = `flash ${this.nextId++}`;
    this.hold(id, level, text);
    const entry = this.shown.get(id);
    if (entry) entry.timer = setTimeout(() => this.clear(id), kShown);
  }

  clear(id: string): void {
    const entry = this.shown.get(id);
    if (!entry) return;
    if (entry.timer) clearTimeout(entry.timer);
    entry.element.remove();
    this.shown.delete(id);
  }
}

/** Messages of processes begin small and have no full stop, as their logs do. */
function sentence(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1) + (/[.…!?]$/.test(text) ? "" : ".");
}
