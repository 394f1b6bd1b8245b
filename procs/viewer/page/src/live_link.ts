/** The WebSocket to vismap-viewer: connects, and connects again whenever the connection was lost. */
import type { LinkState, Want } from "./worker_messages";

export interface LinkHandlers {
  onText(text: string): void;
  onBytes(bytes: ArrayBuffer): void;
  onState(state: LinkState, text: string): void;
}

const kFirstWait = 500; // [ms]
const kLongestWait = 5000; // [ms]
const kAckInterval = 100; // [ms]
const kMomentInterval = 100; // [ms]
const kWantInterval = 100; // [ms], since the server closes the connection at 50 messages per second

export class LiveLink {
  private socket: WebSocket | null = null;
  private wait = kFirstWait;
  private want: Want | null = null;
  private bytes = 0;
  private ackTimer: ReturnType<typeof setTimeout> | null = null;
  private wantTimer: ReturnType<typeof setTimeout> | null = null;
  private moment: number | null | undefined = undefined; // of a log; undefined = none was wanted yet
  private sentMoment: number | null | undefined = undefined;
  private momentTimer: ReturnType<typeof setTimeout> | null = null;

  constructor(
    private readonly url: string,
    private readonly handlers: LinkHandlers,
  ) {}

  /** Bytes of binary messages that came over this connection. */
  get received(): number {
    return this.bytes;
  }

  connect(): void {
    this.handlers.onState("connecting", "");
    const socket = new WebSocket(this.url);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.opened(socket);
    socket.onclose = (event) => this.closed(event);
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => this.take(event.data);
    this.socket = socket;
  }

  /** Says what the page wants; of several wishes in a short time only the last is sent. */
  setWant(want: Want): void {
    this.want = want;
    this.wantTimer ??= setTimeout(() => {
      this.wantTimer = null;
      this.send({ kind: "want", ...this.want });
    }, kWantInterval);
  }

  /** Says which moment of a log the page wants: the first wish at once, further ones now and then. */
  setMoment(frames: number | null): void {
    this.moment = frames;
    if (this.momentTimer) return;
    this.sendMoment();
    this.momentTimer = setTimeout(() => {
      this.momentTimer = null;
      if (this.moment !== undefined && this.moment !== this.sentMoment) this.setMoment(this.moment);
    }, kMomentInterval);
  }

  resync(): void {
    this.send({ kind: "resync" });
  }

  private opened(socket: WebSocket): void {
    this.socket = socket;
    this.wait = kFirstWait;
    this.bytes = 0;
    this.handlers.onState("open", "");
    if (this.want) this.send({ kind: "want", ...this.want });
    if (this.moment !== undefined) this.sendMoment();
  }

  private sendMoment(): void {
    this.sentMoment = this.moment;
    this.send({ kind: "moment", frames: this.moment });
  }

  private closed(event: CloseEvent): void {
    this.socket = null;
    this.handlers.onState("closed", event.reason);
    setTimeout(() => this.connect(), this.wait);
    this.wait = Math.min(2 * this.wait, kLongestWait);
  }

  private take(data: string | ArrayBuffer): void {
    if (typeof data === "string") {
      this.handlers.onText(data);
      return;
    }
    this.bytes += data.byteLength;
    this.handlers.onBytes(data);
    this.ackTimer ??= setTimeout(() => {
      this.ackTimer = null;
      this.send({ kind: "ack", bytes: this.bytes });
    }, kAckInterval);
  }

  private send(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
}
