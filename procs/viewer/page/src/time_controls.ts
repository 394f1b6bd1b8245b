/** Pause of a live map, and the timeline of a log. */
import { askAbout } from "./api";
import { sameDigest } from "./digest";
import { byId } from "./dom";
import type { Command } from "./help";
import type { MapStatus } from "./map_status";
import { PauseButton } from "./pause_button";
import type { HelloMessage, MapMessage } from "./protocol";
import type { Surface } from "./surface";
import { TimelineBar } from "./timeline_bar";
import type { View } from "./view";
import type { WorkerClient } from "./worker_client";

const kMostHold = 400; // [ms] that a moment of a log may take before what there is of it is drawn

export class TimeControls {
  readonly bar = new TimelineBar(byId("timeline", HTMLElement), (frames) => this.want(frames));
  readonly pause = new PauseButton(byId("pause", HTMLButtonElement), byId("behind", HTMLElement), (paused) => this.worker().setPaused(paused));
  readonly commands: Command[] = this.bar.commands();

  constructor(
    private readonly view: View,
    private readonly surface: Surface,
    private readonly status: MapStatus,
    private readonly worker: () => WorkerClient,
  ) {
    view.addAfterRender(() => this.bar.watch.drawn(performance.now()));
  }

  /** A log has a timeline, and no processes. */
  takeHello(message: HelloMessage): void {
    this.status.takeHello(message);
    if (message.mode !== "log") return;
    this.bar.show();
    this.pause.hide();
    byId("tab-processes", HTMLButtonElement).hidden = true;
  }

  takeMap(message: MapMessage): void {
    if (!this.status.isLog) return;
    askAbout(message.frames);
    this.bar.takeMap(message.frames);
    this.check();
  }

  /** Whether exactly the map that the server told of is in the scene. */
  check(): void {
    const { map } = this.status;
    const { received } = this.worker();
    if (!map || !this.status.isLog) return;
    const counts = received.waiting === 0 && received.blocks === map.blocks && this.surface.blocks === map.blocks;
    if (this.bar.watch.has(map.frames, counts && sameDigest(received.digest, map.digest))) this.view.releaseMap();
  }

  toggle(): void {
    if (this.status.isLog) this.bar.toggle();
    else this.pause.toggle();
  }

  private want(frames: number | null): void {
    if (!this.bar.watch.isDone) this.view.holdMap(kMostHold);
    this.worker().setMoment(frames);
  }
}
