#!/usr/bin/env python3
"""The bus: a hub written here, which can misbehave; LCM's own programs on multicast. Usage: bus_test.py"""
import contextlib
import pathlib
import shutil
import socket
import struct
import subprocess
import tempfile
import threading
import time
import tracemalloc
import unittest

import support
from support import wait_until

import vismap
from vismap.transports import Fragments, RecordReader, datagrams, parse_url

GROUP = "239.255.76.68"


class SmallHub:
    """Greets clients, passes messages on to all of them, and remembers what they asked for."""

    def __init__(self, port=0, greeting=struct.pack(">II", 0x287617fa, 0x0100)):
        self.listener = socket.create_server(("127.0.0.1", port))
        self.url = f"tcpq://127.0.0.1:{self.listener.getsockname()[1]}"
        self.greeting, self.clients, self.patterns, self.lock = greeting, [], [], threading.Lock()
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()

    def serve(self, client):
        stream = client.makefile("rb")
        try:
            assert stream.read(8) == struct.pack(">II", 0x287617fb, 0x0100)
            client.sendall(self.greeting)
            with self.lock:
                self.clients.append(client)
            while head := stream.read(8):
                kind, size = struct.unpack(">II", head)
                name = stream.read(size)
                if kind != 1:
                    self.patterns.append((kind, name.decode()))
                    continue
                length = stream.read(4)
                self.send(head + name + length + stream.read(int.from_bytes(length, "big")))
        except (OSError, AssertionError):
            pass
        finally:
            stream.close()
            client.close()

    def send(self, data, pieces=1):
        with self.lock:
            for client in self.clients:
                for i in range(pieces):
                    with contextlib.suppress(OSError):  # the client has gone
                        client.sendall(data[len(data) * i // pieces:len(data) * (i + 1) // pieces])
                    time.sleep(0.001 * (pieces > 1))

    def close(self):
        with contextlib.suppress(OSError):
            self.listener.shutdown(socket.SHUT_RDWR)  # wakes accept(), which would take one more client
        self.listener.close()
        with self.lock:
            for client in self.clients:
                with contextlib.suppress(OSError):
                    client.shutdown(socket.SHUT_RDWR)


def record(channel, data):
    return struct.pack(">II", 1, len(channel)) + channel.encode() + struct.pack(">I", len(data)) + data


def status(text="x"):
    return vismap.types["vismap.process_status_t"](state="running", message=text)


class HubTest(unittest.TestCase):
    def setUp(self):
        self.hub = SmallHub()
        self.addCleanup(self.hub.close)

    def bus(self, **options):
        bus = vismap.Bus(self.hub.url, **options)
        self.addCleanup(bus.close)
        return bus

    def test_messages_have_number_source_time_and_arrive_in_order(self):
        bus = self.bus(name="me")
        subscription = bus.subscribe("STATUS")
        for text in "abc":
            bus.publish("STATUS", status(text))
        found = [subscription.get(10).decode() for _ in range(3)]
        self.assertEqual([(m.seq, m.source, m.message) for m in found], [(0, "me", "a"), (1, "me", "b"), (2, "me", "c")])
        self.assertLess(abs(found[0].utime - vismap.now_utime()), 10e6)

    def test_a_prefix_stands_before_all_channels(self):
        mine, plain = self.bus(channel_prefix="my.robot/"), self.bus()
        chosen, everything = mine.subscribe("STATUS|MAP_.*"), plain.subscribe(".*")
        wait_until(lambda: len(self.hub.patterns) == 2)
        self.assertIn((2, r"my\.robot/(?:STATUS|MAP_.*)"), self.hub.patterns)
        plain.publish("STATUS", status("not mine"))
        mine.publish("STATUS", status("mine"))
        self.assertEqual(sorted(everything.get(10).channel for _ in range(2)), ["STATUS", "my.robot/STATUS"])
        received = chosen.get(10)
        self.assertEqual((received.channel, received.decode().message), ("STATUS", "mine"))
        self.assertIsNone(chosen.poll(0.1))
        self.assertEqual(mine.published, {"STATUS": 1})
        with self.assertRaisesRegex(vismap.BusError, "at most"):
            mine.publish_bytes("STATUS", bytes(1 << 20))
        for prefix in ("a b", "a*", "x" * 49):
            with self.assertRaisesRegex(vismap.BusError, "prefix"):
                vismap.Bus(self.hub.url, channel_prefix=prefix)

    def test_patterns_match_whole_names(self):
        bus = self.bus()
        chosen, one = bus.subscribe("MAP_.*"), bus.subscribe("MAP")
        for channel in ("MAP_REPLY", "MAP", "A_MAP_B", "MAP_DELTA"):
            self.hub_waits_for(bus, lambda: (2, "MAP") in self.hub.patterns)
            bus.publish_bytes(channel, channel.encode())
        self.assertEqual([chosen.get(10).channel for _ in range(2)], ["MAP_REPLY", "MAP_DELTA"])
        self.assertEqual(one.get(10).data, b"MAP")
        self.assertIsNone(one.poll())

    def hub_waits_for(self, bus, condition):
        wait_until(lambda: condition() and bus.connected)

    def test_messages_in_pieces(self):
        bus = self.bus()
        subscription = bus.subscribe("A")
        wait_until(lambda: self.hub.patterns)
        data = bytes(range(256)) * 10
        self.hub.send(record("A", data) + record("A", b"") + record("A", data[:7]), pieces=40)
        self.assertEqual([subscription.get(10).data for _ in range(3)], [data, b"", data[:7]])

    def test_full_queue_drops_the_oldest_and_counts(self):
        bus = self.bus()
        few, small = bus.subscribe("A", capacity=3), bus.subscribe("A", max_queue_mb=1)
        wait_until(lambda: self.hub.patterns)
        for i in range(10):
            self.hub.send(record("A", bytes([i]) * 300_000))
        wait_until(lambda: bus.received["A"] == 10)
        wait_until(lambda: few.dropped == 7 and small.dropped == 7)
        self.assertEqual([few.get(1).data[0] for _ in range(3)], [7, 8, 9])
        self.assertEqual(small.latest(1).data[0], 9)
        with self.assertRaisesRegex(vismap.WaitTimeout, "A within 0.01 s"):
            few.get(0.01)

    def test_comes_back_with_its_subscriptions_after_the_hub_has_gone(self):
        bus = self.bus()
        subscription = bus.subscribe("A|B")
        wait_until(lambda: self.hub.patterns)
        port = int(self.hub.url.rsplit(":", 1)[1])
        self.hub.close()
        wait_until(lambda: not bus.connected)
        with self.assertRaisesRegex(vismap.BusError, "no connection"):
            bus.publish("STATUS", status())
        self.assertEqual(bus.unsent["STATUS"], 1)
        self.hub = SmallHub(port)
        wait_until(lambda: bus.connected)
        self.addCleanup(self.hub.close)
        wait_until(lambda: self.hub.patterns == [(2, "A|B")])
        self.assertEqual(bus.reconnects, 1)
        bus.publish_bytes("B", b"again")
        self.assertEqual(subscription.get(10).data, b"again")
        subscription.close()
        wait_until(lambda: (3, "A|B") in self.hub.patterns)

    def test_a_message_that_was_not_sent_has_no_number(self):
        bus = self.bus()
        subscription = bus.subscribe("STATUS")
        with self.assertRaisesRegex(vismap.BusError, "at most 65536 bytes"):
            bus.publish("STATUS", status("x" * 70000))
        bus.publish("STATUS", status("small"))
        self.assertEqual(subscription.get(10).decode().seq, 0)

    def test_wrong_type_for_a_channel(self):
        with self.assertRaisesRegex(vismap.MessageError, "OBJECTS carries vismap.object_list_t"):
            self.bus().publish("OBJECTS", status())

    def test_hub_that_announces_too_much_or_talks_nonsense_is_left(self):
        for data in (struct.pack(">II", 1, 1) + b"A" + struct.pack(">I", 0xffffffff), struct.pack(">II", 1, 1 << 30),
                     struct.pack(">II", 7, 1) + b"A", b"HTTP/1.1 400 Bad Request\r\n"):
            bus = self.bus()
            wait_until(lambda: len(self.hub.clients) > 0)
            self.hub.send(data)
            wait_until(lambda: bus.reconnects >= 1)
            bus.close()
            with self.hub.lock:
                self.hub.clients.clear()

    def test_no_hub_and_no_lcm_are_told_with_what_to_do(self):
        with self.assertRaisesRegex(vismap.BusError, "vismap-hub --listen 127.0.0.1:1"):
            vismap.Bus("tcpq://127.0.0.1:1", connect_timeout_s=0.1)
        stranger = SmallHub(greeting=b"SSH-2.0-")
        self.addCleanup(stranger.close)
        with self.assertRaisesRegex(vismap.BusError, "does not answer as a hub"):
            vismap.Bus(stranger.url, connect_timeout_s=0.1)

    def test_close_ends_loops_and_waits(self):
        bus = self.bus()
        subscription, ended = bus.subscribe("A"), threading.Event()
        threading.Thread(target=lambda: (list(subscription), ended.set()), daemon=True).start()
        bus.close()
        self.assertTrue(ended.wait(10))
        with self.assertRaises(vismap.BusError):
            bus.subscribe("A")

    def test_status_tells_versions_counters_and_states(self):
        bus = self.bus(name="drv")
        subscription = bus.subscribe("STATUS")
        with vismap.Status(bus, "driver") as state:
            state.count("frames", 3)
            state.add_timing("publish", 2.0)
            state.add_timing("publish", 4.0)
            state.saw_frame(7, 123)
            state.set("running", "fine")
        found = [subscription.get(10).decode() for _ in range(3)]
        self.assertEqual([m.state for m in found], ["starting", "running", "stopping"])
        counters = dict(zip(found[1].counter_names, found[1].counter_values.tolist()))
        self.assertEqual((counters["frames"], counters["newest_utime.camera7"], counters["STATUS.published"]), (3, 123, 1))
        self.assertGreater(counters["memory_bytes"], 1 << 20)
        self.assertEqual((found[1].timing_names, found[1].median_ms.tolist(), found[1].max_ms.tolist()), (["publish"], [3.0], [4.0]))
        self.assertEqual((found[1].source, found[1].process, found[1].message), ("drv", "driver", "fine"))
        with self.assertRaisesRegex(ValueError, "starting, ready"):
            state.set("fine")


class RecordsTest(unittest.TestCase):
    def test_a_large_announcement_allocates_nothing(self):
        reader = RecordReader()
        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        self.assertEqual(reader.add(struct.pack(">II", 1, 1) + b"A" + struct.pack(">I", 190 << 20) + b"x"), [])
        self.assertLess(tracemalloc.get_traced_memory()[1], 1 << 20)


class UrlTest(unittest.TestCase):
    def test_defaults_and_options(self):
        url = parse_url("udpm://?ttl=1&recv_buf_size=1000")
        self.assertEqual((url.host, url.port, url.ttl, url.receive_buffer), ("239.255.76.67", 7667, 1, 1000))
        url = parse_url("tcpq://")
        self.assertEqual((url.host, url.port), ("127.0.0.1", 7700))

    def test_errors_say_what_is_expected(self):
        for text, words in (("tcpq://robot:7700", "numeric address"), ("http://1.2.3.4", "expected tcpq://"), ("7700", "expected tcpq://"),
                            ("udpm://1.2.3.4:5?ttl=x", "ttl must be a number"), ("tcpq://1.2.3.4:70000", "at most 65535")):
            with self.assertRaisesRegex(vismap.BusError, words):
                parse_url(text)


class FragmentsTest(unittest.TestCase):
    DATA = bytes(i % 251 for i in range(300_000))

    def test_parts_in_any_order_and_twice(self):
        parts = datagrams("CHANNEL", self.DATA, 9)
        self.assertEqual(len(parts), 5)
        fragments = Fragments()
        for part in (parts[4], parts[2], parts[2], parts[0], parts[3]):
            self.assertIsNone(fragments.add(part, "a"))
        self.assertIsNone(fragments.add(parts[1], "another sender"))
        self.assertEqual(fragments.add(parts[1], "a"), ("CHANNEL", self.DATA))

    def test_short_messages_and_the_limit_between_both(self):
        for size in (0, 1, 65499 - 2, 65499 - 1, 65500, 65487 * 2 - 2, 65487 * 2 - 1):
            found = [Fragments().add(part, 0) for part in datagrams("C", self.DATA[:size], 0)][-1:]
            fragments = Fragments()
            for part in datagrams("C", self.DATA[:size], 0):
                found = fragments.add(part, 0)
            self.assertEqual(found, ("C", self.DATA[:size]))

    def test_hostile_datagrams_are_counted_and_take_no_memory(self):
        head = struct.Struct(">IIIIHH")
        long = 0x4c433033
        hostile = [b"", b"abc", bytes(8), struct.pack(">II", 0x4c433032, 1) + b"A" * 70, head.pack(long, 1, 190 << 20, 0, 0, 65535)[:19],
                   head.pack(long, 2, 100, 0xfffffff0, 1, 2) + bytes(50), head.pack(long, 3, 10, 0, 5, 2) + bytes(5),
                   head.pack(long, 4, 10, 0, 0, 1) + b"NO NUL" * 20, head.pack(long, 5, 0xffffffff, 0, 0, 9) + b"A\0x",
                   head.pack(long, 6, 100, 0, 0, 1) + b"A\0" + bytes(50)]
        fragments = Fragments()
        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        for datagram in hostile:
            self.assertIsNone(fragments.add(datagram, "x"))
        self.assertEqual(fragments.rejected, len(hostile))
        for i in range(1000):  # messages that never become complete
            fragments.add(head.pack(long, 1000 + i, 60000, 0, 0, 2) + b"A\0" + bytes(1000), "x")
        self.assertLess(tracemalloc.get_traced_memory()[1], 1 << 20)


class MulticastTest(unittest.TestCase):
    """With LCM's own programs: lcm-logger records what we publish, and lcm-logplayer publishes it again."""

    def setUp(self):
        for program in ("lcm-logger", "lcm-logplayer"):
            if not shutil.which(program):
                self.skipTest(f"no {program}")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        self.url = f"udpm://{GROUP}:{port}?ttl=0&recv_buf_size=200000"
        try:
            self.bus = vismap.Bus(self.url)
        except vismap.BusError as error:
            self.skipTest(f"no multicast here: {error}")
        self.addCleanup(self.bus.close)
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.log = pathlib.Path(temporary.name) / "a.lcmlog"

    def test_both_directions(self):
        sizes = [0, 100, 65497, 65498, 130_000]
        sent = [bytes(i % 253 for i in range(size)) for size in sizes]
        logger = subprocess.Popen(["lcm-logger", f"--lcm-url={self.url}", "--flush-interval=10", str(self.log)],
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(logger.wait)
        self.addCleanup(logger.kill)
        echo = self.bus.subscribe("HELLO|DATA")

        def logged():
            self.bus.publish_bytes("HELLO", b"")
            time.sleep(0.05)
            return self.log.exists() and self.log.stat().st_size > 0
        wait_until(logged, "the start of lcm-logger")
        for data in sent:
            self.bus.publish_bytes("DATA", data)
            time.sleep(0.05)
        wait_until(lambda: self.log.stat().st_size > sum(sizes), "the log")
        time.sleep(0.2)
        logger.terminate()
        logger.wait()
        recorded = [event.data for event in vismap.LogReader(self.log, skip_damage=True) if event.channel == "DATA"]
        self.assertEqual(recorded, sent)
        while echo.poll() is not None:
            pass
        subprocess.run(["lcm-logplayer", f"--lcm-url={self.url}", str(self.log)], check=True, timeout=support.DEADLINE,
                       stdout=subprocess.DEVNULL)
        played = []
        while len(played) < len(sent):
            message = echo.get(10)
            if message.channel == "DATA":
                played.append(message.data)
        self.assertEqual(played, sent)


if __name__ == "__main__":
    unittest.main()
