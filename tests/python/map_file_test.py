#!/usr/bin/env python3
"""Saved maps against what the offline mapper itself tells of them, and damaged files. Usage: map_file_test.py FOLDER_OF_PROGRAMS"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import tracemalloc
import unittest

import numpy as np
import support

import vismap
from vismap.map_file import _decode_blocks
from vismap.native import zstd_decompress
from vismap.proto import Schema

BIN = None  # from the command line


def read_ply(path):
    """The vertices of a binary PLY file as a structured array."""
    data = path.read_bytes()
    head, body = data.split(b"end_header\n", 1)
    kinds = {"float": "<f4", "double": "<f8", "uchar": "u1", "ushort": "<u2", "int": "<i4", "uint": "<u4"}
    vertex = re.search(rb"element vertex (\d+)\n((?:property \w+ \w+\n)+)", head)
    fields = [(name.decode(), kinds[kind.decode()]) for kind, name in re.findall(rb"property (\w+) (\w+)\n", vertex.group(2))]
    return np.frombuffer(body, np.dtype(fields), int(vertex.group(1)))


class MapFileTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        subprocess.run([BIN / "vismap-offline-mapper", "--dataset", "synthetic:room?frames=4&width=96", "--out", cls.folder],
                       check=True, capture_output=True, timeout=300)
        cls.path = cls.folder / "map.vismap"
        info = subprocess.run([BIN / "vismap-map", "info", cls.path, "--json"], check=True, capture_output=True, timeout=300)
        cls.facts = json.loads(info.stdout)
        cls.saved = vismap.open_map(cls.path)
        cls.blocks = list(cls.saved.blocks())
        cls.voxels = cls.saved.voxels()

    def test_facts_are_those_of_the_statistics(self):
        saved, facts = self.saved, self.facts
        self.assertEqual((saved.map_id, saved.revision, saved.last_utime), (facts["map_id"], facts["revision"], facts["last_utime"]))
        self.assertAlmostEqual(saved.voxel_size_m, facts["voxel_size_m"])
        self.assertAlmostEqual(saved.truncation_m, facts["truncation_m"], 6)
        self.assertEqual(len(saved.labels), facts["segments_ever"])
        self.assertEqual(sum(label.merged_into == 0 for label in saved.labels.values()), facts["segments"])
        self.assertEqual(len({saved.instance_of(label) for label in saved.labels} - {0}), facts["instances"])
        self.assertEqual(sum(len(b.surface_index) for b in self.blocks), facts["blocks_surface"])
        self.assertEqual(sum(len(b.free_index) for b in self.blocks), facts["blocks_partly_free"])
        self.assertEqual(sum(len(b.all_free_index) for b in self.blocks), facts["blocks_free"])
        self.assertGreater(len(self.blocks), 1)

    def test_trajectory(self):
        saved = self.saved
        self.assertEqual((saved.trajectory.shape, len(saved.utimes), len(saved.camera_ids)), ((4, 4, 4), 4, 4))
        self.assertTrue(np.all(np.diff(saved.utimes) > 0))
        self.assertEqual(saved.utimes[-1], saved.last_utime)
        for T in saved.trajectory:
            np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-6)
            np.testing.assert_array_equal(T[3], [0, 0, 0, 1])
        self.assertIn("integration", saved.config)

    def test_the_surface_of_the_mesh_is_where_the_distance_changes_its_sign(self):
        """Each vertex of mesh.ply lies between voxels on both sides of the surface, and has their labels and objects."""
        mesh = read_ply(self.folder / "mesh.ply")
        vertices = np.stack([mesh["x"], mesh["y"], mesh["z"]], axis=1).astype(np.float64)
        size = self.saved.voxel_size_m
        # Linear marching: signed distances at the voxel centres around a vertex, interpolated along its edge, give 0.
        def key(indices):
            return ((indices[..., 0] + 5000) * 10000 + indices[..., 1] + 5000) * 10000 + indices[..., 2] + 5000

        keys = key(np.floor(self.voxels.centers_W / size).astype(np.int64))
        order = np.argsort(keys)
        errors, same_segment, same_instance, missing = [], 0, 0, 0
        for vertex, row in list(zip(vertices, mesh))[::17]:
            grid = vertex / size - 0.5
            axis = int(np.argmax(np.abs(grid - np.round(grid))))
            if abs(grid[axis] - np.round(grid[axis])) < 0.01:
                continue  # at the centre of a voxel; any of its edges may have made the vertex
            low = np.round(grid).astype(np.int64)
            low[axis] = int(np.floor(grid[axis]))
            wanted = key(np.stack([low, low + np.eye(3, dtype=np.int64)[axis]]))
            ends = order[np.searchsorted(keys, wanted, sorter=order)]
            if not np.array_equal(keys[ends], wanted):
                missing += 1
                continue
            share = grid[axis] - low[axis]
            near, far = self.voxels.distance_m[ends]
            errors.append(abs((1 - share) * near + share * far))
            same_segment += row["segment"] in self.voxels.segment[ends]
            same_instance += row["instance"] in self.voxels.instance[ends]
        self.assertGreater(len(errors), 1000)
        self.assertLess(missing, 0.01 * len(errors))  # beside blocks that were only seen empty
        self.assertLess(np.quantile(errors, 0.99), 0.02 * size)
        self.assertGreater(same_segment, 0.95 * len(errors))
        self.assertGreater(same_instance, 0.95 * len(errors))

    def test_free_voxels_are_free_in_the_octree(self):
        space = vismap.Octree.open(self.folder / "octree.bt")
        size = self.saved.voxel_size_m
        block = next(b for b in self.blocks if len(b.all_free_index))
        centers = (block.all_free_index * 8 + 4) * size
        self.assertGreater(np.mean(space.is_free(centers)), 0.9)

    def test_every_cut_and_every_damaged_byte_is_noticed(self):
        data, rng = self.path.read_bytes(), np.random.default_rng(1)
        path = self.folder / "damaged.vismap"
        places = [*range(0, 28, 3), *rng.integers(0, len(data), 12).tolist()]
        for at in places:
            damaged = bytearray(data)
            damaged[at] ^= 1 << int(rng.integers(0, 8))
            for changed in (damaged, data[:at]):
                path.write_bytes(changed)
                with self.assertRaises(vismap.MapError, msg=f"byte {at}") as caught:
                    list(vismap.open_map(path).blocks())
                self.assertIn("damaged.vismap", str(caught.exception))

    def test_a_folder_or_nothing_is_told(self):
        for name in (".", "nothing.vismap"):
            with self.assertRaisesRegex(vismap.MapError, "cannot be read"):
                vismap.open_map(self.folder / name)


class HostileRecordsTest(unittest.TestCase):
    def test_blocks_that_are_not_there(self):
        for raw, blocks in ((b"", 1), (bytes(12), 1), (bytes(12) + b"\1", 1), (bytes(12) + b"\4", 1), (bytes(12) + b"\2" + bytes(127), 1),
                            (bytes(14), 1), (bytes(100), 1 << 30)):
            tracemalloc.start()
            with self.assertRaises(vismap.MapError):
                _decode_blocks(raw, blocks, 3, 0.03)
            self.assertLess(tracemalloc.get_traced_memory()[1], 1 << 20)
            tracemalloc.stop()

    def test_votes_for_labels_that_are_not_there(self):
        fields = bytes(512 * 2 + 512 * 2 + 512 + 512 * 3)
        votes = b"\1" + bytes(512 * 3 - 1) + bytes(512 * 3)
        good = bytes(12) + b"\1" + fields + votes + b"\1" + (3).to_bytes(4, "little")
        self.assertEqual(int(_decode_blocks(good, 1, 3, 0.03).labels[0, 0, 0, 0, 0]), 3)
        for labels, palette in ((2, b"\1\3\0\0\0"), (3, b"\1\0\0\0\0"), (3, b"\0"), (3, b"\xff")):
            with self.assertRaises(vismap.MapError):
                _decode_blocks(bytes(12) + b"\1" + fields + votes + palette, 1, labels, 0.03)

    def test_protobuf_that_is_cut_or_of_another_type(self):
        schema = Schema("message A { repeated double x = 1; B b = 2; repeated uint32 n = 3; int64 i = 4; } message B { bytes t = 1; }")
        data = b"\x0a\x08" + bytes(8) + b"\x12\x03\x0a\x01z" + b"\x1a\x03\x01\x80\x01" + b"\x20" + b"\xff" * 9 + b"\x01" + b"\x2a\x01?"
        found = schema.decode("A", data)
        self.assertEqual(found, {"x": [0.0], "b": {"t": b"z"}, "n": [1, 128], "i": -1})
        complete = {0, 10, 15, 20, 31, len(data)}
        for cut in set(range(len(data))) - complete:
            with self.assertRaises(vismap.MapError, msg=cut):
                schema.decode("A", data[:cut])
        for wrong in (b"\x08\x01", b"\x0a\x03abc", b"\x10\x01", b"\x22\x01a", b"\x0b", b"\x20" + b"\xff" * 11, b"\x0a\xff\xff\xff\xff\x0f"):
            with self.assertRaises(vismap.MapError):
                schema.decode("A", wrong)
        with self.assertRaisesRegex(vismap.MapError, "sint32"):
            Schema("message A { sint32 x = 1; }")

    def test_zstd_of_another_size(self):
        # A frame of raw blocks: magic, single segment with a size of one byte, one last raw block.
        frame = b"\x28\xb5\x2f\xfd\x20\x05" + (5 << 3 | 1).to_bytes(3, "little") + b"hello"
        self.assertEqual(zstd_decompress(frame, 5), b"hello")
        for data, size in ((frame, 4), (frame, 6), (frame[:-1], 5), (b"", 5), (b"garbage", 5)):
            with self.assertRaises(vismap.MapError):
                zstd_decompress(data, size)


if __name__ == "__main__":
    BIN = pathlib.Path(sys.argv.pop()).resolve()
    unittest.main()
