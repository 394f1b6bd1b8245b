/** The map to turn in a report of vismap-map. It draws when something has changed, never by itself. */
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { listenForClicks } from "./clicks";
import { isSoftware, makeRenderer } from "./renderer";
import { decodeReport, kNoOwner, paintReport, type ReportColouring, type ReportMesh } from "./report_mesh";

declare global {
  interface Window {
    vismapReport?: { vertices: number; triangles: number; drawn: number; chosen: string | null };
  }
}

function element<Kind extends HTMLElement>(id: string): Kind {
  const found = document.getElementById(id);
  if (!found) throw new Error(`The report has no element ${id}.`);
  return found as Kind;
}

class ReportView {
  readonly state = { vertices: 0, triangles: 0, drawn: 0, chosen: null as string | null };
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(50, 1, 0.02, 500);
  private readonly controls: OrbitControls;
  private readonly geometry = new THREE.BufferGeometry();
  private readonly surface: THREE.Mesh;
  private chosen = -1;
  private scheduled = false;

  constructor(
    private readonly mesh: ReportMesh,
    private readonly canvas: HTMLCanvasElement,
    private readonly renderer: THREE.WebGLRenderer,
  ) {
    this.state.vertices = mesh.owners.length;
    this.state.triangles = mesh.corners.length / 3;
    this.geometry.setAttribute("position", new THREE.BufferAttribute(mesh.positions, 3));
    this.geometry.setIndex(new THREE.BufferAttribute(mesh.corners, 1));
    this.geometry.computeVertexNormals();
    this.surface = new THREE.Mesh(this.geometry, new THREE.MeshLambertMaterial({ vertexColors: true }));
    const light = new THREE.DirectionalLight(0xffffff, 1.9);
    this.camera.add(light);
    this.scene.add(this.camera, this.surface, new THREE.AmbientLight(0xffffff, 1.5));
    this.scene.background = new THREE.Color(0xe2e5ea);
    this.camera.up.set(...mesh.up);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.invalidate());
    this.controls.listenToKeyEvents(canvas);
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.placeCamera();
    listenForClicks(canvas, (x, y) => this.choose(this.ownerAt(x, y), false));
    for (const row of document.querySelectorAll<HTMLElement>("tr[data-object]")) this.makeRowLive(row);
    element<HTMLSelectElement>("colouring").addEventListener("change", () => this.paint());
    if (mesh.coloured) element<HTMLSelectElement>("colouring").value = "rgb";
    this.paint();
  }

  private placeCamera(): void {
    this.geometry.computeBoundingSphere();
    const { center, radius } = this.geometry.boundingSphere!;
    const up = new THREE.Vector3(...this.mesh.up);
    const side = new THREE.Vector3(1, 0.35, 0.2).projectOnPlane(up).normalize();
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(side, 1.5 * radius).addScaledVector(up, 1.3 * radius);
    this.controls.update();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  private invalidate(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.renderer.render(this.scene, this.camera);
      ++this.state.drawn;
    });
  }

  private paint(): void {
    const colouring = element<HTMLSelectElement>("colouring").value as ReportColouring;
    this.geometry.setAttribute("color", new THREE.BufferAttribute(paintReport(this.mesh, colouring, this.chosen), 3));
    this.invalidate();
  }

  /** The object at a place of the window; -1 = none. */
  private ownerAt(x: number, y: number): number {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const place = new THREE.Vector2(((x - left) / width) * 2 - 1, 1 - ((y - top) / height) * 2);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(place, this.camera);
    const hit = ray.intersectObject(this.surface)[0];
    const owner = hit?.face ? this.mesh.owners[hit.face.a]! : kNoOwner;
    return owner === kNoOwner ? -1 : owner;
  }

  private makeRowLive(row: HTMLElement): void {
    const index = Number(row.dataset.object);
    row.classList.add("live");
    row.tabIndex = 0;
    row.addEventListener("click", () => this.choose(index, true));
    row.addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.choose(index, true);
    });
  }

  /** `look`: the camera turns to it, and the page scrolls to the map. */
  private choose(index: number, look: boolean): void {
    this.chosen = index === this.chosen && !look ? -1 : index;
    const object = this.mesh.objects[this.chosen];
    this.state.chosen = object?.id ?? null;
    element("picked").textContent = object ? `${object.name}, id ${object.id}` : "";
    for (const row of document.querySelectorAll<HTMLElement>("tr[data-object]"))
      row.setAttribute("aria-selected", String(Number(row.dataset.object) === this.chosen));
    if (look && object) this.lookAt(this.chosen);
    this.paint();
  }

  private lookAt(index: number): void {
    const box = new THREE.Box3();
    const point = new THREE.Vector3();
    this.mesh.owners.forEach((owner, v) => {
      if (owner === index) box.expandByPoint(point.fromArray(this.mesh.positions, 3 * v));
    });
    if (!box.isEmpty()) {
      const center = box.getCenter(new THREE.Vector3());
      const away = this.camera.position.clone().sub(this.controls.target).normalize();
      const distance = Math.max(0.6, 2.2 * box.getSize(new THREE.Vector3()).length());
      this.controls.target.copy(center);
      this.camera.position.copy(center).addScaledVector(away, distance);
      this.controls.update();
    }
    element("viewer").scrollIntoView({ block: "nearest" });
  }
}

function start(): void {
  THREE.ColorManagement.enabled = false; // all our colours are as the screen shows them
  const canvas = element<HTMLCanvasElement>("canvas");
  const renderer = makeRenderer(canvas, !isSoftware(canvas));
  if (!renderer) return; // the pictures of the turntable stay
  const mesh = decodeReport(element("about").textContent ?? "", element("surface").textContent ?? "");
  element("viewer").hidden = false;
  element("turntable").hidden = true;
  window.vismapReport = new ReportView(mesh, canvas, renderer).state;
}

if (document.getElementById("viewer")) start();
