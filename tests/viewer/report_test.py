#!/usr/bin/env python3
"""The report of vismap-map in Chromium, opened as a file. Exit code 77 = it cannot run here.

Usage: report_test.py FOLDER_OF_PROGRAMS
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "viewer")]
import browser_test  # noqa: E402

BIN = None  # from the command line
PARTS = ["summary", "map", "pictures", "objects", "discovered", "structure", "removed", "trajectory", "times", "space",
         "scores", "processes", "versions", "config"]
# Counts the colours of the canvas in a picture of the page.
COLOURS = """
const png = (await page.locator("#canvas").screenshot()).toString("base64");
return await page.evaluate(async (text) => {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
  const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
  context.drawImage(bitmap, 0, 0);
  const pixels = new Uint32Array(context.getImageData(0, 0, bitmap.width, bitmap.height).data.buffer);
  const counts = new Map();
  for (const pixel of pixels) counts.set(pixel, (counts.get(pixel) ?? 0) + 1);
  return { colours: counts.size, most: Math.max(...counts.values()) / pixels.length };
}, png)""".replace("\n", " ")


def run(program, *arguments):
    subprocess.run([BIN / f"vismap-{program}", *arguments], check=True, capture_output=True, timeout=240)


class ReportTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        folder = cls.folder = pathlib.Path(temporary.name)
        subprocess.run(["node", browser_test.PAGE / "build.mjs", folder / "page"], check=True, capture_output=True, timeout=60)
        (folder / "coarse.txtpb").write_text("grid { voxel_size_m: 0.02 }\n")
        run("offline-mapper", "--dataset", "synthetic:room?frames=12&width=160", "--config", folder / "coarse.txtpb", "--out",
            folder / "out")
        run("map", "report", folder / "out", "--out", folder / "report.html", "--page", folder / "page")
        run("map", "report", folder / "out", "--out", folder / "still.html", "--page", folder / "nothing")

    def open(self, name):
        browser = browser_test.Browser((self.folder / name).as_uri())
        self.addCleanup(browser.close)
        return browser

    def check_page(self, browser):
        parts = browser.do("return await page.evaluate(() => [...document.querySelectorAll('section')].map((part) => part.id))")
        self.assertEqual(parts, PARTS)
        empty = browser.do("return await page.evaluate(() => [...document.images].filter((image) => !image.complete || "
                           "image.naturalWidth < 20).length)")
        self.assertEqual(empty, 0)
        self.assertEqual(browser.do("return problems"), [])

    def test_map_turns_and_rows_choose_objects(self):
        browser = self.open("report.html")
        browser.do("await page.waitForFunction(() => window.vismapReport?.drawn > 0)")
        self.check_page(browser)
        self.assertFalse(browser.do("return await page.isVisible('#turntable')"))
        state = browser.do("return await page.evaluate(() => window.vismapReport)")
        self.assertGreater(state["triangles"], 10000)
        before = browser.do(COLOURS)
        self.assertGreater(before["colours"], 1000)
        self.assertLess(before["most"], 0.9)
        browser.do("await page.selectOption('#colouring', 'height'); await page.waitForTimeout(500)")
        self.assertNotEqual(browser.do(COLOURS), before)
        row = "#objects tr[data-object] >> nth=0"
        name = browser.do(f"return await page.locator('{row}').locator('td').nth(1).textContent()")
        browser.do(f"await page.click('{row}')")
        self.assertIn(name, browser.text("#picked"))
        drawn = browser.do("return await page.evaluate(() => window.vismapReport.drawn)")
        browser.do("await page.locator('#canvas').focus(); await page.mouse.wheel(0, 300); await page.locator('#canvas').hover();"
                   "await page.mouse.wheel(0, 300); await page.waitForTimeout(700)")
        self.assertGreater(browser.do("return await page.evaluate(() => window.vismapReport.drawn)"), drawn)
        self.assertEqual(browser.do("return problems"), [])

    def test_without_the_script_there_is_a_turntable(self):
        browser = self.open("still.html")
        self.check_page(browser)
        self.assertTrue(browser.do("return await page.isVisible('#turntable img')"))
        self.assertIn("scripts/page builds it", browser.text("#map"))


if __name__ == "__main__":
    BIN = pathlib.Path(sys.argv.pop(1)).resolve()
    reason = browser_test.why_not()
    if reason:
        print(f"report_test.py: skipped: {reason}")
        sys.exit(77)
    unittest.main(verbosity=2)
