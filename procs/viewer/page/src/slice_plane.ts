/** A slice in the scene: cells as a picture, distances as contours, leaves of the octree as boxes with their outlines in the slice. */
import * as THREE from "three";
import { contourLines, labelPlaces } from "./contours";
import { distancesTo } from "./distance";
import { LeafBoxes, type Leaf } from "./leaf_boxes";
import { axesOf, pixelsOf, type Slice } from "./slice_data";

const kLevels = [0.1, 0.25, 0.5, 1, 2]; // [m]
const kLabelDistance = 1.5; // between two labels of a level [m]

export class SlicePlane {
  readonly group = new THREE.Group();
  private slice: Slice | null = null;
  private readonly picture = new THREE.Mesh(
    new THREE.BufferGeometry(),
    new THREE.MeshBasicMaterial({ transparent: true, side: THREE.DoubleSide, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -1 }),
  );
  private readonly contours = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0x111111 }));
  private readonly leaves = new THREE.LineSegments(
    new THREE.BufferGeometry(),
    new THREE.LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.8 }),
  );

  private readonly boxes = new LeafBoxes();
  private readonly labels = new THREE.Group();

  constructor() {
    this.group.add(this.picture, this.contours, this.leaves, this.boxes.group, this.labels);
    this.group.visible = false;
    this.picture.renderOrder = 2;
  }

  get shown(): Slice | null {
    return this.group.visible ? this.slice : null;
  }

  /** For tests: pieces of contours, their labels, outlines of leaves, and their boxes. */
  get drawn(): { contours: number; labels: number; leaves: number; boxes: LeafBoxes["counts"] } {
    const lines = (object: THREE.LineSegments): number => (object.geometry.getAttribute("position")?.count ?? 0) / 2;
    return { contours: lines(this.contours), labels: this.labels.children.length, leaves: lines(this.leaves) / 4, boxes: this.boxes.counts };
  }

  hide(): void {
    this.group.visible = false;
    this.slice = null;
  }

  show(slice: Slice, contours: boolean): void {
    this.hide();
    if (slice.cells.length === 0) return;
    this.slice = slice;
    this.group.visible = true;
    const old = this.picture.material.map;
    const texture = new THREE.DataTexture(pixelsOf(slice, 0.65), slice.width, slice.height);
    texture.needsUpdate = true;
    this.picture.material.map = texture;
    this.picture.material.needsUpdate = old === null;
    old?.dispose();
    this.picture.geometry.dispose();
    this.picture.geometry = quadOf(slice);
    this.showContours(slice, contours);
    this.showLeaves([]);
  }

  /** The leaves that the slice cuts, and squares where it cuts them. */
  showLeaves(leaves: Leaf[]): void {
    this.leaves.geometry.dispose();
    this.leaves.geometry = new THREE.BufferGeometry();
    this.boxes.show(this.slice ? leaves : []);
    if (!this.slice || leaves.length === 0) return;
    const { u, v, across } = axesOf(this.slice.axis);
    const positions: number[] = [];
    const colours: number[] = [];
    for (const { centre, size, occupied } of leaves) {
      const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) => {
        const p = [0, 0, 0];
        p[across] = this.slice!.at;
        p[u] = centre[u]! + (a! * size) / 2;
        p[v] = centre[v]! + (b! * size) / 2;
        return p;
      });
      for (let i = 0; i < 4; ++i) positions.push(...corners[i]!, ...corners[(i + 1) % 4]!);
      for (let i = 0; i < 8; ++i) colours.push(...(occupied ? [0.45, 0.16, 0] : [0, 0.27, 0.5]));
    }
    this.leaves.geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
    this.leaves.geometry.setAttribute("color", new THREE.Float32BufferAttribute(colours, 3));
  }

  /** Where a ray meets the slice; null when it does not. */
  pick(ray: THREE.Ray): { distance: number; point: THREE.Vector3 } | null {
    if (!this.group.visible || !this.slice) return null;
    const { u, v, across } = axesOf(this.slice.axis);
    const slope = ray.direction.getComponent(across);
    const distance = (this.slice.at - ray.origin.getComponent(across)) / slope;
    if (!Number.isFinite(distance) || distance <= 0) return null;
    const point = ray.at(distance, new THREE.Vector3());
    const column = (point.getComponent(u) - this.slice.origin[0]) / this.slice.cell;
    const row = (point.getComponent(v) - this.slice.origin[1]) / this.slice.cell;
    const inside = column >= 0 && row >= 0 && column < this.slice.width && row < this.slice.height;
    return inside ? { distance, point } : null;
  }

  /** Lines at equal distances from what is occupied in the slice, through what is free. */
  private showContours(slice: Slice, shown: boolean): void {
    this.contours.geometry.dispose();
    this.contours.geometry = new THREE.BufferGeometry();
    this.labels.clear();
    if (!shown) return;
    const distances = slice.distances ?? distancesInSlice(slice);
    const { u, v, across } = axesOf(slice.axis);
    const place = (column: number, row: number): number[] => {
      const p = [0, 0, 0];
      p[across] = slice.at;
      p[u] = slice.origin[0] + column * slice.cell;
      p[v] = slice.origin[1] + row * slice.cell;
      return p;
    };
    const positions: number[] = [];
    const labelled: [number, number][] = [];
    for (const level of kLevels) {
      const lines = contourLines(distances, slice.width, slice.height, level);
      for (let i = 0; i < lines.length; i += 2) positions.push(...place(lines[i]!, lines[i + 1]!));
      const places = labelPlaces(lines, kLabelDistance / slice.cell, labelled);
      labelled.push(...places);
      for (const [column, row] of places) this.labels.add(labelAt(level, place(column, row)));
    }
    this.contours.geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  }
}

/** Distances to what is occupied in the slice alone [m], for servers that do not tell those of the map. */
function distancesInSlice(slice: Slice): Float32Array {
  const cells = distancesTo(slice.cells, slice.width, slice.height, (cell) => cell === 2, (cell) => cell === 1);
  return cells.map((distance) => distance * slice.cell);
}

/** The text of a level beside its line, as large everywhere. */
function labelAt(level: number, place: number[]): THREE.Sprite {
  const sprite = new THREE.Sprite(labelMaterial(level));
  sprite.position.fromArray(place);
  sprite.scale.set(0.075, 0.03, 1);
  sprite.renderOrder = 3;
  return sprite;
}

const materials = new Map<number, THREE.SpriteMaterial>();

function labelMaterial(level: number): THREE.SpriteMaterial {
  const known = materials.get(level);
  if (known) return known;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [160, 64];
  const context = canvas.getContext("2d")!;
  context.font = "600 38px sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineWidth = 9;
  context.strokeStyle = "#fff";
  context.strokeText(`${level} m`, 80, 32);
  context.fillStyle = "#111";
  context.fillText(`${level} m`, 80, 32);
  const material = new THREE.SpriteMaterial({ map: new THREE.CanvasTexture(canvas), sizeAttenuation: false, depthTest: false, transparent: true });
  materials.set(level, material);
  return material;
}

/** The rectangle of a slice, with the picture's first row at its origin. */
function quadOf(slice: Slice): THREE.BufferGeometry {
  const { u, v, across } = axesOf(slice.axis);
  const [w, h] = [slice.width * slice.cell, slice.height * slice.cell];
  const corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
  const positions = corners.flatMap(([a, b]) => {
    const p = [0, 0, 0];
    p[across] = slice.at;
    p[u] = slice.origin[0] + a! * w;
    p[v] = slice.origin[1] + b! * h;
    return p;
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute("uv", new THREE.Float32BufferAttribute(corners.flat(), 2));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  return geometry;
}
