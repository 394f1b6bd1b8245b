import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";

const { readEvidence, pictureUrl, frameName } = await load("evidence");
const kPose = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const frame = (more) => ({ camera_id: 2, utime: 1234567, pixels: 900, share: 0.5, T_W_C: kPose, width: 320, height: 240, url: "/api/frame/2/1234567.jpg?id=s12", ...more });

test("Frames are read; those that cannot be shown are left out", () => {
  const list = readEvidence({ frames: [frame({ detection: { class_name: "cup", score: 0.514 } }), frame({ url: "http://evil.example/a.jpg" }),
    frame({ url: "//evil.example/api/frame/a.jpg" }), frame({ T_W_C: [1, 2] }), 7, null], why: "" });
  assert.equal(list.frames.length, 1);
  const [only] = list.frames;
  assert.equal(only.said, "cup 51 %");
  assert.equal(only.cameraId, 2);
  assert.equal(frameName(only), "camera 2, 1.23 s");
  assert.deepEqual(readEvidence(null), { frames: [], why: "" });
  assert.equal(readEvidence({ frames: [], why: "none is kept" }).why, "none is kept");
});

test("Addresses of pictures are relative, with the mask only when it is wanted", () => {
  const [only] = readEvidence({ frames: [frame()] }).frames;
  const colour = [255, 8, 0];
  assert.equal(pictureUrl(only, { mask: false, colour }), "api/frame/2/1234567.jpg");
  assert.equal(pictureUrl(only, { mask: true, colour }), "api/frame/2/1234567.jpg?id=s12&color=ff0800");
  assert.equal(pictureUrl(only, { mask: false, colour, width: 160 }), "api/frame/2/1234567.jpg?width=160");
});
