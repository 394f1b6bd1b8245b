/** The page: makes its parts and leads messages from one to the other. */
import { Banners } from "./banners";
import { CameraPanel } from "./camera_panel";
import { CameraScene, sightOf } from "./camera_scene";
import { makeCommands, makeToggles } from "./commands";
import { byId } from "./dom";
import { EvidenceDialog } from "./evidence_dialog";
import { EvidenceStrip } from "./evidence_strip";
import { Framing } from "./framing";
import { FreeSpacePanel } from "./free_space_panel";
import { fillHelp, listenForKeys } from "./help";
import { Latency } from "./latency";
import { showLegend } from "./legend";
import { MapStatus } from "./map_status";
import { ObjectCard } from "./object_card";
import { ObjectList } from "./object_list";
import { readObject, type MapObject } from "./objects";
import type { Colouring } from "./painting";
import { ProcessPanel } from "./process_panel";
import { detectionDelays } from "./process_summary";
import type { MapMessage, ServerMessage } from "./protocol";
import { Selection } from "./selection";
import { SelectionBox } from "./selection_box";
import { StructureFeed } from "./structure_feed";
import { Surface } from "./surface";
import { Tabs } from "./tabs";
import { TimeControls } from "./time_controls";
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
const framing = new Framing(view, surface.bounds);
const box = new SelectionBox(byId("labels", HTMLElement));
const latency = new Latency();
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
const time = new TimeControls(view, surface, status, () => worker);
const processPanel = new ProcessPanel(byId("processes", HTMLElement));

const filter = byId("filter", HTMLInputElement);
const list = new ObjectList(byId("object-lists", HTMLElement), filter, byId("found", HTMLElement), (id) => {
  selection.select(selection.id === id ? null : id, true);
});
const evidenceDialog = new EvidenceDialog(byId("evidence", HTMLDialogElement), (frame) => {
  const { position, target } = sightOf(frame);
  view.lookFrom(position, target);
});
const card = new ObjectCard(
  byId("details", HTMLElement),
  new EvidenceStrip((object, frames, at) => evidenceDialog.open(object, frames, at)),
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
  const turned = view.setUp(up);
  surface.setUp(up);
  space.setUp(up);
  if (turned) framing.turn();
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

function takeMap(message: MapMessage): void {
  const before = status.map;
  if (status.takeMap(message)) {
    structure = [];
    listed = [];
    structureFeed.reset();
    cameras.clear();
    space.forget();
    showObjects();
  }
  if (before && before.revision !== message.revision) space.refreshSoon(status.isLog ? 300 : 2000);
  time.takeMap(message);
  processPanel.setMemory(message.bytes);
  space.setVoxel(message.voxelSize);
  if (message.up) setUp(message.up);
  void structureFeed.refresh(message.revision);
}

function takeMessage(message: ServerMessage): void {
  switch (message.kind) {
    case "hello":
      return time.takeHello(message);
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
      cameraPanel.setDelays(detectionDelays(message.processes));
      return processPanel.take(message.processes, message.utime);
    case "navigation":
      return status.takeNavigation(message);
    case "notice":
      if (message.id === "") return banners.flash(message.level, message.text);
      return banners.hold(`notice ${message.id}`, message.level, message.text);
    case "timeline":
      return time.bar.take(message);
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
      latency.arrived(message.chunk.arrivedAt);
      space.setBounds(surface.bounds);
      if (surface.colouring === "height") updateLegend();
      return view.surfaceChanged();
    case "drop":
      surface.drop(message.key);
      return view.surfaceChanged();
    case "held":
      return time.pause.takeBehind(message.updates);
    case "received":
      framing.keep(status.isLog);
      return time.check();
    case "picture":
      return cameraPanel.takePicture(message.picture);
    case "problem":
      console.warn(message.text);
      return banners.flash("warning", `A message of the server could not be used: ${message.text}`);
    default:
  }
}

view.addDetailHandler((coarse) => surface.setCoarse(coarse));
view.addAfterRender(() => latency.drawn(Date.now()));
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

const toggles = makeToggles((both) => {
  surface.setBothSides(both);
  view.invalidate();
});
const commands = makeCommands({ view, surface, selection, tabs, space, theme, toggles, filter, help, setColouring, colouring, time });
fillHelp(help, commands);
listenForKeys(commands);
byId("help-button", HTMLButtonElement).addEventListener("click", () => help.showModal());
byId("show-all", HTMLButtonElement).addEventListener("click", () => view.showAll(surface.bounds));
colouring.addEventListener("change", () => setColouring(colouring.value as Colouring));

const worker = new WorkerClient(take);
view.addMovedHandler(() => worker.setWant({ centre: view.target.toArray() }));
if (!view.canDraw) banners.hold("webgl", "warning", "This browser has no WebGL 2, so there is no 3-D view. The lists work all the same.");
publishForTests({ view, surface, selection, status, worker, space, latency, timeline: time.bar });
updateLegend();
worker.connect();
