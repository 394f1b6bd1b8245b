/** The dialog that explains keys and the mouse, and the keys themselves. */
import { el } from "./dom";

export interface Command {
  keys: string[]; // as KeyboardEvent.key has them
  text: string;
  run(): void;
}

const kPointer: [string, string][] = [
  ["drag, one finger", "turn the view"],
  ["right drag, two fingers", "move the view"],
  ["wheel, pinch", "nearer and farther"],
  ["click, tap", "select an object; on a slice of free space: ask why a cell is as it is"],
  ["arrow keys on the view", "move it; with Shift: turn it"],
];

export function fillHelp(dialog: HTMLDialogElement, commands: Command[]): void {
  const close = el("button", { type: "button" }, "Close");
  close.addEventListener("click", () => dialog.close());
  const keys = commands.map((command) =>
    el("tr", {}, el("th", { scope: "row" }, ...command.keys.flatMap((key) => [el("kbd", {}, key === " " ? "Space" : key), " "])), el("td", {}, command.text)),
  );
  const pointer = kPointer.map(([what, text]) => el("tr", {}, el("th", { scope: "row" }, what), el("td", {}, text)));
  dialog.replaceChildren(
    el("div", { class: "head" }, el("h2", { id: "help-title" }, "Keys and pointer")),
    el("table", { class: "words" }, el("tbody", {}, ...keys, ...pointer)),
    el("div", { class: "row" }, close, el("a", { href: "LICENSES.txt" }, "Licences of what this page is made of")),
  );
}

/** Runs commands at their keys, except while a person types into a field or holds a modifier. */
export function listenForKeys(commands: Command[]): void {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (document.querySelector("dialog[open]") && event.key !== "?") return; // the browser closes it at Escape
    const typing = event.target instanceof HTMLInputElement && event.target.type !== "range" && event.target.type !== "checkbox";
    if ((typing || event.target instanceof HTMLSelectElement) && event.key !== "Escape") return;
    // Space on a button presses it.
    if (event.key === " " && event.target instanceof Element && event.target.closest("button, summary, a, input, [role=tab]")) return;
    // Home and End have their own meaning in lists and on other sliders.
    if (/^(Home|End)$/.test(event.key) && event.target instanceof Element && !event.target.matches("body, canvas, #timeline *")) return;
    const command = commands.find((candidate) => candidate.keys.includes(event.key));
    if (!command) return;
    event.preventDefault();
    command.run();
  });
}
