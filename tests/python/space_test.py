#!/usr/bin/env python3
"""Free and occupied voxels of MAP_DELTA: decoding, following, queries, damaged messages."""
import ctypes
import struct
import unittest

import numpy as np
import support

import vismap
from vismap.space import _content, _scramble

UNKNOWN, FREE, OCCUPIED = vismap.UNKNOWN, vismap.FREE, vismap.OCCUPIED
KINDS = {UNKNOWN: 0, FREE: 1, OCCUPIED: 2}


def compress(data):
    zstd = ctypes.CDLL("libzstd.so.1")
    zstd.ZSTD_compress.restype = ctypes.c_size_t
    packed = ctypes.create_string_buffer(len(data) + 1000)
    size = zstd.ZSTD_compress(packed, ctypes.c_size_t(len(packed)), data, ctypes.c_size_t(len(data)), 1)
    return packed.raw[:size]


def payload(blocks, full, voxel_size_m=0.1):
    """As libs/freespace/occupancy_codec.cc writes it; blocks: index -> a state, or states by [x, y, z]."""
    raw = struct.pack("<BBdI", 1, full, voxel_size_m, len(blocks))
    last, kinds, planes = np.zeros(3, int), b"", b""
    for index in sorted(blocks):
        raw += struct.pack("<3i", *(np.array(index) - last))
        last, states = np.array(index), blocks[index]
        if isinstance(states, int):
            kinds += bytes([KINDS[states]])
            continue
        kinds += b"\x03"
        for state in (FREE, OCCUPIED):
            words = [0] * 8
            for x, y, z in np.argwhere(states == state):
                offset = int(x + 8 * y + 64 * z)
                words[offset // 64] |= 1 << (offset % 64)
            planes += struct.pack("<8Q", *words)
    return raw + kinds + planes


def delta(revision, blocks, base=-1, part=0, parts=1, map_id="map", voxel_size_m=0.1):
    packed = compress(payload(blocks, base < 0, voxel_size_m))
    return vismap.types["vismap.map_delta_t"](
        utime=10 * revision, map_id=map_id, revision=revision, base_revision=base, full=base < 0, part=part, parts=parts,
        voxel_size_m=voxel_size_m, n_blocks=len(blocks), encoding=1, payload_size=len(packed), payload=packed)


def some_states(seed):
    return np.random.default_rng(seed).integers(-1, 2, (8, 8, 8)).astype(np.int8)


class SpaceTest(unittest.TestCase):
    def test_states_come_back(self):
        blocks = {(-3, 0, 5): some_states(1), (0, -1, 0): OCCUPIED, (0, 0, 0): FREE, (7, 2, -9): some_states(2), (8, 0, 0): UNKNOWN}
        space = vismap.space_of(vismap.decode(vismap.encode(delta(4, blocks))))
        self.assertEqual(space.blocks.tolist(), [list(index) for index in sorted(blocks)])
        for index, states in zip(space.blocks.tolist(), space.states):
            np.testing.assert_array_equal(states, blocks[tuple(index)])
        self.assertEqual((space.revision, space.base_revision, space.voxel_size_m, space.map_id), (4, -1, 0.1, "map"))

    def test_points_are_looked_up(self):
        states = np.full((8, 8, 8), UNKNOWN, np.int8)
        states[1, 2, 3] = OCCUPIED
        states[7, 0, 0] = FREE
        space = vismap.space_of(delta(1, {(-1, 0, 0): states, (0, 0, 0): FREE}))
        self.assertEqual(space.at([-0.65, 0.25, 0.35]), OCCUPIED)
        self.assertEqual(space.at([-0.05, 0.05, 0.05]), FREE)
        self.assertEqual(space.at([-0.05, 0.15, 0.05]), UNKNOWN)
        np.testing.assert_array_equal(space.at([[[0.1, 0.1, 0.1]], [[1e12, 0, 0]]]), [[FREE], [UNKNOWN]])
        np.testing.assert_allclose(space.centers_W(OCCUPIED), [[-0.65, 0.25, 0.35]])
        self.assertEqual(len(space.centers_W(FREE)), 513)
        self.assertEqual(vismap.Space(0, space.blocks[:0], space.states[:0]).at([0, 0, 0]), UNKNOWN)
        with self.assertRaises(ValueError):
            space.at([1, 2])

    def test_damaged_payloads_are_errors(self):
        good = delta(1, {(0, 0, 0): some_states(1), (0, 0, 1): FREE})
        raw = payload({(0, 0, 0): some_states(1), (0, 0, 1): FREE}, True)
        both = bytearray(raw)
        both[-128:] = b"\xff" * 128
        for what, changed in (("left over", raw + b"x"), ("missing", raw[:-1]), ("both free", bytes(both)),
                              ("contradicts", b"\x02" + raw[1:]), ("ascending", payload({(0, 0, 0): FREE, (0, 0, 1): FREE}, True)
                                                                   [:26] + b"\xff" * 12 + b"\x01\x01"), ("expands", b"")):
            message = vismap.decode(vismap.encode(good))
            message.payload = compress(changed)
            message.payload_size = len(message.payload)
            with self.assertRaisesRegex(vismap.MapError, what if what != "left over" and what != "missing" else "voxels are missing or left|expands"):
                vismap.space_of(message)
        rng, packed = np.random.default_rng(2), good.payload
        for _ in range(2000):
            data = bytearray(packed)
            data[int(rng.integers(len(data)))] = int(rng.integers(256))
            good.payload = bytes(data)
            try:
                vismap.space_of(good)
            except vismap.MapError:
                pass

    def test_a_bomb_needs_no_memory(self):
        message = delta(1, {(0, 0, 0): FREE})
        message.payload = compress(bytes(1 << 26))
        with self.assertRaisesRegex(vismap.MapError, "expands to 67108864 bytes"):
            vismap.space_of(message)


def field(blocks, limit_m=2.0, resolution_m=0.1, full=True):
    """A distance_field_t; blocks: index -> squares in half leaves [2, x, y, z], or None = unknown everywhere."""
    raw = struct.pack("<I", len(blocks)) + b"".join(struct.pack("<3i", *index) for index in sorted(blocks))
    raw += bytes(int(blocks[index] is not None) for index in sorted(blocks))
    for index in sorted(blocks):
        for squares in () if blocks[index] is None else blocks[index]:
            numbers = squares.transpose(2, 1, 0).reshape(-1).astype("<u2")
            raw += (numbers & 255).astype(np.uint8).tobytes() + (numbers >> 8).astype(np.uint8).tobytes()
    packed = compress(raw)
    return vismap.types["vismap.distance_field_t"](
        utime=9, map_id="map", revision=4, base_revision=-1 if full else 3, full=full, part=0, parts=1, resolution_m=resolution_m,
        limit_m=limit_m, n_blocks=len(blocks), encoding=1, payload_size=len(packed), payload=packed)


class DistancesTest(unittest.TestCase):
    def setUp(self):
        self.squares = np.random.default_rng(4).integers(0, 1600, (2, 8, 8, 8))
        self.squares[0, 1, 2, 3] = 32767
        self.message = field({(-1, 0, 2): self.squares, (0, 0, 0): None})

    def test_values_come_back_by_leaf(self):
        found = vismap.distances_of(vismap.decode(vismap.encode(self.message)))
        self.assertEqual(found.blocks.tolist(), [[-1, 0, 2], [0, 0, 0]])
        expected = np.sqrt(self.squares) * 0.05
        expected[0, 1, 2, 3] = 2.0
        np.testing.assert_allclose(found.obstacle_m[0], expected[0], rtol=1e-6)
        np.testing.assert_allclose(found.unknown_m[0], expected[1], rtol=1e-6)
        self.assertEqual((found.obstacle_m[1].max(), found.unknown_m[1].max()), (0, 0))
        self.assertEqual((found.revision, found.base_revision, found.utime), (4, -1, 9))
        leaf = np.array([-8 + 5, 6, 16 + 7])
        obstacle, unknown = found.at([(leaf + 0.5) * 0.1, [7.0, 7.0, 7.0]])
        np.testing.assert_allclose([obstacle[0], unknown[0]], expected[:, 5, 6, 7], rtol=1e-6)
        self.assertEqual((obstacle[1], unknown[1], obstacle.shape), (0, 0, (2,)))
        self.assertEqual(found.at([1e15, 0, 0])[0].shape, ())
        self.assertEqual(vismap.distances_of(field({}, full=False)).base_revision, 3)
        with self.assertRaises(ValueError):
            found.at([1, 2])

    def test_damaged_payloads_are_errors(self):
        for changes, words in (({"n_blocks": 3}, "another number of blocks"), ({"encoding": 2}, "encoding 2"), ({"n_blocks": -1}, "-1 blocks"),
                               ({"resolution_m": 0.0}, "expected lengths above 0"), ({"limit_m": float("nan")}, "expected lengths above 0")):
            message = vismap.decode(vismap.encode(self.message))
            for name, value in changes.items():
                setattr(message, name, value)
            with self.assertRaisesRegex(vismap.MapError, words):
                vismap.distances_of(message)
        wrong = self.squares.copy()
        wrong[1, 0, 0, 0] = 32768
        with self.assertRaisesRegex(vismap.MapError, "above 32767"):
            vismap.distances_of(field({(0, 0, 0): wrong}))
        rng, packed = np.random.default_rng(6), self.message.payload
        for _ in range(2000):
            data = bytearray(packed)
            data[int(rng.integers(len(data)))] = int(rng.integers(256))
            self.message.payload = bytes(data)
            try:
                vismap.distances_of(self.message)
            except vismap.MapError:
                pass


class FollowerTest(unittest.TestCase):
    def setUp(self):
        self.follower = vismap.SpaceFollower()

    def apply(self, message):
        return self.follower.apply(vismap.encode(message), 0.0)

    def test_updates_change_the_copy(self):
        self.assertTrue(self.apply(delta(1, {(0, 0, 0): FREE, (1, 0, 0): some_states(1)})))
        self.assertTrue(self.apply(delta(2, {(0, 0, 0): UNKNOWN, (2, 0, 0): OCCUPIED}, base=1)))
        space = self.follower.space()
        self.assertEqual(space.blocks.tolist(), [[1, 0, 0], [2, 0, 0]])
        self.assertEqual((space.revision, space.utime, self.follower.position), (2, 20, "map@2"))
        self.assertFalse(self.apply(delta(4, {}, base=3)), "an update is missing")
        self.assertFalse(self.follower.in_sync)
        self.assertTrue(self.apply(delta(4, {(5, 5, 5): FREE})))
        self.assertEqual(self.follower.space().blocks.tolist(), [[5, 5, 5]])
        self.assertEqual(self.follower.gaps, 1)

    def test_parts_are_joined_and_other_voxels_refused(self):
        self.assertFalse(self.apply(delta(1, {(0, 0, 0): FREE}, part=0, parts=2)))
        self.assertTrue(self.apply(delta(1, {(0, 0, 1): FREE}, part=1, parts=2)))
        self.assertEqual(len(self.follower.space().blocks), 2)
        with self.assertRaisesRegex(vismap.MapError, "0.2 m"):
            self.apply(delta(2, {}, base=1, voxel_size_m=0.2))

    def test_memory_is_bounded(self):
        follower = vismap.SpaceFollower(max_bytes=10_000)
        with self.assertRaisesRegex(vismap.MapError, "allowed 10000 bytes"):
            follower.apply(vismap.encode(delta(1, {(i, 0, 0): FREE for i in range(40)})), 0.0)

    def test_digest_depends_on_the_content_only(self):
        self.apply(delta(1, {(0, 0, 0): FREE}))
        self.apply(delta(2, {(1, 0, 0): some_states(1)}, base=1))
        other = vismap.SpaceFollower()
        other.apply(vismap.encode(delta(7, {(0, 0, 0): FREE, (1, 0, 0): some_states(1)})), 0.0)
        self.assertEqual(self.follower.digest, other.digest)
        self.assertEqual(len(other.digest), 32)
        self.assertEqual(len(_content((0, 0, 0), some_states(1))), 12 + 4 + 128)
        self.assertLess(_scramble((1 << 64) - 1), 1 << 64)


if __name__ == "__main__":
    unittest.main()
