/** The page: makes its parts and leads messages from one to the other. */
import { Banners } from "./banners";
import { CameraPanel } from "./camera_panel";
import { CameraScene, sightOf } from "./camera_scene";
import { byId } from "./dom";
import { FreeSpacePanel } from "./free_space_panel";
import { fillHelp, listenForKeys, type Command } from "./help";
import { showLegend } from "./legend";
import { MapStatus } from "./map_status";
import { ObjectCard } from "./object_card";
import { ObjectList } from "./object_list";
import { readObject, type MapObject } from "./objects";
import { kColourings, type Colouring } from "./painting";
import { ProcessPanel } from "./process_panel";
import type { MapMessage, ServerMessage } from "./protocol";
import { Selection } from "./selection";
import { SelectionBox } from "./selection_box";
import { StructureFeed } from "./structure_feed";
import { Surface } from "./surface";
import { Tabs } from "./tabs";
import { publishForTests } from "./test_window";
import { ThemeSwitch } from "./theme";
import { View } from "./view";
import { WorkerClient } from "./worker_client";
import type { ToWindow } from "./worker_messages";

const canvas = byId("scene", HTMLCanvasElement);
const stage = byId("stage", HTMLElement);
const banners = new Banners(byId("banners", HTMLElement));
const status = new MapStatus(byId("link", HTMLElement), byId("summary", HTMLElement), banners);
const view = new View(canvas);
const surface = new Surface();
const box = new SelectionBox(byId("labels", HTMLElement));
const cameras = new CameraScene();
view.scene.add(surface.group, box.lines, cameras.group);
const space = new FreeSpacePanel(byId("space", HTMLElement), view.scene, () => view.invalidate());
const cameraPanel = new CameraPanel(byId("cameras", HTMLElement), {
  onLook: (camera) => {
    const { position, target } = sightOf(camera);
    view.lookFrom(position, target);
  },
  onWant: () => wantForTab(tabs.shown),
  lengthOf: (id) => cameras.lengthOf(id),
});
const processPanel = new ProcessPanel(byId("processes", HTMLElement));

const filter = byId("filter", HTMLInputElement);
const list = new ObjectList(byId("object-lists", HTMLElement), filter, byId("found", HTMLElement), (id) => {
  selection.select(selection.id === id ? null : id, true);
});
const card = new ObjectCard(
  byId("details", HTMLElement),
  (id) => status.hello?.classNames[String(id)] ?? `class ${id}`,
  () => selection.select(null, false),
  () => selection.flyToChosen(),
);
const selection = new Selection(view, surface, box, list, card);
const colouring = byId("colouring", HTMLSelectElement);

let listed: MapObject[] = [];
let structure: MapObject[] = [];
const structureFeed = new StructureFeed((answer, up) => {
  structure = answer;
  if (up) setUp(up);
  showObjects();
});

function showObjects(): void {
  const known = new Set(listed.map((object) => object.id));
  const all = [...listed, ...structure.filter((object) => !known.has(object.id))];
  selection.setObjects(all, status.map?.utime ?? 0);
  updateLegend();
}

function updateLegend(): void {
  showLegend(byId("legend", HTMLElement), surface.colouring, selection.objects, surface.heights);
}

function setUp(up: [number, number, number]): void {
  view.setUp(up);
  surface.setUp(up);
  space.setUp(up);
}

function setColouring(chosen: Colouring): void {
  colouring.value = chosen;
  surface.setColouring(chosen);
  updateLegend();
  view.invalidate();
}

/** Pictures are sent only while their panel is looked at. */
function wantForTab(panel: string): void {
  worker.setWant({ pictures: panel === "cameras" ? cameraPanel.wanted() : [] });
}

let sliceTimer: ReturnType<typeof setTimeout> | null = null;

/** A slice of a growing map is asked for again at most every two seconds. */
function refreshSlicesSoon(): void {
  sliceTimer ??= setTimeout(() => {
    sliceTimer = null;
    space.refresh();
  }, 2000);
}

let shownRadius = 0;

/** Keeps all of a growing map in view until a person has moved the camera. */
function keepInView(): void {
  if (view.touched || surface.bounds.isEmpty()) return;
  const radius = surface.bounds.min.distanceTo(surface.bounds.max) / 2;
  if (Math.abs(radius - shownRadius) < 0.05 * shownRadius) return;
  const first = shownRadius === 0;
  shownRadius = radius;
  view.showAll(surface.bounds, first);
}

function takeMap(message: MapMessage): void {
  if (status.map && status.map.mapId !== message.mapId) {
    structure = [];
    listed = [];
    structureFeed.reset();
    cameras.clear();
    showObjects();
  }
  if (status.map && status.map.revision !== message.revision) refreshSlicesSoon();
  status.takeMap(message);
  processPanel.setMemory(message.bytes);
  space.setVoxel(message.voxelSize);
  if (message.up) setUp(message.up);
  void structureFeed.refresh(message.revision);
}

function takeMessage(message: ServerMessage): void {
  switch (message.kind) {
    case "hello":
      return status.takeHello(message);
    case "map":
      return takeMap(message);
    case "objects":
      listed = message.objects.map(readObject);
      return showObjects();
    case "cameras":
      cameraPanel.setCameras(message.cameras);
      if (cameras.setCameras(message.cameras)) view.invalidateSoon();
      return;
    case "trajectory":
      cameras.extend(message);
      return view.invalidateSoon();
    case "processes":
      return processPanel.take(message.processes, message.utime);
    case "navigation":
      return status.takeNavigation(message);
    case "notice":
      if (message.id === "") return banners.flash(message.level, message.text);
      return banners.hold(`notice ${message.id}`, message.level, message.text);
  }
}

function take(message: ToWindow): void {
  switch (message.kind) {
    case "link":
      return status.takeLink(message.state, message.text);
    case "message":
      return takeMessage(message.message);
    case "chunk":
      surface.put(message.chunk);
      space.setBounds(surface.bounds);
      keepInView();
      if (surface.colouring === "height") updateLegend();
      return view.invalidateSoon();
    case "drop":
      surface.drop(message.key);
      return view.invalidateSoon();
    case "picture":
      return cameraPanel.takePicture(message.picture);
    case "problem":
      console.warn(message.text);
      return banners.flash("warning", `A message of the server could not be used: ${message.text}`);
    default:
  }
}

view.addDetailHandler((coarse) => surface.setCoarse(coarse));
view.addAfterRender(() => box.place(view.camera, stage.clientWidth, stage.clientHeight));
view.addClickHandler((ray) => {
  const hit = surface.pick(ray);
  const cell = space.pick(ray);
  if (cell && (!hit || cell.distance < hit.distance)) {
    tabs.open("space");
    void space.cell.ask([cell.point.x, cell.point.y, cell.point.z]);
    return;
  }
  if (hit) selection.selectAt(hit.instance, hit.segment);
  else selection.select(null, false);
  if (selection.id !== null) tabs.open("objects");
});

const tabs = new Tabs(document.querySelector<HTMLElement>('[role="tablist"]')!, (panel) => {
  wantForTab(panel);
  if (panel === "processes") processPanel.refresh();
});
const help = byId("help", HTMLDialogElement);
const theme = new ThemeSwitch(byId("theme", HTMLButtonElement), () => {
  view.setBackground(getComputedStyle(document.documentElement).getPropertyValue("--scene").trim());
});

function togglePanel(): void {
  const hide = document.body.dataset.panel !== "hidden";
  document.body.dataset.panel = hide ? "hidden" : "shown";
  byId("panel-button", HTMLButtonElement).setAttribute("aria-expanded", String(!hide));
}

function toggleBothSides(): void {
  const button = byId("both-sides", HTMLButtonElement);
  const both = button.getAttribute("aria-pressed") !== "true";
  button.setAttribute("aria-pressed", String(both));
  surface.setBothSides(both);
  view.invalidate();
}

const colouringCommands = kColourings.map((name, i): Command => {
  const text = `colour by ${colouring.options[i]!.text}`;
  return { keys: [String(i + 1)], text, run: () => setColouring(name) };
});
const commands: Command[] = [
  ...colouringCommands,
  { keys: ["r"], text: "show the whole map", run: () => view.showAll(surface.bounds) },
  { keys: ["+", "="], text: "nearer", run: () => view.zoom(0.8) },
  { keys: ["-"], text: "farther", run: () => view.zoom(1.25) },
  { keys: ["n"], text: "next object of the list", run: () => selection.step(1) },
  { keys: ["N"], text: "previous object of the list", run: () => selection.step(-1) },
  { keys: ["f", "/"], text: "filter the list of objects", run: () => (tabs.open("objects"), filter.focus()) },
  { keys: ["Escape"], text: "select nothing, leave a field", run: () => ((document.activeElement as HTMLElement | null)?.blur(), selection.select(null, false)) },
  { keys: ["h"], text: "horizontal slice of free space", run: () => space.toggleHorizontal() },
  { keys: ["v"], text: "vertical slice of free space", run: () => space.toggleVertical() },
  { keys: ["b"], text: "back faces on or off", run: toggleBothSides },
  { keys: ["p"], text: "hide or show the lists", run: togglePanel },
  { keys: ["t"], text: "dark or light", run: () => theme.toggle() },
  { keys: ["?"], text: "this help", run: () => (help.open ? help.close() : help.showModal()) },
];
fillHelp(help, commands);
listenForKeys(commands);
byId("help-button", HTMLButtonElement).addEventListener("click", () => help.showModal());
byId("panel-button", HTMLButtonElement).addEventListener("click", togglePanel);
byId("both-sides", HTMLButtonElement).addEventListener("click", toggleBothSides);
byId("show-all", HTMLButtonElement).addEventListener("click", () => view.showAll(surface.bounds));
colouring.addEventListener("change", () => setColouring(colouring.value as Colouring));

const worker = new WorkerClient(take);
view.addMovedHandler(() => worker.setWant({ centre: view.target.toArray() }));
publishForTests({ view, surface, selection, status, worker, space });
updateLegend();
worker.connect();
