/** The box of the selected object in the scene, with its sides in metres. */
import * as THREE from "three";
import { el } from "./dom";
import type { Box } from "./objects";

const kColour = 0xe69f00;

// Corners of the unit box, and the middle of one edge along each axis.
const kEdges = new THREE.EdgesGeometry(new THREE.BoxGeometry(1, 1, 1));
const kMiddles = [
  [0, -0.5, -0.5],
  [0.5, 0, -0.5],
  [0.5, -0.5, 0],
] as const;

export class SelectionBox {
  readonly lines = new THREE.LineSegments(kEdges, new THREE.LineBasicMaterial({ color: kColour, depthTest: false, transparent: true }));
  private readonly labels: HTMLElement[];
  private box: Box | null = null;

  constructor(parent: HTMLElement) {
    this.labels = kMiddles.map(() => el("span", { class: "size-label", "aria-hidden": "true", hidden: true }));
    parent.append(...this.labels);
    this.lines.visible = false;
    this.lines.renderOrder = 10;
  }

  show(box: Box | null): void {
    this.box = box;
    this.lines.visible = box !== null;
    if (!box) {
      for (const label of this.labels) label.hidden = true;
      return;
    }
    this.lines.position.fromArray(box.centre);
    this.lines.quaternion.fromArray(box.orientation as [number, number, number, number]);
    this.lines.scale.fromArray(box.size.map((side) => Math.max(side, 1e-3)) as [number, number, number]);
    this.lines.updateMatrixWorld();
    this.labels.forEach((label, axis) => (label.textContent = `${box.size[axis]!.toFixed(2)} m`));
  }

  /** Puts the labels where the box is on the screen; to be called after each drawing. */
  place(camera: THREE.Camera, width: number, height: number): void {
    if (!this.box) return;
    this.labels.forEach((label, axis) => {
      const p = new THREE.Vector3(...kMiddles[axis]!).applyMatrix4(this.lines.matrixWorld).project(camera);
      label.hidden = p.z > 1 || Math.abs(p.x) > 1 || Math.abs(p.y) > 1;
      const [x, y] = [((p.x + 1) / 2) * width, ((1 - p.y) / 2) * height];
      label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
    });
  }
}

/** The axis-parallel bounds of a box. */
export function boundsOfBox(box: Box): THREE.Box3 {
  const half = new THREE.Vector3(...(box.size as [number, number, number])).multiplyScalar(0.5);
  const place = new THREE.Matrix4().compose(
    new THREE.Vector3(...(box.centre as [number, number, number])),
    new THREE.Quaternion(...(box.orientation as [number, number, number, number])),
    new THREE.Vector3(1, 1, 1),
  );
  return new THREE.Box3(half.clone().negate(), half).applyMatrix4(place);
}
