#!/usr/bin/env python3
"""Frames that vismap-viewer keeps, with the masks of objects over them, against what the simulator says is in them.

Usage: evidence_process_test.py FOLDER_OF_PROGRAMS
"""
import json
import pathlib
import statistics
import sys
import tempfile
import threading
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "python"), str(ROOT / "tests" / "viewer")]
import viewer_process_test as viewer  # noqa: E402
from support import wait_until  # noqa: E402
from web_client import get  # noqa: E402

import numpy as np  # noqa: E402
import vismap  # noqa: E402
from vismap.images import decode_png  # noqa: E402

viewer.ROOM = f"synthetic:room?frames={viewer.FRAMES}&width=320"
LEAST = 500  # pixels of a mask that is compared; detections and surface are coarse


def mask_of(detection, width, height):
    runs = np.asarray(detection.runs)
    return np.repeat(np.arange(len(runs)) % 2, runs).reshape(width, height).T.astype(bool)


def overlap(a, b):
    return (a & b).sum() / max(1, (a | b).sum())


class EvidenceTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        folder = pathlib.Path(temporary.name)
        config = folder / "viewer.txtpb"
        config.write_text("viewer { evidence_hz: 30 }\n")
        cls.run_ = viewer.Run(folder, ("--config", config))
        cls.addClassCleanup(cls.run_.stop)
        cls.address = cls.run_.address
        # No page is connected: frames are kept all the same.
        cls.before = cls.ask("/api/evidence?id=7")
        bus = vismap.Bus(cls.run_.url, name="truth")
        cls.addClassCleanup(bus.close)
        subscription = bus.subscribe("DETECTIONS")
        cls.run_.start_mapping()
        cls.run_.replay()
        cls.truth = {}
        while len(cls.truth) < viewer.FRAMES:
            message = subscription.get(20).decode()
            cls.truth[message.camera_id, message.utime] = message
        cls.hash = json.loads(cls.run_.map_tool("info", "live", "--json"))["hash"]
        wait_until(lambda: cls.ask("/api/map")[1]["revision"] == viewer.FRAMES, "the whole map")
        cls.objects = [o for o in cls.ask("/api/objects")[1]["objects"] if o["state"] == "present"]

    @classmethod
    def ask(cls, path):
        status, _, body = get(cls.address, path)
        return status, json.loads(body)

    def test_before_a_map_it_says_so(self):
        self.assertEqual(self.before[0], 503)
        self.assertIn("nothing is known yet", self.before[1]["error"])

    def test_hash_is_that_of_a_map_without_a_viewer(self):
        self.assertEqual(self.hash, viewer.offline_hash())

    def drawn(self, frame):
        """The mask that the viewer draws, from its picture with and without it."""
        path, query = frame["url"].split("?")
        path = path.replace(".jpg", ".png")
        with_mask = decode_png(get(self.address, f"{path}?{query}&color=ff00ff")[2]).astype(int)
        without = decode_png(get(self.address, path)[2]).astype(int)
        outline = (with_mask == 255).all(axis=2)  # white: of the detection
        return (with_mask != without).any(axis=2) & ~outline

    def test_masks_are_those_of_the_simulator(self):
        """The simulated detector misses a tenth of what is in a frame, and its masks have coarse edges."""
        overlaps, missed, seen = [], 0, 0
        for wanted in self.objects:
            status, answer = self.ask(f"/api/evidence?id={wanted['instance']}")
            self.assertEqual(status, 200)
            seen += bool(answer["frames"])
            values = [frame["pixels"] * frame["whole"] for frame in answer["frames"]]
            self.assertEqual(values, sorted(values, reverse=True))
            self.assertLessEqual(len(values), 12)
            for frame in answer["frames"]:
                if frame["pixels"] < LEAST:
                    continue
                truth = self.truth[frame["camera_id"], frame["utime"]]
                mask = self.drawn(frame)
                self.assertAlmostEqual(mask.sum(), frame["pixels"], delta=0.1 * frame["pixels"] + 10)
                same = [mask_of(d, truth.image_width, truth.image_height) for d in truth.detections if d.class_id == wanted["class"]]
                best = max((overlap(mask, other) for other in same), default=0)
                if best > 0:
                    overlaps.append(best)
                else:
                    missed += 1
        print(f"{len(self.objects)} objects, {seen} with frames, {len(overlaps)} masks, {missed} without a detection: intersection over "
              f"union median {statistics.median(overlaps):.3f}, tenth part below {statistics.quantiles(overlaps, n=10)[0]:.3f}")
        self.assertGreaterEqual(seen, 0.8 * len(self.objects))
        self.assertGreater(len(overlaps), 50)
        self.assertLess(missed, 0.25 * len(overlaps))
        self.assertGreater(statistics.median(overlaps), 0.8)
        self.assertGreater(statistics.quantiles(overlaps, n=10)[0], 0.6)

    def test_the_picture_as_it_came(self):
        frame = self.ask(f"/api/evidence?id={self.objects[0]['instance']}")[1]["frames"][0]
        status, headers, body = get(self.address, frame["url"].split("?")[0])
        self.assertEqual((status, headers["content-type"], body[:2]), (200, "image/jpeg", b"\xff\xd8"))
        status, headers, small = get(self.address, frame["url"] + "&width=40")
        self.assertEqual((status, headers["content-type"]), (200, "image/jpeg"))
        self.assertLess(len(small), len(body))

    def test_wrong_addresses_are_refused_with_a_sentence(self):
        utime = next(iter(self.truth))[1]
        for path, expected in (("/api/evidence", 400), ("/api/evidence?id=", 400), ("/api/evidence?id=x", 400),
                               ("/api/evidence?id=7&more=1", 400), ("/api/evidence?id=4000000000", 404), ("/api/evidence?id=s4000000000", 404),
                               ("/api/frame/0/1.jpg", 404), (f"/api/frame/9/{utime}.jpg", 404), ("/api/frame/0/x.jpg", 400),
                               ("/api/frame/0/-1.jpg", 400), ("/api/frame/0/1.gif", 400), (f"/api/frame/0/{utime}.jpg?id=-7", 400),
                               (f"/api/frame/0/{utime}.jpg?width=0", 400), (f"/api/frame/0/{utime}.jpg?color=zzzzzz", 400),
                               ("/api/frame/" + "9" * 4000 + "/1.jpg", 400), ("/api/frame/0/%2e%2e/1.jpg", 400)):
            status, answer = self.ask(path)
            self.assertEqual(status, expected, path)
            self.assertIn(" ", answer["error"])

    def test_many_requests_at_once_are_answered_or_refused(self):
        frame = self.ask(f"/api/evidence?id={self.objects[0]['instance']}")[1]["frames"][0]
        answers = []
        threads = [threading.Thread(target=lambda: answers.append(get(self.address, frame["url"])[0])) for _ in range(40)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(answers), 40)
        self.assertLessEqual(set(answers), {200, 429, 503})
        self.assertIn(200, answers)

    def test_the_newest_picture_comes_at_once_after_the_replay(self):
        page = viewer.Page(self.address, {"pictures": [0]})
        page.run_until(lambda p: 0 in p.pictures, seconds=10)
        self.assertEqual(page.pictures[0][0]["utime"], max(utime for _, utime in self.truth))
        page.socket.close()


class SmallTest(unittest.TestCase):
    def test_without_memory_nothing_is_kept_and_it_says_so(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            config = folder / "viewer.txtpb"
            config.write_text("viewer { evidence_mb: 0 }\n")
            run = viewer.Run(folder, ("--config", config))
            self.addCleanup(run.stop)
            for path in ("/api/evidence?id=7", "/api/frame/0/1.jpg"):
                status, _, body = get(run.address, path)
                self.assertEqual(status, 404)
                self.assertIn("viewer.evidence_mb is 0", json.loads(body)["error"])


if __name__ == "__main__":
    viewer.BIN = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
