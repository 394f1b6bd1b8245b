/** Keeps all of a growing map in view until a person has moved the camera. */
import type { Box3 } from "three";
import type { View } from "./view";

const kGrowth = 0.05; // of the map, from which the camera moves

export class Framing {
  private radius = 0; // of what is in view [m]; 0 = nothing yet

  constructor(
    private readonly view: View,
    private readonly bounds: Box3,
  ) {}

  /** The map may have grown. In a log, where a person goes from moment to moment, the camera jumps, and going back moves nothing. */
  keep(isLog: boolean): void {
    if (this.view.touched || this.bounds.isEmpty()) return;
    const radius = this.bounds.min.distanceTo(this.bounds.max) / 2;
    if (Math.abs(radius - this.radius) < kGrowth * this.radius || (isLog && radius < this.radius)) return;
    const first = this.radius === 0;
    this.radius = radius;
    this.view.showAll(this.bounds, first || isLog);
  }

  /** Another direction is upward: a view from above the map is another one now. */
  turn(): void {
    this.radius = 0;
    this.keep(false);
  }
}
