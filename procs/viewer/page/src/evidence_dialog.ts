/** One of the frames in which an object was seen, large, with or without its mask. */
import { getJson } from "./api";
import { css } from "./colours";
import { count, el, setText } from "./dom";
import { frameName, pictureUrl, type EvidenceFrame } from "./evidence";
import { colourOfObject } from "./object_list";
import type { MapObject } from "./objects";

export class EvidenceDialog {
  private object: MapObject | null = null;
  private frames: EvidenceFrame[] = [];
  private at = 0;
  private readonly title = el("h2", { id: "evidence-title" });
  private readonly image = el("img", { class: "frame" });
  private readonly problem = el("p", { class: "bad", role: "status" });
  private readonly words = el("figcaption", { "aria-live": "polite" });
  private readonly mask = el("input", { type: "checkbox", checked: true });

  constructor(
    private readonly dialog: HTMLDialogElement,
    private readonly onLook: (frame: EvidenceFrame) => void,
  ) {
    const close = this.button("✕", "Close (Esc)", () => dialog.close());
    close.setAttribute("aria-label", "Close");
    const look = this.button("Look from here", "The 3-D view flies to where the camera was (l)", () => this.look());
    this.mask.addEventListener("change", () => this.showPicture());
    this.image.addEventListener("error", () => void this.explain());
    this.image.addEventListener("load", () => this.setProblem(""));
    dialog.replaceChildren(
      el("div", { class: "head" }, this.title, close),
      el("figure", {}, this.image, this.problem, this.words),
      el(
        "div",
        { class: "row" },
        this.button("‹ Previous", "Arrow left", () => this.step(-1)),
        this.button("Next ›", "Arrow right", () => this.step(1)),
        el("label", { title: "m" }, this.mask, " mask"),
        look,
      ),
    );
    dialog.addEventListener("keydown", (event) => this.onKey(event));
    dialog.addEventListener("click", (event) => {
      if (event.target === dialog) dialog.close(); // beside the dialog
    });
  }

  open(object: MapObject, frames: EvidenceFrame[], at: number): void {
    this.object = object;
    this.frames = frames;
    this.at = at;
    if (!this.dialog.open) this.dialog.showModal();
    this.show();
  }

  private button(text: string, title: string, run: () => void): HTMLButtonElement {
    const button = el("button", { type: "button", title }, text);
    button.addEventListener("click", run);
    return button;
  }

  private onKey(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => this.step(-1),
      ArrowRight: () => this.step(1),
      l: () => this.look(),
      m: () => {
        this.mask.checked = !this.mask.checked;
        this.showPicture();
      },
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  private step(by: number): void {
    this.at = (this.at + by + this.frames.length) % this.frames.length;
    this.show();
  }

  private look(): void {
    const frame = this.frames[this.at];
    this.dialog.close();
    if (frame) this.onLook(frame);
  }

  private show(): void {
    const frame = this.frames[this.at];
    if (!frame || !this.object) return;
    const swatch = el("span", { class: "swatch", "aria-hidden": "true" });
    swatch.style.background = css(colourOfObject(this.object));
    this.title.replaceChildren(swatch, `${this.object.name} ${this.object.id}, frame ${this.at + 1} of ${this.frames.length}`);
    const said = frame.said === "" ? "" : ` The detector said ${frame.said} there (white line).`;
    const hidden = frame.share > 0.995 ? "nothing hides it" : `${Math.round(100 * frame.share)} % of it is not hidden`;
    const seen = `${count(frame.pixels)} pixels, ${hidden}.`;
    setText(this.words, `${frameName(frame)}: ${seen}${said}`);
    this.showPicture();
  }

  private showPicture(): void {
    const frame = this.frames[this.at];
    if (!frame || !this.object) return;
    this.setProblem("");
    this.image.width = frame.width;
    this.image.height = frame.height;
    this.image.alt = `${this.mask.checked ? `${this.object.name} ${this.object.id} marked in the` : "The"} picture of ${frameName(frame)}`;
    this.image.src = pictureUrl(frame, { mask: this.mask.checked, colour: colourOfObject(this.object) });
  }

  private setProblem(text: string): void {
    setText(this.problem, text);
    this.problem.hidden = text === "";
  }

  /** Asks the server why there is no picture. */
  private async explain(): Promise<void> {
    const address = this.image.getAttribute("src") ?? "";
    const answer = await getJson(address);
    if (address === this.image.getAttribute("src")) this.setProblem(answer.error ?? "The picture is damaged.");
  }
}
