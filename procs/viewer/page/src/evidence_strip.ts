/** The frames in which the selected object was seen, as small pictures. */
import { atMoment, getJson } from "./api";
import { el } from "./dom";
import { frameName, pictureUrl, readEvidence, type EvidenceFrame, type EvidenceList } from "./evidence";
import { colourOfObject } from "./object_list";
import type { MapObject } from "./objects";

const kThumbnailWidth = 240; // [px]
const kAskAgain = 10000; // [ms] while the object is still seen
const kStill = 500; // [ms] that a log must stand still at another moment

export class EvidenceStrip {
  readonly element = el("div", { class: "evidence" });
  private shownId: string | null = null;
  private askedAt = 0;
  private askedUtime = 0;
  private shown = ""; // of the frames that are shown
  private asked = ""; // with the moment of a log
  private timer: ReturnType<typeof setTimeout> | null = null;

  constructor(private readonly onOpen: (object: MapObject, frames: EvidenceFrame[], at: number) => void) {}

  /** Shows the frames of an object, and asks again from time to time while it is seen. `anew`: another one is selected. */
  show(object: MapObject, anew: boolean): void {
    if (object.group === "removed") {
      this.shownId = object.id;
      return this.element.replaceChildren();
    }
    const newer = object.lastUtime !== this.askedUtime && Date.now() - this.askedAt > kAskAgain;
    if (!anew && this.asked !== atMoment(questionOf(object))) this.askSoon(object);
    if (!anew && !newer) return;
    this.shownId = object.id;
    this.askedAt = Date.now();
    this.askedUtime = object.lastUtime;
    if (anew) this.say("Frames that it was seen in: asking …");
    void this.ask(object);
  }

  private say(text: string): void {
    this.shown = "";
    this.element.replaceChildren(el("p", { class: "faint" }, text));
  }

  /** A log shows another moment, and perhaps soon the next one. */
  private askSoon(object: MapObject): void {
    if (this.timer) clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      this.timer = null;
      if (this.shownId === object.id) void this.ask(object);
    }, kStill);
  }

  private async ask(object: MapObject): Promise<void> {
    const question = questionOf(object);
    this.asked = atMoment(question);
    const answer = await getJson(question);
    if (this.shownId !== object.id || this.asked !== atMoment(question)) return;
    if (answer.error !== null) {
      if (this.shown === "") this.say(`Frames that it was seen in: not available: ${answer.error}`);
      return;
    }
    this.fill(object, readEvidence(answer.value));
  }

  private fill(object: MapObject, list: EvidenceList): void {
    if (list.frames.length === 0) return this.say(`Frames that it was seen in: none. ${list.why}`);
    const names = list.frames.map((frame) => frame.url).join();
    if (names === this.shown) return;
    this.shown = names;
    const items = list.frames.map((frame, at) => el("li", {}, this.thumbnail(object, list.frames, frame, at)));
    this.element.replaceChildren(el("h3", {}, "Frames that it was seen in"), el("ul", { class: "thumbnails" }, ...items));
  }

  private thumbnail(object: MapObject, frames: EvidenceFrame[], frame: EvidenceFrame, at: number): HTMLElement {
    const text = `${object.name} ${object.id} in the frame of ${frameName(frame)}`;
    const src = pictureUrl(frame, { mask: true, colour: colourOfObject(object), width: kThumbnailWidth });
    const image = el("img", { src, alt: text, loading: "lazy", width: frame.width, height: frame.height });
    const button = el("button", { type: "button", title: `Show it large: ${frameName(frame)}` }, image);
    image.addEventListener("error", () => button.replaceChildren(`${frameName(frame)}: no longer kept`), { once: true });
    button.addEventListener("click", () => this.onOpen(object, frames, at));
    return button;
  }
}

function questionOf(object: MapObject): string {
  return `api/evidence?id=${encodeURIComponent(object.id)}`;
}
