/** The line about connection and map, and the banners that belong to them. */
import type { Banners } from "./banners";
import { bytesText, count, setText } from "./dom";
import { mapChange, shownMap, type MapChange, type ShownMap } from "./map_change";
import type { HelloMessage, MapMessage, NavigationMessage } from "./protocol";
import type { LinkState } from "./worker_messages";

const kOldMap = 5; // [s] without word from the map server

export class MapStatus {
  map: MapMessage | null = null;
  hello: HelloMessage | null = null;
  /** The newest map; a viewer that has just started knows none yet, which is no other map. */
  private shown: ShownMap | null = null;
  private wasOpen = false;

  constructor(
    private readonly link: HTMLElement,
    private readonly summary: HTMLElement,
    private readonly banners: Banners,
  ) {}

  takeLink(state: LinkState, text: string): void {
    this.link.dataset.state = state;
    setText(this.link, state === "open" ? (this.hello?.mode === "log" ? "log" : "live") : state === "closed" ? "not connected" : "connecting");
    if (state === "open") {
      this.banners.clear("link");
      if (this.wasOpen) this.banners.flash("info", "The connection is back.");
      this.wasOpen = true;
    } else if (state === "closed") {
      const why = text === "" ? "" : ` (${text})`;
      const what = this.wasOpen ? "The connection to the viewer is lost" : "The viewer cannot be reached";
      this.banners.hold("link", "error", `${what}${why}. What you see is old. Trying again …`);
    }
  }

  takeHello(hello: HelloMessage): void {
    this.hello = hello;
    setText(this.link, hello.mode === "log" ? "log" : "live");
    this.link.title = `vismap ${hello.version}, ${hello.source}`;
    const other = hello.protocol !== 1;
    this.banners.hold("protocol", "warning", other ? "This page is of another version than its server: reload it." : "");
  }

  get mapId(): string {
    return this.shown?.mapId ?? "";
  }

  /** Returns what has happened to the map since the last message. In a log, going back is no change: a person has asked for it. */
  takeMap(map: MapMessage): MapChange | null {
    const found = mapChange(this.shown, shownMap(map));
    const change = this.hello?.mode === "log" && found?.kind === "went back" ? null : found;
    if (change) this.banners.flash("warning", change.text);
    this.map = map;
    if (map.revision >= 0 && map.mapId !== "") this.shown = shownMap(map);
    const silent = map.revision >= 0 && map.age > kOldMap;
    this.banners.hold("age", "warning", silent ? "The map server is silent; what you see may be old." : "");
    this.banners.hold("sync", "info", map.inSync || map.revision < 0 ? "" : "Updates of the map are missing; they were asked for.");
    this.banners.hold("empty", "info", map.revision < 0 ? this.isLog ? "No frame of the log is mapped yet." : "There is no map yet: the viewer waits for the map server." : "");
    setText(this.summary, summaryText(map, silent));
    return change;
  }

  get isLog(): boolean {
    return this.hello?.mode === "log";
  }

  takeNavigation(message: NavigationMessage): void {
    this.banners.hold("navigation", "warning", message.message);
  }
}

function summaryText(map: MapMessage, silent: boolean): string {
  if (map.revision < 0) return "";
  const bytes = Object.values(map.bytes).reduce((sum, size) => sum + size, 0);
  const parts = [
    `${count(map.frames)} frames`,
    `${count(map.blocks)} blocks`,
    `${count(map.triangles)} triangles`,
    map.voxelSize > 0 ? `voxels of ${(100 * map.voxelSize).toFixed(1)} cm` : "",
    bytes > 0 ? bytesText(bytes) : "",
    map.waiting > 0 ? `${count(map.waiting)} blocks still to come` : "",
    // Here and not in the banner, which a screen reader would read out every second.
    silent ? `no word from the map server for ${Math.round(map.age)} s` : "",
  ];
  return parts.filter((part) => part !== "").join(" · ");
}
