/** The bar below the view of a log: a slider over its moments, play and pause, steps, and when objects come and go. */
import { el, setText } from "./dom";
import type { Command } from "./help";
import { MomentWatch } from "./moment_watch";
import { clockText, markText, Timeline, type TimelineMessage } from "./timeline_data";

const kSpeeds = [0.5, 1, 2, 4, 8];
const kTick = 50; // [ms] while it plays
const kPatience = 400; // [ms] that playing waits until a moment is drawn
const kManySteps = 10;

export class TimelineBar {
  readonly watch = new MomentWatch();
  private timeline: Timeline | null = null;
  private wanted: number | null = null; // frames; null = the newest moment, also while the log is being mapped
  private shown = 0; // frames of the map that the server has told of last
  private timer: ReturnType<typeof setInterval> | null = null;
  private clock = 0; // of playing, in the log's time [us]
  private tickedAt = 0;

  private readonly play = this.button("Play", "Play or pause (Space)", () => this.toggle());
  private readonly slider = el("input", { type: "range", min: 1, max: 1, value: 1, step: 1, "aria-label": "Moment of the log" });
  private readonly marks = el("div", { class: "marks", "aria-hidden": "true" });
  private readonly fill = el("div", { class: "mapped", "aria-hidden": "true" });
  private readonly time = el("output");
  private readonly state = el("span", { class: "faint" });
  private readonly event = el("span", { role: "status" });
  private readonly speed = el("select", { "aria-label": "Speed" });

  constructor(
    private readonly parent: HTMLElement,
    private readonly onWant: (frames: number | null) => void,
  ) {
    this.speed.append(...kSpeeds.map((speed) => el("option", { value: speed, selected: speed === 1 }, `${speed}×`)));
    this.slider.addEventListener("input", () => this.drag());
    this.slider.addEventListener("keydown", (event) => this.key(event));
    const buttons = el(
      "div",
      { class: "buttons" },
      this.button("|◀", "To the first moment", () => this.goTo(this.timeline?.first ?? 1)),
      this.button("◀", "One moment back (,)", () => this.step(-1)),
      this.play,
      this.button("▶", "One moment forward (.)", () => this.step(1)),
      this.button("▶|", "To the newest moment", () => this.goToEnd()),
      this.speed,
    );
    const track = el("div", { class: "track" }, this.fill, this.marks, this.slider);
    parent.append(buttons, track, el("div", { class: "words-of-time" }, this.time, this.event, this.state));
  }

  /** The page shows a log. */
  show(): void {
    this.parent.hidden = false;
  }

  take(message: TimelineMessage): void {
    this.timeline = new Timeline(message);
    this.slider.min = String(this.timeline.first);
    this.slider.max = String(Math.max(this.timeline.first, this.timeline.end));
    const kept = this.wanted === null ? null : this.timeline.at(this.wanted);
    if (kept !== this.wanted && kept !== null) this.want(kept); // the moment was forgotten
    this.paintMarks();
    this.paint();
  }

  /** The server tells of the map after so many frames. */
  takeMap(frames: number): void {
    this.shown = frames;
    this.paint();
  }

  commands(): Command[] {
    const event = (forward: boolean) => () => {
      const mark = this.timeline?.markFrom(this.current, forward);
      if (mark) this.goTo(mark.frames);
    };
    return [
      { keys: [","], text: "log: one moment back", run: () => this.step(-1) },
      { keys: ["."], text: "log: one moment forward", run: () => this.step(1) },
      { keys: ["<", ";"], text: `log: ${kManySteps} moments back; on the slider: Shift and arrow keys`, run: () => this.step(-kManySteps) },
      { keys: [">", ":"], text: `log: ${kManySteps} moments forward`, run: () => this.step(kManySteps) },
      { keys: ["["], text: "log: where the object before came or went", run: event(false) },
      { keys: ["]"], text: "log: where the next object comes or goes", run: event(true) },
      { keys: ["Home"], text: "log: first moment", run: () => this.goTo(this.timeline?.first ?? 1) },
      { keys: ["End"], text: "log: newest moment", run: () => this.goToEnd() },
    ];
  }

  get isPlaying(): boolean {
    return this.timer !== null;
  }

  toggle(): void {
    if (this.isPlaying) this.pause();
    else this.start();
  }

  /** Wants the moment of at most so many frames. */
  goTo(frames: number): void {
    this.pause();
    this.want(frames);
  }

  private goToEnd(): void {
    this.pause();
    this.wanted = null;
    if (this.timeline && this.timeline.last !== this.shown) this.watch.ask(this.timeline.last, performance.now());
    this.onWant(null);
    this.paint();
  }

  private step(steps: number): void {
    if (this.timeline) this.goTo(this.timeline.step(this.current, steps));
  }

  private get current(): number {
    return this.wanted ?? this.shown;
  }

  private want(frames: number): void {
    if (!this.timeline || this.timeline.length === 0) return;
    const moment = this.timeline.at(frames);
    this.wanted = moment;
    if (moment !== this.shown || !this.watch.isDone) this.watch.ask(moment, performance.now());
    this.onWant(moment);
    this.paint();
  }

  private drag(): void {
    this.pause();
    const frames = Number(this.slider.value);
    if (this.timeline && this.timeline.at(frames) !== this.wanted) this.want(frames);
  }

  /** Keys of the slider go by moments, not by frames. */
  private key(event: KeyboardEvent): void {
    const many = event.shiftKey || event.key.startsWith("Page") ? kManySteps : 1;
    const back = ["ArrowLeft", "ArrowDown", "PageDown"].includes(event.key);
    const forward = ["ArrowRight", "ArrowUp", "PageUp"].includes(event.key);
    if (!back && !forward) return;
    event.preventDefault();
    this.step(back ? -many : many);
  }

  private start(): void {
    if (!this.timeline || this.timeline.length === 0) return;
    if (this.current >= this.timeline.last) this.want(this.timeline.first);
    this.clock = this.timeline.utimeOf(this.current);
    this.tickedAt = performance.now();
    this.timer = setInterval(() => this.tick(), kTick);
    this.paint();
  }

  private pause(): void {
    if (this.timer === null) return;
    clearInterval(this.timer);
    this.timer = null;
    this.paint();
  }

  /** Goes on to the moment that is due, once the one before is drawn. */
  private tick(): void {
    const now = performance.now();
    this.clock += 1000 * (now - this.tickedAt) * Number(this.speed.value);
    this.tickedAt = now;
    const timeline = this.timeline!;
    const due = timeline.atTime(this.clock);
    if (due !== this.wanted && (this.watch.isDone || this.watch.waiting(now) > kPatience)) this.want(due);
    if (due >= timeline.last && this.wanted === due) this.pause();
  }

  private paint(): void {
    const timeline = this.timeline;
    if (!timeline || timeline.length === 0) {
      setText(this.state, timeline?.message.done ? "no frame could be mapped" : "the first frame is being mapped");
      return;
    }
    const frames = this.current;
    if (document.activeElement !== this.slider || Number(this.slider.value) !== frames) this.slider.value = String(frames);
    const text = `${clockText(timeline.secondsOf(frames))} of ${clockText(timeline.secondsOf(timeline.last))}, frame ${frames} of ${timeline.last}`;
    setText(this.time, text);
    this.slider.setAttribute("aria-valuetext", text);
    setText(this.play, this.isPlaying ? "Pause" : "Play");
    setText(this.event, timeline.marksAt(frames).slice(0, 3).map(markText).join(", "));
    setText(this.state, this.stateText(timeline));
    const { total, read, done } = timeline.message;
    this.fill.style.width = `${done || total === 0 ? 100 : (100 * timeline.last) / Math.max(total, 1)}%`;
    this.fill.dataset.read = String(read);
  }

  private stateText(timeline: Timeline): string {
    const { done, read, total, stride, message } = timeline.message;
    const parts = [
      done ? "" : `being mapped: frame ${read} of ${total}`,
      stride > 1 ? `every ${stride}th frame is kept` : "",
      message,
    ];
    return parts.filter((part) => part !== "").join("; ");
  }

  private paintMarks(): void {
    const { timeline } = this;
    if (!timeline) return;
    const span = Math.max(1, timeline.end - timeline.first);
    const lines = timeline.message.marks.map((mark) => {
      const line = el("i", { title: markText(mark), class: mark.appeared ? "" : "gone" });
      line.style.left = `${(100 * (mark.frames - timeline.first)) / span}%`;
      return line;
    });
    this.marks.replaceChildren(...lines);
  }

  private button(text: string, title: string, run: () => void): HTMLButtonElement {
    const words = /[a-z]/i.test(text);
    const button = el("button", { type: "button", title, "aria-label": words ? null : title }, text);
    button.addEventListener("click", run);
    return button;
  }
}
