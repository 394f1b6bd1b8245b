// Bundles TypeScript modules of the page in memory, so that node can run them.
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
export const page = join(here, "../../../procs/viewer/page");
const require = createRequire(join(page, "package.json"));
const { build } = require("esbuild");

/** The exports of these modules of procs/viewer/page/src, as one object. */
export async function load(...names) {
  const contents = names.map((name) => `export * from "./${name}";`).join("\n");
  const result = await build({
    stdin: { contents, resolveDir: join(page, "src"), loader: "ts" },
    bundle: true,
    write: false,
    format: "esm",
    target: "es2022",
    logLevel: "error",
  });
  return import(`data:text/javascript;base64,${Buffer.from(result.outputFiles[0].contents).toString("base64")}`);
}
