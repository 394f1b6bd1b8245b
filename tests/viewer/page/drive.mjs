// Opens a page in Chromium and does what it is told: drive.mjs ADDRESS. Each line of standard input is a piece of JavaScript
// with `page` (of playwright); its value, or {"error": text}, is printed as one line of JSON.
import { createRequire } from "node:module";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { page as source } from "./load.mjs";

const { chromium } = createRequire(join(source, "package.json"))("playwright-core");
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const page = await browser.newPage({ viewport: { width: 1000, height: 640 }, reducedMotion: "reduce" });
page.setDefaultTimeout(30000);
const problems = []; // exceptions in the page
page.on("pageerror", (error) => problems.push(error.message));
if (process.argv[2].startsWith("file:")) {
  // A file must need nothing else.
  page.on("console", (message) => message.type() === "error" && problems.push(message.text()));
  page.on("request", (request) => /^(file|data|blob):/.test(request.url()) || problems.push(request.url()));
}
await page.goto(process.argv[2]);

const AsyncFunction = (async () => {}).constructor;
for await (const line of createInterface({ input: process.stdin })) {
  let answer;
  try {
    answer = (await new AsyncFunction("page", "problems", line)(page, problems)) ?? null;
  } catch (error) {
    answer = { error: String(error.message) };
  }
  console.log(JSON.stringify(answer));
}
await browser.close();
