import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { page } from "./load.mjs";

const out = mkdtempSync(join(tmpdir(), "vismap-page-"));
after(() => rmSync(out, { recursive: true }));

test("The page's TypeScript has no error of types", () => {
  execFileSync(process.execPath, [join(page, "node_modules/typescript/bin/tsc"), "-p", page], { stdio: "pipe" });
});

test("The built page is complete, loads nothing from elsewhere and has the licences of what it contains", () => {
  execFileSync(process.execPath, [join(page, "build.mjs"), out], { stdio: "pipe" });
  assert.deepEqual(readdirSync(out).sort(), ["LICENSES.txt", "app.js", "index.html", "report.js", "style.css", "worker.js"]);
  for (const file of ["index.html", "style.css"]) {
    assert.doesNotMatch(readFileSync(join(out, file), "utf8"), /(?:src|href)=["']?(?:https?:)?\/\/|url\(|@import/, file);
  }
  const licences = readFileSync(join(out, "LICENSES.txt"), "utf8");
  for (const name of ["three", "three-mesh-bvh", "uplot"]) assert.match(licences, new RegExp(`^${name} [0-9.]+ \\(MIT\\)$`, "m"));
  const report = readFileSync(join(out, "report.js"), "utf8");
  assert.match(report, /^\/\*\nthree [0-9.]+ \(MIT\)\n[^]*Permission is hereby granted/);
  assert.doesNotMatch(report, /<\/script/); // it stands in a page
});

test("The lockfile names no registry", () => {
  assert.doesNotMatch(readFileSync(join(page, "package-lock.json"), "utf8"), /"resolved"|https?:/);
});

test("No module is longer than 250 lines", () => {
  for (const name of readdirSync(join(page, "src"))) {
    const lines = readFileSync(join(page, "src", name), "utf8").split("\n").length;
    assert.ok(lines <= 250, `${name} has ${lines} lines`);
  }
});
