/** The memory of the map by layer: a table with a bar for each, the largest first. */
import { bytesText, el } from "./dom";

/** What each layer is, for the title of its row. */
const kLayers: Record<string, string> = {
  distances: "distances, weights and counts of voxels",
  colours: "colours of voxels",
  labels: "votes for labels, and what is known of each label",
  packed: "all layers of blocks that no camera has seen for a while, packed",
  spare: "room that packed voxels have left, for the next ones",
  free_space: "space that was seen empty, and hits of thin things",
  table: "the table of blocks",
  surface: "what the surface and objects are followed by",
  occupancy: "what changes of free space are found by",
  objects: "objects that were published",
  trajectory: "poses of the frames",
  copies: "copies of tables for requests that are being answered",
};

export interface MemoryRow {
  name: string;
  title: string;
  size: number; // [bytes]
  share: number; // of all layers, 0 to 1
}

export function memoryRows(bytes: Record<string, number>): MemoryRow[] {
  const total = Object.values(bytes).reduce((sum, size) => sum + size, 0);
  return Object.entries(bytes)
    .filter(([, size]) => size > 0)
    .sort((a, b) => b[1] - a[1])
    .map(([name, size]) => ({ name: name.replaceAll("_", " "), title: kLayers[name] ?? "", size, share: size / total }));
}

/** Nothing when no layer is known. */
export function memoryTable(bytes: Record<string, number>): HTMLElement[] {
  const rows = memoryRows(bytes);
  if (rows.length === 0) return [];
  const total = rows.reduce((sum, row) => sum + row.size, 0);
  const body = rows.map((row) => {
    const bar = el("span", { class: "level", "aria-hidden": "true" });
    bar.style.width = `${Math.max(1, 100 * row.share)}%`;
    const cells = [el("td", {}, bytesText(row.size)), el("td", {}, `${(100 * row.share).toFixed(0)} %`), el("td", { class: "levels" }, bar)];
    return el("tr", { title: row.title }, el("th", { scope: "row" }, row.name), ...cells);
  });
  return [el("h2", {}, `Memory of the map: ${bytesText(total)}`), el("table", { class: "memory", "aria-label": "Memory of the map by layer" }, el("tbody", {}, ...body))];
}
