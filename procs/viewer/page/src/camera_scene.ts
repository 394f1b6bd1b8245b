/** Cameras in the scene: a frustum at the newest pose, and the trajectory as a line. */
import * as THREE from "three";
import { colourOfId } from "./colours";
import type { CameraState, TrajectoryMessage } from "./protocol";

const kDepth = 0.35; // [m] how long a frustum is drawn

class CameraMark {
  readonly group = new THREE.Group();
  private readonly frustum: THREE.LineSegments;
  private readonly path: THREE.Line;
  private positions: number[] = [];
  private pose = "";
  private count = -1; // positions of the path that are drawn; -1 = all

  constructor(id: number) {
    const [r, g, b] = colourOfId(3 * id + 2);
    const material = new THREE.LineBasicMaterial({ color: new THREE.Color(r / 255, g / 255, b / 255) });
    this.frustum = new THREE.LineSegments(new THREE.BufferGeometry(), material);
    this.path = new THREE.Line(new THREE.BufferGeometry(), material);
    this.frustum.matrixAutoUpdate = false;
    this.path.frustumCulled = false;
    this.frustum.frustumCulled = false;
    this.group.add(this.frustum, this.path);
  }

  get length(): number {
    return this.count < 0 ? this.positions.length / 3 : this.count;
  }

  setState(camera: CameraState): boolean {
    const pose = camera.pose.join();
    const other = camera.positions !== this.count;
    this.count = camera.positions;
    this.cutPath();
    if (pose === this.pose) return other;
    this.pose = pose;
    this.frustum.geometry.dispose();
    this.frustum.geometry = frustumOf(camera);
    this.frustum.matrix.fromArray(camera.pose).transpose(); // rows to columns
    this.frustum.matrixWorldNeedsUpdate = true;
    return true;
  }

  extend(message: TrajectoryMessage): void {
    this.positions.length = Math.min(this.positions.length, 3 * message.from);
    this.positions.push(...message.positions.flat());
    this.path.geometry.dispose();
    this.path.geometry = new THREE.BufferGeometry();
    this.path.geometry.setAttribute("position", new THREE.Float32BufferAttribute(this.positions, 3));
    this.cutPath();
  }

  private cutPath(): void {
    this.path.geometry.setDrawRange(0, this.count < 0 ? Infinity : this.count);
  }
}

/** The edges of the cone that a camera sees, in its own frame: x right, y down, z forward. */
function frustumOf(camera: CameraState): THREE.BufferGeometry {
  const corner = (u: number, v: number): number[] => [
    ((u - camera.cx) / camera.fx) * kDepth,
    ((v - camera.cy) / camera.fy) * kDepth,
    kDepth,
  ];
  const corners = [corner(0, 0), corner(camera.width, 0), corner(camera.width, camera.height), corner(0, camera.height)];
  const lines = corners.flatMap((p, i) => [...[0, 0, 0], ...p, ...p, ...corners[(i + 1) % 4]!]);
  // A tick above the upper edge says which way is up in the picture.
  const tick = corner(camera.width / 2, -0.15 * camera.height);
  lines.push(...corner(0.4 * camera.width, 0), ...tick, ...tick, ...corner(0.6 * camera.width, 0));
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(lines, 3));
  return geometry;
}

export class CameraScene {
  readonly group = new THREE.Group();
  private readonly marks = new Map<number, CameraMark>();

  /** Takes the newest states; answers whether any camera has moved. */
  setCameras(cameras: CameraState[]): boolean {
    const moved = cameras.filter((camera) => this.mark(camera.id).setState(camera));
    // At a moment of a log, a camera may not have taken a frame yet.
    const known = new Set(cameras.map((camera) => camera.id));
    for (const [id, mark] of this.marks) mark.group.visible = known.has(id);
    return moved.length > 0;
  }

  extend(message: TrajectoryMessage): void {
    this.mark(message.cameraId).extend(message);
  }

  /** How many positions of a camera's trajectory are known. */
  lengthOf(id: number): number {
    return this.marks.get(id)?.length ?? 0;
  }

  clear(): void {
    this.marks.clear();
    this.group.clear();
  }

  private mark(id: number): CameraMark {
    let mark = this.marks.get(id);
    if (!mark) {
      mark = new CameraMark(id);
      this.marks.set(id, mark);
      this.group.add(mark.group);
    }
    return mark;
  }
}

/** Where a camera is and a point that it looks at [m]. */
export function sightOf(camera: { pose: number[] }): { position: THREE.Vector3; target: THREE.Vector3 } {
  const p = camera.pose;
  const position = new THREE.Vector3(p[3], p[7], p[11]);
  const forward = new THREE.Vector3(p[2], p[6], p[10]);
  return { position, target: position.clone().addScaledVector(forward, 1.5) };
}
