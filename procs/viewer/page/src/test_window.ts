/** What tests and curious people may read: window.vismap. */
import type { FreeSpacePanel } from "./free_space_panel";
import type { Latency } from "./latency";
import type { MapStatus } from "./map_status";
import type { Selection } from "./selection";
import type { Surface } from "./surface";
import type { TimelineBar } from "./timeline_bar";
import type { View } from "./view";
import type { WorkerClient } from "./worker_client";

interface Parts {
  view: View;
  surface: Surface;
  selection: Selection;
  status: MapStatus;
  worker: WorkerClient;
  space: FreeSpacePanel;
  latency: Latency;
  timeline: TimelineBar;
}

function snapshot({ view, surface, selection, status, worker, space, latency, timeline }: Parts): object {
  return {
    blocks: surface.blocks, // drawn
    triangles: surface.triangles,
    chunks: surface.chunks,
    received: worker.received,
    digest: worker.received.digest,
    revision: status.map?.revision ?? -1,
    mapId: status.map?.mapId ?? "",
    server: status.map,
    objects: selection.objects.length,
    selected: selection.id,
    colouring: surface.colouring,
    latency: latency.summary(), // [ms] from the arrival of a block to its drawing
    moment: { shown: timeline.watch.shown, isDone: timeline.watch.isDone, ...timeline.watch.summary() }, // [ms] from the wish to the drawing
    goTo: (frames: number) => timeline.goTo(frames),
    renderCount: view.renderCount,
    drawCalls: view.drawCalls,
    pixelRatio: view.pixelRatio,
    camera: view.camera.position.toArray(),
    slices: space.counts(), // cells of each slice: unknown, free, occupied
    sliceLines: space.drawn, // of the horizontal one
    project: (x: number, y: number, z: number) => view.project(x, y, z),
    target: view.target.toArray(),
  };
}

/** Every read of window.vismap computes its members anew. */
export function publishForTests(parts: Parts): void {
  Object.defineProperty(window, "vismap", { get: () => snapshot(parts), configurable: true });
}
