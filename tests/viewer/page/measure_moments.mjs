// Measures how long the page of a log takes to show another moment: measure_moments.mjs ADDRESS [JUMPS]
// From the wish (the slider stands still) to the drawing of exactly that map, in Chromium. Prints JSON.
import { createRequire } from "node:module";
import { join } from "node:path";
import { page as source } from "./load.mjs";

const [address, jumps = "30"] = process.argv.slice(2);
if (!address) {
  console.error("Usage: measure_moments.mjs ADDRESS [JUMPS]");
  process.exit(2);
}
const { chromium } = createRequire(join(source, "package.json"))("playwright-core");
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, reducedMotion: "reduce" });
await page.goto(address);

let timeline;
do {
  await new Promise((resolve) => setTimeout(resolve, 500));
  timeline = await (await fetch(new URL("api/timeline", address))).json();
} while (!timeline.done);
const { frames } = timeline;

/** Goes to a moment; answers the time [ms] until it was drawn. */
async function goTo(moment) {
  const before = await page.evaluate(() => window.vismap.moment.count);
  await page.evaluate((wanted) => window.vismap.goTo(wanted), moment);
  await page.waitForFunction((wanted) => window.vismap.moment.isDone && window.vismap.moment.shown === wanted, moment, { timeout: 60000, polling: 10 });
  const after = await page.evaluate(() => window.vismap.moment);
  return after.count > before ? after.last : 0;
}

function summary(times) {
  const sorted = [...times].sort((a, b) => a - b);
  const at = (share) => Math.round(sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))]);
  return { count: sorted.length, p50: at(0.5), p95: at(0.95), max: at(1) };
}

await goTo(frames.at(-1));
await page.waitForTimeout(1500);
let random = 12345;
const next = () => (random = (1103515245 * random + 12345) % 2 ** 31) / 2 ** 31;
const far = [];
const near = [];
const bytesBefore = await page.evaluate(() => window.vismap.received.bytes);
for (let i = 0; i < Number(jumps); ++i) {
  const at = Math.floor(next() * frames.length);
  far.push(await goTo(frames[at]));
  await page.waitForTimeout(700);
}
const bytes = (await page.evaluate(() => window.vismap.received.bytes)) - bytesBefore;
for (let i = 0; i < Number(jumps); ++i) {
  const at = Math.floor((0.1 + 0.8 * next()) * frames.length);
  await goTo(frames[at]);
  await page.waitForTimeout(500);
  near.push(await goTo(frames[at + 1] ?? frames.at(-1)));
  await page.waitForTimeout(500);
}
await goTo(frames.at(-1));
const now = await page.evaluate(() => ({ blocks: window.vismap.blocks, triangles: window.vismap.triangles }));
console.log(JSON.stringify({ moments: frames.length, ...now, jump_ms: summary(far), step_ms: summary(near), mb_per_jump: Number((bytes / 1e6 / Number(jumps)).toFixed(2)) }));
await browser.close();
