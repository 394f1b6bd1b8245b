#!/usr/bin/env python3
"""The timeline of the page in Chromium, with a log. Exit code 77 = it cannot run here.

Usage: log_browser_test.py FOLDER_OF_PROGRAMS
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "viewer")]
import log_process_test as logs  # noqa: E402
from browser_test import PAGE, Browser, why_not  # noqa: E402
from web_client import get  # noqa: E402

FRAMES = logs.FRAMES
MOMENTS = (3, 9, 14, 20, FRAMES - 1)
LONGEST = 4000  # from the wish to the drawing [ms]; 200 are wanted of a computer that does nothing else
DONE = "await page.waitForFunction((frames) => window.vismap.moment.shown === frames, %d, {polling: 20, timeout: 60000})"


class TimelineTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        folder = pathlib.Path(temporary.name)
        subprocess.run(["node", PAGE / "build.mjs", folder / "built"], check=True, capture_output=True, timeout=60)
        cls.log = logs.make_log(folder / "room.lcmlog")
        config = folder / "coarse.txtpb"
        config.write_text("grid { voxel_size_m: 0.03 }")
        cls.viewer = logs.LogViewer(folder, cls.log, "--config", config, page=folder / "built")
        cls.addClassCleanup(cls.viewer.processes.stop_all)
        cls.browser = Browser(cls.viewer.address)
        cls.addClassCleanup(cls.browser.close)
        cls.viewer.wait_until_mapped()
        cls.browser.do(DONE % FRAMES)

    def tearDown(self):
        self.assertEqual(self.browser.do("return problems"), [])

    def state(self, name):
        return self.browser.state(name)

    def check_map_of(self, frames):
        server = json.loads(get(self.viewer.address, f"/api/map?frames={frames}")[2])
        self.assertEqual(server["frames"], frames)
        for name in ("blocks", "triangles", "digest"):
            self.assertEqual(self.state(name), server[name], f"{name} after {frames} frames")

    def test_the_slider_goes_to_five_moments_with_the_counts_of_the_server(self):
        for frames in MOMENTS:
            self.browser.do(f'await page.locator("#timeline input[type=range]").fill("{frames}")')
            self.browser.do(DONE % frames)
            self.check_map_of(frames)
            self.assertIn(f"frame {frames} of {FRAMES}", self.browser.text("#timeline output"))
        took = self.state("moment")
        print(f"moments: {took['count']}, p50 {took['p50']:.0f} ms, p95 {took['p95']:.0f} ms, longest {took['max']:.0f} ms")
        self.assertGreaterEqual(took["count"], len(MOMENTS))
        self.assertLess(took["max"], LONGEST)
        self.assertEqual(self.state("received.resyncs"), 0)

    def test_keys_go_by_moments(self):
        do = self.browser.do
        do('await page.locator("#timeline input[type=range]").fill("10")')
        for key, frames in ((".", 11), (",", 10), (">", 20), ("<", 10), ("Home", 1), ("End", FRAMES)):
            do(f'await page.locator("#scene").focus(); await page.keyboard.press({json.dumps(key)})')
            do(DONE % frames)
        do('await page.locator("#timeline input[type=range]").focus()')
        for key, frames in (("ArrowLeft", FRAMES - 1), ("Shift+ArrowLeft", FRAMES - 11), ("ArrowRight", FRAMES - 10)):
            do(f'await page.keyboard.press("{key}")')
            do(DONE % frames)

    def test_it_plays_to_the_end_and_stops(self):
        do = self.browser.do
        do('await page.locator("#timeline input[type=range]").fill("18"); await page.getByLabel("Speed").selectOption("8")')
        do('await page.locator("#scene").focus(); await page.keyboard.press("Space")')
        do(DONE % FRAMES)
        do('await page.waitForFunction(() => [...document.querySelectorAll("#timeline button")].some((b) => b.textContent === "Play"))')
        self.check_map_of(FRAMES)

    def test_events_are_marked_and_gone_to(self):
        marks = [mark for mark in self.viewer.timeline()["marks"] if mark["appeared"]]
        self.assertEqual(self.browser.do('return await page.locator("#timeline .marks i").count()'), len(self.viewer.timeline()["marks"]))
        do = self.browser.do
        do('await page.locator("#scene").focus(); await page.keyboard.press("Home")')
        do(DONE % 1)
        later = next((mark for mark in marks if mark["frames"] > 1), None)
        do('await page.keyboard.press("]")')
        do(DONE % later["frames"])
        self.assertIn(f"{later['name']} {later['id']} appears", self.browser.text("#timeline [role=status]"))

    def test_lists_and_slices_are_of_the_moment(self):
        do = self.browser.do
        counts = {}
        do('await page.click("#tab-space"); await page.getByLabel("Horizontal slice").first().check()')
        for frames in (2, FRAMES):
            do(f"await page.evaluate(() => window.vismap.goTo({frames}))")
            do(DONE % frames)
            at = float(do('return await page.locator("#space input[type=range]").first().inputValue()'))
            voxel = self.state("server.voxelSize")
            middle = (int(at / voxel + 1e-6) + 0.5) * voxel
            body = get(self.viewer.address, f"/api/slice?axis=z&at={middle:.4f}&frames={frames}")[2]
            cells = body[4 + int.from_bytes(body[:4], "little"):]
            counts[frames] = [cells.count(state) for state in range(3)]
            do(f"await page.waitForFunction((c) => String(window.vismap.slices.horizontal) === String(c), {counts[frames]}, {{timeout: 10000}})")
            objects = json.loads(get(self.viewer.address, f"/api/objects?frames={frames}")[2])
            expected = sum(len(objects[group]) for group in ("objects", "discovered", "structure", "removed"))
            do(f"await page.waitForFunction((n) => window.vismap.objects === n, {expected}, {{timeout: 10000}})")
        self.assertGreater(sum(counts[FRAMES]), sum(counts[2]))
        do('await page.getByLabel("Horizontal slice").first().uncheck(); await page.click("#tab-objects")')

    def test_an_object_has_its_file_and_its_frames_at_each_moment(self):
        do = self.browser.do
        objects = json.loads(get(self.viewer.address, "/api/objects?frames=12")[2])["objects"]
        named = max(objects, key=lambda o: o["points"])["instance"]
        do("await page.evaluate(() => window.vismap.goTo(12))")
        do(DONE % 12)
        do(f"""await page.click("#tab-objects"); await page.fill("#filter", ""); """
           f"""await page.locator(`#object-lists button[data-id="{named}"]`).click()""")
        self.assertEqual(self.state("selected"), str(named))
        shown = []
        for frames in (12, FRAMES):
            do(f"await page.evaluate(() => window.vismap.goTo({frames}))")
            do(DONE % frames)
            do(f"""await page.waitForFunction(() => document.querySelector('.thumbnails img')?.getAttribute("src").includes("frames={frames}"), null, {{timeout: 20000}})""")
            server = json.loads(get(self.viewer.address, f"/api/evidence?id={named}&frames={frames}")[2])["frames"]
            self.assertEqual(do('return await page.locator(".thumbnails li").count()'), len(server))
            shown.append(len(server))
            do("await page.waitForFunction(() => document.querySelector('.thumbnails img').naturalWidth > 0, null, {timeout: 20000})")
            saved = do('const wait = page.waitForEvent("download"); await page.getByRole("link", { name: "Download as PLY" }).click(); '
                       'const file = await wait; return [file.url(), await file.path()]')
            self.assertTrue(saved[0].endswith(f"/api/object/{named}.ply?frames={frames}"), saved)
            self.assertEqual(pathlib.Path(saved[1]).read_bytes(), get(self.viewer.address, f"/api/object/{named}.ply?frames={frames}")[2])
        self.assertGreaterEqual(shown[0], 1)
        do('await page.locator("#scene").focus(); await page.keyboard.press("Escape")')

    def test_there_are_no_processes_and_the_bar_says_where_it_is(self):
        self.assertFalse(self.browser.do('return await page.isVisible("#tab-processes")'))
        self.assertFalse(self.browser.do('return await page.isVisible("#pause")'))
        text = self.browser.do('return await page.locator("#timeline input[type=range]").getAttribute("aria-valuetext")')
        self.assertTrue(re.match(r"\d+:\d\d\.\d of \d+:\d\d\.\d, frame \d+ of \d+", text), text)


if __name__ == "__main__":
    reason = why_not()
    if reason:
        print(f"The test of the timeline in a browser is skipped: {reason}.")
        sys.exit(77)
    logs.BIN = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
