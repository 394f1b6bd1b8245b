/** The panel of cameras: each with its newest picture, segments and masks over it. */
import { count, el, setText } from "./dom";
import { detectionsText, overlayPixels, type OverlayChoice } from "./overlay";
import type { Picture } from "./picture_codec";
import { delayText } from "./process_summary";
import type { CameraState, Timing } from "./protocol";

export interface CameraActions {
  onLook(camera: CameraState): void;
  /** Another set of cameras has its picture shown. */
  onWant(ids: number[]): void;
  lengthOf(id: number): number;
}

class CameraCard {
  readonly element: HTMLElement;
  readonly open = el("input", { type: "checkbox" });
  private readonly canvas = el("canvas", { class: "picture", role: "img" });
  private readonly facts = el("p", { class: "faint" });
  private readonly words = el("p");
  private state: CameraState;
  private picture: Picture | null = null;

  constructor(state: CameraState, actions: CameraActions, onToggle: () => void) {
    this.state = state;
    const look = el("button", { type: "button" }, "Look from here");
    look.addEventListener("click", () => actions.onLook(this.state));
    this.open.addEventListener("change", () => {
      this.canvas.hidden = !this.open.checked || this.picture === null;
      if (this.open.checked && this.picture === null) setText(this.words, "The picture comes with the camera's next frame.");
      this.words.hidden = !this.open.checked;
      onToggle();
    });
    this.canvas.hidden = true;
    const head = el("div", { class: "head" }, el("h2", {}, `Camera ${state.id}`), look);
    this.element = el("div", { class: "card" }, head, this.facts, el("label", {}, this.open, " picture"), this.canvas, this.words);
  }

  setState(state: CameraState, positions: number, delay: Timing | undefined): void {
    this.state = state;
    const late = delayText(delay);
    const after = state.detections === null || late === "" ? "" : `, which came after ${late}`;
    const detections = state.detections === null ? "no detector looked" : `${state.detections} detections${after}`;
    const place = [state.pose[3], state.pose[7], state.pose[11]].map((value) => value!.toFixed(2)).join(", ");
    const path = positions > 0 ? `, ${count(positions)} positions so far` : "";
    setText(this.facts, `${state.width} × ${state.height}, at ${place} m, frame of ${(state.utime / 1e6).toFixed(2)} s, ${detections}${path}`);
  }

  async show(picture: Picture, choice: OverlayChoice): Promise<void> {
    this.picture = picture;
    this.canvas.hidden = !this.open.checked;
    const words = picture.problem || detectionsText(picture.segments) || "nothing detected";
    setText(this.words, words);
    this.canvas.setAttribute("aria-label", `Picture of camera ${picture.cameraId}: ${words}`);
    const context = this.canvas.getContext("2d");
    if (!context) return;
    const image = picture.jpeg.length > 0 ? await decodeJpeg(picture.jpeg) : null;
    if (this.picture !== picture) return; // a newer one came
    this.canvas.width = image?.width ?? (picture.width || 640);
    this.canvas.height = image?.height ?? (picture.height || 480);
    if (image) context.drawImage(image, 0, 0);
    image?.close();
    if (picture.segments) drawOverlay(context, this.canvas, picture, choice);
  }

  async redraw(choice: OverlayChoice): Promise<void> {
    if (this.picture) await this.show(this.picture, choice);
  }
}

async function decodeJpeg(bytes: Uint8Array): Promise<ImageBitmap | null> {
  try {
    return await createImageBitmap(new Blob([bytes.slice()], { type: "image/jpeg" }));
  } catch {
    return null;
  }
}

function drawOverlay(context: CanvasRenderingContext2D, canvas: HTMLCanvasElement, picture: Picture, choice: OverlayChoice): void {
  const { width, height } = picture.segments!;
  const layer = el("canvas", { width, height });
  layer.getContext("2d")?.putImageData(new ImageData(overlayPixels(picture.segments!, choice), width, height), 0, 0);
  context.imageSmoothingEnabled = false;
  context.drawImage(layer, 0, 0, canvas.width, canvas.height);
}

export class CameraPanel {
  private readonly cards = new Map<number, CameraCard>();
  private readonly list = el("div");
  private delays = new Map<number, Timing>();
  private readonly empty = el("p", { class: "faint" }, "No camera has sent a frame yet.");
  private readonly choice: OverlayChoice = { segments: false, masks: true };

  constructor(
    parent: HTMLElement,
    private readonly actions: CameraActions,
  ) {
    parent.append(el("div", { class: "row" }, this.toggle("masks", "masks"), this.toggle("segments", "segments")), this.empty, this.list);
  }

  /** How long after a camera's frames their detections come, by camera. */
  setDelays(delays: Map<number, Timing>): void {
    this.delays = delays;
  }

  setCameras(cameras: CameraState[]): void {
    this.empty.hidden = cameras.length > 0 || this.cards.size > 0;
    for (const camera of cameras) this.card(camera).setState(camera, this.actions.lengthOf(camera.id), this.delays.get(camera.id));
  }

  takePicture(picture: Picture): void {
    void this.cards.get(picture.cameraId)?.show(picture, this.choice);
  }

  /** The cameras whose picture is shown. */
  wanted(): number[] {
    return [...this.cards].filter(([, card]) => card.open.checked).map(([id]) => id);
  }

  private card(camera: CameraState): CameraCard {
    let card = this.cards.get(camera.id);
    if (!card) {
      card = new CameraCard(camera, this.actions, () => this.actions.onWant(this.wanted()));
      this.cards.set(camera.id, card);
      this.list.append(card.element);
    }
    return card;
  }

  private toggle(which: keyof OverlayChoice, text: string): HTMLElement {
    const input = el("input", { type: "checkbox", checked: this.choice[which] });
    input.addEventListener("change", () => {
      this.choice[which] = input.checked;
      for (const card of this.cards.values()) void card.redraw(this.choice);
    });
    return el("label", {}, input, ` ${text}`);
  }
}
