// Bundles the page: build.mjs [FOLDER], by default build/page of the repository.
import { build } from "esbuild";
import { cp, mkdir, readdir, readFile, rm, writeFile } from "node:fs/promises";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = resolve(process.argv[2] ?? join(here, "../../../build/page"));

/** The names of the packages that a bundle has code of. */
function packagesOf(metafile) {
  const names = new Set();
  for (const input of Object.keys(metafile.inputs)) {
    const found = /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(input);
    if (found) names.add(found[1]);
  }
  return [...names].sort();
}

/** Name, version, licence and the licence's text of a package. */
async function licenceOf(name) {
  const folder = join(here, "node_modules", name);
  const about = JSON.parse(await readFile(join(folder, "package.json"), "utf8"));
  const file = (await readdir(folder)).find((entry) => /^licen[cs]e/i.test(entry));
  if (!file) throw new Error(`${name}: the package has no file with its licence, so it cannot be shipped`);
  const text = await readFile(join(folder, file), "utf8");
  return `${name} ${about.version} (${about.license})\n\n${text.trim()}\n`;
}

await rm(out, { recursive: true, force: true });
await mkdir(out, { recursive: true });
const result = await build({
  absWorkingDir: here,
  entryPoints: { app: "src/app.ts", worker: "src/worker.ts" },
  outdir: out,
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  metafile: true,
  legalComments: "none",
  logLevel: "warning",
});
// The script of `vismap-map report`, which stands in the report itself: one classic script, with the licences in it.
const report = { absWorkingDir: here, entryPoints: ["src/report.ts"], bundle: true, minify: true, format: "iife", target: "es2022",
  metafile: true, legalComments: "none", logLevel: "warning", write: false };
const reportPackages = packagesOf((await build(report)).metafile);
const banner = (await Promise.all(reportPackages.map(licenceOf))).join("\n").replaceAll("*/", "* /");
await build({ ...report, write: true, outfile: join(out, "report.js"), banner: { js: `/*\n${banner}*/` } });
const charts = await readFile(join(here, "node_modules/uplot/dist/uPlot.min.css"), "utf8");
const style = await readFile(join(here, "style.css"), "utf8");
await writeFile(join(out, "style.css"), `${charts}\n${style}`);
await cp(join(here, "index.html"), join(out, "index.html"));
const packages = [...new Set([...packagesOf(result.metafile), "uplot"])].sort();
const licences = await Promise.all(packages.map(licenceOf));
await writeFile(join(out, "LICENSES.txt"), licences.join("\n----------------------------------------\n\n"));
