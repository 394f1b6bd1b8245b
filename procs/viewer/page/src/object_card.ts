/** What is known of the selected object, with its PLY and the frames that it was seen in. */
import { atMoment } from "./api";
import { css } from "./colours";
import { count, el } from "./dom";
import type { EvidenceStrip } from "./evidence_strip";
import { colourOfObject } from "./object_list";
import { ageText, sizeText, type MapObject } from "./objects";

function lastSeen(utime: number, now: number): string {
  const age = ageText(utime, now);
  return age === "now" ? "in the newest frame" : `${age} before the newest frame`;
}

export class ObjectCard {
  private shownId: string | null = null;

  constructor(
    private readonly parent: HTMLElement,
    private readonly evidence: EvidenceStrip,
    private readonly className: (id: number) => string,
    private readonly onClose: () => void,
    private readonly onFly: () => void,
  ) {}

  show(object: MapObject | null, now: number): void {
    this.parent.hidden = object === null;
    if (!object) {
      this.shownId = null;
      this.parent.replaceChildren();
      return;
    }
    const other = object.id !== this.shownId;
    this.shownId = object.id;
    if (other) {
      this.parent.replaceChildren(this.head(object), el("div"), this.links(object), this.evidence.element);
    }
    this.evidence.show(object, other);
    this.parent.children[1]!.replaceChildren(this.facts(object, now));
  }

  private head(object: MapObject): HTMLElement {
    const swatch = el("span", { class: "swatch", "aria-hidden": "true" });
    swatch.style.background = css(colourOfObject(object));
    const close = el("button", { type: "button", "aria-label": "Close: nothing selected", title: "Close (Esc)" }, "✕");
    close.addEventListener("click", this.onClose);
    return el("div", { class: "head" }, el("h2", {}, swatch, `${object.name} ${object.id}`), close);
  }

  private facts(object: MapObject, now: number): HTMLElement {
    const others = Object.entries(object.probabilities).sort((a, b) => b[1] - a[1]);
    const classes = others.slice(0, 3).map(([id, share]) => `${this.className(Number(id))} ${Math.round(100 * share)} %`);
    const facts: [string, string][] = [
      ["Class", classes.join(", ") || (object.group === "structure" ? `structure: ${object.name}` : "not known")],
      ["Probability", object.instance > 0 ? `${Math.round(100 * object.score)} %` : ""],
      ["Size", object.box ? `${sizeText(object.box)} m` : ""],
      ["Centre", object.box ? `${object.box.centre.map((c) => c.toFixed(2)).join(", ")} m` : ""],
      ["Surface", object.area > 0 ? `${object.area.toFixed(2)} m², ${count(object.points)} points` : ""],
      ["Seen", `in ${count(object.frames)} ${object.frames === 1 ? "frame" : "frames"}, last ${lastSeen(object.lastUtime, now)}`],
      ["Segments", object.segments.slice(0, 12).join(", ") + (object.segments.length > 12 ? ", …" : "")],
    ];
    const shown = facts.filter(([, text]) => text !== "");
    return el("dl", {}, ...shown.flatMap(([name, text]) => [el("dt", {}, name), el("dd", {}, text)]));
  }

  private links(object: MapObject): HTMLElement {
    if (object.group === "removed") return el("p", { class: "faint" }, "It is no longer in the map.");
    const fly = el("button", { type: "button" }, "Fly there");
    fly.addEventListener("click", this.onFly);
    const file = `${object.name.replace(/\W+/g, "_")}_${object.id}.ply`;
    const path = `api/object/${encodeURIComponent(object.id)}.ply`;
    const ply = el("a", { href: path, download: file }, "Download as PLY");
    ply.addEventListener("click", () => (ply.href = atMoment(path))); // a log may show another moment by now
    return el("div", { class: "row" }, fly, ply);
  }
}
