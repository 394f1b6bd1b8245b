#!/usr/bin/env python3
"""Real processes on a real hub: the example camera in, the map out, and every example of libs/python/README.md.

Usage: pipeline_test.py FOLDER_OF_PROGRAMS
"""
import contextlib
import importlib.util
import io
import json
import os
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np
from support import DEADLINE, PACKAGE, ROOT, Processes, python_blocks, wait_until

import vismap
from vismap.objects import objects_from_json

BIN = None  # from the command line
DRIVER = ROOT / "procs" / "examples" / "camera_driver.py"
FRAMES = 30
specification = importlib.util.spec_from_file_location("camera_driver", DRIVER)
camera_driver = importlib.util.module_from_spec(specification)
sys.modules["camera_driver"] = camera_driver
specification.loader.exec_module(camera_driver)


def distance_to_room(points):
    """Distance of points (N, 3) to the nearest surface of the room that the example camera sees [m]."""
    low, high = camera_driver.ROOM
    walls = np.minimum(np.abs(points - low), np.abs(points - high)).min(axis=1)
    low, high = camera_driver.BOX
    outside = np.linalg.norm(np.maximum(0, np.maximum(low - points, points - high)), axis=1)
    inside = np.minimum(points - low, high - points).min(axis=1)
    return np.minimum(walls, np.where(outside > 0, outside, np.abs(inside)))


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
        cls.start("driver", sys.executable, "-B", DRIVER)
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
        self.assertGreaterEqual(len(examples), 8)

    def test_frames_are_mapped_where_the_camera_saw_them(self):
        errors = distance_to_room(self.mesh.vertices.astype(np.float64))
        self.assertGreater(len(errors), 5000)
        self.assertLess(np.median(errors), 0.003)
        self.assertLess(np.quantile(errors, 0.99), 0.02)
        self.assertGreater(len(np.unique(self.mesh.segment)), 3)

    def test_colors_of_the_map_are_those_of_the_camera(self):
        """The box is yellow, the walls are not."""
        low, high = camera_driver.BOX
        on_box = np.all((self.mesh.vertices > low - 0.02) & (self.mesh.vertices < high + 0.02), axis=1) & (self.mesh.vertices[:, 2] > 0.1)
        self.assertGreater(np.sum(on_box), 100)
        box, walls = self.mesh.colors[on_box].mean(axis=0), self.mesh.colors[~on_box].mean(axis=0)
        self.assertGreater(box[0] - box[2], 50)
        self.assertLess(walls[0] - walls[2], -30)

    def test_depth_of_the_segmenter_is_that_of_the_camera(self):
        """The segmenter packs the depth in our own code, and takes pixels out of it."""
        sent = {message.utime: message for message in (self.frames.get(DEADLINE).decode() for _ in range(10))}
        while (segmented := self.segmented.get(DEADLINE).decode()).frame.utime not in sent:
            pass
        before, after = vismap.depth_of(sent[segmented.frame.utime]), vismap.depth_of(segmented.frame)
        self.assertEqual(before.shape, after.shape)
        left = np.isfinite(after)
        self.assertGreater(np.mean(left), 0.5)
        np.testing.assert_allclose(before[left], after[left], atol=1e-5)

    def test_live_surface_has_the_digest_of_the_server(self):
        self.processes.stop("driver")
        self.addCleanup(self.start, "driver", sys.executable, "-B", DRIVER)
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

    def test_live_space_has_the_digest_of_the_server(self):
        self.run_example("The live space: free, occupied and unknown voxels")
        self.processes.stop("driver")
        self.addCleanup(self.start, "driver", sys.executable, "-B", DRIVER)
        with vismap.LiveSpace(self.bus) as live:
            live.wait()
            wait_until(lambda: vismap.ask(self.bus, "statistics").json()["occupancy_digest"] == live.digest, "equality of the digests")
            space = live.space()
        self.assertEqual(space.at([2.5, 1.5, 1.0]), vismap.FREE, "above the box")
        self.assertEqual(space.at([9.0, 9.0, 9.0]), vismap.UNKNOWN)
        obstacles = space.centers_W(vismap.OCCUPIED)
        self.assertGreater(len(obstacles), 1000)
        self.assertLess(np.median(np.abs(distance_to_room(obstacles))), 0.03)

    def test_doctor_calls_the_camera_healthy(self):
        doctor = subprocess.run([BIN / "vismap-doctor", "--seconds", "3", "--json", "--lcm-url", self.url], capture_output=True,
                                text=True, timeout=DEADLINE)
        report = json.loads(doctor.stdout)
        told = [finding for finding in report["findings"] if "camera-driver" in json.dumps(finding) or "RGBD_FRAME" in json.dumps(finding)]
        self.assertEqual(told, [], doctor.stdout)
        self.assertIn("camera-driver", doctor.stdout)
        states = self.bus.subscribe("STATUS")  # self.states still has those of the beginning
        status = next(s for s in iter(lambda: states.get(DEADLINE).decode(), None) if s.process == "camera-driver" and s.state == "running")
        counters = dict(zip(status.counter_names, status.counter_values.tolist()))
        self.assertGreater(counters["newest_utime.camera0"], vismap.now_utime() - 60_000_000)
        self.assertEqual(status.version, vismap.version())

    def test_publish_frames_from_arrays(self):
        before = self.mesh.revision
        commits = self.bus.subscribe("MAP_COMMIT")
        self.run_example("Publish frames from arrays")
        while (commit := commits.get(DEADLINE).decode()).camera_id != 1:
            pass
        self.assertEqual((commit.status, commit.reason), (commit.STATUS_INTEGRATED, ""))
        self.assertGreater(commit.revision, before)

    def test_live_map(self):
        found, printed = self.run_example("The live map: vertices, faces and ids")
        mesh = found["mesh"]
        self.assertGreaterEqual(mesh.revision, FRAMES)
        self.assertIn(str(mesh.vertices.shape), printed)

    def test_objects_with_boxes(self):
        """Without a detector, the box in the room is a discovered object; its oriented box is known."""
        self.run_example("Objects with boxes")
        objects = [o for o in vismap.get_objects(self.bus) if o.box is not None and not o.kind]
        found = min(objects, key=lambda o: float(np.linalg.norm(o.box.center_W - camera_driver.BOX.mean(axis=0))))
        self.assertTrue(found.box.contains(camera_driver.BOX.mean(axis=0)), found)
        self.assertLess(np.abs(np.sort(found.box.size_m) - [0.6, 0.6, 0.7]).max(), 0.15, found)
        with self.assertRaisesRegex(vismap.RequestError, "rejected the request 'objects'.*unicorn"):
            vismap.get_objects(self.bus, "class=unicorn")

    def test_objects_of_the_request_and_of_the_channel_are_the_same(self):
        self.processes.stop("driver")  # so that the map does not change
        self.addCleanup(self.start, "driver", sys.executable, "-B", DRIVER)
        commits = self.bus.subscribe("MAP_COMMIT")
        while commits.poll(2) is not None:
            pass
        published = self.bus.subscribe("OBJECTS")
        objects = vismap.get_objects(self.bus)  # the server publishes them, too
        told = subprocess.run([BIN / "vismap-map", "objects", "live", "--json", "--lcm-url", self.url], check=True, capture_output=True,
                              timeout=DEADLINE)
        self.assertEqual([o.segments for o in objects], [o.segments for o in objects_from_json(json.loads(told.stdout))])
        by_segments = {o.segments: o for o in vismap.objects_of(published.latest(DEADLINE).decode())}
        compared = [o for o in objects if not o.kind and o.box is not None]  # OBJECTS does not have the planes of the structure
        self.assertGreater(len(compared), 0)
        for found in compared:
            live = by_segments[found.segments]
            np.testing.assert_allclose(live.box.corners_W(), found.box.corners_W(), atol=1e-4)
            self.assertEqual((live.instance, live.points, live.frames), (found.instance, found.points, found.frames))

    def test_clearance_grid_and_frontiers(self):
        self.start("exporter", BIN / "vismap-octomap-exporter")
        self.addCleanup(self.processes.stop, "exporter")
        status = self.bus.subscribe("NAVIGATION")
        while not (navigation := status.get(DEADLINE).decode()).in_sync or navigation.revision < FRAMES:
            pass
        self.processes.stop("driver")
        self.addCleanup(self.start, "driver", sys.executable, "-B", DRIVER)
        found, _ = self.run_example("Clearance, a grid for wheels, frontiers")
        self.assertEqual(found["clearance"].limit_m, 2.0)
        points = np.array([[2.0, 1.5, 1.0], [2.5, 1.5, 1.1], [2.5, 1.5, 0.35], [9.0, 9.0, 9.0]])
        clearance = vismap.distance(self.bus, points)
        for i in range(2):
            # A leaf of 5 cm is occupied when any surface is in it, so that its far corner may count.
            expected = float(distance_to_room(points[i:i + 1])[0])
            self.assertLess(clearance.obstacle_m[i], expected + 0.02)
            self.assertGreater(clearance.obstacle_m[i], expected - 0.05 * 3 ** 0.5)
        self.assertEqual(clearance.distance_m[2], 0, "inside of the box")
        self.assertEqual((clearance.distance_m[3], clearance.nearest[3]), (0, "UNKNOWN"))
        np.testing.assert_allclose(np.linalg.norm(clearance.gradient, axis=1), [1, 1, 0, 0], atol=1e-9)
        np.testing.assert_array_equal(clearance.distance_m, np.minimum(clearance.obstacle_m, clearance.unknown_m))
        grid = vismap.grid(self.bus, band_m=(0.6, 0.8))
        self.assertEqual(int(grid.state([2.5, 1.5])), vismap.OCCUPIED, "the top of the box")
        self.assertEqual(int(grid.state([90.0, 1.5])), vismap.UNKNOWN)
        self.assertTrue(np.all(grid.distances_m[grid.states != vismap.FREE] == 0))
        frontiers = vismap.frontiers(self.bus)
        sizes = [frontier.leaves for frontier in frontiers]
        self.assertEqual(sizes, sorted(sizes, reverse=True))
        np.testing.assert_allclose(vismap.distance(self.bus, frontiers[0].member_W).unknown_m, 0.025, atol=1e-6)
        seen = [frontier.viewpoint_W for frontier in frontiers if frontier.viewpoint_W is not None]
        self.assertGreater(np.min(vismap.distance(self.bus, seen).distance_m), 0.2)
        self.check_distances_in_a_box(found["near"])
        self.check_questions_without_the_box(grid, frontiers)
        with self.assertRaisesRegex(vismap.RequestError, "band: expected the lower height first"):
            vismap.grid(self.bus, band_m=(1, 0.5))
        with self.assertRaisesRegex(vismap.RequestError, "argument: expected key=value.*found 'colour=red'"):
            vismap.ask(self.bus, "grid", "colour=red")

    def check_distances_in_a_box(self, near):
        self.assertEqual((near.limit_m, near.resolution_m, near.base_revision), (2.0, 0.05, -1))
        corners = (near.blocks[:, None] * 8 + np.stack(np.meshgrid(*[np.arange(8)] * 3, indexing="ij"), -1).reshape(1, -1, 3) + 0.5) * 0.05
        centers = corners.reshape(-1, 3)[::97]
        np.testing.assert_array_equal(near.at(centers)[0], near.obstacle_m.reshape(-1)[::97])
        clearance = vismap.distance(self.bus, centers)
        while near.revision != clearance.revision:  # until the last frames are in the map
            near, clearance = vismap.distances(self.bus, ([1.5, 1.0, 0.5], [2.5, 2.0, 1.5])), vismap.distance(self.bus, centers)
        obstacle, unknown = near.at(centers)
        np.testing.assert_allclose(unknown, clearance.unknown_m, atol=1e-5)
        inside = clearance.unknown_m > 0
        self.assertGreater(np.sum(inside), 100)
        np.testing.assert_allclose(obstacle[inside], clearance.obstacle_m[inside], atol=1e-5)

    def check_questions_without_the_box(self, grid, frontiers):
        objects = [o for o in vismap.get_objects(self.bus) if o.box is not None and not o.kind]
        found = min(objects, key=lambda o: float(np.linalg.norm(o.box.center_W - camera_driver.BOX.mean(axis=0))))
        without, top = f"id=s{found.segments[0]}", [2.5, 1.5, 0.69]
        self.assertEqual(float(vismap.distance(self.bus, top).obstacle_m), 0)
        self.assertGreater(float(vismap.distance(self.bus, top, without=without).obstacle_m), 0)
        emptied = vismap.grid(self.bus, band_m=(0.6, 0.8), without=without)
        self.assertNotEqual(int(emptied.state([2.5, 1.5])), vismap.OCCUPIED, "its top is free, its inside unknown")
        box = ([2.3, 1.3, 0.6], [2.6, 1.6, 0.8])
        self.assertGreater(float(vismap.distances(self.bus, box, without=without).at(top)[0]), float(vismap.distances(self.bus, box).at(top)[0]))
        # What the box hid is unknown, so that its place has a frontier to the space above it, which is free.
        around = ([2.2, 1.2, 0.0], [2.8, 1.8, 0.75])
        before = sum(frontier.leaves for frontier in vismap.frontiers(self.bus, around, least_leaves=1))
        after = sum(frontier.leaves for frontier in vismap.frontiers(self.bus, around, without=without, least_leaves=1))
        self.assertGreater(after, before)
        self.assertLess(len(vismap.frontiers(self.bus, least_leaves=200)), len(frontiers))
        self.assertEqual(vismap.grid(self.bus, band_m=(0.6, 0.8), limit_m=0.3).distances_m.max(), np.float32(0.3))
        self.assertGreater(grid.distances_m.max(), 0.3)

    def test_all_verbs_can_be_asked(self):
        """Those of the programs are those of the table in the README, and each has an answer."""
        sources = [ROOT / "procs" / folder for folder in ("map_server/map_requests.cc", "octomap_exporter/exporter.cc")]
        verbs = set()
        for source in sources:
            text = source.read_text()
            verbs |= set(re.findall(r'Handle(?:Late|Reading)?\(\s*"([a-z-]+)"', text)) | set(re.findall(r'\{"([a-z]+)", Answer\w+\}', text))
        self.assertGreaterEqual(len(verbs), 20)
        rows = re.findall(r"^\| (`[a-z].*?) \|", (PACKAGE / "README.md").read_text(), re.MULTILINE)
        self.assertEqual({verb for row in rows for verb in re.findall(r"`([a-z-]+)`", row)}, verbs)
        self.start("exporter", BIN / "vismap-octomap-exporter", "--config", self.write_config())
        self.addCleanup(self.processes.stop, "exporter")
        states = self.bus.subscribe("NAVIGATION")
        while states.get(DEADLINE).decode().revision < FRAMES:
            pass
        box = ([1.5, 1.0, 0.5], [2.5, 2.0, 1.5])
        encodings = {"objects": "json", "mesh": "ply", "points": "ply", "octree": "bt", "octomap": "bt", "map": "vismap", "statistics": "json",
                     "frames": "json", "cell": "json", "clearance": "json", "frontiers": "json", "grid": "occupancy_grid_t", "distances": "distance_field_t"}
        arguments = {"mesh": "ply", "points": "id=s1", "clearance": "at=2,1.5,1", "cell": "at=2,1.5,1", "frames": "positions=0"}
        for verb in sorted(verbs - {"save", "load", "reset"}):
            with self.subTest(verb=verb):
                reply = vismap.ask(self.bus, verb, arguments.get(verb, ""), box_W=box if verb == "distances" else None,
                                   without="id=s1" if verb == "occupancy" else "", timeout=DEADLINE)
                self.assertEqual(reply.encoding, encodings.get(verb, reply.encoding))
                self.assertEqual(bool(reply.payload), bool(reply.encoding))
        colored = vismap.ask(self.bus, "octree", color=True)
        self.assertEqual(colored.encoding, "ot")
        self.assertIn(b"ColorOcTree", colored.payload[:200])
        path = self.folder / "asked.vismap"
        path.write_bytes(vismap.ask(self.bus, "map", timeout=DEADLINE).payload)
        self.assertGreater(len(vismap.open_map(path).labels), 3)

    def write_config(self):
        path = self.folder / "exporter.txtpb"
        path.write_text("octomap_exporter { distance_limit_m: 2 grid_period_s: 1 }\n")
        return path

    def test_free_space_and_obstacles(self):
        found, _ = self.run_example("Is this point free, and how far is the next obstacle")
        space, eye = found["space"], np.array([1.4, 1.5, 1.3])
        self.assertTrue(space.is_free(eye))
        self.assertTrue(space.is_free([2.5, 1.5, 1.0]), "above the box")
        self.assertFalse(space.is_free([2.5, 1.5, 0.35]), "inside of the box")
        self.assertEqual(space.state([9.0, 9.0, 9.0]), vismap.UNKNOWN)
        for point in ([2.0, 1.5, 1.0], [2.5, 1.5, 1.1], [3.0, 1.5, 1.2]):
            expected = float(distance_to_room(np.array([point]))[0])
            self.assertAlmostEqual(float(space.distance(point)), expected, delta=0.06, msg=point)
        box = ([1.5, 1.0, 0.2], [3.5, 2.0, 1.5])
        careful = vismap.read_octree(self.bus, box, resolution_m=0.05, unknown_occupied=True)
        self.assertTrue(careful.is_occupied([2.5, 1.5, 0.35]), "inside of the box it is unknown, which counts as occupied")

    def check_tree_without_the_box(self):
        objects = [o for o in vismap.get_objects(self.bus) if o.box is not None and not o.kind]
        found = min(objects, key=lambda o: float(np.linalg.norm(o.box.center_W - camera_driver.BOX.mean(axis=0))))
        around, top, floor = ([2.0, 1.0, -0.1], [3.0, 2.0, 0.9]), [2.5, 1.5, 0.69], [2.1, 1.5, -0.01]
        whole = vismap.tree_without(self.bus, "", around, resolution_m=0.02, timeout=DEADLINE)
        self.assertTrue(whole.is_occupied(top))
        tree = vismap.tree_without(self.bus, f"id=s{found.segments[0]}", around, resolution_m=0.02, timeout=DEADLINE)
        self.assertTrue(tree.is_free(top), found)
        self.assertTrue(whole.is_occupied(floor) and tree.is_occupied(floor))
        with self.assertRaisesRegex(vismap.RequestError, "no object with id s99999"):
            vismap.tree_without(self.bus, "id=s99999", around, timeout=DEADLINE)

    def test_live_octree_and_its_age(self):
        self.start("exporter", BIN / "vismap-octomap-exporter")
        found, printed = self.run_example("The live octree, for planners")
        space = found["space"]
        self.assertTrue(space.is_free([2.5, 1.5, 1.0]), "above the box")
        self.assertTrue(space.is_occupied([2.5, 1.5, 0.35]), "inside of the box it is unknown, which counts as occupied")
        self.assertIn("True", printed)
        with vismap.LiveOctree(self.bus) as live:
            tree = live.wait(timeout=DEADLINE, revision=FRAMES)
            self.assertLess(live.age_s, 10)
            self.assertIs(live.octree(), live.octree(max_age_s=60))
            self.assertEqual(live.why_stale, "")
            self.assertTrue(tree.is_occupied([9.0, 1.5, 1.0]) or tree.state([9.0, 1.5, 1.0]) == vismap.UNKNOWN)
            self.check_tree_without_the_box()
            self.processes.running["exporter"].kill()
            start = time.monotonic()
            wait_until(lambda: live.why_stale, "that the tree is stale")
            self.assertLess(time.monotonic() - start, 3)
            self.assertRegex(live.why_stale, r"the octomap exporter was not heard for \d")
            self.assertIsNone(live.octree(max_age_s=60))
            self.assertIsNotNone(live.octree())
        self.processes.running.pop("exporter").wait()

    def test_save_load_ask(self):
        found, printed = self.run_example("Save, load, ask")
        self.assertIn("kitchen", printed)
        self.assertGreater(found["facts"]["frames"], 0)
        before = vismap.ask(self.bus, "statistics")
        self.assertIn("the map is empty now", vismap.reset(self.bus))
        self.assertNotEqual(vismap.ask(self.bus, "statistics").map_id, before.map_id)
        vismap.load(self.bus, "kitchen")
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
        near = np.abs(voxels.distance_m) < 0.6 * saved.voxel_size_m
        self.assertGreater(np.sum(near), 1000)
        self.assertLess(np.quantile(distance_to_room(voxels.centers_W[near]), 0.9), saved.voxel_size_m)
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

    def test_a_log_of_our_frames_can_be_mapped(self):
        """What LogWriter writes, the offline mapper reads: frames of the example camera."""
        path, source = self.folder / "frames.lcmlog", camera_driver.Source(100.0)
        with vismap.LogWriter(path, overwrite=True) as log:
            for i in range(5):
                images = source.wait_for_images()
                message = vismap.frame_message(images.depth, source.pose(images.device_s), source.camera, images.color, utime=1000 * (i + 1))
                message.seq, message.source = i, "camera"
                log.write("RGBD_FRAME", message)
        subprocess.run([BIN / "vismap-log", "verify", path], check=True, capture_output=True, timeout=DEADLINE)
        out = self.folder / "offline"
        subprocess.run([BIN / "vismap-offline-mapper", "--dataset", path, "--out", out], check=True, capture_output=True, timeout=DEADLINE)
        self.assertEqual(vismap.open_map(out / "map.vismap").utimes.tolist(), [1000, 2000, 3000, 4000, 5000])

    def test_depth_of_a_camera_beside_the_color_camera_is_mapped(self):
        """Depth in metres with its own optics and viewpoint, grey colour of another size: the map is where the room is."""
        path, out = self.folder / "beside.lcmlog", self.folder / "beside"
        color_camera, depth_camera = vismap.Camera(400, 300, 380.0, 380.0, 199.5, 149.5), vismap.Camera(240, 180, 200.0, 205.0, 118.0, 91.0)
        angle, T_color_depth = 0.03, np.eye(4)
        T_color_depth[:3, :3] = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
        T_color_depth[:3, 3] = [0.05, 0.01, -0.02]
        with vismap.LogWriter(path, overwrite=True) as log:
            for i in range(4):
                T_W_C = camera_driver.Source(10.0).pose(0.3 * i)
                color, _ = camera_driver.render_room(color_camera, T_W_C)
                _, depth = camera_driver.render_room(depth_camera, T_W_C @ T_color_depth)
                log.write("RGBD_FRAME", vismap.frame_message(depth, T_W_C, color_camera, color[:, :, 1], depth_camera=depth_camera,
                                                             T_color_depth=T_color_depth, utime=100_000 * (i + 1)))
        subprocess.run([BIN / "vismap-offline-mapper", "--dataset", path, "--out", out], check=True, capture_output=True, timeout=DEADLINE)
        saved = vismap.open_map(out / "map.vismap")
        self.assertEqual(saved.revision, 4)
        voxels = saved.voxels()
        near = np.abs(voxels.distance_m) < 0.6 * saved.voxel_size_m
        self.assertGreater(np.sum(near), 10000)
        self.assertLess(np.quantile(distance_to_room(voxels.centers_W[near]), 0.9), saved.voxel_size_m)


class OtherBusesTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.processes = Processes(BIN, temporary.name)
        self.addCleanup(self.processes.stop_all)
        os.environ["PYTHONPATH"] = str(PACKAGE)

    def test_the_same_on_multicast(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            url = f"udpm://239.255.76.69:{probe.getsockname()[1]}?ttl=0&recv_buf_size=200000"
        try:
            bus = vismap.Bus(url)
        except vismap.BusError as error:
            self.skipTest(f"no multicast here: {error}")
        self.addCleanup(bus.close)
        states = bus.subscribe("STATUS")
        for name, program, *options in (("segmenter", "vismap-depth-segmenter", "--detections", "none"), ("server", "vismap-map-server")):
            self.processes.start(name, BIN / program, "--lcm-url", url, *options)
        ready = set()
        while not {"depth-segmenter", "map-server"} <= ready:
            status = states.get(DEADLINE).decode()
            ready |= {status.process} if status.state in ("ready", "running") else set()
        commits = bus.subscribe("MAP_COMMIT")
        T_W_C = camera_driver.Source(10.0).pose(0.0)
        camera = vismap.Camera(160, 120, 140.0, 140.0, 79.5, 59.5)
        depth = camera_driver.render_room(camera, T_W_C)[1].astype(np.float32)
        vismap.publish_frame(bus, depth, T_W_C, camera)  # 77 kB, two datagrams
        self.assertEqual(commits.get(DEADLINE).decode().status, 0)
        self.assertEqual(vismap.ask(bus, "statistics", timeout=DEADLINE).json()["frames"], 1)

    def test_driver_and_readers_survive_a_restart_of_the_hub(self):
        url = self.processes.start_hub()
        self.processes.start("driver", sys.executable, "-B", DRIVER, "--lcm-url", url)
        with vismap.Bus(url) as bus:
            frames = bus.subscribe("RGBD_FRAME")
            first = frames.get(DEADLINE).decode()
            self.processes.stop("hub")
            wait_until(lambda: not bus.connected)
            self.processes.start_hub(url.removeprefix("tcpq://"))
            wait_until(lambda: bus.connected)
            while (later := frames.get(DEADLINE).decode()).utime < first.utime + 500_000:
                pass
            self.assertGreater(later.seq, first.seq)
        self.assertIsNone(self.processes.running["driver"].poll())
        self.assertEqual(self.processes.stop("driver"), 0)
        self.assertIn("again", self.processes.log("driver"))


if __name__ == "__main__":
    BIN = pathlib.Path(sys.argv.pop()).resolve()
    unittest.main()
