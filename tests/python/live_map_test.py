#!/usr/bin/env python3
"""The follower of the surface: parts, gaps, other maps, and messages that contradict themselves; objects with boxes."""
import unittest

import numpy as np
import support

import vismap
from vismap.objects import objects_from_json

TYPES = vismap.types


def block(index, vertices=3, edge=0.5, **changed):
    n = np.arange(vertices)
    fields = dict(index=list(index), edge_m=edge, x=n.astype(np.int16), y=(-n).astype(np.int16), z=n.astype(np.int16),
                  nx=np.zeros(vertices, np.int8), ny=np.zeros(vertices, np.int8), nz=np.full(vertices, 127, np.int8),
                  red=bytes(vertices), green=bytes([1]) * vertices, blue=bytes([2]) * vertices, segment=n + 10, instance=n % 2,
                  class_id=np.full(vertices, -1, np.int16), a=[0] if vertices else [], b=[1] if vertices else [],
                  c=[2] if vertices else [], seen=bytes(range(1, vertices + 1)))
    return TYPES["vismap.mesh_block_t"](**{**fields, **changed})


def delta(revision, base, blocks, part=0, parts=1, full=None, map_id="m"):
    full = base < 0 if full is None else full
    return vismap.encode(TYPES["vismap.mesh_delta_t"](map_id=map_id, revision=revision, base_revision=base, full=full, part=part,
                                                      parts=parts, blocks=blocks, utime=1000 + revision))


class FollowerTest(unittest.TestCase):
    def setUp(self):
        self.follower = vismap.MeshFollower()

    def apply(self, data, now=0.0):
        return self.follower.apply(data, now)

    def test_vertices_faces_and_ids(self):
        self.assertTrue(self.apply(delta(1, -1, [block((0, 0, 0)), block((2, 0, -1), 4, segment=[1, 2, 3, 4])])))
        mesh = self.follower.mesh()
        self.assertEqual((mesh.vertices.shape, mesh.faces.tolist()), ((7, 3), [[0, 1, 2], [3, 4, 5]]))
        self.assertEqual((mesh.segment.tolist(), mesh.instance.tolist()), ([10, 11, 12, 1, 2, 3, 4], [0, 1, 0, 0, 1, 0, 1]))
        self.assertEqual((mesh.class_id.tolist(), mesh.colors[0].tolist()), ([65535] * 7, [0, 1, 2]))
        np.testing.assert_allclose(mesh.normals, [[0, 0, 1]] * 7)
        self.assertEqual(mesh.seen.tolist(), [1, 2, 3, 1, 2, 3, 4])
        # position_W = (index - 0.5 + 2 * x / 65535) * edge_m, with x as an unsigned number
        np.testing.assert_allclose(mesh.vertices[4], [(2 - 0.5 + 2 / 65535) * 0.5, (-0.5 + 2 * 65535 / 65535) * 0.5, (-1.5 + 2 / 65535) * 0.5], atol=1e-6)
        self.assertEqual((mesh.map_id, mesh.revision, mesh.utime), ("m", 1, 1001))

    def test_a_surface_that_is_only_seen_once_more_keeps_its_digest(self):
        self.apply(delta(1, -1, [block((0, 0, 0))]))
        digest = self.follower.digest
        self.apply(delta(2, 1, [block((0, 0, 0), seen=bytes([7, 8, 9]))]))
        self.assertEqual((self.follower.digest, self.follower.mesh().seen.tolist()), (digest, [7, 8, 9]))
        self.apply(delta(3, 2, [block((0, 0, 0), red=bytes([1, 0, 0]))]))
        self.assertNotEqual(self.follower.digest, digest)

    def test_logs_of_both_versions_have_the_same_surface(self):
        kept = {}
        for name in ("meshes_v1", "meshes_v2"):
            follower = vismap.MeshFollower()
            data = (support.ROOT / f"tests/logs/{name}.lcmlog").read_bytes()
            self.assertTrue(follower.apply(data[data.index(b"MESH_DELTA") + 10:], 0.0))
            kept[name] = (follower.digest, follower.mesh().vertices.tolist())
            self.assertEqual(follower.mesh().seen.tolist(), [0] * 9 if name == "meshes_v1" else [1, 2, 3, 4, 5, 1, 2, 3, 4])
        self.assertEqual(kept["meshes_v1"], kept["meshes_v2"])

    def test_part_of_an_object(self):
        self.apply(delta(1, -1, [block((0, 0, 0), 4, instance=[5, 5, 5, 6], a=[0, 0], b=[1, 1], c=[2, 3])]))
        part = self.follower.mesh().of_instance(5)
        self.assertEqual(part.seen.tolist(), [1, 2, 3])
        self.assertEqual((len(part.vertices), part.faces.tolist(), part.instance.tolist()), (3, [[0, 1, 2]], [5, 5, 5]))

    def test_updates_replace_and_delete_blocks(self):
        self.apply(delta(1, -1, [block((0, 0, 0)), block((1, 0, 0))]))
        first = self.follower.digest
        self.assertTrue(self.apply(delta(2, 1, [block((0, 0, 0), 0), block((3, 0, 0), 5)])))
        self.assertEqual((len(self.follower.mesh().vertices), self.follower.revision), (8, 2))
        self.assertTrue(self.apply(delta(3, 2, [block((0, 0, 0)), block((3, 0, 0), 0)])))
        self.assertEqual(self.follower.digest, first)
        self.assertEqual(len(first), 32)

    def test_parts_in_any_order_and_twice(self):
        parts = [delta(1, -1, [block((i, 0, 0))], part=i, parts=3) for i in range(3)]
        self.assertFalse(self.apply(parts[2]))
        self.assertFalse(self.apply(parts[0]))
        self.assertFalse(self.apply(parts[2]))
        self.assertEqual(len(self.follower.mesh().vertices), 0)
        self.assertTrue(self.apply(parts[1]))
        self.assertEqual(len(self.follower.mesh().vertices), 9)

    def test_a_missing_update_is_noticed_and_repaired(self):
        self.assertEqual((self.follower.position, self.follower.in_sync), ("", False))
        self.apply(delta(1, -1, [block((0, 0, 0))]))
        self.assertEqual((self.follower.position, self.follower.in_sync), ("m@1", True))
        self.assertFalse(self.apply(delta(3, 2, [block((9, 0, 0))])))
        self.assertEqual((self.follower.gaps, self.follower.in_sync, len(self.follower.mesh().vertices)), (1, False, 3))
        self.assertTrue(self.apply(delta(3, 1, [block((7, 0, 0)), block((9, 0, 0))])))
        self.assertEqual((self.follower.in_sync, len(self.follower.mesh().vertices)), (True, 9))
        self.assertFalse(self.apply(delta(2, 1, [block((0, 0, 0), 0)])), "older updates are ignored")

    def test_another_map_needs_all_of_it(self):
        self.apply(delta(5, -1, [block((0, 0, 0))]))
        self.assertFalse(self.apply(delta(6, 5, [], map_id="other")))
        self.assertFalse(self.follower.in_sync)
        self.assertTrue(self.apply(delta(1, -1, [block((1, 1, 1), 4)], map_id="other")))
        self.assertEqual((self.follower.position, len(self.follower.mesh().vertices)), ("other@1", 4))

    def test_parts_that_stay_alone_are_given_up(self):
        self.apply(delta(1, -1, [block((0, 0, 0))], part=0, parts=2), now=0.0)
        self.assertEqual((self.follower.give_up_stale_parts(10), self.follower.give_up_stale_parts(31)), (0, 1))

    def test_contradictions_are_refused_and_change_nothing(self):
        self.apply(delta(1, -1, [block((0, 0, 0))]))
        before = self.follower.digest
        for blocks, words in (([block((1, 0, 0), c=[3])], "refers to a vertex"), ([block((1, 0, 0), a=[-1])], "refers to a vertex"),
                              ([block((1, 0, 0), edge=0.0)], "edge_m"), ([block((1, 0, 0), edge=np.nan)], "edge_m"),
                              ([block((1, 0, 0)), block((1, 0, 0))], "ascending"), ([block((1, 0, 0)), block((0, 9, 9))], "ascending")):
            with self.assertRaisesRegex(vismap.MapError, words):
                self.apply(delta(2, 1, blocks))
        for part, parts in ((1, 1), (-1, 1), (0, 0), (5, 2)):
            with self.assertRaisesRegex(vismap.MapError, "part"):
                self.apply(delta(2, 1, [], part=part, parts=parts))
        with self.assertRaises(vismap.MessageError):
            self.apply(delta(2, 1, [block((1, 0, 0))])[:-1])
        self.assertEqual((self.follower.digest, self.follower.revision), (before, 1))
        self.assertTrue(self.apply(delta(2, 1, [block((1, 0, 0))])))

    def test_memory_is_bounded(self):
        follower = vismap.MeshFollower(max_bytes=20_000)
        with self.assertRaisesRegex(vismap.MapError, "max_mb"):
            for i in range(100):
                follower.apply(delta(1, -1, [block((i, 0, 0), 100)], part=i, parts=101), 0.0)
        self.assertTrue(follower.apply(delta(1, -1, [block((0, 0, 0))]), 0.0))
        with self.assertRaisesRegex(vismap.MapError, "max_mb"):
            for i in range(2, 100):
                follower.apply(delta(i, i - 1, [block((i, 0, 0), 100)]), 0.0)
        self.assertEqual((follower.position, follower.in_sync, len(follower.mesh().vertices)), ("", False, 0))


class ObjectsTest(unittest.TestCase):
    def message(self, **changed):
        fields = dict(instance=7, class_id=62, class_name="chair", class_ids=[56, 62], class_probabilities=[0.25, 0.75], score=0.5,
                      segments=[3, 9], points=100, area_m2=1.5, center_W=[1, 2, 3], size_m=[2, 4, 6],
                      orientation=[np.cos(np.pi / 4), 0, 0, np.sin(np.pi / 4)], frames=8, first_utime=1, last_utime=2)
        return TYPES["vismap.object_list_t"](objects=[TYPES["vismap.object_t"](**{**fields, **changed})])

    def test_box_and_facts(self):
        (found,) = vismap.objects_of(vismap.decode(vismap.encode(self.message())))
        self.assertEqual((found.instance, found.class_name, found.segments, found.class_probabilities), (7, "chair", (3, 9), {56: 0.25, 62: 0.75}))
        # A quarter turn around z: the long side of the box, y, points along -x of W.
        np.testing.assert_allclose(found.box.R_W_B, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-12)
        corners = found.box.corners_W()
        np.testing.assert_allclose([corners.min(axis=0), corners.max(axis=0)], [[-1, 1, 0], [3, 3, 6]], atol=1e-12)
        self.assertEqual(found.box.contains([[1, 2, 3], [2.9, 2, 3], [1, 3.1, 3]]).tolist(), [True, True, False])

    def test_removed_objects_have_no_box(self):
        (found,) = vismap.objects_of(self.message(removed_utime=5, orientation=[0, 0, 0, 0]))
        self.assertIsNone(found.box)

    def test_impossible_rotations_are_refused(self):
        for quaternion in ([0, 0, 0, 0], [np.nan, 0, 0, 1], [np.inf, 0, 0, 1]):
            with self.assertRaisesRegex(vismap.MapError, "no rotation"):
                vismap.objects_of(self.message(orientation=quaternion))

    def test_an_answer_that_is_no_objects_json(self):
        for document in ([], {"objects": [{"instance": 1}]}, {"objects": [3]}):
            with self.assertRaises(vismap.MapError):
                objects_from_json(document)


if __name__ == "__main__":
    unittest.main()
