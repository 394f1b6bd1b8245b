#!/usr/bin/env python3
"""The page of vismap-viewer in Chromium, on a real hub while a map grows. Exit code 77 = it cannot run here.

Usage: browser_test.py FOLDER_OF_PROGRAMS
"""
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "viewer")]
import viewer_process_test as viewer  # noqa: E402
from support import wait_until  # noqa: E402
from web_client import get  # noqa: E402

PAGE = ROOT / "procs" / "viewer" / "page"
FRAMES = viewer.FRAMES
LEVEL = """
await page.waitForFunction((frames) => {
  const now = window.vismap;
  return now.server && now.revision === frames && now.digest === now.server.digest && now.blocks === now.server.blocks;
}, %d, {polling: 200, timeout: 90000})""".replace("\n", " ")


def why_not():
    """Why the test cannot run here, or None."""
    node = shutil.which("node")
    if not node:
        return "node is missing"
    if int(subprocess.run([node, "-p", "process.versions.node.split('.')[0]"], capture_output=True, text=True).stdout) < 20:
        return "playwright-core needs node 20 or newer"
    if not (PAGE / "node_modules").is_dir():
        return "the page's npm packages are missing; scripts/page installs them"
    if not os.access(os.environ.get("CHROMIUM", "/usr/bin/chromium"), os.X_OK):
        return "the Debian package chromium is missing"
    return None


class Browser:
    """A page in a browser of its own."""

    def __init__(self, address):
        self.process = subprocess.Popen(["node", ROOT / "tests/viewer/page/drive.mjs", address], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)

    def do(self, script):
        self.process.stdin.write(script + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise AssertionError(f"the browser has died at: {script}")
        answer = json.loads(line)
        if isinstance(answer, dict) and "error" in answer:
            raise AssertionError(f"{script}: {answer['error']}")
        return answer

    def state(self, name):
        return self.do(f"return await page.evaluate(() => window.vismap.{name})")

    def text(self, selector):
        return self.do(f"return await page.textContent({json.dumps(selector)})")

    def close(self):
        self.process.stdin.close()
        self.process.wait(timeout=30)
        self.process.stdout.close()


class BrowserTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        folder = pathlib.Path(temporary.name)
        subprocess.run(["node", PAGE / "build.mjs", folder / "built"], check=True, capture_output=True, timeout=60)
        cls.run_ = viewer.Run(folder, page=folder / "built")
        cls.addClassCleanup(cls.run_.stop)
        cls.browser = Browser(cls.run_.address)
        cls.addClassCleanup(cls.browser.close)
        cls.waited_for_map = "no map yet" in cls.browser.text("#banners")
        cls.run_.start_mapping()
        cls.run_.replay()
        cls.browser.do(LEVEL % FRAMES)

    def get_json(self, path):
        """Asks again while a busy map server has not answered in time (504)."""
        answers = []

        def answered():
            answers.append(get(self.run_.address, path))
            return answers[-1][0] != 504

        wait_until(answered, f"an answer to {path}")
        status, _, body = answers[-1]
        self.assertEqual(status, 200, body)
        return json.loads(body)

    def tearDown(self):
        self.assertEqual(self.browser.do("return problems"), [])

    def test_a_page_that_saw_the_map_grow_draws_what_the_server_has(self):
        server = self.get_json("/api/map")
        for name in ("blocks", "triangles", "digest"):
            self.assertEqual(self.browser.state(name), server[name])
        self.assertEqual(self.browser.state("received.resyncs"), 0)

    def test_a_late_page_draws_the_same(self):
        late = Browser(self.run_.address)
        try:
            late.do(LEVEL % FRAMES)
            for name in ("blocks", "triangles", "digest"):
                self.assertEqual(late.state(name), self.browser.state(name))
        finally:
            late.close()

    def test_objects_of_the_list_are_those_of_the_server(self):
        objects = self.get_json("/api/objects")
        wait_until(lambda: self.browser.state("objects") == sum(len(objects[group]) for group in
                   ("objects", "discovered", "structure", "removed")), "all objects")
        self.browser.do('await page.fill("#filter", "structure")')
        shown = self.browser.do('return await page.locator(".name").allTextContents()')
        self.browser.do('await page.fill("#filter", "")')
        self.assertEqual(len(shown), len(objects["structure"]))

    def test_an_object_is_picked_by_its_pixel(self):
        objects = [o for o in self.get_json("/api/objects")["objects"] if o["state"] == "present"]
        table = max(objects, key=lambda o: o["points"])
        self.browser.do('await page.keyboard.press("Escape"); await page.keyboard.press("r"); await page.waitForTimeout(800)')
        center, size = table["center"], table["size"]
        for step in range(25):  # over the top of its box: somewhere there is its surface
            point = [center[0] + (step % 5 - 2) * 0.2 * size[0], center[1] + (step // 5 - 2) * 0.2 * size[1], center[2] + 0.45 * size[2]]
            self.browser.do(f"const [x, y] = await page.evaluate((p) => window.vismap.project(...p), {point}); await page.mouse.click(x, y)")
            if self.browser.state("selected") == str(table["instance"]):
                break
        self.assertEqual(self.browser.state("selected"), str(table["instance"]))
        self.assertIn(table["class_name"], self.browser.text("#details h2"))
        link = self.browser.do('return await page.getByRole("link", {name: "Download as PLY"}).getAttribute("href")')
        self.assertEqual(link, f"api/object/{table['instance']}.ply")
        self.browser.do('await page.keyboard.press("Escape")')

    def test_frames_of_an_object_are_those_of_the_server(self):
        do = self.browser.do
        objects = [o for o in self.get_json("/api/objects")["objects"] if o["state"] == "present"]
        name = max(objects, key=lambda o: o["points"])
        server = self.get_json(f"/api/evidence?id={name['instance']}")["frames"]
        self.assertTrue(server)
        do(f'await page.getByRole("button", {{name: "{name["class_name"]} {name["instance"]}", exact: true}}).click(); '
           'await page.waitForSelector(".thumbnails button")')
        self.assertEqual(do('return await page.locator(".thumbnails li").count()'), len(server))
        do('await page.locator(".thumbnails button").first().click(); '
           'await page.waitForFunction(() => document.querySelector("#evidence img").naturalWidth === 160)')
        self.assertIn(f"{server[0]['utime'] / 1e6:.2f} s", self.browser.text("#evidence figcaption"))
        do('await page.keyboard.press("l"); await page.waitForTimeout(800)')
        camera = self.browser.state("camera")
        for axis in range(3):
            self.assertAlmostEqual(camera[axis], server[0]["T_W_C"][4 * axis + 3], delta=0.02)
        do('await page.keyboard.press("Escape")')

    def test_slice_and_cell_are_as_the_programs_say(self):
        do = self.browser.do
        do('await page.keyboard.press("r"); await page.click("#tab-space"); await page.getByLabel("Horizontal slice").first().check()')
        do("await page.waitForFunction(() => window.vismap.slices.horizontal[1] > 0)")
        at = float(do('return await page.locator("#space input[type=range]").first().inputValue()')) + 0.005
        body = get(self.run_.address, f"/api/slice?axis=z&at={at:.4f}")[2]
        cells = body[4 + struct.unpack_from("<I", body)[0]:]
        self.assertEqual(self.browser.state("slices.horizontal"), [cells.count(state) for state in range(3)])
        do('const frame = await page.locator("#scene").boundingBox(); '
           'await page.mouse.click(frame.x + 0.5 * frame.width, frame.y + 0.62 * frame.height)')
        do('await page.waitForSelector("#cell dd")')
        place = self.browser.text('#cell dd[data-key="at"]').replace(" ", "")
        said = json.loads(self.run_.map_tool("cell", "live", "--at", place, "--json"))
        self.assertEqual(self.browser.text('#cell dd[data-key="state"]'), said["state"])
        self.assertEqual(self.browser.text('#cell [data-key="why"]'), said["why"])
        self.assertEqual(self.browser.text('#cell dd[data-key="observations"]'), str(said["observations"]))
        do('await page.getByLabel("Horizontal slice").first().uncheck(); await page.click("#tab-objects")')

    def test_processes_are_those_of_the_bus(self):
        self.browser.do('await page.click("#tab-processes"); await page.waitForSelector("#processes tbody tr")')
        names = self.browser.do('return await page.locator("#processes tbody .name").allTextContents()')
        self.assertLessEqual({"map-server", "depth-segmenter", "detector", "viewer"}, set(names))
        self.browser.do('await page.click("#tab-objects")')


class LastTest(unittest.TestCase):
    """The viewer dies and comes back, with another map."""

    def test_lost_connection_and_another_map(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            subprocess.run(["node", PAGE / "build.mjs", folder / "built"], check=True, capture_output=True, timeout=60)
            run = viewer.Run(folder, page=folder / "built")
            self.addCleanup(run.stop)
            browser = Browser(run.address)
            self.addCleanup(browser.close)
            run.start_mapping()
            run.replay()
            browser.do(LEVEL % FRAMES)
            first = browser.state("mapId")
            run.processes.stop("viewer")
            browser.do('await page.waitForFunction(() => document.querySelector("#banners").textContent.includes("is lost"))')
            for process in ("detector", "depth-segmenter", "map-server"):
                run.processes.stop(process)
            shutil.rmtree(folder / "maps", ignore_errors=True)
            run.start_mapping()
            run.start("viewer", "--bind", run.address.removeprefix("http://").rstrip("/"), "--page", folder / "built")
            run.replay()
            browser.do(LEVEL % FRAMES)
            self.assertNotEqual(browser.state("mapId"), first)
            self.assertNotIn("is lost", browser.text("#banners"))
            self.assertEqual(browser.state("digest"), json.loads(get(run.address, "/api/map")[2])["digest"])


if __name__ == "__main__":
    reason = why_not()
    if reason:
        print(f"The test of the page in a browser is skipped: {reason}.")
        sys.exit(77)
    viewer.BIN = pathlib.Path(sys.argv.pop())
    unittest.main()
