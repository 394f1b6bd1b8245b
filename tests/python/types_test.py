#!/usr/bin/env python3
"""Message types against lcm-gen's own Python code, and hostile bytes at the decoders."""
import importlib
import pathlib
import subprocess
import sys
import tempfile
import tracemalloc
import types
import unittest

import numpy as np
from random_messages import random_pair
from support import ROOT

import vismap
from vismap import messages
from vismap.lcm_types import TypeTable, parse_lcm

ODD = """package reference;
/* Everything that our own types have not. */
struct point_t { float x, y; int8_t tag; }
struct odd_t {
  const int32_t LARGE = 0x7fffffff, MINUS = -3; const double HALF = 0.5;
  int8_t n; int16_t m; // two lengths
  int16_t grid[3][n]; double cube[2][n][m]; string names[m]; point_t points[n]; point_t pair[2]; point_t one;
  boolean flags[n]; byte raw[4]; byte table[2][2]; int8_t a, b; boolean on; string text;
}
"""


class TypesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        folder = pathlib.Path(cls.temporary.name)
        # Package and name of a type are not part of its fingerprint, so that ours and lcm-gen's can be loaded together.
        texts = [file.read_text() for pattern in ("*.lcm", "older/*.lcm") for file in sorted((ROOT / "lcmtypes").glob(pattern))]
        (folder / "all.lcm").write_text("\n".join(text.replace("package vismap;", "package reference;") for text in texts))
        (folder / "odd.lcm").write_text(ODD)
        subprocess.run(["lcm-gen", "-p", "--ppath", folder, folder / "all.lcm", folder / "odd.lcm"], check=True,
                       stdout=subprocess.DEVNULL)
        sys.path.insert(0, str(folder))
        cls.odd = TypeTable(parse_lcm(ODD))["reference.odd_t"]
        cls.kinds = [*messages.types.values(), cls.odd]

    @staticmethod
    def reference_of(name):
        return getattr(importlib.import_module(f"reference.{name}"), name)

    def test_there_is_a_type_for_every_file(self):
        ours = [*(ROOT / "lcmtypes").glob("*.lcm"), *(ROOT / "lcmtypes/older").glob("*.lcm")]
        files = {file.stem.removeprefix("vismap_") for file in ours}
        self.assertEqual(files, {name.removeprefix("vismap.") for name in messages.types})

    def test_fingerprints_are_those_of_lcm_gen(self):
        for kind in self.kinds:
            theirs = self.reference_of(kind.TYPE.split(".")[1])._get_packed_fingerprint()
            self.assertEqual(kind.FINGERPRINT.to_bytes(8, "big"), theirs, kind.TYPE)

    def test_constants_are_those_of_lcm_gen(self):
        for name in ("LARGE", "MINUS", "HALF"):
            self.assertEqual(getattr(self.odd, name), getattr(self.reference_of("odd_t"), name))
        self.assertEqual(vismap.types["vismap.map_request_t"].UNKNOWN_DEFAULT, -1)

    def test_bytes_are_those_of_lcm_gen_and_decode_to_the_same_message(self):
        rng = np.random.default_rng(1)
        for kind in self.kinds:
            for _ in range(20):
                ours, theirs = random_pair(rng, kind, self.reference_of)
                data = theirs.encode()
                self.assertEqual(ours.encode(), data, kind.TYPE)
                self.assertEqual(kind.decode(data).encode(), data, kind.TYPE)

    def test_decoded_fields_have_the_types_of_python_and_numpy(self):
        mesh = vismap.types["vismap.mesh_block_t"](index=np.array([1, -2, 3]), x=[1, 2], y=[3, 4], z=[5, -6], nx=[0, 0],
                                                   ny=[0, 0], nz=[1, 1], red=b"ab", green=b"cd", blue=b"ef",
                                                   segment=[7, 8], instance=[9, 0], class_id=[1, 2], seen=b"\x01\xff")
        found = type(mesh).decode(mesh.encode())
        self.assertEqual(found.index.tolist(), [1, -2, 3])
        self.assertEqual((found.z.dtype, found.z.tolist(), found.n_vertices, found.red, found.seen), (np.int16, [5, -6], 2, b"ab", b"\x01\xff"))
        self.assertTrue(found.z.dtype.isnative)
        self.assertEqual(len(found.a), 0)

    def test_inconsistent_messages_are_refused_with_a_reason(self):
        mesh, camera = vismap.types["vismap.mesh_block_t"], vismap.types["vismap.detection_t"]
        for message, words in ((mesh(x=[1], y=[1, 2]), "same length, n_vertices"), (mesh(index=[1, 2]), "expected 3 elements"),
                               (mesh(x=[40000]), "does not fit"), (camera(runs=[0.5]), "whole numbers"),
                               (camera(class_id=1 << 40), "class_id"), (camera(class_id="x"), "class_id")):
            if words == "does not fit":
                for name in "yz":
                    setattr(message, name, [0])
                for name in ("nx", "ny", "nz", "segment", "instance", "class_id"):
                    setattr(message, name, [0])
                message.red = message.green = message.blue = message.seen = b"0"
            with self.assertRaisesRegex(vismap.MessageError, words):
                message.encode()
        with self.assertRaisesRegex(vismap.MessageError, "no field speed"):
            camera(speed=1)
        with self.assertRaisesRegex(AttributeError, "class_id"):
            camera().classid = 1

    def test_faulty_texts_are_refused_with_their_line(self):
        for text, words in (("struct a_t { int32_t x }", "x:1: expected ';'"), ("package p;\nstruct a_t {\n float v[n]; }", "x:3: the length 'n'"),
                            ("enum e_t { A }", "expected 'package' or 'struct'"), ("struct a_t { float x; float x; }", "two fields x"),
                            ("struct a_t { const int8_t A = b; }", "expected a number")):
            with self.assertRaisesRegex(vismap.MessageError, words):
                parse_lcm(text, "x")
        for text, words in (("package p; struct a_t { b_t x; }", "no type p.b_t"), ("package p; struct a_t { a_t x; }", "contains itself")):
            with self.assertRaisesRegex(vismap.MessageError, words):
                TypeTable(parse_lcm(text))


class EnvelopeTest(unittest.TestCase):
    def message(self):
        return vismap.types["vismap.detections_t"](utime=5, seq=6, source="a-detector", camera_id=7, image_width=4, image_height=3,
                                                   detections=[vismap.types["vismap.detection_t"](class_id=1, runs=[1, 2, 9])])

    def test_checksum_covers_all_that_follows_it(self):
        data = vismap.encode(self.message())
        found = vismap.decode(data)
        self.assertNotEqual(found.checksum, 0)
        self.assertEqual(found.detections[0].runs.tolist(), [1, 2, 9])
        at = 28 + len("a-detector") + 1 + 8
        for offset in range(at, len(data)):
            damaged = bytearray(data)
            damaged[offset] ^= 1
            with self.assertRaises(vismap.MessageError):
                vismap.decode(bytes(damaged))

    def test_checksum_0_is_not_compared(self):
        message = self.message()
        message.checksum = 0
        self.assertEqual(vismap.decode(message.encode()).camera_id, 7)

    def test_older_status_is_read(self):
        status = vismap.types["vismap.process_status_t"](utime=1, source="s", state="running")
        older = bytes.fromhex("dfd3012ff7311f8a") + status.encode()[8:-4]
        self.assertEqual(vismap.decode(older).state, "running")

    def test_unknown_types_are_told(self):
        with self.assertRaisesRegex(vismap.MessageError, "0102030405060708"):
            vismap.decode(bytes(range(1, 20)))
        with self.assertRaises(vismap.MessageError):
            vismap.decode(b"abc")


class HostileBytesTest(unittest.TestCase):
    """Whatever the bytes are: a message or a MessageError, and no memory beyond what the bytes can fill."""

    def setUp(self):
        rng = np.random.default_rng(2)
        self.messages = []
        for kind in messages.types.values():
            ours, _ = random_pair(rng, kind, lambda name: types.SimpleNamespace)  # lcm-gen's message is not needed
            self.messages.append((kind, ours.encode()))

    def try_to_decode(self, kind, data, most):
        tracemalloc.reset_peak()
        before = tracemalloc.get_traced_memory()[0]
        try:
            kind.decode(data)
            decoded = True
        except vismap.MessageError:
            decoded = False
        self.assertLess(tracemalloc.get_traced_memory()[1] - before, most, f"{kind.TYPE}: {data[:200].hex()}")
        return decoded

    def test_every_truncated_message_is_refused(self):
        for kind, data in self.messages:
            for size in range(0, len(data), 1 if len(data) < 500 else 7):
                with self.assertRaises(vismap.MessageError, msg=kind.TYPE):
                    kind.decode(data[:size])
            with self.assertRaisesRegex(vismap.MessageError, "end after byte"):
                kind.decode(data + b"\0")

    def test_impossible_lengths_are_refused_without_allocating(self):
        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        for kind, data in self.messages:
            for at in range(8, min(len(data) - 4, 300)):
                for length in (b"\x7f\xff\xff\xff", b"\xff\xff\xff\xff", b"\x20\x00\x00\x01", b"\x00\x01\x00\x00"):
                    self.try_to_decode(kind, data[:at] + length + data[at + 4:], 400 * len(data) + 200_000)

    def test_random_damage(self):
        rng = np.random.default_rng(3)
        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        decoded = 0
        for kind, data in self.messages:
            for _ in range(200):
                damaged = bytearray(data)
                for at in rng.integers(8, len(data), int(rng.integers(1, 4))):
                    damaged[at] = int(rng.integers(0, 256))
                decoded += self.try_to_decode(kind, bytes(damaged), 400 * len(data) + 200_000)
        self.assertGreater(decoded, 100)

    def test_a_list_of_many_small_structs_takes_bounded_memory(self):
        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        delta = vismap.types["vismap.mesh_delta_t"](parts=1, blocks=[vismap.types["vismap.mesh_block_t"]()] * 20000)
        data = delta.encode()
        self.assertTrue(self.try_to_decode(type(delta), data, 40 * len(data)))


if __name__ == "__main__":
    unittest.main()
