/** The surface in the scene: one mesh for each chunk, painted and picked here. */
import * as THREE from "three";
import { MeshBVH } from "three-mesh-bvh";
import type { Chunk } from "./chunk_store";
import { ObjectIndex, type MapObject } from "./objects";
import { belongsTo, markSelected, paintChunk, type Colouring, type Paint } from "./painting";

const kVertexShader = `
attribute vec4 paint;
uniform float dim;
varying vec3 shade;
void main() {
  vec4 p = modelViewMatrix * vec4(position, 1.0);
  vec3 n = normalize(normalMatrix * normal);
  float light = 0.45 + 0.55 * abs(dot(n, normalize(p.xyz)));
  vec3 lit = paint.rgb * light;
  float grey = dot(lit, vec3(0.3, 0.6, 0.1));
  vec3 dimmed = mix(lit, vec3(0.25 + 0.4 * grey), 0.75);
  shade = mix(lit, dimmed, dim * (1.0 - paint.a));
  gl_Position = projectionMatrix * p;
}`;

const kFragmentShader = `
varying vec3 shade;
void main() { gl_FragColor = vec4(shade, 1.0); }`;

const kAlwaysWhole = 100000; // triangles

interface Piece {
  chunk: Chunk;
  mesh: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial>;
  paint: Uint8Array;
  indices: { fine: THREE.BufferAttribute; coarse: THREE.BufferAttribute };
  bvh: MeshBVH | null;
}

export interface Hit {
  distance: number; // [m]
  point: THREE.Vector3;
  instance: number;
  segment: number;
}

export class Surface {
  readonly group = new THREE.Group();
  readonly bounds = new THREE.Box3();
  private readonly pieces = new Map<string, Piece>();
  private selected: MapObject | null = null;
  private coarse = false;
  private readonly paint: Paint = {
    colouring: "instance",
    objects: new ObjectIndex([]),
    up: [0, 0, 1],
    heights: [0, 1],
  };
  private readonly material = new THREE.ShaderMaterial({
    vertexShader: kVertexShader,
    fragmentShader: kFragmentShader,
    uniforms: { dim: { value: 0 } },
  });

  get blocks(): number {
    return this.sum((piece) => piece.chunk.blocks);
  }

  get triangles(): number {
    return this.sum((piece) => piece.chunk.triangles);
  }

  get chunks(): number {
    return this.pieces.size;
  }

  get heights(): [number, number] {
    return this.paint.heights;
  }

  get colouring(): Colouring {
    return this.paint.colouring;
  }

  put(chunk: Chunk): void {
    this.drop(chunk.key);
    const paint = new Uint8Array(4 * chunk.segments.length);
    paintChunk(chunk, this.paint, paint);
    markSelected(chunk, this.selected, paint);
    const indices = { fine: new THREE.BufferAttribute(chunk.indices, 1), coarse: new THREE.BufferAttribute(chunk.coarse, 1) };
    const mesh = new THREE.Mesh(geometryOf(chunk, paint), this.material);
    mesh.geometry.setIndex(this.coarse ? indices.coarse : indices.fine);
    mesh.matrixAutoUpdate = false;
    this.pieces.set(chunk.key, { chunk, mesh, paint, indices, bvh: null });
    this.group.add(mesh);
    this.updateBounds();
  }

  drop(key: string): void {
    const piece = this.pieces.get(key);
    if (!piece) return;
    this.group.remove(piece.mesh);
    piece.mesh.geometry.dispose();
    this.pieces.delete(key);
    this.updateBounds();
  }

  setColouring(colouring: Colouring): void {
    this.paint.colouring = colouring;
    this.repaint();
  }

  setUp(up: [number, number, number]): void {
    this.paint.up = up;
    this.updateBounds();
  }

  /** Answers whether the surface has other colours then. */
  setObjects(objects: ObjectIndex): boolean {
    const other = objects.signature !== this.paint.objects.signature;
    this.paint.objects = objects;
    const repainted = other && this.paint.colouring === "instance";
    if (repainted) this.repaint();
    return repainted;
  }

  select(object: MapObject | null): void {
    this.selected = object;
    this.material.uniforms.dim!.value = object && object.group !== "removed" ? 1 : 0;
    for (const piece of this.pieces.values()) {
      if (markSelected(piece.chunk, object, piece.paint)) upload(piece);
    }
  }

  /** Draws fewer triangles, or all. A small surface is always drawn whole. */
  setCoarse(coarse: boolean): void {
    this.coarse = coarse && this.triangles > kAlwaysWhole;
    for (const { mesh, indices } of this.pieces.values()) mesh.geometry.setIndex(this.coarse ? indices.coarse : indices.fine);
  }

  /** Back faces: a ceiling seen from above is not drawn unless they are. */
  setBothSides(both: boolean): void {
    this.material.side = both ? THREE.DoubleSide : THREE.FrontSide;
    this.material.needsUpdate = true;
  }

  /** The first surface that a ray meets on its front side. */
  pick(ray: THREE.Ray): Hit | null {
    let best: Hit | null = null;
    for (const piece of this.pieces.values()) {
      const box = piece.mesh.geometry.boundingBox;
      if (!box || !ray.intersectsBox(box)) continue;
      const hit = pickPiece(piece, ray, this.material.side);
      if (hit && (!best || hit.distance < best.distance)) best = hit;
    }
    return best;
  }

  /** The bounds of an object's surface, for things whose box is not known. */
  boundsOf(object: MapObject): THREE.Box3 {
    const bounds = new THREE.Box3();
    const point = new THREE.Vector3();
    for (const { chunk } of this.pieces.values()) {
      const inside = belongsTo(chunk, object);
      for (let v = 0; v < chunk.segments.length; ++v) {
        if (inside(v)) bounds.expandByPoint(point.fromArray(chunk.positions, 3 * v));
      }
    }
    return bounds;
  }

  private repaint(): void {
    for (const piece of this.pieces.values()) {
      paintChunk(piece.chunk, this.paint, piece.paint);
      upload(piece);
    }
  }

  private updateBounds(): void {
    this.bounds.makeEmpty();
    for (const { mesh } of this.pieces.values()) {
      if (mesh.geometry.boundingBox) this.bounds.union(mesh.geometry.boundingBox);
    }
    const heights = heightsOf(this.bounds, this.paint.up);
    const before = this.paint.heights;
    this.paint.heights = heights;
    const moved = Math.abs(heights[0] - before[0]) + Math.abs(heights[1] - before[1]);
    if (this.paint.colouring === "height" && moved > 0.05) this.repaint();
  }

  private sum(value: (piece: Piece) => number): number {
    let total = 0;
    for (const piece of this.pieces.values()) total += value(piece);
    return total;
  }
}

function geometryOf(chunk: Chunk, paint: Uint8Array): THREE.BufferGeometry {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(chunk.positions, 3));
  geometry.setAttribute("normal", new THREE.BufferAttribute(chunk.normals, 4, true));
  geometry.setAttribute("paint", new THREE.BufferAttribute(paint, 4, true));
  geometry.computeBoundingBox();
  geometry.boundingSphere = geometry.boundingBox!.getBoundingSphere(new THREE.Sphere());
  return geometry;
}

function upload(piece: Piece): void {
  piece.mesh.geometry.getAttribute("paint").needsUpdate = true;
}

function pickPiece(piece: Piece, ray: THREE.Ray, side: THREE.Side): Hit | null {
  piece.bvh ??= searchTreeOf(piece);
  const found = piece.bvh.raycastFirst(ray, side);
  if (!found || found.faceIndex == null) return null;
  const vertex = piece.chunk.indices[3 * found.faceIndex]!;
  return {
    distance: found.distance,
    point: found.point.clone(),
    instance: piece.chunk.instances[vertex]!,
    segment: piece.chunk.segments[vertex]!,
  };
}

/** The tree is over all triangles, whichever are drawn at present. */
function searchTreeOf(piece: Piece): MeshBVH {
  const whole = new THREE.BufferGeometry();
  whole.setAttribute("position", piece.mesh.geometry.getAttribute("position"));
  whole.setIndex(piece.indices.fine);
  return new MeshBVH(whole, { indirect: true });
}

/** Lowest and highest corner of a box along the upward direction [m]. */
function heightsOf(bounds: THREE.Box3, up: [number, number, number]): [number, number] {
  if (bounds.isEmpty()) return [0, 1];
  let low = 0;
  let high = 0;
  up.forEach((share, axis) => {
    const [a, b] = [bounds.min.getComponent(axis) * share, bounds.max.getComponent(axis) * share];
    low += Math.min(a, b);
    high += Math.max(a, b);
  });
  return [low, high];
}
