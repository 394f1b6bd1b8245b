import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";

const { mapChange } = await load("map_change");

const before = { mapId: "a", revision: 40, serverStart: 1000 };
const after = (changed) => mapChange(before, { ...before, ...changed });

test("A map that grows or stays is no change, nor is one that is not known yet", () => {
  assert.equal(after({}), null);
  assert.equal(after({ revision: 41 }), null);
  assert.equal(mapChange(null, before), null);
  assert.equal(after({ mapId: "", revision: -1 }), null, "a viewer that has just started");
  assert.equal(after({ mapId: "b", revision: -1 }), null);
  assert.equal(after({ serverStart: 2000 }), null, "a server that continues the same map");
});

test("Reset, another map, a restarted server and a map that went back are told apart", () => {
  assert.match(after({ mapId: "b", revision: 0 }).text, /was reset: it is empty/);
  assert.match(after({ mapId: "b", revision: 7 }).text, /another map now.*loaded.*has 7 frames/);
  assert.match(after({ mapId: "b", revision: 0, serverStart: 2000 }).text, /server was started again, and its map is empty/);
  assert.match(after({ mapId: "b", revision: 1, serverStart: 2000 }).text, /server was started again; its map has 1 frame\./);
  assert.match(after({ mapId: "b", revision: 0, serverStart: 0 }).text, /was reset/, "when the server was started is not known");
  const back = after({ revision: 12 });
  assert.equal(back.kind, "went back");
  assert.match(back.text, /corrected.*from 40 frames to 12 frames/);
});
