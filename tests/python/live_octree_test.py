#!/usr/bin/env python3
"""The newest octree with its age: who is silent, what is old, and which trees are not taken."""
import time
import unittest
from unittest import mock

import support

import vismap
from vismap import live_octree

TYPES = vismap.types
HEADER = b"# Octomap OcTree binary file\nid OcTree\nsize %d\nres 0.1\ndata\n"
# A root of which one child is an occupied leaf, and one a free one.
TREE = HEADER % 3 + bytes([0b0110, 0])


class FakeBus:
    """Hands over what the test puts in."""

    url, connected = "fake", True

    def __init__(self):
        self.queue, self.idle = [], 0

    def subscribe(self, pattern):
        self.pattern = pattern
        return self

    def poll(self, timeout):
        if not self.queue:
            self.idle += 1
            time.sleep(0.001)
            return None
        return self.queue.pop(0)

    def close(self):
        pass


class LiveOctreeTest(unittest.TestCase):
    def setUp(self):
        self.now = 1000.0
        clock = mock.patch.object(live_octree, "time", mock.Mock(monotonic=lambda: self.now))
        clock.start()
        self.addCleanup(clock.stop)
        self.bus = FakeBus()
        self.live = vismap.LiveOctree(self.bus)
        self.addCleanup(self.live.close)

    def put(self, channel, message):
        self.bus.queue.append(vismap.Received(channel, vismap.encode(message), 0))
        idle = self.bus.idle + 1  # one poll may have begun before the message was there
        support.wait_until(lambda: not self.bus.queue and self.bus.idle > idle)

    def tree(self, revision=5, unknown=1, data=TREE, nodes=3, map_id="m"):
        self.put("OCTOMAP", TYPES["vismap.octree_t"](map_id=map_id, revision=revision, unknown=unknown, data=data, n_nodes=nodes, resolution_m=0.1))

    def status(self, revision=5, silent_s=0.0, **changed):
        fields = dict(map_id="m", revision=revision, in_sync=True, published_utime=10**9, server_utime=10**9 - int(silent_s * 1e6))
        self.put("NAVIGATION", TYPES["vismap.navigation_status_t"](**{**fields, **changed}))

    def test_age_revision_and_points(self):
        self.assertIn("nothing was heard of the octomap exporter yet", self.live.why_stale)
        self.assertEqual((self.live.revision, self.live.age_s, self.live.octree()), (-1, float("inf"), None))
        self.tree()
        self.assertIn("NAVIGATION", self.live.why_stale)
        self.status(silent_s=0.5)
        self.assertEqual((self.live.why_stale, self.live.revision), ("", 5))
        self.assertAlmostEqual(self.live.age_s, 0.5)
        self.now += 1
        self.assertAlmostEqual(self.live.age_s, 1.5)
        tree = self.live.octree(max_age_s=2)
        self.assertIs(self.live.octree(), tree)
        self.assertEqual(len(tree), 2)
        self.assertIsNone(self.live.octree(max_age_s=1))
        self.status()
        self.assertAlmostEqual(self.live.age_s, 0)
        self.tree(revision=6)
        self.assertEqual(self.live.revision, 6)
        self.assertIsNot(self.live.octree(), tree)

    def test_who_is_silent(self):
        self.tree()
        self.status()
        self.now += 2.9
        self.assertEqual(self.live.why_stale, "the octomap exporter was not heard for 2.9 s")
        self.tree()  # sent again, which says nothing of the map server
        self.assertEqual(self.live.why_stale, "the map server was not heard for 2.9 s")
        self.assertAlmostEqual(self.live.age_s, 2.9)
        self.put("STATUS", TYPES["vismap.process_status_t"](process="map-server", state="running"))
        self.assertEqual(self.live.why_stale, "")
        self.bus.connected = False
        self.assertIn("no connection to the hub", self.live.why_stale)

    def test_a_tree_that_comes_first_from_a_dead_server_is_old(self):
        self.tree()
        self.status(silent_s=100)
        self.assertAlmostEqual(self.live.age_s, 100)
        self.assertIn("map server was not heard for 100.0 s", self.live.why_stale)

    def test_replaced_maps_and_reasons(self):
        self.tree()
        self.status(revision=9, message="the tree is too large")
        self.assertEqual(self.live.why_stale, "the tree is too large")
        self.status(revision=9, message="OCTOMAP: the tree is too large")
        self.assertEqual(self.live.why_stale, "OCTOMAP: the tree is too large")
        self.status(revision=9, message="GRID: a grid needs z of the map to point upward")
        self.assertEqual(self.live.why_stale, "", "this concerns grids alone")
        self.status(map_id="other")
        self.assertIn("replaced", self.live.why_stale)
        with self.assertRaisesRegex(vismap.WaitTimeout, "replaced"):
            self.live.wait(timeout=0)
        self.tree(map_id="other")
        self.assertEqual(self.live.why_stale, "")
        self.assertEqual(len(self.live.wait(timeout=0)), 2)
        with self.assertRaisesRegex(vismap.WaitTimeout, "revision 5, not 7"):
            self.live.wait(timeout=0, revision=7)

    def test_trees_that_are_not_taken(self):
        self.tree()
        self.status()
        before = self.live.octree()
        for changed, words in ((dict(nodes=0, data=HEADER % 0), "an empty tree"), (dict(unknown=0), "raw")):
            self.tree(revision=6, **changed)
            self.assertIn(words, self.live.why_stale)
            self.assertIs(self.live.octree(), before)
            self.tree()
            self.assertEqual(self.live.why_stale, "")


if __name__ == "__main__":
    unittest.main()
