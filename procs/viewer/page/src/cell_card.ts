/** Why a cell is as it is: what /api/cell says of it, in words. */
import { getJson } from "./api";
import { el } from "./dom";
import { asList, asNumber, asObject, asText, type Json } from "./json";

// Names of what the server tells, with units. Other keys are shown as they are.
const kNames: Record<string, string> = {
  state: "State",
  at: "Place [m]",
  center: "Centre of the voxel [m]",
  distance_m: "Signed distance to the surface [m]",
  weight: "Weight",
  observations: "Observations",
  block: "Block",
  thin_hits: "Hits of something thin",
  color: "Colour",
  shown: "Shown as",
  last_frame: "Last frame that changed it",
  last_utime: "Time of that frame",
  voxel: "Voxel",
  revision: "Revision of the map",
};
const kHidden = new Set(["labels", "map_id", "kind", "why"]);

function valueText(key: string, value: unknown): string {
  if (value === null || value === undefined) return "not known";
  if (key.endsWith("utime") && typeof value === "number") return value > 0 ? `${(value / 1e6).toFixed(2)} s` : "not known";
  if (typeof value === "number") return Number.isInteger(value) ? String(value) : value.toFixed(3);
  if (typeof value === "string") return value;
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (Array.isArray(value)) return value.map((entry) => valueText("", entry)).join(", ");
  return Object.entries(value as Json).map(([name, entry]) => `${name}: ${valueText(name, entry)}`).join(", ");
}

function facts(cell: Json): HTMLElement {
  const known = Object.keys(kNames).filter((key) => key in cell);
  const others = Object.keys(cell).filter((key) => !(key in kNames) && !kHidden.has(key));
  const rows = [...known, ...others].flatMap((key) => [
    el("dt", {}, kNames[key] ?? key.replace(/_m$/, " [m]").replaceAll("_", " ")),
    el("dd", { "data-key": key }, valueText(key, cell[key])),
  ]);
  return el("dl", {}, ...rows);
}

function votes(cell: Json): HTMLElement {
  const labels = asList(cell.labels).map(asObject);
  if (labels.length === 0) return el("p", { class: "faint" }, "No label has votes here.");
  const rows = labels.map((label) => {
    const instance = asNumber(label.instance);
    const what = instance > 0 ? `${asText(label.class_name, "object")} ${instance}` : "no object";
    return el("tr", {}, el("th", { scope: "row" }, `label ${asNumber(label.label)}`), el("td", {}, String(asNumber(label.votes))), el("td", {}, what));
  });
  const head = el("thead", {}, el("tr", {}, ...["Label", "Votes", "Object"].map((name) => el("th", { scope: "col" }, name))));
  return el("table", { "aria-label": "Votes of labels" }, head, el("tbody", {}, ...rows));
}

export class CellCard {
  readonly element = el("div", { class: "card", id: "cell", role: "status", hidden: true });
  private asked = 0;

  /** Hides the card, and ignores an answer that is on its way. */
  hide(): void {
    ++this.asked;
    this.element.hidden = true;
  }

  /** Asks for the cell at a point of W [m] and shows the answer. */
  async ask(point: [number, number, number]): Promise<void> {
    const number = ++this.asked;
    const place = point.map((value) => value.toFixed(4)).join(",");
    this.element.hidden = false;
    this.element.replaceChildren(el("p", { class: "faint" }, `Asking for the cell at ${place} …`));
    const answer = await getJson(`api/cell?at=${place}`);
    if (number !== this.asked) return;
    const close = el("button", { type: "button", "aria-label": "Close" }, "✕");
    close.addEventListener("click", () => (this.element.hidden = true));
    const head = el("div", { class: "head" }, el("h2", {}, "Why is this cell so?"), close);
    const cell = asObject(answer.value);
    const why = el("p", { "data-key": "why" }, asText(cell.why));
    const body = answer.error !== null ? [el("p", { class: "bad" }, answer.error)] : [why, facts(cell), votes(cell)];
    this.element.replaceChildren(head, ...body);
  }
}
