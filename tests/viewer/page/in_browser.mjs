// Looks at the page with Chromium while a mock server serves a computed map of known counts.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync } from "node:fs";
import { execFileSync } from "node:child_process";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, beforeEach, test } from "node:test";
import { page as source } from "./load.mjs";
import { computedMap } from "./mock_map.mjs";
import { startMock } from "./mock_server.mjs";

const { chromium } = createRequire(join(source, "package.json"))("playwright-core");
const built = mkdtempSync(join(tmpdir(), "vismap-page-"));
const kWait = { timeout: 20000, polling: 100 };
let browser, mock, page, problems;

before(async () => {
  execFileSync(process.execPath, [join(source, "build.mjs"), built], { stdio: "pipe" });
  const args = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
});
after(async () => {
  await browser?.close();
  await mock?.close();
  rmSync(built, { recursive: true });
});

/** A fresh server with the computed room, and the page that has all of it. */
beforeEach(async () => {
  await page?.context().close();
  await mock?.close();
  const map = computedMap();
  map.still = true;
  mock = await startMock({ map, page: built });
  const context = await browser.newContext({ viewport: { width: 1000, height: 640 }, reducedMotion: "reduce", colorScheme: "light" });
  page = await context.newPage();
  problems = [];
  page.on("pageerror", (error) => problems.push(error.message));
  await page.goto(`http://127.0.0.1:${mock.port}/`);
  await complete();
});

const state = (name) => page.evaluate((key) => window.vismap[key], name);

/** Waits until the page draws exactly the blocks that the server has. */
async function complete() {
  const { map } = mock;
  const digest = map.summary().digest;
  await page.waitForFunction(([blocks, triangles, wanted]) => {
    const now = window.vismap;
    return now && now.blocks === blocks && now.triangles === triangles && now.digest === wanted;
  }, [map.blocks.size, map.triangles, digest], kWait);
}

/** Clicks where a point of W is drawn. */
async function clickAt(...point) {
  const [x, y] = await page.evaluate((p) => window.vismap.project(...p), point);
  await page.mouse.click(x, y);
}

/** How many pixels of the view have each colour, "r,g,b" in steps of 32. */
async function colours() {
  const png = (await page.locator("#scene").screenshot()).toString("base64");
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d");
    canvas.drawImage(image, 0, 0);
    const counts = {};
    const { data: rgba } = canvas.getImageData(0, 0, image.width, image.height);
    for (let i = 0; i < rgba.length; i += 4) {
      const key = [0, 1, 2].map((c) => rgba[i + c] >> 5).join();
      counts[key] = (counts[key] ?? 0) + 1;
    }
    return counts;
  }, png);
}

/** The colour of a point of the page. */
async function pixelAt([x, y]) {
  const image = (await page.screenshot({ clip: { x: Math.floor(x), y: Math.floor(y), width: 1, height: 1 } })).toString("base64");
  return page.evaluate(async (data) => {
    const picture = new Image();
    picture.src = `data:image/png;base64,${data}`;
    await picture.decode();
    const context = new OffscreenCanvas(1, 1).getContext("2d");
    context.drawImage(picture, 0, 0);
    return [...context.getImageData(0, 0, 1, 1).data.slice(0, 3)];
  }, image);
}

/** How many pixels differ, from two results of colours(). */
function difference(a, b) {
  return [...new Set([...Object.keys(a), ...Object.keys(b)])].reduce((sum, key) => sum + Math.abs((a[key] ?? 0) - (b[key] ?? 0)), 0) / 2;
}

test("The map is seen from above also when the upward direction comes late and is another one", async () => {
  // From above, what is nearest is lowest on the page. Nearest is where three short lines along the axes are longest together.
  const seenFromAbove = (upAxis) => page.evaluate((axis) => {
    const others = [0, 1, 2].filter((other) => other !== axis);
    const around = Array.from({ length: 16 }, (_, i) => {
      const p = [2, 1.5, 1];
      p[others[0]] += 0.5 * Math.cos((i * Math.PI) / 8);
      p[others[1]] += 0.5 * Math.sin((i * Math.PI) / 8);
      const [u, v] = window.vismap.project(...p);
      const ends = [0, 1, 2].map((a) => window.vismap.project(...p.map((value, i) => value + (i === a ? 0.05 : 0))));
      return { height: v, length: Math.hypot(...ends.map(([x, y]) => Math.hypot(u - x, v - y))) };
    });
    const nearest = around.reduce((best, one) => (one.length > best.length ? one : best));
    return nearest.height > window.vismap.project(2, 1.5, 1)[1] + 5;
  }, upAxis);
  assert.ok(await seenFromAbove(2));
  assert.ok(!(await seenFromAbove(1)));
  mock.map.up = [0, 1, 0];
  for (let tries = 0; tries < 50 && !(await seenFromAbove(1)); ++tries) await page.waitForTimeout(200);
  assert.ok(await seenFromAbove(1));
});

test("The page has what the server has, and draws nothing while nothing changes", async () => {
  await page.waitForTimeout(800);
  const drawn = await state("renderCount");
  await page.waitForTimeout(2500);
  assert.equal(await state("renderCount"), drawn, "a second statement of the same map is no reason to draw");
  assert.match(await page.textContent("#summary"), /102 blocks/);
  assert.deepEqual(problems, []);
});

test("A growing and shrinking map: counts and digest follow", async () => {
  const { map } = mock;
  map.revision = 2;
  map.remove([0, 0, 1]);
  map.remove([-5, -5, 0]);
  await complete();
  assert.equal(map.blocks.size, 100);
});

test("A paused page stays as it is and says what it lacks, until it goes on", async () => {
  const { map } = mock;
  const before = await state("blocks");
  await page.keyboard.press("Space");
  assert.equal(await page.textContent("#pause"), "Continue");
  const was = map.revision;
  map.revision = was + 2;
  map.remove([0, 0, 1]);
  map.remove([-5, -5, 0]);
  await page.waitForFunction(() => document.querySelector("#behind").textContent === "paused, 2 updates behind", null, kWait);
  await page.waitForTimeout(500);
  assert.equal(await state("blocks"), before);
  assert.equal(await state("revision"), was);
  await page.click("#pause");
  await complete();
  assert.equal(await page.isVisible("#behind"), false);
  assert.equal((await state("received")).resyncs, 0);
});

test("A paused page whose connection is lost has the right map when it goes on", async () => {
  await page.click("#pause");
  mock.dropClients();
  mock.map.revision += 1;
  mock.map.remove([0, 0, 1]);
  await page.waitForFunction(() => document.querySelector("#banners").textContent.includes("is back"), null, kWait);
  await page.waitForTimeout(1500);
  await page.click("#pause");
  await complete();
});

test("An object is picked by its pixel: selected, boxed with its sizes, with a link to its PLY, and put aside by Escape", async () => {
  await clickAt(0.2, 0.2, 0.6);
  assert.equal(await state("selected"), "7");
  assert.match(await page.textContent("#details"), /chair 7.*83 %/s);
  assert.deepEqual(await page.locator(".size-label:visible").allTextContents(), ["0.40 m", "0.40 m", "0.10 m"]);
  assert.equal(await page.getByRole("link", { name: "Download as PLY" }).getAttribute("href"), "api/object/7.ply");
  await page.keyboard.press("Escape");
  assert.equal(await state("selected"), null);
  await clickAt(-1.4, 1.0, 0.6);
  assert.equal(await state("selected"), "s12", "a discovered thing is picked by its segment");
});

/** Waits until the large picture is loaded; answers its colour in the middle. */
async function largePicture() {
  await page.waitForFunction(() => {
    const image = document.querySelector("#evidence img");
    return image.complete && image.naturalWidth > 0;
  }, null, kWait);
  return page.evaluate(() => {
    const image = document.querySelector("#evidence img");
    const canvas = new OffscreenCanvas(1, 1).getContext("2d");
    canvas.drawImage(image, 100, 100, 1, 1, 0, 0, 1, 1);
    return [...canvas.getImageData(0, 0, 1, 1).data].slice(0, 3);
  });
}

test("Frames in which an object was seen: small pictures, a large one with and without mask, keys, and a look from there", async () => {
  await page.getByRole("button", { name: "chair 7" }).click();
  await page.waitForSelector(".thumbnails button", kWait);
  assert.equal(await page.locator(".thumbnails li").count(), 3);
  await page.waitForFunction(() => document.querySelector(".thumbnails").textContent.includes("no longer kept"), null, kWait);
  assert.equal(await page.getByAltText(/chair 7 in the frame of camera 0, 90\.00 s/).count(), 1);
  await page.locator(".thumbnails button").first().click();
  assert.deepEqual(await largePicture(), [200, 30, 30]);
  assert.match(await page.textContent("#evidence figcaption"), /camera 0, 90\.00 s.*92 %.*chair 91 %/);
  await page.keyboard.press("m");
  assert.deepEqual(await largePicture(), [120, 120, 120]);
  await page.getByRole("checkbox", { name: "mask", exact: true }).check();
  await page.keyboard.press("ArrowRight");
  assert.match(await page.textContent("#evidence h2"), /chair 7, frame 2 of 3/);
  assert.match(await page.textContent("#evidence figcaption"), /camera 1/);
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => document.querySelector("#evidence [role=status]").textContent.includes("not kept"), null, kWait);
  await page.keyboard.press("ArrowRight");
  assert.match(await page.textContent("#evidence h2"), /frame 1 of 3/);
  await page.keyboard.press("Escape");
  assert.equal(await page.locator("#evidence").isVisible(), false);
  assert.equal(await state("selected"), "7", "Escape closes the picture alone");
  await page.locator(".thumbnails button").nth(1).click();
  await page.getByRole("button", { name: "Look from here" }).click();
  await page.waitForTimeout(700);
  const camera = await state("camera");
  assert.ok(Math.hypot(camera[0] - 0.2, camera[1] + 3, camera[2] - 0.6) < 0.05, `the view is at ${camera}`);
  await page.getByRole("button", { name: "thing s12" }).click();
  await page.waitForFunction(() => document.querySelector("#details").textContent.includes("no frame is kept yet"), null, kWait);
  assert.deepEqual(problems, []);
});

test("On a phone the picture of a frame fits", async () => {
  await page.setViewportSize({ width: 390, height: 844 });
  await page.getByRole("button", { name: "chair 7" }).click();
  const small = await page.locator(".thumbnails img").first().boundingBox();
  assert.ok(Math.abs(small.height - 0.75 * small.width) < 2, JSON.stringify(small));
  await page.locator(".thumbnails button").first().click();
  await largePicture();
  const frame = await page.locator("#evidence").boundingBox();
  assert.ok(frame.x >= 0 && frame.x + frame.width <= 390, JSON.stringify(frame));
  assert.ok((await page.locator("#evidence img").boundingBox()).height < 400);
  for (const name of ["‹ Previous", "Next ›", "Look from here", "Close"])
    assert.ok(await page.locator("#evidence").getByRole("button", { name }).isVisible(), name);
});

test("A click in the list flies there", async () => {
  await page.getByRole("button", { name: "thing s12" }).click();
  await page.waitForTimeout(700);
  const target = await state("target");
  assert.ok(Math.hypot(target[0] + 1.4, target[1] - 1.0, target[2] - 0.6) < 0.05, `the view's target is ${target}`);
});

test("Every colouring shows other colours", async () => {
  const seen = [];
  for (const name of ["instance", "class", "rgb", "height", "seen"]) {
    await page.selectOption("#colouring", name);
    await page.waitForTimeout(300);
    const now = await colours();
    for (const before of seen) assert.ok(difference(now, before) > 500, `${name} looks like another one`);
    seen.push(now);
  }
});

test("The list: groups, filter, sorting, keys", async () => {
  const groups = (await page.locator("details.group:visible > summary").allTextContents()).sort();
  assert.deepEqual(groups, ["Discovered things (1)", "Objects (1)", "Removed (1)", "Structure (1)"]);
  await page.keyboard.press("/");
  await page.keyboard.type("thing");
  assert.deepEqual(await page.locator(".name:visible").allTextContents(), ["thing s12"]);
  assert.equal(await page.textContent("#found"), "1 of 4");
  await page.keyboard.press("Escape");
  await page.fill("#filter", "");
  await page.keyboard.press("Escape");
  await page.keyboard.press("n");
  assert.equal(await state("selected"), "7");
  await page.keyboard.press("n");
  assert.equal(await state("selected"), "s12");
});

test("Slices: cells as the server says, drawn in their colours, and why a cell is so", async () => {
  const before = await colours();
  await page.keyboard.press("h");
  await page.click("#tab-space");
  await page.waitForFunction(() => window.vismap.slices.horizontal[1] > 0, null, kWait);
  const height = Number(await page.locator("#space input[type=range]").first().inputValue());
  const answer = await (await fetch(`http://127.0.0.1:${mock.port}/api/slice?axis=z&at=${height + 0.025}`)).arrayBuffer();
  const cells = new Uint8Array(answer).subarray(4 + new DataView(answer).getUint32(0, true));
  const counts = [0, 0, 0];
  for (const cell of cells) ++counts[cell];
  assert.deepEqual((await state("slices")).horizontal, counts);
  await page.waitForTimeout(400);
  assert.ok(difference(await colours(), before) > 5000);
  await page.locator("#space input[type=range]").first().fill("0.5");
  await page.waitForTimeout(800);
  await clickAt(1.01, -1.02, 0.525);
  await page.waitForSelector("#cell dd", kWait);
  const place = await page.textContent('#cell dd[data-key="at"]');
  place.split(", ").forEach((value, axis) => assert.ok(Math.abs(Number(value) - [1.01, -1.02, 0.525][axis]) < 0.02, place));
  assert.equal(await page.textContent('#cell dd[data-key="state"]'), "free");
  assert.equal(await page.getByRole("row", { name: /label 5 12 chair 7/ }).count(), 1);
});

test("Contours are those of the map's distances, with their metres, or of the slice where the server has none; leaves are squares and translucent boxes", async () => {
  await page.keyboard.press("h");
  await page.click("#tab-space");
  await page.waitForFunction(() => window.vismap.slices.horizontal[1] > 0, null, kWait);
  assert.deepEqual(await state("sliceLines"), { contours: 0, labels: 0, leaves: 0, boxes: { free: 0, occupied: 0 } });
  await page.locator("#space input[type=range]").first().fill("0.5");
  await page.getByLabel("distances as contours").check();
  await page.waitForFunction(() => window.vismap.sliceLines.contours > 0, null, kWait);
  const { contours, labels } = await state("sliceLines");
  assert.ok(labels >= 3, `${labels} labels`);
  assert.match(await page.textContent("#space"), /nearest obstacle in all directions/);
  const bare = await colours();
  const inFree = await page.evaluate(() => window.vismap.project(-1, -1, 1.39));
  const before = await pixelAt(inFree);
  await page.getByLabel("octree leaves").check();
  await page.waitForFunction(() => window.vismap.sliceLines.leaves === 3, null, kWait);
  await page.waitForTimeout(300);
  assert.ok(difference(await colours(), bare) > 100, "the squares are drawn");
  assert.deepEqual((await state("sliceLines")).boxes, { free: 2, occupied: 1 });
  const after = await pixelAt(inFree);
  const kFree = [86, 180, 233];
  const towards = (pixel) => pixel.reduce((sum, level, i) => sum + Math.abs(level - kFree[i]), 0);
  assert.ok(towards(after) < 0.95 * towards(before), `a free leaf is drawn: ${before} became ${after}`);
  assert.ok(towards(after) > 0.5 * towards(before), `and one sees through it: ${before} became ${after}`);
  mock.map.noExporter = true;
  await page.selectOption('[aria-label="Which octree"]', "closed");
  await page.waitForFunction(() => document.querySelector("#space").textContent.includes("in this slice alone"), null, kWait);
  assert.match(await page.textContent("#space"), /Leaves of the octree: no octomap exporter was heard/);
  const flat = await state("sliceLines");
  assert.equal(flat.leaves, 0);
  assert.notEqual(flat.contours, contours, "half a metre above the floor the floor is near");
  assert.ok(flat.contours > 0);
});

test("Processes: a silent one is red, with its last words; stage times are drawn", async () => {
  await page.click("#tab-processes");
  await page.waitForSelector("tr.stale", kWait);
  assert.match(await page.textContent("tr.stale"), /detector.*silent/);
  assert.match(await page.textContent("tr.stale + tr"), /the model could not be read/);
  await page.waitForSelector(".chart canvas", kWait);
  assert.match(await page.textContent("tbody tr:has-text('map-server')"), /12\/29/, "p50 and p95 of the slowest stage");
  const mesh = page.locator("table.stages tr", { hasText: "mesh" }).locator("td");
  assert.deepEqual(await mesh.allTextContents(), ["8.0", "14.0", "", ""]);
});

test("The camera's panel says how long after a frame its detections come", async () => {
  await page.click("#tab-cameras");
  await page.waitForFunction(() => document.querySelector("#cameras .card").textContent.includes("2 detections, which came after 140 ms (in the last minute p50 138 ms, p95 190 ms)"), null, kWait);
});

test("The memory of the map by layer is a table with bars", async () => {
  await page.click("#tab-processes");
  await page.waitForSelector("table.memory tr", kWait);
  assert.deepEqual(await page.locator("table.memory th").allTextContents(), ["distances", "labels", "free space"]);
  assert.deepEqual(await page.locator("table.memory tr").first().locator("td").allTextContents(), ["31.0 MB", "75 %", ""]);
  const widths = await page.locator("table.memory .level").evaluateAll((bars) => bars.map((bar) => bar.getBoundingClientRect().width));
  assert.ok(widths[0] > 3 * widths[1] && widths[1] > 2 * widths[2] && widths[2] > 0, `${widths}`);
});

test("Cameras: pictures are asked for only while they are looked at", async () => {
  const [client] = mock.clients;
  await page.click("#tab-cameras");
  await page.getByLabel("picture").first().check();
  await page.waitForTimeout(300);
  assert.deepEqual(client.want.pictures, [0]);
  await page.click("#tab-objects");
  await page.waitForTimeout(300);
  assert.deepEqual(client.want.pictures, []);
});

test("A lost connection is said and mends itself", async () => {
  mock.setRefuse(true);
  mock.dropClients();
  await page.waitForFunction(() => document.querySelector("#banners").textContent.includes("connection to the viewer is lost"), null, kWait);
  mock.setRefuse(false);
  await page.waitForSelector('#link[data-state="open"]', kWait);
  await complete();
  assert.doesNotMatch(await page.textContent("#banners"), /is lost/);
});

test("Another map takes the place of the old one, and the page says so", async () => {
  const { map } = mock;
  const wanted = [...map.blocks.keys()].filter((key) => key.startsWith("0,"));
  for (const key of [...map.blocks.keys()]) if (!wanted.includes(key)) map.remove(key.split(",").map(Number));
  map.mapId = "mock-2";
  for (const client of mock.clients) client.sent.clear();
  await complete();
  assert.equal(await state("mapId"), "mock-2");
  await said("another map now");
});

/** Waits until a banner says these words. */
function said(words) {
  return page.waitForFunction((text) => document.querySelector("#banners").textContent.includes(text), words, kWait);
}

/** Leaves these blocks of the map and takes away all others. */
function keepOnly(map, kept) {
  for (const key of [...map.blocks.keys()]) if (!kept(key)) map.remove(key.split(",").map(Number));
}

test("A reset map: the page says so, and is empty", async () => {
  const { map } = mock;
  keepOnly(map, () => false);
  Object.assign(map, { mapId: "mock-2", revision: 0, objects: [], structure: [] });
  for (const client of mock.clients) client.sent.clear();
  await said("The map was reset");
  await complete();
  assert.equal(await state("blocks"), 0);
  await page.waitForFunction(() => document.querySelector("#found").textContent === "no objects yet", null, kWait);
  assert.equal(await page.locator(".name:visible").count(), 0, "objects of the old map are gone");
});

test("A map server that was started again: the page says so, also when the connection was lost meanwhile", async () => {
  const { map } = mock;
  mock.setRefuse(true);
  mock.dropClients();
  await said("connection to the viewer is lost");
  keepOnly(map, (key) => key.startsWith("1,"));
  Object.assign(map, { mapId: "mock-2", revision: 3, serverStart: 2000 });
  mock.setRefuse(false);
  await said("server was started again; its map has 3 frames");
  await complete();
});

test("A map that goes back to an earlier revision: the page says so, and has that state", async () => {
  const { map } = mock;
  map.revision = 5;
  await page.waitForFunction(() => window.vismap.revision === 5, null, kWait);
  map.revision = 2;
  keepOnly(map, (key) => !key.startsWith("-5,"));
  await said("went back from 5 frames to 2 frames");
  await complete();
});

test("Blocks that got lost are asked for again", async () => {
  const { map } = mock;
  const [client] = mock.clients;
  map.revision = 2;
  const key = "0,0,1";
  const block = map.blocks.get(key);
  map.digest = BigInt.asUintN(64, map.digest + 1n);
  block.hash += 1n;
  block.bytes.writeBigUInt64LE(block.hash, 32); // the server has another block now and believes that the page has it
  await complete();
  assert.ok(client.said.some((message) => message.kind === "resync"));
  assert.equal((await state("received")).resyncs, 1);
});

test("Every control has a name, and the panels are tabs with arrow keys", async () => {
  for (const tab of ["#tab-objects", "#tab-space", "#tab-cameras", "#tab-processes"]) {
    await page.click(tab);
    const nameless = await page.evaluate(() => [...document.querySelectorAll("button, input, select, canvas, a")].filter((element) => {
      const label = element.getAttribute("aria-label") || element.textContent || (element.labels?.length ? element.labels[0].textContent : "");
      return element.checkVisibility() && !element.closest(".chart") && !label?.trim();
    }).map((element) => element.outerHTML));
    assert.deepEqual(nameless, [], tab);
  }
  await page.focus("#tab-processes");
  await page.keyboard.press("ArrowRight");
  assert.equal(await page.getAttribute("#tab-objects", "aria-selected"), "true");
  assert.equal(await page.locator("#objects").isVisible(), true);
});

test("Dark and light: the button changes both page and scene", async () => {
  const light = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  await page.click("#theme");
  assert.notEqual(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), light);
  await page.waitForTimeout(300);
  const dark = Object.entries(await colours()).filter(([key]) => key === "0,0,0").map(([, n]) => n)[0] ?? 0;
  assert.ok(dark > 50000, `${dark} dark pixels`);
});

test("On a phone nothing is wider than the screen", async () => {
  await page.setViewportSize({ width: 390, height: 844 });
  for (const tab of ["#tab-objects", "#tab-space", "#tab-cameras", "#tab-processes"]) {
    await page.click(tab);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390, tab);
  }
});

test("Turning the wheel fast does not send more than the server allows", async () => {
  const [client] = mock.clients;
  const before = client.said.length;
  const frame = await page.locator("#scene").boundingBox();
  await page.mouse.move(frame.x + 200, frame.y + 200);
  for (let i = 0; i < 120; ++i) await page.mouse.wheel(0, i % 2 === 0 ? 40 : -40);
  await page.waitForTimeout(1000);
  const wishes = client.said.slice(before).filter((message) => message.kind === "want");
  assert.ok(wishes.length >= 1 && wishes.length <= 60, `${wishes.length} wishes`);
  assert.equal(wishes.at(-1).centre.length, 3);
});

test("Without WebGL the lists work, and the page says why there is no view", async () => {
  const other = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--disable-3d-apis"] });
  try {
    const flat = await other.newPage();
    await flat.goto(`http://127.0.0.1:${mock.port}/`);
    await flat.getByRole("button", { name: "chair 7" }).click(kWait);
    assert.match(await flat.textContent("#details"), /chair 7/);
    assert.match(await flat.textContent("#banners"), /no WebGL 2/);
  } finally {
    await other.close();
  }
});
