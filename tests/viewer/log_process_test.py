#!/usr/bin/env python3
"""vismap-viewer --log: moments of a log, compared with maps of so many frames that vismap-offline-mapper makes.

Usage: log_process_test.py FOLDER_OF_PROGRAMS
"""
import json
import pathlib
import random
import re
import struct
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "python"), str(ROOT / "tests" / "viewer")]
from support import DEADLINE, Processes, wait_until  # noqa: E402
from viewer_process_test import Reader  # noqa: E402
from web_client import Page, get  # noqa: E402

BIN = None  # from the command line
FRAMES = 24
MOMENTS = (1, 6, 13, 18, FRAMES)
ROOM = f"synthetic:room?frames={FRAMES}&width=160"


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=240)
    if done.returncode != 0:
        raise AssertionError(f"{command}: {done.stderr}")
    return done.stdout


def make_log(path, sequence=ROOM):
    run(BIN / "vismap-log", "from-dataset", sequence, "--out", path)
    return path


def faces_of(ply):
    return int(re.search(rb"element face (\d+)", ply.read_bytes()[:2000])[1])


def times_told(page, kind, seconds):
    """How many texts of a kind come within this time."""
    page.socket.link.settimeout(0.2)
    told, end = 0, time.monotonic() + seconds
    while time.monotonic() < end:
        before = page.texts.get(kind)
        try:
            page.step()
        except TimeoutError:
            continue
        told += page.texts.get(kind) is not before
    return told


class LogViewer:
    """A viewer of a log, without a bus."""

    def __init__(self, folder, log, *arguments, page=None):
        self.processes = Processes(BIN, folder)
        self.processes.start("viewer", BIN / "vismap-viewer", "--log", log, "--bind", "127.0.0.1:0", "--page", page or folder / "page",
                             "--lcm-url", "tcpq://127.0.0.1:9", *arguments)
        out = folder / "viewer.out"
        wait_until(lambda: b"\n" in out.read_bytes(), "the start of the viewer")
        self.address = out.read_text().split()[0]

    def timeline(self):
        return json.loads(get(self.address, "/api/timeline")[2])

    def wait_until_mapped(self):
        wait_until(lambda: self.timeline()["done"], "the end of the mapping")
        return self.timeline()


class OfflineMaps:
    """The map after so many frames as the offline mapper makes it, and the digest of its surface as a follower of a map server has it."""

    def __init__(self, folder, log, moments=MOMENTS):
        self.folder = folder
        self.figures = {frames: self.map(log, frames) for frames in moments}
        self.add_digests()

    def map(self, log, frames):
        out = self.folder / f"map-{frames}"
        run(BIN / "vismap-offline-mapper", "--dataset", log, "--max-frames", frames, "--out", out)
        return {"objects": json.loads((out / "objects.json").read_text()), "folder": out, "map": self.folder / "maps" / f"after-{frames}.vismap"}

    def add_digests(self):
        processes = Processes(BIN, self.folder)
        url = processes.start_hub()
        try:
            maps = self.folder / "maps"
            maps.mkdir()
            for frames in self.figures:
                (self.folder / f"map-{frames}" / "map.vismap").rename(maps / f"after-{frames}.vismap")
            processes.start("server", BIN / "vismap-map-server", "--lcm-url", url, "--map-folder", maps)
            for frames in self.figures:
                run(BIN / "vismap-map", "load", f"after-{frames}", "--lcm-url", url)
                surface = self.folder / f"surface-{frames}.ply"
                said = run(BIN / "vismap-map", "follow", "--frames", frames, "--out", surface, "--lcm-url", url)
                self.figures[frames]["digest"] = re.search(r"mesh digest ([0-9a-f]{32})", said)[1]
                self.figures[frames]["triangles"] = faces_of(surface)
        finally:
            processes.stop_all()


class MomentsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        folder = pathlib.Path(temporary.name)
        cls.log = make_log(folder / "room.lcmlog")
        cls.viewer = LogViewer(folder, cls.log)
        cls.addClassCleanup(cls.viewer.processes.stop_all)
        cls.early = Reader(Page(cls.viewer.address))  # while the log is mapped
        cls.addClassCleanup(cls.early.stop)
        cls.timeline = cls.viewer.wait_until_mapped()
        (folder / "offline").mkdir()
        cls.offline = OfflineMaps(folder / "offline", cls.log).figures

    def page(self, want=None):
        page = Page(self.viewer.address, want)
        self.addCleanup(page.socket.close)
        return page

    def go(self, page, frames, seconds=60):
        page.socket.send_json({"kind": "moment", "frames": frames})
        page.run_until(lambda p: p.is_level() and p.texts["map"]["revision"] == frames, seconds)
        return page.texts["map"]

    def test_five_moments_are_the_offline_maps_of_so_many_frames(self):
        page = self.page()
        for frames in (*MOMENTS, *reversed(MOMENTS), 13, 1, FRAMES, 6):
            said, offline = self.go(page, frames), self.offline[frames]
            self.assertEqual(said["frames"], frames)
            self.assertEqual(page.triangles(), said["triangles"])
            self.assertEqual(said["triangles"], offline["triangles"])
            self.assertEqual(said["mesh_digest"], offline["digest"])

    def test_a_page_that_was_there_from_the_beginning_has_the_end(self):
        page = self.early.page
        wait_until(lambda: self.early.failure or page.is_level() and page.texts["map"]["revision"] == FRAMES, "the end of the log")
        self.assertIsNone(self.early.failure)
        self.assertEqual(page.texts["hello"]["mode"], "log")
        self.assertEqual(page.texts["map"]["mesh_digest"], self.offline[FRAMES]["digest"])
        fresh = self.page()
        fresh.run_until(lambda p: p.is_level() and "objects" in p.texts)
        wait_until(lambda: page.texts["objects"] == fresh.texts["objects"], "the last list of objects")

    def test_the_timeline_has_all_moments(self):
        self.assertEqual(self.timeline["frames"], list(range(1, FRAMES + 1)))
        self.assertEqual((self.timeline["total"], self.timeline["read"], self.timeline["mapped"]), (FRAMES, FRAMES, FRAMES))
        self.assertTrue(all(step > 0 for step in self.timeline["utimes"]))
        self.assertEqual(self.timeline["message"], "")
        came = {mark["id"] for mark in self.timeline["marks"] if mark["appeared"]}
        self.assertLessEqual({str(o["instance"]) for o in self.offline[FRAMES]["objects"]["objects"]}, came)
        page = self.page()
        page.run_until(lambda p: "timeline" in p.texts)
        self.assertEqual(page.texts["timeline"], self.timeline)

    def test_pages_look_at_moments_of_their_own(self):
        pages = [self.page() for _ in range(3)]
        for page, frames in zip(pages, (3, 11, 20)):
            self.go(page, frames)
        for page, frames in zip(pages, (3, 11, 20)):
            page.run_until(lambda p: p.is_level())
            self.assertEqual(page.texts["map"]["revision"], frames)

    def test_wishes_that_come_faster_than_blocks_end_at_the_last_one(self):
        chooser = random.Random(3)
        page = self.page({"batches": True})
        for _ in range(15):
            page.socket.send_json({"kind": "moment", "frames": chooser.randint(1, FRAMES)})
        said = self.go(page, 18)
        self.assertEqual(said["mesh_digest"], self.offline[18]["digest"])

    def test_cameras_pictures_objects_and_paths_are_of_the_moment(self):
        page = self.page({"pictures": [0]})
        utimes = {}
        for frames in (20, 4):
            self.go(page, frames)
            page.run_until(lambda p: p.texts["cameras"]["cameras"][0]["positions"] == frames)
            utimes[frames] = page.texts["cameras"]["cameras"][0]["utime"]
            page.run_until(lambda p: 0 in p.pictures and p.pictures[0][0]["utime"] == utimes[frames])
            self.assertTrue(page.pictures[0][1].startswith(b"\xff\xd8"), "a JPEG")
            self.assertTrue(page.pictures[0][0]["segments"]["list"])
            self.assertLessEqual(page.texts["objects"]["revision"], frames)
        self.assertGreater(utimes[20], utimes[4])
        page.run_until(lambda p: len(p.paths.get(0, [])) == FRAMES)

    def test_questions_are_about_the_moment(self):
        status, _, body = get(self.viewer.address, f"/api/objects?frames={FRAMES}")
        self.assertEqual(status, 200)
        answer, offline = json.loads(body), self.offline[FRAMES]["objects"]
        for group in ("objects", "discovered", "structure", "removed"):
            self.assertEqual(answer[group], offline[group], group)
        known = []
        for frames in (2, FRAMES):
            status, _, body = get(self.viewer.address, f"/api/slice?axis=z&at=0.5&frames={frames}")
            self.assertEqual(status, 200, body)
            known.append(len([c for c in body[4 + struct.unpack_from("<I", body)[0]:] if c]))
        self.assertLess(known[0], known[1])
        table = max(offline["objects"], key=lambda o: o["points"])
        at = ",".join(f"{c + 0.48 * s * (axis == 2):.4f}" for axis, (c, s) in enumerate(zip(table["center"], table["size"])))
        for frames in (6, 18, FRAMES):
            status, _, body = get(self.viewer.address, f"/api/cell?at={at}&frames={frames}")
            self.assertEqual(status, 200, body)
            answer = json.loads(body)
            offline = json.loads(run(BIN / "vismap-map", "cell", self.offline[frames]["map"], "--at", at, "--json"))
            for key in ("map_id", "last_frame"):  # a map file does not have the latter
                answer.pop(key), offline.pop(key)
            self.assertEqual(answer["revision"], frames)
            self.assertEqual(answer, offline)
        said = json.loads(get(self.viewer.address, "/api/map?frames=13")[2])
        self.assertEqual((said["revision"], said["triangles"]), (13, self.offline[13]["triangles"]))
        for path, expected in (("/api/slice?axis=z&at=0&frames=x", 400), ("/api/cell?frames=3", 400), ("/api/object/x.ply", 400),
                               ("/api/object/4000000000.ply", 400), ("/api/leaves?axis=z", 400), ("/api/evidence?id=x", 400),
                               ("/api/evidence?id=4000000000", 404), ("/api/frame/0/1.jpg", 404), ("/api/processes", 404)):
            status, _, body = get(self.viewer.address, path)
            self.assertEqual(status, expected)
            self.assertTrue(json.loads(body)["error"])

    def json_of(self, path):
        status, _, body = get(self.viewer.address, path)
        self.assertEqual(status, 200, body)
        return json.loads(body)

    def slice_of(self, path):
        status, _, body = get(self.viewer.address, path)
        self.assertEqual(status, 200, body)
        size = struct.unpack_from("<I", body)[0]
        header, cells = json.loads(body[4:4 + size]), body[4 + size:]
        shape = (header["height"], header["width"])
        states = np.frombuffer(cells, np.uint8, shape[0] * shape[1]).reshape(shape)
        if not header["distances"]:
            return header, states, None
        return header, states, np.frombuffer(cells, "<f4", shape[0] * shape[1], (states.size + 3) // 4 * 4).reshape(shape)

    def test_leaves_are_those_of_the_moment(self):
        for frames in (6, FRAMES):
            time.sleep(0.3)  # all pages together get ten cuts per second
            answer = self.json_of(f"/api/leaves?axis=z&at=0.525&frames={frames}")
            self.assertEqual(answer["revision"], frames)
            header, states, _ = self.slice_of(f"/api/slice?axis=z&at=0.525&frames={frames}")
            drawn = np.zeros_like(states)
            centres = [header["origin"][axis] + (np.arange(states.shape[1 - axis]) + 0.5) * header["cell_m"] for axis in range(2)]
            for x, y, _, size, state in answer["leaves"]:
                inside = [np.abs(c - at) < size / 2 for c, at in zip(centres, (x, y))]
                drawn[np.ix_(inside[1], inside[0])] = state
            self.assertGreater(np.count_nonzero(states == 2), 50)
            self.assertTrue((drawn[states == 2] == 2).all(), "what is occupied lies in occupied leaves")
            self.assertFalse((states[drawn == 1] != 1).any(), "free leaves are free everywhere in the slice")
        self.assertGreater(len(self.json_of("/api/leaves?axis=z&at=0.525&layer=closed&frames=6")["leaves"]), 10)

    def test_distances_are_those_of_the_moment(self):
        for frames in (6, FRAMES):
            time.sleep(0.3)
            header, _, metres = self.slice_of(f"/api/slice?axis=z&at=0.525&distance=1&frames={frames}")
            self.assertTrue(header["distances"], header)
            leaf, cell = header["distance_leaf_m"], header["cell_m"]
            rows, columns = np.nonzero((metres > 0.1) & (metres < header["distance_limit_m"] - 0.1))
            x, y = (header["origin"][axis] + (index + 0.5) * cell for axis, index in enumerate((columns, rows)))
            centred = (np.abs((x / leaf) % 1 - 0.5) < 1e-3) & (np.abs((y / leaf) % 1 - 0.5) < 1e-3)
            chosen = np.nonzero(centred)[0][::7][:20]
            self.assertGreaterEqual(len(chosen), 10)
            points = ";".join(f"{x[i]:.4f},{y[i]:.4f},0.525" for i in chosen)
            said = json.loads(run(BIN / "vismap-map", "clearance", self.offline[frames]["map"], "--at", points, "--json"))
            np.testing.assert_allclose([metres[rows[i], columns[i]] for i in chosen], [point["obstacle_m"] for point in said["points"]], atol=2e-3)

    def test_object_files_are_those_of_the_offline_mapper(self):
        for frames in (6, FRAMES):
            offline = self.offline[frames]
            compared = 0
            for entry in offline["objects"]["objects"][:6]:
                files = list((offline["folder"] / "objects").glob(f"instance_{entry['instance']}_*.ply"))
                if not files:
                    continue
                status, headers, body = get(self.viewer.address, f"/api/object/{entry['instance']}.ply?frames={frames}")
                self.assertEqual(status, 200, body[:300])
                expected = files[0].read_bytes()
                self.assertEqual(body.split(b"end_header\n", 1)[1], expected.split(b"end_header\n", 1)[1])
                compared += 1
            self.assertGreaterEqual(compared, 3)

    def test_evidence_frames_are_of_the_moment_or_before(self):
        named = max(self.offline[6]["objects"]["objects"], key=lambda o: o["points"])["instance"]
        counts = []
        for frames in (6, FRAMES):
            newest = self.json_of(f"/api/map?frames={frames}")["utime"]
            answer = self.json_of(f"/api/evidence?id={named}&frames={frames}")
            self.assertEqual(answer["revision"], frames)
            self.assertTrue(answer["frames"], answer)
            self.assertTrue(all(frame["utime"] <= newest for frame in answer["frames"]))
            counts.append(len(answer["frames"]))
            shown = answer["frames"][0]
            self.assertTrue(shown["url"].endswith(f"?id={named}&frames={frames}"), shown["url"])
            status, _, masked = get(self.viewer.address, shown["url"])
            self.assertEqual(status, 200)
            status, _, plain = get(self.viewer.address, shown["url"].split("?")[0])
            self.assertEqual(status, 200)
            self.assertTrue(masked.startswith(b"\xff\xd8") and plain.startswith(b"\xff\xd8"))
            self.assertNotEqual(masked, plain)
        self.assertGreaterEqual(counts[1], counts[0])
        discovered = self.json_of(f"/api/objects?frames={FRAMES}")["discovered"]
        if discovered:
            self.assertIn("frames", self.json_of(f"/api/evidence?id=s{discovered[0]['segments'][0]}&frames={FRAMES}"))


class TroubleTest(unittest.TestCase):
    def start(self, *arguments):
        return subprocess.run([BIN / "vismap-viewer", *arguments], capture_output=True, text=True, timeout=DEADLINE)

    def test_what_cannot_be_opened_is_told(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            done = self.start("--log", folder / "none.lcmlog")
            self.assertEqual(done.returncode, 3)
            self.assertIn("none.lcmlog", done.stderr)
            other = folder / "other.lcmlog"
            other.write_bytes(struct.pack(">IqqII", 0xeda1da01, 0, 0, 6, 3) + b"WHEELSabc")
            done = self.start("--log", other)
            self.assertEqual(done.returncode, 3)
            self.assertIn("its channels are WHEELS", done.stderr)

    def test_small_bound_keeps_fewer_moments_that_are_right(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            log = make_log(folder / "room.lcmlog", "synthetic:room?frames=48&width=160")
            config = folder / "small.txtpb"
            config.write_text("viewer { log_mb: 64 }")
            viewer = LogViewer(folder, log, "--config", config)
            self.addCleanup(viewer.processes.stop_all)
            page = Page(viewer.address, {"batches": True})
            self.addCleanup(page.socket.close)
            wait_until(lambda: page.step() or viewer.timeline()["done"], "the end of the mapping")
            timeline = viewer.timeline()
            self.assertGreater(timeline["stride"], 1)
            self.assertEqual(timeline["frames"][-1], 48)
            for frames in timeline["frames"][::-3]:
                page.socket.send_json({"kind": "moment", "frames": frames})
                page.run_until(lambda p: p.is_level() and p.texts["map"]["revision"] == frames)
            frames = timeline["frames"][len(timeline["frames"]) // 2]
            page.socket.send_json({"kind": "moment", "frames": frames + 1})  # which is forgotten
            page.run_until(lambda p: p.is_level() and p.texts["map"]["revision"] == frames)
            times_told(page, "map", 1)
            self.assertLessEqual(times_told(page, "map", 3), 4, "a page that has its moment gets it again")
            offline = OfflineMaps(folder, log, (frames,)).figures[frames]
            said = json.loads(get(viewer.address, f"/api/map?frames={frames}")[2])
            self.assertEqual((said["mesh_digest"], said["triangles"]), (offline["digest"], offline["triangles"]))


if __name__ == "__main__":
    BIN = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
