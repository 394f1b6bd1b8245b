/** The 3-D view: renderer, camera and controls. It draws when something has changed, never by itself. */
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { listenForClicks } from "./clicks";
import { DrawPacer } from "./draw_pacer";
import { Flight } from "./flight";
import { FrameRate, type Quality } from "./frame_rate";
import { isSoftware, makeRenderer, waitForPixels } from "./renderer";

const kSmallTurn = 0.03; // of the upward direction [rad]

THREE.ColorManagement.enabled = false; // all our colours are as the screen shows them

export type ClickHandler = (ray: THREE.Ray) => void;

export class View {
  readonly scene = new THREE.Scene();
  readonly camera = new THREE.PerspectiveCamera(55, 1, 0.02, 500);
  renderCount = 0;
  touched = false; // a person has moved the camera

  private readonly renderer: THREE.WebGLRenderer | null;
  private readonly rate: FrameRate;
  private controls: OrbitControls;
  private scheduled = false;
  private flight: Flight | null = null;
  private readonly afterRender: (() => void)[] = [];
  private readonly onClick: ClickHandler[] = [];
  private readonly onMoved: (() => void)[] = [];
  private readonly onDetail: ((coarse: boolean) => void)[] = [];
  private readonly slow: boolean;
  private readonly pacer = new DrawPacer(() => this.invalidate());

  constructor(readonly canvas: HTMLCanvasElement) {
    this.slow = isSoftware(canvas);
    this.renderer = makeRenderer(canvas, !this.slow);
    this.rate = new FrameRate(this.slow, (quality) => this.setQuality(quality));
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(4, -4, 4);
    this.controls = this.makeControls(new THREE.Vector3());
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement ?? canvas);
    listenForClicks(canvas, (x, y) => {
      const ray = this.rayAt(x, y);
      for (const handler of this.onClick) handler(ray);
    });
    canvas.addEventListener("webglcontextrestored", () => this.invalidate());
  }

  get target(): THREE.Vector3 {
    return this.controls.target;
  }

  /** False when the browser has no WebGL 2. */
  get canDraw(): boolean {
    return this.renderer !== null;
  }

  get pixelRatio(): number {
    return this.renderer?.getPixelRatio() ?? 0;
  }

  get drawCalls(): number {
    return this.renderer?.info.render.calls ?? 0;
  }

  addAfterRender(handler: () => void): void {
    this.afterRender.push(handler);
  }

  addClickHandler(handler: ClickHandler): void {
    this.onClick.push(handler);
  }

  /** Calls the handler when the camera has been moved and stands still again. */
  addMovedHandler(handler: () => void): void {
    this.onMoved.push(handler);
  }

  /** Asks for one drawing at the next frame of the screen. */
  invalidate(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame((now) => this.draw(now));
  }

  /** As invalidate, for what the map changes: a slow computer then has time for other things between two drawings. */
  invalidateSoon(): void {
    if (!this.scheduled) this.pacer.soon();
  }

  /** The map is on its way to another moment of a log: its changes are drawn when it is there, or after so long [ms]. */
  holdMap(most: number): void {
    this.pacer.hold(most);
  }

  /** The map is there. */
  releaseMap(): void {
    this.pacer.release();
  }

  /** The surface has changed. */
  surfaceChanged(): void {
    this.rate.mapChanged();
    this.invalidateSoon();
  }

  /** Calls the handler when fewer triangles, or all again, are to be drawn. */
  addDetailHandler(handler: (coarse: boolean) => void): void {
    this.onDetail.push(handler);
  }

  setBackground(colour: string): void {
    this.scene.background = new THREE.Color(colour);
    this.invalidate();
  }

  /** Which direction is upward. A small change, as one estimate differs from the next, turns nothing; answers whether it did. */
  setUp(up: [number, number, number]): boolean {
    const wanted = new THREE.Vector3(...up).normalize();
    if (wanted.lengthSq() === 0 || wanted.distanceTo(this.camera.up) < kSmallTurn) return false;
    this.camera.up.copy(wanted);
    const target = this.controls.target.clone();
    this.controls.dispose();
    this.controls = this.makeControls(target);
    this.invalidate();
    return true;
  }

  /** Shows all of a box, from obliquely above. */
  showAll(bounds: THREE.Box3, jump = false): void {
    if (bounds.isEmpty()) return;
    const up = this.camera.up;
    const side = Math.abs(up.x) < 0.9 ? new THREE.Vector3(1, 0, 0) : new THREE.Vector3(0, 1, 0);
    side.addScaledVector(up, -side.dot(up)).normalize();
    const forward = new THREE.Vector3().crossVectors(up, side);
    const direction = side.multiplyScalar(0.55).addScaledVector(forward, -0.75).addScaledVector(up, 0.85).normalize();
    this.lookAt(bounds, direction, 0.8, jump);
  }

  /** Flies to a box and keeps the direction in which the camera looks. */
  flyTo(bounds: THREE.Box3): void {
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    this.touched = true;
    this.lookAt(bounds, direction, 2.2);
  }

  /** Moves nearer (factor below 1) or away. */
  zoom(factor: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    this.touched = true;
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.invalidate();
  }

  /** Looks from a camera's place in its direction. */
  lookFrom(position: THREE.Vector3, target: THREE.Vector3): void {
    this.touched = true;
    this.fly(position, target, false);
  }

  /** Where a point of W is on the page [CSS px]. */
  project(x: number, y: number, z: number): [number, number] {
    const p = new THREE.Vector3(x, y, z).project(this.camera);
    const frame = this.canvas.getBoundingClientRect();
    return [frame.left + ((p.x + 1) / 2) * frame.width, frame.top + ((1 - p.y) / 2) * frame.height];
  }

  private lookAt(bounds: THREE.Box3, direction: THREE.Vector3, room: number, jump = false): void {
    const sphere = bounds.getBoundingSphere(new THREE.Sphere());
    const radius = Math.max(sphere.radius * room, 0.3);
    const narrow = Math.min(1, this.camera.aspect);
    const distance = radius / Math.sin(THREE.MathUtils.degToRad(this.camera.fov) / 2) / narrow;
    this.fly(sphere.center.clone().addScaledVector(direction, distance), sphere.center, jump);
  }

  private fly(position: THREE.Vector3, target: THREE.Vector3, jump: boolean): void {
    if (!jump) this.rate.moving(true);
    const still = jump || matchMedia("(prefers-reduced-motion: reduce)").matches;
    const from = { position: this.camera.position, target: this.controls.target };
    this.flight = new Flight(from, { position, target }, still);
    this.invalidate();
  }

  private stopped(): void {
    this.rate.moving(false);
    for (const handler of this.onMoved) handler();
  }

  private draw(now: number): void {
    this.scheduled = false;
    const flying = this.flight !== null;
    const start = performance.now();
    if (this.flight && !this.flight.advance(now)) this.flight = null;
    if (flying) this.controls.update();
    this.renderer?.render(this.scene, this.camera);
    if (this.slow) waitForPixels(this.renderer);
    this.pacer.drawn(start, performance.now());
    ++this.renderCount;
    for (const handler of this.afterRender) handler();
    if (this.flight) this.invalidate();
    else if (flying) this.stopped();
    this.rate.drawn(now);
  }

  private setQuality(quality: Quality): void {
    for (const handler of this.onDetail) handler(quality.coarse);
    if (quality.ratio === this.pixelRatio) this.invalidateSoon();
    else this.resize();
  }

  private resize(): void {
    const frame = this.canvas.parentElement;
    const width = Math.max(1, frame?.clientWidth ?? 1);
    const height = Math.max(1, frame?.clientHeight ?? 1);
    this.renderer?.setPixelRatio(this.rate.quality.ratio);
    this.renderer?.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  private makeControls(target: THREE.Vector3): OrbitControls {
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.zoomToCursor = true;
    controls.maxDistance = 400;
    controls.target.copy(target);
    controls.update();
    controls.addEventListener("change", () => this.invalidate());
    controls.addEventListener("start", () => {
      this.touched = true;
      this.flight = null;
      this.rate.moving(true);
    });
    controls.addEventListener("end", () => this.stopped());
    controls.listenToKeyEvents(this.canvas);
    return controls;
  }

  private rayAt(clientX: number, clientY: number): THREE.Ray {
    const frame = this.canvas.getBoundingClientRect();
    const x = ((clientX - frame.left) / frame.width) * 2 - 1;
    const y = 1 - ((clientY - frame.top) / frame.height) * 2;
    const caster = new THREE.Raycaster();
    this.camera.updateMatrixWorld();
    caster.setFromCamera(new THREE.Vector2(x, y), this.camera);
    return caster.ray;
  }
}
