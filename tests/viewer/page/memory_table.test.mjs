import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";

const { memoryRows } = await load("memory_table");

test("Layers stand by size, with their share; empty ones are left out", () => {
  const rows = memoryRows({ labels: 10e6, free_space: 30e6, packed: 0 });
  assert.deepEqual(rows.map((row) => [row.name, row.size, row.share]), [["free space", 30e6, 0.75], ["labels", 10e6, 0.25]]);
  assert.match(rows[0].title, /seen empty/);
  assert.deepEqual(memoryRows({}), []);
  assert.equal(memoryRows({ "of another version": 5 })[0].title, "");
});
