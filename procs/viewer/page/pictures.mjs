// Takes pictures of a running viewer's page: pictures.mjs ADDRESS FOLDER [MIN_REVISION]. Needs the Debian package chromium.
// It waits until the page draws all that the server has, of at least MIN_REVISION frames (1).
import { mkdir } from "node:fs/promises";
import { join } from "node:path";
import { chromium } from "playwright-core";

const [address, folder, least = "1"] = process.argv.slice(2);
if (!address || !folder) {
  console.error("Usage: pictures.mjs ADDRESS FOLDER [MIN_REVISION]");
  process.exit(2);
}
await mkdir(folder, { recursive: true });
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});

/** A page of this size that draws all that the server has. */
async function open(width, height, colorScheme) {
  const page = await browser.newPage({ viewport: { width, height }, colorScheme, reducedMotion: "reduce" });
  await page.goto(address);
  await page.waitForFunction(
    (revision) => {
      const now = window.vismap;
      return now?.server && now.revision >= revision && now.digest === now.server.digest && now.blocks === now.server.blocks && now.objects > 0;
    },
    Number(least),
    { timeout: 300000, polling: 200 },
  );
  await page.waitForTimeout(1500);
  return page;
}

async function shoot(page, name) {
  await page.waitForTimeout(1200);
  await page.screenshot({ path: join(folder, `${name}.png`) });
  console.log(join(folder, `${name}.png`));
}

const wide = await open(1280, 800, "light");
await shoot(wide, "objects");
// The one of the README, in fewer bytes.
await wide.screenshot({ path: join(folder, "objects.jpg"), type: "jpeg", quality: 82 });
await wide.selectOption("#colouring", "rgb");
await wide.keyboard.press("n");
await shoot(wide, "selected");
if (await wide.locator(".thumbnails button").count()) {
  await wide.locator(".thumbnails button").first().click();
  await shoot(wide, "frame");
  await wide.keyboard.press("Escape");
}
await wide.keyboard.press("Escape");
await wide.keyboard.press("r");
await wide.keyboard.press("h");
await wide.click("#tab-space");
await wide.getByLabel("distances as contours").check();
await shoot(wide, "free-space");
await wide.keyboard.press("h");
await wide.click("#tab-processes");
await shoot(wide, "processes");
console.log(JSON.stringify(await wide.evaluate(() => window.vismap.latency)));
await wide.close();
const dark = await open(1024, 640, "dark");
await dark.selectOption("#colouring", "class");
await shoot(dark, "dark");
await dark.close();
const phone = await open(390, 844, "light");
await shoot(phone, "phone");
await browser.close();
