#!/usr/bin/env python3
"""The reader of OctoMap's streams and its queries, against trees that are walked node by node."""
import itertools
import pathlib
import shutil
import struct
import subprocess
import tempfile
import tracemalloc
import unittest

import numpy as np
import support

import vismap

RESOLUTION = 0.1


def random_tree(rng, depth=0):
    """A node: None = unknown, True or False = occupied or free leaf, a list of eight = inner. Few inner nodes near the root."""
    if depth == 16:
        return bool(rng.integers(0, 2))
    share = 0.9 if depth < 12 else 0.35
    children = [None] * 8
    # Around the origin, so that the leaves are near each other.
    chosen = [7 if depth == 0 else 0] if depth < 8 else list(rng.choice(8, int(rng.integers(1, 6)), replace=False))
    for child in chosen:
        inner = depth < 8 or rng.random() < share
        children[child] = random_tree(rng, depth + 1) if inner and depth < 15 else bool(rng.integers(0, 2))
    return children


def count(node):
    return 0 if node is None else 1 if isinstance(node, bool) else 1 + sum(map(count, node))


def encode_bt(node):
    word = 0
    for child, kind in enumerate(node):
        word |= (0 if kind is None else 3 if isinstance(kind, list) else 2 if kind else 1) << (2 * child)
    return struct.pack("<H", word) + b"".join(encode_bt(child) for child in node if isinstance(child, list))


def encode_ot(node):
    if isinstance(node, bool):
        return struct.pack("<fB", 1.5 if node else -0.7, 0)
    mask = sum(1 << i for i, child in enumerate(node) if child is not None)
    return struct.pack("<fB", 0.3, mask) + b"".join(encode_ot(child) for child in node if child is not None)


def stream(node, kind="bt", size=None):
    name = b"OcTree binary" if kind == "bt" else b"OcTree"
    body = (encode_bt if kind == "bt" else encode_ot)(node) if node is not None else b""
    head = b"# Octomap %s file\n# a comment\nid OcTree\nsize %d\nres %g\ndata\n" % (name, count(node) if size is None else size, RESOLUTION)
    return head + body


def naive_state(node, point):
    low, edge = np.full(3, -32768 * RESOLUTION), 65536 * RESOLUTION
    if np.any(point < low) or np.any(point >= low + edge):
        return vismap.UNKNOWN
    while isinstance(node, list):
        edge /= 2
        upper = point >= low + edge
        low = low + upper * edge
        node = node[int(upper[0]) + 2 * int(upper[1]) + 4 * int(upper[2])]
    return vismap.UNKNOWN if node is None else int(node)


def leaves(node, low=np.full(3, -32768 * RESOLUTION), edge=65536 * RESOLUTION):
    if isinstance(node, bool):
        yield low, edge, node
    elif node is not None:
        for i, child in enumerate(node):
            yield from leaves(child, low + edge / 2 * np.array([i & 1, i >> 1 & 1, i >> 2]), edge / 2)


class OctreeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.tree = random_tree(np.random.default_rng(4))
        cls.octree = vismap.Octree.from_bytes(stream(cls.tree))
        cls.boxes = list(leaves(cls.tree))

    def points(self, count):
        rng = np.random.default_rng(5)
        lows = np.array([low for low, _, _ in self.boxes])
        return rng.uniform(lows.min(axis=0) - 1, lows.max(axis=0) + 1, (count, 3))

    def test_the_tree_is_worth_it(self):
        self.assertGreater(len(self.boxes), 300)
        self.assertEqual(len(self.octree), len(self.boxes))
        self.assertGreater(len({edge for _, edge, _ in self.boxes}), 3)

    def test_states_are_those_of_a_walk_down_the_tree(self):
        points = np.concatenate([self.points(3000), [low + 0.5 * edge for low, edge, _ in self.boxes]])
        expected = [naive_state(self.tree, point) for point in points]
        self.assertEqual(set(expected), {vismap.FREE, vismap.OCCUPIED, vismap.UNKNOWN})
        self.assertEqual(self.octree.state(points).tolist(), expected)
        self.assertEqual(self.octree.is_free(points).tolist(), [state == vismap.FREE for state in expected])
        self.assertEqual(self.octree.is_occupied(points[0]), expected[0] == vismap.OCCUPIED)
        self.assertEqual(self.octree.state(points.reshape(2, -1, 3)).shape, (2, len(points) // 2)) if len(points) % 2 == 0 else None

    def test_outside_and_not_finite_is_unknown(self):
        for point in ([1e9, 0, 0], [-1e300, 0, 0], [np.nan, 0, 0], [np.inf, 0, 0]):
            self.assertEqual(self.octree.state(point), vismap.UNKNOWN)

    def test_distances_are_those_to_the_nearest_occupied_box(self):
        occupied = [(low, edge) for low, edge, full in self.boxes if full]
        for point in self.points(200):
            expected = min(float(np.linalg.norm(np.maximum(0, np.maximum(low - point, point - low - edge)))) for low, edge in occupied)
            distance, nearest = self.octree.nearest_obstacle(point)
            self.assertAlmostEqual(distance, expected, 9)
            self.assertAlmostEqual(float(self.octree.distance(point)), expected, 9)
            self.assertAlmostEqual(float(np.linalg.norm(nearest - point)), expected, 9)
        inside = occupied[0][0] + 0.5 * occupied[0][1]
        self.assertEqual(self.octree.distance([inside, inside]).tolist(), [0, 0])

    def test_both_formats_give_the_same_leaves(self):
        other = vismap.Octree.from_bytes(stream(self.tree, "ot"))
        for mine, theirs in zip(self.octree.leaves(), other.leaves()):
            np.testing.assert_array_equal(mine, theirs)
        expected = sorted((*(low + edge / 2), edge, full) for low, edge, full in self.boxes)
        found = sorted((*center, edge, bool(full)) for center, edge, full in zip(*self.octree.leaves()))
        np.testing.assert_allclose(np.array(found, float), np.array(expected, float), atol=1e-9)

    def test_what_octomap_itself_makes_of_it(self):
        if not shutil.which("convert_octree"):
            self.skipTest("no octomap-tools")
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "a.bt"
            path.write_bytes(stream(self.tree))
            subprocess.run(["convert_octree", str(path), str(path.with_suffix(".ot"))], check=True, timeout=support.DEADLINE,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            other = vismap.Octree.open(path.with_suffix(".ot"))
        points = self.points(2000)
        np.testing.assert_array_equal(other.state(points), self.octree.state(points))

    def test_an_empty_tree(self):
        for kind in ("bt", "ot"):
            empty = vismap.Octree.from_bytes(stream(None, kind))
            self.assertEqual((empty.state([0, 0, 0]), float(empty.distance([0, 0, 0]))), (vismap.UNKNOWN, np.inf))

    def test_points_of_another_shape(self):
        for points in ([1, 2], 3.0, [[1, 2, 3, 4]]):
            with self.assertRaisesRegex(ValueError, "3 coordinates"):
                self.octree.state(points)


class HostileOctreeTest(unittest.TestCase):
    def test_everything_that_octomap_cannot_have_written_is_refused(self):
        tree = random_tree(np.random.default_rng(6))
        for kind in ("bt", "ot"):
            whole = stream(tree, kind)
            begin = whole.index(b"data\n") + 5
            for cut in (*range(begin, len(whole), 3), 10, 40):
                with self.assertRaises(vismap.MapError):
                    vismap.Octree.from_bytes(whole[:cut])
            for data, words in ((whole + b"\0\0", "left after"), (stream(tree, kind, 5), "promises 5 nodes"),
                                (stream(tree, kind, 10 ** 9), "at most"), (whole.replace(b"id OcTree", b"id ColorOcTree"), "ColorOcTree"),
                                (whole.replace(b"res 0.1", b"res -1 "), "res -1"), (whole.replace(b"res 0.1", b"rex 0.1"), "no res"),
                                (whole.replace(b"data\n", b"date\n"), "no end"), (b"P6\n" + whole, "do not begin")):
                with self.assertRaisesRegex(vismap.MapError, words):
                    vismap.Octree.from_bytes(data)

    def test_a_tree_that_is_too_deep(self):
        for kind, depth in itertools.product(("bt", "ot"), (17, 40)):
            node = True
            for _ in range(depth):
                node = [node] + [None] * 7
            with self.assertRaisesRegex(vismap.MapError, "16 levels"):
                vismap.Octree.from_bytes(stream(node, kind))

    def test_random_damage_takes_bounded_memory(self):
        rng = np.random.default_rng(7)
        whole = stream(random_tree(rng))
        begin = whole.index(b"data\n") + 5
        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        for _ in range(300):
            damaged = bytearray(whole)
            damaged[int(rng.integers(begin, len(whole)))] = int(rng.integers(0, 256))
            try:
                vismap.Octree.from_bytes(bytes(damaged))
            except vismap.MapError:
                pass
        self.assertLess(tracemalloc.get_traced_memory()[1], 1000 * len(whole) + (1 << 20))


if __name__ == "__main__":
    unittest.main()
