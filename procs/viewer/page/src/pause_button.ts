/** Freezes the view of a live map: what comes waits, and the button says how much of it there is. */
import { count, setText } from "./dom";

export class PauseButton {
  private paused = false;

  constructor(
    private readonly button: HTMLButtonElement,
    private readonly behind: HTMLElement,
    private readonly onPause: (paused: boolean) => void,
  ) {
    button.addEventListener("click", () => this.toggle());
  }

  toggle(): void {
    this.paused = !this.paused;
    this.button.setAttribute("aria-pressed", String(this.paused));
    this.button.textContent = this.paused ? "Continue" : "Pause";
    this.onPause(this.paused);
    this.behind.hidden = !this.paused;
    this.takeBehind(0);
  }

  /** So many updates of the map wait. */
  takeBehind(updates: number): void {
    setText(this.behind, updates === 0 ? "paused" : `paused, ${count(updates)} ${updates === 1 ? "update" : "updates"} behind`);
  }

  /** There is no live map. */
  hide(): void {
    this.button.hidden = true;
  }
}
