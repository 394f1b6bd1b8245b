#!/usr/bin/env python3
"""Frames from arrays, and their images back; clocks and pace."""
import contextlib
import ctypes
import io
import math
import time
import unittest
import zlib

import numpy as np
import support

import vismap
from vismap.clocks import DeviceClock, Newest, Pace
from vismap.images import decode_png
from vismap.native import optional_module

CAMERA = vismap.Camera(8, 6, fx=10, fy=10, cx=3.5, cy=2.5)
POSE = np.eye(4)


def steps(seed=0):
    depth = np.random.default_rng(seed).integers(1, 65535, (6, 8)).astype(np.uint16)
    depth[0, :2] = 0, 65535
    return depth


def through_bytes(message):
    return vismap.decode(vismap.encode(message))


class FrameTest(unittest.TestCase):
    def test_depth_comes_back_in_metres(self):
        expected = steps().astype(np.float32) * np.float32(0.0005)
        expected[0, :2] = np.nan
        for options in ({}, {"compress": True}):
            message = through_bytes(vismap.frame_message(steps(), POSE, CAMERA, depth_unit_m=0.0005, **options))
            np.testing.assert_array_equal(vismap.depth_of(message), expected)
        metres = np.array(expected, np.float64)
        metres[1, :3] = np.inf, -1, 0
        found = vismap.depth_of(through_bytes(vismap.frame_message(metres, POSE, CAMERA)))
        self.assertTrue(np.isnan(found[1, :3]).all())
        np.testing.assert_array_equal(found[2:], expected[2:])

    @staticmethod
    def packed(depth):
        """The code of libs/codecs/depth_codec.h."""
        zstd = ctypes.CDLL("libzstd.so.1")
        difference = np.diff(depth.ravel(), prepend=np.uint16(0)).astype(np.uint16)
        folded = (difference << 1) ^ np.where(difference & 0x8000, 0xffff, 0).astype(np.uint16)
        planes = (folded & 0xff).astype(np.uint8).tobytes() + (folded >> 8).astype(np.uint8).tobytes()
        packed = ctypes.create_string_buffer(1000)
        zstd.ZSTD_compress.restype = ctypes.c_size_t
        size = zstd.ZSTD_compress(packed, ctypes.c_size_t(1000), planes, ctypes.c_size_t(len(planes)), 1)
        return packed.raw[:size]

    def test_the_first_version_of_the_type_is_read(self):
        older = vismap.types["vismap.rgbd_frame_v1_t"](utime=5, camera_id=3, width=8, height=6, depth_unit_m=0.001, depth_encoding=1,
                                                       depth=self.packed(steps(4)))
        found = through_bytes(older)
        self.assertEqual((found.utime, found.camera_id), (5, 3))
        np.testing.assert_array_equal(vismap.depth_of(found)[1:], steps(4)[1:].astype(np.float32) * np.float32(0.001))
        self.assertIsNone(vismap.color_of(found))

    def test_depth_in_our_code(self):
        depth = steps(3)
        message = vismap.frame_message(depth, POSE, CAMERA)
        message.depth, message.depth_encoding = self.packed(depth), message.DEPTH_ZSTD_DELTA
        found = vismap.depth_of(message)
        np.testing.assert_array_equal(np.isnan(found), (depth == 0) | (depth == 65535))
        np.testing.assert_array_equal(found[1:], depth[1:].astype(np.float32) * np.float32(0.001))

    def test_color_comes_back_as_rgb(self):
        rgba = np.random.default_rng(1).integers(0, 256, (6, 8, 4)).astype(np.uint8)
        rgb = rgba[:, :, :3]
        for color, order, expected in ((rgb, "rgb", rgb), (rgba, "rgb", rgb), (rgb[:, :, ::-1], "bgr", rgb),
                                       (rgba[:, :, [2, 1, 0, 3]], "bgr", rgb), (rgb[:, :, 0], "rgb", rgb[:, :, [0, 0, 0]])):
            message = through_bytes(vismap.frame_message(steps(), POSE, CAMERA, color, color_order=order))
            np.testing.assert_array_equal(vismap.color_of(message), expected)
        self.assertIsNone(vismap.color_of(vismap.frame_message(steps(), POSE, CAMERA)))
        jpeg = vismap.frame_message(steps(), POSE, CAMERA, b"\xff\xd8\xff\xe0rest")
        self.assertEqual((jpeg.color_encoding, jpeg.color), (jpeg.COLOR_JPEG, b"\xff\xd8\xff\xe0rest"))
        with self.assertRaisesRegex(vismap.MessageError, "JPEG"):
            vismap.color_of(jpeg)

    def test_cameras_and_poses_are_in_the_message(self):
        T = np.eye(4)
        T[:3, 3] = 1, 2, 3
        lens = vismap.Camera(4, 2, 5, 6, 1.5, 0.5, distortion=(0.1, 0.2, 0.3, 0.4, 0.5))
        fisheye = vismap.Camera(8, 6, 5, 6, 3, 2, distortion=(1, 2, 3, 4), fisheye=True)
        message = through_bytes(vismap.frame_message(np.ones((2, 4), np.float32), T, fisheye, np.zeros((6, 8), np.uint8),
                                                     depth_camera=lens, T_color_depth=T, camera_id=3, utime=99, frame_number=4))
        self.assertEqual((message.utime, message.camera_id, message.frame_number, message.after_utime, message.depth_registered),
                         (99, 3, 4, -1, False))
        self.assertEqual((message.depth_camera.distortion, message.depth_camera.coefficients.tolist()), (1, [0.1, 0.2, 0.3, 0.4, 0.5]))
        self.assertEqual((message.color_camera.distortion, message.color_camera.num_coefficients), (2, 4))
        self.assertEqual((message.T_W_C.reshape(4, 4)[:3, 3].tolist(), message.T_color_depth[3]), ([1, 2, 3], 1))
        self.assertEqual(vismap.depth_of(message).shape, (2, 4))
        self.assertTrue(vismap.frame_message(steps(), POSE, CAMERA).depth_registered)

    def test_what_cannot_be_right_is_refused_with_a_reason(self):
        gray, left_handed = np.zeros((6, 8), np.uint8), np.diag([1, 1, -1, 1.0])
        by_columns = np.eye(4)
        by_columns[3, :3] = 1
        for arguments, options, words in (
                ((steps()[:5], POSE, CAMERA), {}, r"shape \(5, 8\)"), ((steps().astype(np.int32), POSE, CAMERA), {}, "int32; expected uint16"),
                ((steps(), np.eye(3), CAMERA), {}, "4x4"), ((steps(), 2 * POSE, CAMERA), {}, "last row"),
                ((steps(), left_handed, CAMERA), {}, "det R is -1"), ((steps(), by_columns, CAMERA), {}, "column by column"),
                ((steps(), POSE * np.nan, CAMERA), {}, "NaN"), ((steps(), POSE, CAMERA, gray[:2]), {}, r"shape \(2, 8\)"),
                ((steps(), POSE, CAMERA, b"GIF89a"), {}, "JPEG or PNG"), ((steps(), POSE, CAMERA, gray.astype(float)), {}, "float64"),
                ((steps(), POSE, CAMERA, np.zeros((6, 8, 2), np.uint8)), {}, "3 or 4 channels"),
                ((steps(), POSE, CAMERA), {"depth_unit_m": 1000}, "depth_unit_m is 1000"), ((steps(), POSE, CAMERA), {"camera_id": -1}, "camera_id"),
                ((steps(), POSE, CAMERA, gray), {"depth_camera": CAMERA}, "T_color_depth")):
            with self.assertRaisesRegex(ValueError, words):
                vismap.frame_message(*arguments, **options)
        for changed, words in ({"fx": 0}, "positive"), ({"cx": np.nan}, "finite"), ({"width": 0}, "0x6"), ({"distortion": (1, 2, 3)}, "3 coefficients"):
            with self.assertRaisesRegex(ValueError, words):
                vismap.Camera(**{"width": 8, "height": 6, "fx": 1, "fy": 1, "cx": 1, "cy": 1, **changed})

    def test_hostile_images(self):
        message = vismap.frame_message(steps(), POSE, CAMERA)
        for encoding, depth, words in ((2, b"abc", "3 bytes; expected 96"), (4, zlib.compress(bytes(10 ** 7)), "97 bytes; expected 96"),
                                       (4, b"garbage", "zlib"), (5, bytes(96), "expected 192"), (3, b"", "a PNG has"), (99, b"", "99"),
                                       (1, b"garbage", "zstd")):
            message.depth, message.depth_encoding = depth, encoding
            with self.assertRaisesRegex(vismap.VismapError, words):
                vismap.depth_of(message)
        message.depth_camera.width = message.color_camera.width = 1 << 30
        with self.assertRaisesRegex(vismap.MessageError, "at most"):
            vismap.depth_of(message)


def png(pixels, filters=(0,), interlaced=0):
    """A PNG file, written as its specification says; row i has the filter filters[i % len(filters)]."""
    height, width = pixels.shape[:2]
    samples = 1 if pixels.ndim == 2 else pixels.shape[2]
    rows = np.frombuffer(pixels.astype(pixels.dtype.newbyteorder(">")).tobytes(), np.uint8).reshape(height, -1).astype(int)
    size, above, plain = pixels.dtype.itemsize * samples, np.zeros(rows.shape[1], int), b""
    for number, row in enumerate(rows):
        kind = filters[number % len(filters)]
        left = np.concatenate([np.zeros(size, int), row[:-size]])
        corner = np.concatenate([np.zeros(size, int), above[:-size]])
        nearest = [abs(left + above - corner - value) for value in (left, above, corner)]
        paeth = np.where((nearest[0] <= nearest[1]) & (nearest[0] <= nearest[2]), left,
                         np.where(nearest[1] <= nearest[2], above, corner))
        predicted = (0, left, above, (left + above) // 2, paeth)[kind]
        plain += bytes([kind]) + ((row - predicted) & 255).astype(np.uint8).tobytes()
        above = row

    def chunk(name, content):
        return len(content).to_bytes(4, "big") + name + content + zlib.crc32(name + content).to_bytes(4, "big")
    kind = {1: 0, 2: 4, 3: 2, 4: 6}[samples]
    head = width.to_bytes(4, "big") + height.to_bytes(4, "big") + bytes([8 * pixels.dtype.itemsize, kind, 0, 0, interlaced])
    packed = zlib.compress(plain)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", packed[:50]) + chunk(b"IDAT", packed[50:]) + chunk(b"IEND", b""))


class ImageTest(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(3)

    def test_png_of_every_kind_and_filter(self):
        for kind in (np.uint8, np.uint16):
            for shape in ((6, 8), (6, 8, 2), (6, 8, 3), (6, 8, 4), (1, 1), (7, 31, 3)):
                pixels = self.rng.integers(0, np.iinfo(kind).max + 1, shape).astype(kind)
                for filters in ((0,), (1,), (2,), (3,), (4,), (4, 3, 2, 1, 0)):
                    found = decode_png(png(pixels, filters))
                    self.assertEqual(found.dtype, kind)
                    np.testing.assert_array_equal(found, pixels)

    def test_libraries_and_our_own_decoder_agree(self):
        cv2, pillow = optional_module("cv2"), optional_module("PIL.Image")
        depth = self.rng.integers(0, 65536, (48, 64)).astype(np.uint16)
        color = np.repeat(np.repeat(self.rng.integers(0, 256, (6, 8, 3)), 8, axis=0), 8, axis=1).astype(np.uint8)
        if cv2 is not None:
            np.testing.assert_array_equal(decode_png(cv2.imencode(".png", depth)[1].tobytes()), depth)
        if pillow is not None:
            file = io.BytesIO()
            pillow.fromarray(color).save(file, "PNG")
            np.testing.assert_array_equal(decode_png(file.getvalue()), color)
            pillow.fromarray(color).convert("P").save(palette := io.BytesIO(), "PNG")
            expected = np.array(pillow.fromarray(color).convert("P").convert("RGB"))
            np.testing.assert_array_equal(decode_png(palette.getvalue()), expected)

    def test_depth_and_colour_of_messages(self):
        depth, color = steps(9), self.rng.integers(0, 256, (6, 8, 3)).astype(np.uint8)
        message = vismap.frame_message(depth, POSE, CAMERA, png(color, (4,)))
        message.depth, message.depth_encoding = png(depth, (2, 4)), message.DEPTH_PNG
        found = through_bytes(message)
        expected = depth.astype(np.float32) * np.float32(0.001)
        expected[0, :2] = np.nan
        np.testing.assert_array_equal(vismap.depth_of(found), expected)
        np.testing.assert_array_equal(vismap.color_of(found), color)
        grey = vismap.frame_message(depth, POSE, CAMERA, png(color[:, :, 0]))
        np.testing.assert_array_equal(vismap.color_of(grey), color[:, :, [0, 0, 0]])

    def test_jpeg(self):
        pillow, cv2 = optional_module("PIL.Image"), optional_module("cv2")
        smooth = np.stack([np.linspace(0, 255, 48).reshape(6, 8), np.full((6, 8), 90), np.full((6, 8), 30)], axis=2).astype(np.uint8)
        if pillow is not None:
            pillow.fromarray(smooth).save(file := io.BytesIO(), "JPEG", quality=95, subsampling=0)
            data = file.getvalue()
        elif cv2 is not None:
            data = cv2.imencode(".jpg", smooth[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, 95])[1].tobytes()
        else:
            self.skipTest("neither Pillow nor OpenCV")
        found = vismap.color_of(vismap.frame_message(steps(), POSE, CAMERA, data))
        self.assertLess(np.abs(found.astype(int) - smooth).mean(), 12)
        wrong = vismap.frame_message(steps(), POSE, CAMERA, data)
        wrong.color_camera.width = 9
        with self.assertRaisesRegex(vismap.MessageError, "a JPEG has 8x6 pixels; expected 9x6"):
            vismap.color_of(wrong)
        for size in range(2, len(data), 7):
            cut = vismap.frame_message(steps(), POSE, CAMERA, data[:size] if size > 3 else b"\xff\xd8\xff")
            with contextlib.suppress(vismap.MessageError):
                self.assertEqual(vismap.color_of(cut).shape, (6, 8, 3))

    def test_damaged_images_are_errors(self):
        good = png(steps(), (4, 1))
        accepted = 0
        for i in range(3000):
            data = bytearray(good)
            for _ in range(1 + int(self.rng.integers(3))):
                data[int(self.rng.integers(len(data)))] = int(self.rng.integers(256))
            with contextlib.suppress(vismap.MessageError):
                decode_png(bytes(data[:int(self.rng.integers(len(data))) if i % 3 == 0 else len(data)]))
                accepted += 1
        self.assertLess(accepted, 100)
        huge = bytearray(good)
        huge[16:24] = b"\x00\x00\xff\xff\x00\x00\xff\xff"
        huge[29:33] = zlib.crc32(huge[12:29]).to_bytes(4, "big")
        with self.assertRaisesRegex(vismap.MessageError, "65535x65535 pixels"):
            decode_png(bytes(huge))
        with self.assertRaisesRegex(vismap.MessageError, "interlacing 1"):
            decode_png(png(steps(), interlaced=1))


class ClockTest(unittest.TestCase):
    def test_jitter_of_the_arrival_disappears(self):
        rng, clock = np.random.default_rng(8), DeviceClock(latency_s=0.01)
        truth, found = [], []
        for i in range(600):
            device = 100 + i / 30
            truth.append(1_700_000_000_000_000 + round(i / 30 * 1e6))
            found.append(clock.to_utime(device, truth[-1] + 10_000 + int(rng.exponential(3000))))
        errors = np.abs(np.array(found) - truth)[100:]
        self.assertLess(errors.max(), 400)  # [us]

    def test_drift_is_followed_and_a_restart_noticed(self):
        clock = DeviceClock(window_s=5)
        for i in range(3000):
            utime = clock.to_utime(i / 30 * 1.0001, 10_000_000 + round(i / 30 * 1e6))
        self.assertLess(abs(utime - 10_000_000 - 2999 / 30 * 1e6), 1000)
        self.assertGreater(clock.to_utime(0.0, 10_000_000 + 101_000_000), utime)
        self.assertEqual(clock.restarts, 1)

    def test_times_always_increase(self):
        clock = DeviceClock()
        times = [clock.to_utime(1.0, 5_000_000 - i) for i in range(5)]
        self.assertEqual(times, sorted(set(times)))

    def test_a_wall_clock_that_is_set_counts_at_once(self):
        """Also backward by an hour, though times go back then; drift and jitter stay out as before."""
        for step_s in (-3600, -5, -0.2, 0.3, 5, 3600):
            with self.subTest(step_s=step_s):
                rng, clock, errors, times = np.random.default_rng(10), DeviceClock(), [], []
                for i in range(600):
                    taken = i / 30
                    arrival = taken + 0.002 + float(rng.exponential(0.003))
                    ahead = 1_700_000_000 + (step_s if i >= 300 else 0)
                    times.append(clock.to_utime(50 + taken, round((ahead + arrival) * 1e6), 20 + arrival))
                    errors.append(times[-1] / 1e6 - ahead - taken)
                self.assertLess(np.abs(errors[200:]).max(), 0.003)  # also of frame 300, the first one after the step
                self.assertEqual(clock.steps_back, int(step_s < 0))
                self.assertEqual(np.flatnonzero(np.diff(times) <= 0).tolist(), [299] if step_s < 0 else [])

    def test_arrivals_of_the_wall_clock_alone_may_go_back(self):
        clock = DeviceClock()
        times = [clock.to_utime(i / 30, 1_700_000_000_000_000 + round((i / 30 - (600 if i >= 40 else 0)) * 1e6)) for i in range(80)]
        self.assertEqual(times[40], times[39] - 600_000_000 + 33_333)
        self.assertEqual((clock.steps_back, clock.restarts), (1, 0))
        self.assertAlmostEqual(DeviceClock().to_utime(3.0) / 1e6, time.time(), delta=1)
        for wrong in (math.nan, math.inf):
            with self.assertRaisesRegex(ValueError, "the time stamp of the camera is"):
                clock.to_utime(wrong)

    def test_pace_is_even(self):
        for rate, expected in ((10, 10), (30, 30), (100, 30), (15, 15), (0, 30)):
            pace, rng = Pace(rate), np.random.default_rng(9)
            taken = [i for i in range(300) if pace.takes(round(i / 30 * 1e6) + int(rng.integers(-2000, 2000)))]
            self.assertAlmostEqual(len(taken) / 10, expected, delta=0.5)
            self.assertLessEqual(max(np.diff(taken)), 30 / expected)
        pace = Pace(10)
        self.assertTrue(pace.takes(10_000_000))
        self.assertTrue(pace.takes(1_000_000), "the clock was set back")

    def test_the_newest_value_replaces_others(self):
        newest = Newest()
        self.assertIsNone(newest.take(0.001))
        newest.put(1)
        newest.put(2)
        self.assertEqual((newest.take(1), newest.skipped, newest.take(0)), (2, 1, None))


if __name__ == "__main__":
    unittest.main()
