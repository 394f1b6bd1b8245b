/** What keys and buttons do. */
import { byId } from "./dom";
import type { FreeSpacePanel } from "./free_space_panel";
import type { Command } from "./help";
import { kColourings, type Colouring } from "./painting";
import type { Selection } from "./selection";
import type { Surface } from "./surface";
import type { Tabs } from "./tabs";
import type { ThemeSwitch } from "./theme";
import type { TimeControls } from "./time_controls";
import type { View } from "./view";

export interface Toggles {
  panel(): void;
  bothSides(): void;
}

/** The buttons that hide the lists and draw back faces. */
export function makeToggles(onBothSides: (both: boolean) => void): Toggles {
  const panelButton = byId("panel-button", HTMLButtonElement);
  const sidesButton = byId("both-sides", HTMLButtonElement);
  const panel = (): void => {
    const hide = document.body.dataset.panel !== "hidden";
    document.body.dataset.panel = hide ? "hidden" : "shown";
    panelButton.setAttribute("aria-expanded", String(!hide));
  };
  const bothSides = (): void => {
    const both = sidesButton.getAttribute("aria-pressed") !== "true";
    sidesButton.setAttribute("aria-pressed", String(both));
    onBothSides(both);
  };
  panelButton.addEventListener("click", panel);
  sidesButton.addEventListener("click", bothSides);
  return { panel, bothSides };
}

interface Parts {
  view: View;
  surface: Surface;
  selection: Selection;
  tabs: Tabs;
  space: FreeSpacePanel;
  theme: ThemeSwitch;
  toggles: Toggles;
  filter: HTMLInputElement;
  help: HTMLDialogElement;
  colouring: HTMLSelectElement;
  setColouring(chosen: Colouring): void;
  time: TimeControls;
}

export function makeCommands(parts: Parts): Command[] {
  const { view, surface, selection, tabs, space, theme, toggles, filter, help, colouring, setColouring, time } = parts;
  const colourings = kColourings.map((name, i): Command => {
    const text = `colour by ${colouring.options[i]!.text}`;
    return { keys: [String(i + 1)], text, run: () => setColouring(name) };
  });
  const leave = (): void => {
    if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
    selection.select(null, false);
  };
  const search = (): void => {
    tabs.open("objects");
    filter.focus();
  };
  return [
    ...colourings,
    { keys: ["r"], text: "show the whole map", run: () => view.showAll(surface.bounds) },
    { keys: ["+", "="], text: "nearer", run: () => view.zoom(0.8) },
    { keys: ["-"], text: "farther", run: () => view.zoom(1.25) },
    { keys: ["n"], text: "next object of the list", run: () => selection.step(1) },
    { keys: ["N"], text: "previous object of the list", run: () => selection.step(-1) },
    { keys: ["f", "/"], text: "filter the list of objects", run: search },
    { keys: ["Escape"], text: "select nothing, leave a field", run: leave },
    { keys: ["h"], text: "horizontal slice of free space", run: () => space.toggleHorizontal() },
    { keys: ["v"], text: "vertical slice of free space", run: () => space.toggleVertical() },
    { keys: ["b"], text: "back faces on or off", run: () => toggles.bothSides() },
    { keys: [" "], text: "pause and go on; a log: play and pause", run: () => time.toggle() },
    ...time.commands,
    { keys: ["p"], text: "hide or show the lists", run: () => toggles.panel() },
    { keys: ["t"], text: "dark or light", run: () => theme.toggle() },
    { keys: ["?"], text: "this help", run: () => (help.open ? help.close() : help.showModal()) },
  ];
}
