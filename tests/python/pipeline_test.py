#!/usr/bin/env python3
"""Real processes on a real hub: the built-in room in, the map out, and every example of libs/python/README.md.

Usage: pipeline_test.py FOLDER_OF_PROGRAMS
"""
import contextlib
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from support import DEADLINE, PACKAGE, ROOT, Processes, python_blocks, wait_until

import vismap
from vismap.objects import objects_from_json

BIN = None  # from the command line
FRAMES = 6


class PipelineTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        cls.processes = Processes(BIN, cls.folder)
        cls.addClassCleanup(cls.processes.stop_all)
        cls.url = cls.processes.start_hub()
        os.environ["LCM_DEFAULT_URL"] = cls.url
        cls.bus = vismap.Bus(cls.url, name="test")
        cls.addClassCleanup(cls.bus.close)
        cls.states = cls.bus.subscribe("STATUS", capacity=10000)
        cls.start("segmenter", BIN / "vismap-depth-segmenter", "--detections", "none")
        cls.start("server", BIN / "vismap-map-server", "--map-folder", cls.folder / "maps")
        ready = set()
        while not {"depth-segmenter", "map-server"} <= ready:
            status = cls.states.get(DEADLINE).decode()
            ready |= {status.process} if status.state in ("ready", "running") else set()
        cls.frames = cls.bus.subscribe("RGBD_FRAME", capacity=100)
        cls.segmented = cls.bus.subscribe("SEGMENTED_FRAME", capacity=100)
        cls.start("replay", BIN / "vismap-sensor-replay", "--dataset", f"synthetic:room?frames={FRAMES}&width=160", "--mode", "lockstep",
                  "--wait-for", "depth-segmenter,map-server")
        with vismap.LiveMap(cls.bus) as live:
            cls.mesh = live.wait(revision=FRAMES, timeout=DEADLINE)

    @classmethod
    def start(cls, name, *command):
        os.environ["PYTHONPATH"] = str(PACKAGE)
        cls.processes.start(name, *command)

    def run_example(self, heading):
        """Runs the text of the README below a heading, in a folder of its own. Returns its variables and what it printed."""
        text = python_blocks((PACKAGE / "README.md").read_text())[heading]
        printed, variables, before = io.StringIO(), {}, os.getcwd()
        os.chdir(self.folder)
        try:
            with contextlib.redirect_stdout(printed):
                exec(compile(text, heading, "exec"), variables)
        finally:
            os.chdir(before)
        return variables, printed.getvalue()

    def test_every_example_is_run_here(self):
        examples = set(python_blocks((PACKAGE / "README.md").read_text()))
        text = pathlib.Path(__file__).read_text()
        self.assertEqual({heading for heading in examples if f'run_example("{heading}")' not in text}, set())
        self.assertGreaterEqual(len(examples), 7)

    def test_live_surface_has_the_digest_of_the_server(self):
        with vismap.LiveMap(self.bus) as live:
            wait_until(lambda: vismap.ask(self.bus, "mesh", "digest").message == live.digest, "equality of the digests")
            mesh = live.mesh()
        self.assertEqual(len(mesh.vertices), len(mesh.instance))
        self.assertLess(int(mesh.faces.max()), len(mesh.vertices))
        # vismap-map follows the same surface, and writes what it holds.
        subprocess.run([BIN / "vismap-map", "follow", "--frames", "1", "--out", self.folder / "live.ply", "--lcm-url", self.url],
                       check=True, capture_output=True, timeout=DEADLINE)
        header = (self.folder / "live.ply").read_bytes().split(b"end_header\n")[0]
        self.assertIn(b"element vertex %d\n" % len(mesh.vertices), header)
        self.assertIn(b"element face %d\n" % len(mesh.faces), header)

    def test_live_map(self):
        found, printed = self.run_example("The live map: vertices, faces and ids")
        mesh = found["mesh"]
        self.assertGreaterEqual(mesh.revision, FRAMES)
        self.assertIn(str(mesh.vertices.shape), printed)

    def test_objects_with_boxes(self):
        """Those that vismap-map tells of, with the same boxes."""
        self.run_example("Objects with boxes")
        objects = vismap.get_objects(self.bus)
        told = subprocess.run([BIN / "vismap-map", "objects", "live", "--json", "--lcm-url", self.url], check=True, capture_output=True,
                              timeout=DEADLINE)
        expected = objects_from_json(json.loads(told.stdout))
        self.assertGreater(len(expected), 3)
        self.assertEqual([o.segments for o in objects], [o.segments for o in expected])
        published = self.bus.subscribe("OBJECTS")
        vismap.ask(self.bus, "objects")
        by_segments = {o.segments: o for o in vismap.objects_of(published.get(DEADLINE).decode())}
        for found in (o for o in objects if not o.kind):  # OBJECTS does not have the planes of the structure
            live = by_segments[found.segments]
            np.testing.assert_allclose(live.box.corners_W(), found.box.corners_W(), atol=1e-4)
            self.assertEqual((live.instance, live.points, live.frames), (found.instance, found.points, found.frames))
            self.assertTrue(found.box.contains(found.box.center_W))
        with self.assertRaisesRegex(vismap.RequestError, "rejected the request 'objects'.*unicorn"):
            vismap.get_objects(self.bus, "class=unicorn")

    def test_free_space_and_obstacles(self):
        """The surface is occupied, before it is free space, behind it none."""
        found, _ = self.run_example("Is this point free, and how far is the next obstacle")
        space, surface = found["space"], self.mesh.vertices[::200].astype(np.float64)
        normals = self.mesh.normals[::200]
        self.assertEqual(np.median(space.distance(surface)), 0)
        self.assertLess(np.mean(space.is_free(surface)), 0.05)
        self.assertGreater(np.mean(space.is_free(surface + 0.15 * normals)), 0.3)
        self.assertLess(np.mean(space.is_free(surface - 0.1 * normals)), 0.1)
        self.assertEqual(space.state([900.0, 9.0, 9.0]), vismap.UNKNOWN)
        center = surface.mean(axis=0)
        careful = vismap.read_octree(self.bus, (center - 0.5, center + 0.5), resolution_m=0.05, unknown_occupied=True)
        points = center + np.random.default_rng(1).uniform(-0.45, 0.45, (500, 3))
        plain = space.state(points)
        np.testing.assert_array_equal(careful.state(points) == vismap.FREE, plain == vismap.FREE)
        self.assertTrue(np.all(careful.state(points) != vismap.UNKNOWN))

    def test_save_load_ask(self):
        found, printed = self.run_example("Save, load, ask")
        self.assertIn("kitchen", printed)
        self.assertTrue((self.folder / "maps" / "kitchen.vismap").exists() or any((self.folder / "maps").glob("kitchen*")))
        self.assertGreaterEqual(found["facts"]["revision"], FRAMES)
        with self.assertRaisesRegex(vismap.RequestError, "save.*evil"):
            vismap.save(self.bus, "../evil")
        with self.assertRaisesRegex(vismap.RequestError, "nothing"):
            vismap.load(self.bus, "nothing")
        with self.assertRaisesRegex(vismap.RequestError, "dance.*objects"):
            vismap.ask(self.bus, "dance")

    def test_open_a_saved_map(self):
        (self.folder / "map.vismap").write_bytes(vismap.ask(self.bus, "map", timeout=DEADLINE).payload)
        found, _ = self.run_example("Open a saved map")
        saved, voxels = found["saved"], found["voxels"]
        self.assertEqual(set(voxels.segment.tolist()) - {0} <= set(saved.labels), True)
        self.assertGreater(len(voxels.centers_W), 10000)
        self.assertEqual(len(saved.trajectory), saved.revision)

    def test_read_and_write_logs(self):
        (self.folder / "run.lcmlog").unlink(missing_ok=True)
        _, printed = self.run_example("Read and write logs")
        self.assertIn("STATUS", printed)

    def test_messages_and_the_bus(self):
        detections = self.bus.subscribe("DETECTIONS")
        self.run_example("Messages and the bus")
        found = detections.get(DEADLINE).decode()
        self.assertEqual((found.source, found.seq, found.camera_id), ("my-detector", 0, 1))


if __name__ == "__main__":
    BIN = pathlib.Path(sys.argv.pop()).resolve()
    unittest.main()
