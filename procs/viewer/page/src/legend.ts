/** The legend of the chosen colouring. */
import { colourOfId, css, kStructure, kUnknown, paleColourOfId, ramp, type Rgb } from "./colours";
import { el } from "./dom";
import type { MapObject } from "./objects";
import type { Colouring } from "./painting";

function entry(colour: Rgb, text: string): HTMLElement {
  const swatch = el("span", { class: "swatch", "aria-hidden": "true" });
  swatch.style.background = css(colour);
  return el("li", {}, swatch, text);
}

function bar(low: string, high: string): HTMLElement {
  const strip = el("div", { class: "bar", "aria-hidden": "true" });
  const colours = [0, 0.2, 0.4, 0.6, 0.8, 1].map((share) => css(ramp(share)));
  strip.style.background = `linear-gradient(to right, ${colours.join(", ")})`;
  return el("div", {}, strip, el("div", { class: "ends" }, el("span", {}, low), el("span", {}, high)));
}

function classes(objects: MapObject[]): HTMLElement[] {
  const names = new Map<number, string>();
  for (const object of objects) if (object.classId > 0 && object.group === "named") names.set(object.classId, object.name);
  const sorted = [...names].sort((a, b) => a[1].localeCompare(b[1]));
  return [...sorted.map(([id, name]) => entry(colourOfId(id), name)), entry(kUnknown, "no class")];
}

export function showLegend(parent: HTMLElement, colouring: Colouring, objects: MapObject[], heights: [number, number]): void {
  switch (colouring) {
    case "instance":
      parent.replaceChildren(
        el(
          "ul",
          {},
          entry(colourOfId(1), "object, each its own"),
          entry(paleColourOfId(1), "discovered thing"),
          entry(kStructure, "structure"),
          entry(kUnknown, "other surface"),
        ),
      );
      break;
    case "class":
      parent.replaceChildren(el("ul", {}, ...classes(objects)));
      break;
    case "rgb":
      parent.replaceChildren();
      break;
    case "height":
      parent.replaceChildren(bar(`${heights[0].toFixed(2)} m`, `${heights[1].toFixed(2)} m`));
      break;
    case "seen":
      parent.replaceChildren(bar("seen once", "255 times or more"), el("ul", {}, entry(kUnknown, "not known")));
      break;
  }
}
