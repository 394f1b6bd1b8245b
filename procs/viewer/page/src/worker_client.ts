/** The window's end of the worker. */
import type { Received, ToWindow, ToWorker, Want } from "./worker_messages";

export class WorkerClient {
  received: Received = { blocks: 0, triangles: 0, digest: "", waiting: 0, bytes: 0, resyncs: 0 };
  private readonly worker = new Worker("worker.js", { type: "module" });
  private want: Want = { mesh: true, pictures: [], processes: true, centre: null, batches: true };

  constructor(take: (message: ToWindow) => void) {
    this.worker.onmessage = (event: MessageEvent<ToWindow>) => {
      if (event.data.kind === "received") this.received = event.data.received;
      try {
        take(event.data);
      } finally {
        // A chunk that could not be shown must not hold up those after it.
        if (event.data.kind === "chunk") this.send({ kind: "taken", count: 1 });
      }
    };
  }

  connect(): void {
    const url = new URL("live", document.baseURI);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    this.send({ kind: "connect", url: url.href });
    this.setWant({});
  }

  /** Says what the page wants to be sent from now on; what is not named stays as it is. */
  setWant(change: Partial<Want>): void {
    this.want = { ...this.want, ...change };
    this.send({ kind: "want", want: this.want });
  }

  /** Wants a moment of a log; null = the newest one. */
  setMoment(frames: number | null): void {
    this.send({ kind: "moment", frames });
  }

  /** What comes waits while the page is paused. */
  setPaused(paused: boolean): void {
    this.send({ kind: "pause", paused });
  }

  private send(message: ToWorker): void {
    this.worker.postMessage(message);
  }
}
