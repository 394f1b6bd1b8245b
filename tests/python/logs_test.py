#!/usr/bin/env python3
"""Logs: what is written is read; damage is told or passed over, and takes no memory."""
import pathlib
import struct
import tempfile
import tracemalloc
import unittest

import support

import vismap


class LogsTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.path = pathlib.Path(temporary.name) / "run.lcmlog"

    def write(self, count=5, size=100):
        with vismap.LogWriter(self.path) as log:
            for i in range(count):
                log.write(f"C{i}", bytes([i]) * size, utime=1000 + i)
        return self.path.read_bytes()

    def read(self, **options):
        log = vismap.LogReader(self.path, **options)
        return [(e.number, e.utime, e.channel, e.data) for e in log], log

    def test_what_is_written_is_read(self):
        data = self.write()
        self.assertEqual(self.read()[0], [(i, 1000 + i, f"C{i}", bytes([i]) * 100) for i in range(5)])
        # The format of lcm-logger: sync word, number, time, two sizes, channel, data.
        self.assertEqual(data[:30], struct.pack(">Iqqii", 0xeda1da01, 0, 1000, 2, 100) + b"C0")
        log = vismap.LogReader(self.path)
        for _ in range(2):
            self.assertEqual([e.offset for e in log], [130 * i for i in range(5)])

    def test_messages_are_encoded_and_decoded(self):
        with vismap.LogWriter(self.path) as log:
            log.write("STATUS", vismap.types["vismap.process_status_t"](source="me", state="running"))
        (event,) = vismap.LogReader(self.path)
        self.assertEqual((event.decode().source, event.decode().state), ("me", "running"))
        self.assertLess(abs(event.utime - vismap.now_utime()), 60e6)

    def test_a_log_is_not_replaced_unasked(self):
        self.write()
        with self.assertRaisesRegex(vismap.LogError, "overwrite=True"):
            vismap.LogWriter(self.path)
        with vismap.LogWriter(self.path, overwrite=True):
            pass
        self.assertEqual(self.read()[0], [])
        with self.assertRaisesRegex(vismap.LogError, "nowhere.lcmlog: the log cannot be read"):
            vismap.LogReader(self.path.with_name("nowhere.lcmlog"))

    def test_cut_end(self):
        data = self.write()
        for cut in (1, 50, 101, 129):
            self.path.write_bytes(data[:-cut])
            with self.assertRaisesRegex(vismap.LogError, "from byte 520 on.*skip_damage"):
                self.read()
            events, log = self.read(skip_damage=True)
            self.assertEqual(len(events), 4)
            self.assertEqual([(d.offset, d.size) for d in log.damage], [(520, 130 - cut)])

    def test_damage_in_the_middle_is_passed_over(self):
        data = self.write()
        for begin, end, lost in ((150, 158, [1]), (130, 131, [1]), (280, 283, [2]), (0, 4, [0])):
            damaged = bytearray(data)
            damaged[begin:end] = b"\xff" * (end - begin)
            self.path.write_bytes(damaged)
            with self.assertRaises(vismap.LogError):
                self.read()
            events, log = self.read(skip_damage=True)
            self.assertEqual([e[0] for e in events if e[2] == f"C{e[0]}"], [i for i in range(5) if i not in lost], (begin, end))
            self.assertEqual(sum(d.size for d in log.damage), 130)

    def test_impossible_sizes_and_a_false_sync_word_take_no_memory(self):
        data = self.write()
        for sizes in ((2, 0x7fffffff), (0x7fffffff, 1), (-1, -1), (0, 10), (2, 150 << 20)):
            self.path.write_bytes(data + struct.pack(">Iqqii", 0xeda1da01, 0, 0, *sizes) + data)
            tracemalloc.start()
            events, log = self.read(skip_damage=True)
            peak = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
            self.assertEqual((len(events), len(log.damage)), (10, 1))
            self.assertLess(peak, 4 << 20)

    def test_a_sync_word_between_two_search_windows(self):
        event = self.write(count=1)
        for gap in range((1 << 20) - 3, (1 << 20) + 3):
            self.path.write_bytes(b"\x55" * gap + event)
            events, log = self.read(skip_damage=True)
            self.assertEqual((len(events), log.damage[0].size), (1, gap))

    def test_a_large_log_is_not_loaded(self):
        self.write(count=60, size=1 << 20)
        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        self.assertEqual(sum(len(event.data) for event in vismap.LogReader(self.path)), 60 << 20)
        self.assertLess(tracemalloc.get_traced_memory()[1], 8 << 20)


if __name__ == "__main__":
    unittest.main()
