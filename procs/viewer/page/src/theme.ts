/** Dark and light: as the system says, until a person chooses. */

type Theme = "dark" | "light";

const kKey = "vismap theme";

export class ThemeSwitch {
  private readonly system = matchMedia("(prefers-color-scheme: dark)");

  constructor(
    private readonly button: HTMLButtonElement,
    private readonly onChange: () => void,
  ) {
    const kept = remembered();
    if (kept) document.documentElement.dataset.theme = kept;
    this.system.addEventListener("change", () => this.show());
    button.addEventListener("click", () => this.toggle());
    this.show();
  }

  toggle(): void {
    const theme = this.current === "dark" ? "light" : "dark";
    document.documentElement.dataset.theme = theme;
    try {
      localStorage.setItem(kKey, theme);
    } catch {
      // The browser keeps nothing for this page; the choice holds until it is closed.
    }
    this.show();
  }

  get current(): Theme {
    const chosen = document.documentElement.dataset.theme;
    if (chosen === "dark" || chosen === "light") return chosen;
    return this.system.matches ? "dark" : "light";
  }

  private show(): void {
    this.button.textContent = this.current === "dark" ? "Light" : "Dark";
    this.onChange();
  }
}

function remembered(): Theme | null {
  try {
    const kept = localStorage.getItem(kKey);
    return kept === "dark" || kept === "light" ? kept : null;
  } catch {
    return null;
  }
}
