/** The panel of free space: a horizontal and a vertical slice with sliders, and why a cell is as it is. */
import type * as THREE from "three";
import { CellCard } from "./cell_card";
import { css, kFree, kNotSeen, kOccupied, type Rgb } from "./colours";
import { el } from "./dom";
import { kAxes, type Axis } from "./slice_data";
import { SliceFeed, type LeafLayer } from "./slice_feed";
import { SlicePlane } from "./slice_plane";

const kStep = 0.05; // [m]

const kMapContours = "Contours: distances to the nearest obstacle in all directions, as planners get them.";
const kSliceContours = "Contours: distances to what is occupied in this slice alone, since no octomap exporter tells those of the map.";

interface SliceOptions {
  contours: boolean;
  leaves: LeafLayer | null;
  voxel: number;
}

/** One slice: its switch, its slider, and its plane in the scene. */
class SliceControl {
  readonly plane = new SlicePlane();
  readonly element: HTMLElement;
  private readonly on = el("input", { type: "checkbox" });
  private readonly slider = el("input", { type: "range", step: kStep, min: 0, max: 1, value: 0 });
  private readonly value = el("output");
  private readonly problem = el("p", { class: "bad" });
  private readonly leafProblem = el("p", { class: "bad" });
  private readonly note = el("p", { class: "faint" });
  private readonly feed: SliceFeed;
  private moved = false;

  constructor(
    readonly title: string,
    private axis: Axis,
    extra: HTMLElement[],
    private readonly options: () => SliceOptions,
    private readonly onChange: () => void,
  ) {
    this.feed = new SliceFeed(
      (slice, wish, leaves) => {
        this.problem.textContent = slice.cells.length > 0 ? "" : "Nothing is known of space in this slice yet.";
        this.note.textContent = wish.contours ? (slice.distances ? kMapContours : kSliceContours) : "";
        this.plane.show(slice, wish.contours);
        this.plane.showLeaves(leaves);
        onChange();
      },
      (text) => (this.problem.textContent = text),
      (problem) => (this.leafProblem.textContent = problem === "" ? "" : `Leaves of the octree: ${problem}`),
    );
    this.slider.setAttribute("aria-label", `Place of the ${title.toLowerCase()}`);
    this.on.addEventListener("change", () => this.refresh());
    this.slider.addEventListener("input", () => {
      this.moved = true;
      this.on.checked = true;
      this.refresh();
    });
    const label = el("label", {}, this.on, ` ${title}`);
    this.element = el("div", {}, el("div", { class: "row" }, label, ...extra), el("div", { class: "row" }, this.slider, this.value), this.problem, this.leafProblem, this.note);
    this.showValue();
  }

  get isOn(): boolean {
    return this.on.checked;
  }

  set isOn(on: boolean) {
    this.on.checked = on;
    this.refresh();
  }

  /** `bounds` is null while nothing of the map has come. */
  setAxis(axis: Axis, bounds: THREE.Box3 | null): void {
    if (axis === this.axis) return;
    this.axis = axis;
    this.moved = false;
    if (bounds) this.setBounds(bounds);
    this.refresh();
  }

  /** The slider reaches over the map. Until it has been moved it stands at two fifths of it. */
  setBounds(bounds: THREE.Box3): void {
    if (bounds.isEmpty()) return;
    const which = kAxes.indexOf(this.axis);
    const [low, high] = [bounds.min.getComponent(which), bounds.max.getComponent(which)];
    this.slider.min = (Math.floor(low / kStep) * kStep).toFixed(2);
    this.slider.max = (Math.ceil(high / kStep) * kStep).toFixed(2);
    if (!this.moved) this.slider.value = (low + 0.4 * (high - low)).toFixed(2);
    this.showValue();
  }

  /** Asks for the slice again, since the map or a choice has changed. */
  refresh(): void {
    this.showValue();
    if (!this.on.checked) {
      this.feed.want(null);
      this.plane.hide();
      this.problem.textContent = "";
      this.onChange();
      return;
    }
    const { voxel, ...rest } = this.options();
    this.feed.want({ axis: this.axis, at: middleOfVoxel(Number(this.slider.value), voxel), ...rest });
  }

  /** Another map: what is shown is no longer true. */
  forget(): void {
    this.feed.forget();
    this.plane.hide();
    this.refresh();
  }

  private showValue(): void {
    this.value.textContent = `${this.axis} = ${Number(this.slider.value).toFixed(2)} m`;
  }
}

/** A place within the voxel that begins at or before `at` [m], so that slice and cell never fall on two sides of a face. */
function middleOfVoxel(at: number, voxel: number): number {
  return voxel > 0 ? (Math.floor(at / voxel + 1e-6) + 0.5) * voxel : at;
}

function swatch(colour: Rgb, text: string): HTMLElement {
  const box = el("span", { class: "swatch", "aria-hidden": "true" });
  box.style.background = css(colour);
  return el("span", {}, box, text);
}

function choice(text: string, onChange: () => void): { input: HTMLInputElement; element: HTMLElement } {
  const input = el("input", { type: "checkbox" });
  input.addEventListener("change", onChange);
  return { input, element: el("label", {}, input, ` ${text}`) };
}

export class FreeSpacePanel {
  readonly cell = new CellCard();
  private readonly horizontal: SliceControl;
  private readonly vertical: SliceControl;
  private readonly across = el("select", { "aria-label": "Axis across the vertical slice" });
  private upAxis: Axis = "z";
  private bounds: THREE.Box3 | null = null;
  private voxel = 0; // [m], 0 = not known
  private timer: ReturnType<typeof setTimeout> | null = null;

  constructor(parent: HTMLElement, scene: THREE.Scene, onChange: () => void) {
    const again = (): void => this.refresh();
    const contours = choice("distances as contours", again);
    const leaves = choice("octree leaves", again);
    const layer = el("select", { "aria-label": "Which octree" }, el("option", { value: "raw" }, "raw"), el("option", { value: "closed" }, "closed, for planners"));
    layer.addEventListener("change", again);
    const options = (): SliceOptions => ({
      contours: contours.input.checked,
      leaves: leaves.input.checked ? (layer.value as LeafLayer) : null,
      voxel: this.voxel,
    });
    this.horizontal = new SliceControl("Horizontal slice", "z", [], options, onChange);
    this.vertical = new SliceControl("Vertical slice", "y", [this.across], options, onChange);
    this.across.addEventListener("change", () => this.vertical.setAxis(this.across.value as Axis, this.bounds));
    this.fillAcross();
    scene.add(this.horizontal.plane.group, this.vertical.plane.group);
    parent.append(
      el("div", { class: "row" }, swatch(kFree, "free"), swatch(kOccupied, "occupied"), swatch(kNotSeen, "unknown")),
      this.horizontal.element,
      this.vertical.element,
      el("div", { class: "row" }, contours.element, leaves.element, layer),
      el("p", { class: "faint" }, "Contours are at 0.1, 0.25, 0.5, 1 and 2 m. Click a cell of a slice to read why it is so."),
      this.cell.element,
    );
  }

  /** The horizontal slice is across the axis nearest to up. */
  setUp(up: [number, number, number]): void {
    const sizes = up.map(Math.abs);
    const upAxis = kAxes[sizes.indexOf(Math.max(...sizes))]!;
    if (upAxis === this.upAxis) return;
    this.upAxis = upAxis;
    this.fillAcross();
    this.horizontal.setAxis(this.upAxis, this.bounds);
    this.vertical.setAxis(this.across.value as Axis, this.bounds);
  }

  setVoxel(voxel: number): void {
    this.voxel = voxel;
  }

  setBounds(bounds: THREE.Box3): void {
    this.bounds = bounds;
    this.horizontal.setBounds(bounds);
    this.vertical.setBounds(bounds);
  }

  /** Asks for the slices again, since a choice has changed. */
  private refresh(): void {
    for (const control of [this.horizontal, this.vertical]) if (control.isOn) control.refresh();
  }

  /** The map has changed: asks for the slices again after `wait` [ms], once also when it changes several times until then. */
  refreshSoon(wait: number): void {
    this.timer ??= setTimeout(() => {
      this.timer = null;
      this.refresh();
    }, wait);
  }

  /** There is another map. */
  forget(): void {
    this.horizontal.forget();
    this.vertical.forget();
    this.cell.hide();
  }

  toggleHorizontal(): void {
    this.horizontal.isOn = !this.horizontal.isOn;
  }

  toggleVertical(): void {
    this.vertical.isOn = !this.vertical.isOn;
  }

  /** The nearest point of a slice on a ray. */
  pick(ray: THREE.Ray): { distance: number; point: THREE.Vector3 } | null {
    const hits = [this.horizontal, this.vertical].flatMap((control) => control.plane.pick(ray) ?? []);
    return hits.sort((a, b) => a.distance - b.distance)[0] ?? null;
  }

  /** For tests: how many cells of each state are shown. */
  counts(): Record<string, number[]> {
    const count = (control: SliceControl): number[] => {
      const counts = [0, 0, 0];
      for (const state of control.plane.shown?.cells ?? []) ++counts[state]!;
      return counts;
    };
    return { horizontal: count(this.horizontal), vertical: count(this.vertical) };
  }

  /** For tests. */
  get drawn(): SlicePlane["drawn"] {
    return this.horizontal.plane.drawn;
  }

  private fillAcross(): void {
    const others = kAxes.filter((axis) => axis !== this.upAxis);
    this.across.replaceChildren(...others.map((axis) => el("option", { value: axis }, `across ${axis}`)));
    this.across.value = others[1]!;
  }
}
