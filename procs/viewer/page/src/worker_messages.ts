/** What the page's window and its worker say to each other. */
import type { Chunk } from "./chunk_store";
import type { Picture } from "./picture_codec";
import type { ServerMessage } from "./protocol";

/** What the page would like to be sent. */
export interface Want {
  mesh: boolean;
  pictures: number[]; // camera ids
  processes: boolean;
  centre: [number, number, number] | null; // blocks near it come first
  batches: boolean; // several blocks may come in one message
}

export type LinkState = "connecting" | "open" | "closed";

/** What the worker has received so far. */
export interface Received {
  blocks: number;
  triangles: number;
  digest: string;
  waiting: number; // chunks that changed and are not on their way to the window yet
  bytes: number; // of all binary messages of this connection
  resyncs: number; // how often all blocks were asked for again
}

export type ToWindow =
  | { kind: "link"; state: LinkState; text: string }
  | { kind: "message"; message: ServerMessage }
  | { kind: "chunk"; chunk: Chunk }
  | { kind: "drop"; key: string }
  | { kind: "received"; received: Received }
  | { kind: "picture"; picture: Picture }
  | { kind: "held"; updates: number } // the page is paused, and lacks so many updates of the map
  | { kind: "problem"; text: string };

export type ToWorker =
  | { kind: "connect"; url: string }
  | { kind: "want"; want: Want }
  | { kind: "moment"; frames: number | null } // of a log; null = the newest one
  | { kind: "pause"; paused: boolean }
  | { kind: "taken"; count: number }; // the window has taken so many chunks
