/** The worker: receives, decodes and merges, so that the window only draws. */
import { blocksOfBatch, decodeBlock, kBatchKind, kBlockKind, type Block } from "./block_codec";
import { ChunkStore } from "./chunk_store";
import { sameDigest } from "./digest";
import { Hold } from "./hold";
import { LiveLink } from "./live_link";
import { decodePicture, kPictureKind } from "./picture_codec";
import { parseMessage, type MapMessage, type ServerMessage } from "./protocol";
import { Staleness } from "./staleness";
import type { ToWindow, ToWorker } from "./worker_messages";

const kMergeInterval = 120; // [ms] between two rounds of merging
const kMomentInterval = 700; // [ms] the same while blocks of a moment of a log come: most chunks get several
const kMostUntaken = 6; // chunks that the window has not taken yet
const kMostUntakenOfMoment = 200; // the same of a complete moment of a log, which is drawn in one go

const scope = self as unknown as {
  postMessage(message: ToWindow, transfer?: Transferable[]): void;
  onmessage: ((event: MessageEvent<ToWorker>) => void) | null;
};

const store = new ChunkStore();
const staleness = new Staleness();
let link: LiveLink | null = null;
let mapId = "";
let untaken = 0;
let resyncs = 0;
let mergeTimer: ReturnType<typeof setTimeout> | null = null;
let isLog = false;
let server: MapMessage | null = null; // what it said last
const hold = new Hold();
let paused = false;

function tell(message: ToWindow, transfer: Transferable[] = []): void {
  scope.postMessage(message, transfer);
}

function tellReceived(): void {
  const received = {
    blocks: store.blockCount,
    triangles: store.triangles,
    digest: store.digestText,
    waiting: store.dirtyCount,
    bytes: link?.received ?? 0,
    resyncs,
  };
  tell({ kind: "received", received });
}

/** Sends chunks that changed, as many as the window keeps up with. */
function mergeSome(): void {
  mergeTimer = null;
  const most = isLog && isLevel() ? kMostUntakenOfMoment : kMostUntaken;
  while (untaken < most) {
    const changed = store.takeDirty();
    if (changed === null) break;
    const chunk = store.merge(changed.key, changed.arrivedAt);
    if (!chunk) {
      tell({ kind: "drop", key: changed.key });
      continue;
    }
    ++untaken;
    const { positions, normals, colours, segments, instances, classes, indices, coarse } = chunk;
    tell(
      { kind: "chunk", chunk },
      [positions, normals, colours, segments, instances, classes, indices, coarse].map((array) => array.buffer as ArrayBuffer),
    );
  }
  tellReceived();
}

function mergeSoon(): void {
  mergeTimer ??= setTimeout(mergeSome, isLog ? kMomentInterval : kMergeInterval);
}

/** Whether the page has all blocks that the server told of. */
function isLevel(): boolean {
  return server !== null && store.blockCount === server.blocks && sameDigest(store.digestText, server.digest);
}

/** When a moment of a log is complete, nothing is left to wait for. */
function mergeWhenComplete(): void {
  if (!isLog || !isLevel()) return mergeSoon();
  if (mergeTimer) clearTimeout(mergeTimer);
  mergeSome();
}

function takeMap(message: MapMessage): void {
  if (message.reset || (mapId !== "" && message.mapId !== mapId)) {
    store.clear();
    mergeSoon();
  }
  mapId = message.mapId;
  server = message;
  if (isLog && store.dirtyCount > 0) mergeWhenComplete();
  if (staleness.check(Date.now(), { blocks: store.blockCount, digest: store.digestText }, message)) {
    ++resyncs;
    link?.resync();
  }
}

function takeText(text: string): void {
  const message = parseMessage(text);
  if (!message) return;
  if (message.kind === "hello") isLog = message.mode === "log";
  if (paused && hold.keeps(message)) return tell({ kind: "held", updates: hold.behind });
  takeMessage(message);
}

function takeMessage(message: ServerMessage): void {
  if (message.kind === "map") takeMap(message);
  tell({ kind: "message", message });
}

function takeBlock(block: Block): void {
  if (paused) hold.keepBlock(block);
  else store.put(block);
}

/** Holds what comes, or goes on with the newest of everything. */
function setPaused(pause: boolean): void {
  if (pause === paused) return;
  paused = pause;
  if (pause) return hold.begin(mapId, server?.revision ?? 0);
  const { isReset, map, blocks, messages } = hold.release();
  if (isReset) store.clear();
  staleness.blockCame(Date.now());
  if (map) takeMessage(map); // first, since another map than before empties the store
  for (const block of blocks) store.put(block);
  for (const message of messages) takeMessage(message);
  mergeSoon();
}

function takeBytes(bytes: ArrayBuffer): void {
  const kind = bytes.byteLength > 0 ? new Uint8Array(bytes)[0] : -1;
  if (kind === kBlockKind) {
    takeBlock(decodeBlock(bytes));
    staleness.blockCame(Date.now());
    mergeWhenComplete();
  } else if (kind === kBatchKind) {
    for (const block of blocksOfBatch(bytes)) takeBlock(block);
    staleness.blockCame(Date.now());
    mergeWhenComplete();
  } else if (kind === kPictureKind) {
    const picture = decodePicture(bytes);
    tell({ kind: "picture", picture }, [bytes]);
  }
}

/** Runs a function; what it throws is told to the window, and the next message gets its chance. */
function guarded<T>(take: (value: T) => void): (value: T) => void {
  return (value) => {
    try {
      take(value);
    } catch (error) {
      tell({ kind: "problem", text: error instanceof Error ? error.message : String(error) });
    }
  };
}

function connect(url: string): void {
  link = new LiveLink(url, {
    onText: guarded(takeText),
    onBytes: guarded(takeBytes),
    onState: (state, text) => {
      if (state === "open") {
        // The server sends all blocks to a new client.
        if (paused) hold.reset();
        else store.clear();
        mergeSoon();
      }
      tell({ kind: "link", state, text });
    },
  });
  link.connect();
}

scope.onmessage = (event) => {
  const message = event.data;
  if (message.kind === "connect") connect(message.url);
  if (message.kind === "want") link?.setWant(message.want);
  if (message.kind === "moment") link?.setMoment(message.frames);
  if (message.kind === "pause") setPaused(message.paused);
  if (message.kind === "taken") {
    untaken -= message.count;
    if (store.dirtyCount > 0) mergeWhenComplete();
  }
};
