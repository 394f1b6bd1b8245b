/** A flight of the view from where it is to another place. */
import * as THREE from "three";

const kDuration = 350; // [ms]

export interface Sight {
  position: THREE.Vector3;
  target: THREE.Vector3;
}

export class Flight {
  private readonly start: number;
  private readonly from: Sight;

  /** `moving` is changed by advance. `jump`: arrives at the first step. */
  constructor(
    private readonly moving: Sight,
    private readonly to: Sight,
    jump: boolean,
  ) {
    this.start = performance.now() - (jump ? kDuration : 0);
    this.from = { position: moving.position.clone(), target: moving.target.clone() };
  }

  /** Moves to where the view is at this time [ms]; false when it has arrived. */
  advance(now: number): boolean {
    const share = Math.min(1, Math.max(0, (now - this.start) / kDuration));
    const smooth = share * share * (3 - 2 * share);
    this.moving.position.lerpVectors(this.from.position, this.to.position, smooth);
    this.moving.target.lerpVectors(this.from.target, this.to.target, smooth);
    return share < 1;
  }
}
