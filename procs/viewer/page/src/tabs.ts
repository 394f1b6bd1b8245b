/** Tabs as screen readers know them: arrow keys go from one to the next. */
export class Tabs {
  private readonly tabs: HTMLButtonElement[];

  constructor(
    list: HTMLElement,
    private readonly onShow: (panel: string) => void,
  ) {
    this.tabs = [...list.querySelectorAll<HTMLButtonElement>('[role="tab"]')];
    this.tabs.forEach((tab, i) => {
      tab.addEventListener("click", () => this.show(i));
      tab.addEventListener("keydown", (event) => this.step(event, i));
    });
  }

  /** The id of the panel that is shown. */
  get shown(): string {
    const tab = this.tabs.find((candidate) => candidate.getAttribute("aria-selected") === "true");
    return tab?.getAttribute("aria-controls") ?? "";
  }

  open(panel: string): void {
    const i = this.tabs.findIndex((tab) => tab.getAttribute("aria-controls") === panel);
    if (i >= 0) this.show(i);
  }

  private step(event: KeyboardEvent, i: number): void {
    const n = this.tabs.length;
    const next = { ArrowRight: (i + 1) % n, ArrowLeft: (i + n - 1) % n, Home: 0, End: n - 1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    this.show(next);
    this.tabs[next]!.focus();
  }

  private show(chosen: number): void {
    this.tabs.forEach((tab, i) => {
      tab.setAttribute("aria-selected", String(i === chosen));
      tab.tabIndex = i === chosen ? 0 : -1;
      const panel = document.getElementById(tab.getAttribute("aria-controls") ?? "");
      if (panel) panel.hidden = i !== chosen;
    });
    this.onShow(this.shown);
  }
}
