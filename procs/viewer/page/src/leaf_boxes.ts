/** Leaves of the octree as boxes: free ones so translucent that one sees what stands in them, occupied ones less. */
import * as THREE from "three";
import { kFree, kOccupied, type Rgb } from "./colours";

/** A leaf of the octree: its centre and edge [m], and whether it is occupied. */
export interface Leaf {
  centre: number[];
  size: number;
  occupied: boolean;
}

const kFreeOpacity = 0.14;
const kOccupiedOpacity = 0.5;
const kShrink = 0.96; // of the edges, so that one leaf is told from the next

export class LeafBoxes {
  readonly group = new THREE.Group();
  private readonly cube = new THREE.BoxGeometry(kShrink, kShrink, kShrink);
  private readonly free = materialOf(kFree, kFreeOpacity);
  private readonly occupied = materialOf(kOccupied, kOccupiedOpacity);

  /** For tests: how many boxes are drawn of each kind. */
  get counts(): { free: number; occupied: number } {
    const of = (material: THREE.Material): number =>
      this.meshes.filter((mesh) => mesh.material === material).reduce((sum, mesh) => sum + mesh.count, 0);
    return { free: of(this.free), occupied: of(this.occupied) };
  }

  show(leaves: Leaf[]): void {
    for (const mesh of this.meshes) mesh.dispose();
    this.group.clear();
    this.add(leaves.filter((leaf) => leaf.occupied), this.occupied, 3);
    this.add(leaves.filter((leaf) => !leaf.occupied), this.free, 4);
  }

  private get meshes(): THREE.InstancedMesh[] {
    return this.group.children as THREE.InstancedMesh[];
  }

  private add(leaves: Leaf[], material: THREE.Material, order: number): void {
    if (leaves.length === 0) return;
    const mesh = new THREE.InstancedMesh(this.cube, material, leaves.length);
    const place = new THREE.Matrix4();
    leaves.forEach(({ centre, size }, i) => {
      place.makeScale(size, size, size).setPosition(centre[0]!, centre[1]!, centre[2]!);
      mesh.setMatrixAt(i, place);
    });
    mesh.frustumCulled = false;
    mesh.renderOrder = order; // after the surface and the slice
    this.group.add(mesh);
  }
}

function materialOf(colour: Rgb, opacity: number): THREE.MeshBasicMaterial {
  const color = new THREE.Color(...(colour.map((level) => level / 255) as [number, number, number]));
  return new THREE.MeshBasicMaterial({ color, transparent: true, opacity, depthWrite: false });
}
