#!/usr/bin/env python3
"""vismap-viewer on a real hub, with a map that grows, and with browsers that behave and that do not.

Usage: viewer_process_test.py FOLDER_OF_PROGRAMS
"""
import functools
import json
import math
import os
import pathlib
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "python"), str(ROOT / "tests" / "viewer")]
from support import DEADLINE, Processes, wait_until  # noqa: E402
import numpy as np  # noqa: E402
import vismap  # noqa: E402
from web_client import BINARY, CLOSE, PING, TEXT, Page, WebSocket, ask_raw, connect, get  # noqa: E402

BIN = None  # from the command line
FRAMES = 24
ROOM = f"synthetic:room?frames={FRAMES}&width=160"


class Run:
    """A hub with all processes that map the room."""

    def __init__(self, folder, viewer_arguments=(), page=None):
        self.processes = Processes(BIN, folder)
        self.folder = folder
        self.url = self.processes.start_hub()
        self.start("viewer", "--bind", "127.0.0.1:0", "--page", page or folder / "page", *viewer_arguments)
        out = folder / "viewer.out"
        wait_until(lambda: b"\n" in out.read_bytes(), "the start of the viewer")
        self.address = out.read_text().split()[0]

    def start(self, name, *arguments):
        self.processes.start(name, BIN / f"vismap-{name}", "--lcm-url", self.url, *arguments)

    def start_mapping(self):
        self.start("map-server", "--map-folder", self.folder / "maps", "--threads", "1")
        self.start("depth-segmenter", "--detections", "required", "--threads", "1")
        self.start("detector", "--dataset", ROOM)

    def replay(self):
        done = subprocess.run([BIN / "vismap-sensor-replay", "--lcm-url", self.url, "--dataset", ROOM, "--mode", "lockstep",
                               "--wait-for", "map-server,depth-segmenter,detector"], capture_output=True, timeout=240)
        if done.returncode != 0:
            raise AssertionError(done.stderr.decode(errors="replace"))

    def map_tool(self, *words):
        done = subprocess.run([BIN / "vismap-map", *words, "--lcm-url", self.url], capture_output=True, timeout=DEADLINE, text=True)
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        return done.stdout

    def stop(self):
        self.processes.stop_all()


def memory_mb(pid):
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    return 0


class Reader(threading.Thread):
    """A page that reads all the time, or a part of it."""

    def __init__(self, page, pause=0):
        super().__init__(daemon=True)
        self.page, self.pause, self.stopped, self.failure = page, pause, False, None
        self.start()

    def run(self):
        try:
            while not self.stopped:
                self.page.step()
                time.sleep(self.pause)
        except Exception as failure:  # noqa: BLE001, told by the test
            if not self.stopped:
                self.failure = failure

    def stop(self):
        self.stopped = True
        self.join(10)


@functools.cache
def offline_hash():
    """The hash of the room as one process maps it, without bus and viewer."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([BIN / "vismap-offline-mapper", "--dataset", ROOM, "--out", folder], check=True, capture_output=True, timeout=240)
        return subprocess.run([BIN / "vismap-map", "hash", f"{folder}/map.vismap"], capture_output=True, text=True, check=True).stdout.split()[0]


class LiveTest(unittest.TestCase):
    """One map that grows while five pages are connected, one of which never reads."""

    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.run_ = Run(pathlib.Path(temporary.name))
        cls.addClassCleanup(cls.run_.stop)
        cls.early = Reader(Page(cls.run_.address, {"pictures": [0, 1]}))
        cls.silent = WebSocket(cls.run_.address, receive_buffer=4096)
        cls.readers = [Reader(Page(cls.run_.address)), Reader(Page(cls.run_.address)),
                       Reader(Page(cls.run_.address), pause=0.0003)]
        cls.run_.start_mapping()
        cls.run_.start("octomap-exporter")
        cls.run_.replay()
        statistics = json.loads(cls.run_.map_tool("info", "live", "--json"))
        cls.hash = statistics["hash"]
        wait_until(lambda: json.loads(get(cls.run_.address, "/api/map")[2])["revision"] == FRAMES, "the whole map")

    def level(self, page):
        page.run_until(lambda p: p.is_level() and p.texts["map"]["revision"] == FRAMES)

    def test_hash_is_that_of_a_map_without_viewers(self):
        self.assertEqual(self.hash, offline_hash())

    def test_late_page_equals_early_ones_and_the_server(self):
        late = Page(self.run_.address)
        self.level(late)
        self.assertGreater(len(late.blocks), 100)
        for reader in [self.early, *self.readers]:
            wait_until(lambda: reader.failure or reader.page.is_level(), "a page that is level")
            self.assertIsNone(reader.failure)
            self.assertEqual(reader.page.blocks, late.blocks)
        state = late.texts["map"]
        self.assertEqual(state["triangles"], late.triangles())
        self.assertEqual(state["frames"], FRAMES)
        self.assertIn(f"mesh digest {state['mesh_digest']}", self.run_.map_tool("follow", "--frames", str(FRAMES)))

    def exporter_has_all(self):
        """The map's slice at 1 m with distances of the exporter, when the exporter has the whole map."""
        def fetch():
            status, _, body = get(self.run_.address, "/api/slice?axis=z&at=1.01&distance=1")
            self.assertEqual(status, 200, body)
            size = struct.unpack_from("<I", body)[0]
            return json.loads(body[4:4 + size]), body[4 + size:]
        end = time.monotonic() + DEADLINE
        while True:
            head, rest = fetch()
            if head["distances"] or time.monotonic() > end:
                return head, rest
            time.sleep(0.3)

    def test_distances_of_a_slice_are_those_of_the_exporter(self):
        head, rest = self.exporter_has_all()
        self.assertTrue(head["distances"], head)
        cells = head["width"] * head["height"]
        states = np.frombuffer(rest, np.uint8, cells).reshape(head["height"], head["width"])
        metres = np.frombuffer(rest, np.float32, cells, (cells + 3) // 4 * 4).reshape(states.shape)
        leaf, cell = head["distance_leaf_m"], head["cell_m"]
        self.assertTrue((metres[states == 2] <= leaf).all(), "occupied cells lie in occupied leaves")
        self.assertLessEqual(np.nanmax(metres), head["distance_limit_m"] + 1e-5)
        # At the centres of leaves the picture is not interpolated.
        places = [[first + (np.arange(count) + 0.5) * cell for first, count in zip(head["origin"], states.shape[::-1])][i] for i in (0, 1)]
        on_centre = [np.abs(place / leaf - 0.5 - np.round(place / leaf - 0.5)) < 1e-6 for place in places]
        usable = (states == 1) & (metres > 0.3) & (metres < 1) & on_centre[0][None, :] & on_centre[1][:, None]
        rows, columns = np.nonzero(usable)
        self.assertGreater(len(rows), 20)
        chosen = range(0, len(rows), max(1, len(rows) // 8))
        z = (math.floor(1.01 / leaf) + 0.5) * leaf
        points = ";".join(f"{places[0][columns[i]]:.4f},{places[1][rows[i]]:.4f},{z:.4f}" for i in chosen)
        said = json.loads(self.run_.map_tool("clearance", "live", "--at", points, "--json"))["points"]
        for i, point in zip(chosen, said):
            self.assertAlmostEqual(point["obstacle_m"], float(metres[rows[i], columns[i]]), delta=2e-3)

    def test_leaves_are_those_of_the_octree(self):
        self.exporter_has_all()
        status, _, body = get(self.run_.address, "/api/leaves?axis=z&at=1.01")
        self.assertEqual(status, 200, body)
        raw = json.loads(body)
        self.assertGreater(len(raw["leaves"]), 200)
        self.assertEqual({leaf[4] for leaf in raw["leaves"]}, {1, 2})
        for x, y, z, size, _ in raw["leaves"]:
            self.assertLessEqual(abs(z - 1.01), size / 2)
        tree = self.run_.folder / "live.bt"
        self.run_.map_tool("octree", "live", "--unknown", "absent", "--out", tree)
        octree = vismap.Octree.open(tree)
        for x, y, _, _, state in raw["leaves"][::len(raw["leaves"]) // 50]:
            self.assertEqual(octree.state([[x, y, 1.01]])[0], {1: vismap.FREE, 2: vismap.OCCUPIED}[state])
        closed = json.loads(get(self.run_.address, "/api/leaves?axis=z&at=1.01&layer=closed")[2])
        self.assertGreater(sum(leaf[4] == 2 for leaf in closed["leaves"]), sum(leaf[4] == 2 for leaf in raw["leaves"]))
        self.assertEqual(get(self.run_.address, "/api/leaves?at=1&layer=some")[0], 400)

    def test_bytes_of_the_map_are_told_by_layer(self):
        late = Page(self.run_.address)
        self.level(late)
        late.run_until(lambda p: p.texts["map"]["bytes"].get("distances", 0) + p.texts["map"]["bytes"].get("packed", 0) > 1e6)
        layers = json.loads(self.run_.map_tool("info", "live", "--json"))["memory"]
        self.assertEqual(set(late.texts["map"]["bytes"]), set(layers))
        late.run_until(lambda p: p.texts["map"]["bytes"]["trajectory"] == layers["trajectory"])

    def test_page_gets_objects_processes_cameras_and_paths(self):
        page = Page(self.run_.address)
        page.run_until(lambda p: {"hello", "map", "objects", "processes"} <= set(p.texts)
                       and sum(len(path) for path in p.paths.values()) == FRAMES)
        self.assertEqual(page.texts["hello"]["protocol"], 1)
        self.assertFalse(page.texts["hello"]["control"])
        self.assertEqual(page.texts["hello"]["class_names"]["62"], "chair")
        self.assertIn("map-server", [p["process"] for p in page.texts["processes"]["processes"]])
        self.assertTrue(page.texts["objects"]["objects"])
        early = self.early.page
        self.assertEqual(early.texts["cameras"]["cameras"][0]["width"], 160)
        (_, (picture, jpeg)), *_ = early.pictures.items()
        self.assertEqual(jpeg[:2], b"\xff\xd8")
        self.assertEqual(sum(picture["segments"]["runs"][1::2]),
                         picture["segments"]["width"] * picture["segments"]["height"])
        self.assertLess(max(picture["segments"]["runs"][0::2]), len(picture["segments"]["list"]))

    def test_page_that_never_read_cost_nothing(self):
        self.assertLess(memory_mb(self.run_.processes.running["viewer"].pid), 300)
        self.silent.close()

    def test_answers_of_the_api(self):
        address = self.run_.address
        status, _, body = get(address, "/api/map")
        self.assertEqual((status, json.loads(body)["frames"]), (200, FRAMES))
        status, _, body = get(address, "/api/objects")
        self.assertEqual(status, 200)
        objects = json.loads(body)
        self.assertTrue(objects["structure"])
        name = objects["objects"][0]["instance"] if objects["objects"] else f"s{objects['discovered'][0]['segments'][0]}"
        status, headers, body = get(address, f"/api/object/{name}.ply")
        self.assertEqual((status, body[:3]), (200, b"ply"))
        self.assertIn(f"object-{name}.ply", headers["content-disposition"])
        status, _, body = get(address, "/api/slice?axis=z&at=1.0")
        size = struct.unpack_from("<I", body)[0]
        header = json.loads(body[4:4 + size])
        self.assertEqual(len(body), 4 + size + header["width"] * header["height"])
        self.assertEqual(set(body[4 + size:]), {0, 1, 2})
        status, _, body = get(address, "/api/processes")
        self.assertIn("viewer", [p["process"] for p in json.loads(body)["processes"]])

    def test_cell_is_as_the_map_tool_says(self):
        status, _, body = get(self.run_.address, "/api/objects")
        objects = json.loads(body)
        center = (objects["objects"] + objects["discovered"])[0]["center"]
        at = ",".join(str(x) for x in center)
        status, _, body = get(self.run_.address, f"/api/cell?at={at}")
        self.assertEqual(status, 200)
        self.assertEqual(json.loads(body), json.loads(self.run_.map_tool("cell", "live", "--at", at, "--json")))
        for wrong in ("", "?at=1,2", "?at=a,b,c", "?at=1,2,3;at=4,5,6", "?at=1e9,0,0"):
            status, _, body = get(self.run_.address, "/api/cell" + wrong)
            self.assertEqual(status, 400, wrong)
            self.assertTrue(json.loads(body)["error"])

    def test_unknown_addresses_are_refused_with_a_sentence(self):
        for path, expected in (("/api/nothing", 404), ("/api/object/x.ply", 400), ("/api/object/99999.ply", 400),
                               ("/api/slice", 400), ("/api/objects?what=1", 400), ("/none.js", 404)):
            status, _, body = get(self.run_.address, path)
            self.assertEqual(status, expected, path)
            self.assertIn(" ", json.loads(body)["error"])

    def test_pages_of_other_sites_may_not_ask(self):
        for header in ("Sec-Fetch-Site: cross-site", "Sec-Fetch-Site: same-site", "Origin: http://evil.example"):
            status, _, body = get(self.run_.address, "/api/map", headers=[header])
            self.assertEqual(status, 403, header)
            self.assertIn(" ", json.loads(body)["error"])
        self.assertEqual(get(self.run_.address, "/api/map", headers=["Sec-Fetch-Site: same-origin"])[0], 200)

    def test_questions_to_the_map_server_are_bounded(self):
        time.sleep(1)
        answers = []
        def ask(number):
            answers.append(get(self.run_.address, f"/api/cell?at={number},0,0")[0])

        threads = [threading.Thread(target=ask, args=(number,)) for number in range(40)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertLessEqual(set(answers), {200, 429})
        self.assertIn(200, answers)
        self.assertIn(429, answers)
        time.sleep(1)


class ResetTest(unittest.TestCase):
    def test_page_follows_a_reset_and_a_server_that_comes_back(self):
        expected = offline_hash()  # before there is a page, which must not be silent for long
        with tempfile.TemporaryDirectory() as folder:
            run = Run(pathlib.Path(folder))
            self.addCleanup(run.stop)
            run.start_mapping()
            page = Page(run.address)
            reader = Reader(page)
            run.replay()
            reader.stop()
            self.assertIsNone(reader.failure)
            self.assertEqual(json.loads(run.map_tool("info", "live", "--json"))["hash"], expected)
            page.run_until(lambda p: p.is_level() and p.texts["map"]["revision"] == FRAMES)
            before, first = page.resets, page.texts["map"]
            run.map_tool("reset")
            page.run_until(lambda p: p.is_level() and not p.blocks)
            self.assertEqual(page.resets, before + 1)
            page.run_until(lambda p: p.texts["map"]["map_id"] != first["map_id"] and p.texts["map"]["revision"] == 0)
            self.assertEqual(page.texts["map"]["server_start_utime"], first["server_start_utime"])
            run.processes.stop("map-server")
            page.run_until(lambda p: any("not heard" in text for text in p.notices))
            run.start("map-server", "--map-folder", run.folder / "maps")
            page.run_until(lambda p: any("there again" in text for text in p.notices))
            page.run_until(lambda p: p.texts["map"]["server_start_utime"] > first["server_start_utime"])
            # The hub goes, and comes back at the same address.
            run.processes.running["hub"].kill()
            run.processes.running.pop("hub").wait()
            self.assertEqual(get(run.address, "/api/map")[0], 200)
            run.processes.start_hub(run.url.removeprefix("tcpq://"))
            page.run_until(lambda p: p.texts["map"]["age_s"] < 2 and p.texts["map"]["in_sync"])


class BackTest(unittest.TestCase):
    def test_page_follows_a_map_that_goes_back_to_an_earlier_revision(self):
        with tempfile.TemporaryDirectory() as folder:
            run = Run(pathlib.Path(folder))
            self.addCleanup(run.stop)
            page = Page(run.address)
            with vismap.Bus(run.url, name="map-server") as bus:
                def block(x):
                    fields = dict.fromkeys(("x", "y", "z", "segment", "instance", "class_id", "nx", "ny", "nz"), [0, 1, 2])
                    return vismap.types["vismap.mesh_block_t"](index=[x, 0, 0], edge_m=0.1, a=[0], b=[1], c=[2], **fields,
                                                               **dict.fromkeys(("red", "green", "blue", "seen"), b"abc"))

                def publish(revision, base, blocks):
                    bus.publish("MESH_DELTA", vismap.types["vismap.mesh_delta_t"](
                        map_id="replayed", revision=revision, base_revision=base, full=base < 0, parts=1, blocks=blocks))

                def speak_until(condition, speak):
                    end = time.monotonic() + DEADLINE
                    while not condition(page):
                        self.assertLess(time.monotonic(), end)
                        speak()
                        pause = time.monotonic() + 0.5
                        page.run_until(lambda p: time.monotonic() > pause)

                speak_until(lambda p: len(p.blocks) == 2 and p.texts["map"]["revision"] == 9, lambda: publish(9, -1, [block(0), block(1)]))
                start = time.monotonic()
                speak_until(lambda p: not p.texts["map"]["in_sync"], lambda: publish(4, 4, []))
                self.assertGreater(time.monotonic() - start, 4, "a late update is no map that went back")
                self.assertEqual(len(page.blocks), 2)
                speak_until(lambda p: len(p.blocks) == 1 and p.texts["map"]["revision"] == 4, lambda: publish(4, -1, [block(1)]))
                page.run_until(lambda p: p.is_level())


class HostileTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        folder = pathlib.Path(temporary.name)
        (folder / "page").mkdir()
        (folder / "page" / "index.html").write_text("<p>page</p>")
        (folder / "secret.txt").write_text("secret")
        cls.run_ = Run(folder, ("--max-clients", "5"))
        cls.addClassCleanup(cls.run_.stop)
        cls.address = cls.run_.address

    def tearDown(self):
        status, _, body = get(self.address, "/")
        self.assertEqual((status, body), (200, b"<p>page</p>"))

    def test_headers_keep_browsers_to_this_server(self):
        for path in ("/", "/api/map", "/none"):
            _, headers, _ = get(self.address, path)
            self.assertIn("default-src 'self'", headers["content-security-policy"])
            self.assertEqual(headers["x-content-type-options"], "nosniff")
        status, headers, body = get(self.address, "/", method="HEAD")
        self.assertEqual((status, headers["content-length"], body), (200, "11", b""))

    def test_no_file_outside_of_the_page(self):
        for path in ("/../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt", "//etc/passwd", "/%00", "/.%2e/secret.txt",
                     "/index.html/../../secret.txt", "/\\..\\secret.txt"):
            status, _, body = get(self.address, path)
            self.assertIn(status, (400, 404), path)
            self.assertNotIn(b"secret\n", body)

    def test_foreign_names_and_pages_are_refused(self):
        self.assertEqual(get(self.address, "/", host="evil.example")[0], 403)
        host = self.address.removeprefix("http://")
        for origin, status in (("http://evil.example", 403), ("null", 403), (f"http://{host}", 101)):
            page = WebSocket(self.address, headers=(f"Origin: {origin}",))
            page.close()
            self.assertEqual(page.status, status, origin)

    def test_only_get(self):
        for method in ("POST", "PUT", "DELETE", "OPTIONS", "TRACE"):
            status, headers, body = get(self.address, "/api/map", method=method)
            self.assertEqual(status, 405, method)
            self.assertIn("only GET", json.loads(body)["error"])
        self.assertEqual(get(self.address, "/live")[0], 426)

    def test_bytes_that_are_no_request(self):
        host = self.address.removeprefix("http://").encode()
        long = b"GET / HTTP/1.1\r\nHost: " + host + b"\r\nX: " + b"a" * 20000 + b"\r\n\r\n"
        body = b"POST / HTTP/1.1\r\nHost: " + host + b"\r\nContent-Length: 999999999999\r\n\r\n"
        for request, expected in ((b"\x16\x03\x01\x02\x00" + bytes(range(256)), b"400"), (b"GET\r\n\r\n", b"400"),
                                  (long, b"431"), (body, b"413"),
                                  (b"GET / HTTP/1.1\r\nHost: " + host + b"\r\nContent-Length: -1\r\n\r\n", b"400")):
            answer = ask_raw(self.address, request)
            self.assertIn(expected, answer.split(b"\r\n")[0], request[:40])
        for _ in range(200):
            with connect(self.address) as link:
                link.sendall(os.urandom(200))

    def test_slow_request_is_given_up(self):
        with connect(self.address, 40) as link:
            link.sendall(b"GET / HTTP/1.1\r\nHost: ")
            begin = time.monotonic()
            try:
                self.assertEqual(link.recv(100), b"")
            except ConnectionResetError:
                pass
            self.assertLess(time.monotonic() - begin, 20)

    def test_many_connections_are_bounded(self):
        links = [connect(self.address) for _ in range(120)]
        time.sleep(0.5)
        refused = 0
        for link in links:
            link.setblocking(False)
            try:
                answer = link.recv(4096)
                refused += answer == b"" or b"503" in answer
            except (BlockingIOError, ConnectionResetError) as failure:
                refused += isinstance(failure, ConnectionResetError)
        self.assertGreater(refused, 60)
        for link in links:
            link.close()
        wait_until(lambda: get(self.address, "/")[0] == 200, "an answer after the flood")

    def refused(self, *frames):
        """How the server ends the connection after these messages: (code, reason)."""
        page = WebSocket(self.address)
        self.assertEqual(page.status, 101)
        try:
            for opcode, payload in frames:
                page.send(opcode, payload)
            while True:
                opcode, payload = page.receive()
                if opcode == CLOSE:
                    return struct.unpack(">H", payload[:2])[0], payload[2:].decode()
        except (EOFError, ConnectionResetError, BrokenPipeError):
            return None, "cut"
        finally:
            page.close()

    def test_wrong_messages_end_the_connection(self):
        for frame, reason in (((TEXT, b"{"), "not JSON"), ((BINARY, b"{}"), "binary"), ((TEXT, b'{"kind":"save"}'), "want, ack"),
                              ((TEXT, b"[" * 3000), "not JSON")):
            code, said = self.refused(frame)
            self.assertEqual(code, 1008)
            self.assertIn(reason, said)
        self.assertEqual(self.refused((TEXT, b"a" * 5000))[0], 1009)
        self.assertIn(self.refused((TEXT, b"\xff\xfe"))[0], (1007, None))
        self.assertIn(self.refused((3, b"x"))[0], (1002, None))
        code, said = self.refused(*[(TEXT, b'{"kind":"resync"}')] * 60)
        self.assertEqual(code, 1008)
        self.assertIn("per second", said)
        self.assertEqual(self.refused(*[(PING, b"x")] * 200)[1], "cut")

    def test_random_frames(self):
        for seed in range(60):
            page = WebSocket(self.address)
            if page.status == 101:
                try:
                    page.link.sendall(os.urandom(300))
                except (ConnectionResetError, BrokenPipeError):
                    pass
            page.close()
            time.sleep(0.01)

    def test_number_of_pages_is_bounded(self):
        wait_until(lambda: self.try_page(), "a free place")
        pages = [WebSocket(self.address) for _ in range(5)]
        self.assertEqual([page.status for page in pages], [101] * 5)
        pages.append(WebSocket(self.address))
        self.assertEqual(pages[-1].status, 503)
        for page in pages:
            page.close()
        wait_until(lambda: self.try_page(), "a free place")

    def page_from(self, address):
        """The status that a page gets that connects from this address."""
        with socket.create_connection(("127.0.0.1", int(self.address.rsplit(":", 1)[1])), 30, (address, 0)) as link:
            host = self.address.removeprefix("http://")
            link.sendall(f"GET /live HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                         "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode())
            head = link.recv(4096)
            self.open_links.append(link.dup())
            return int(head.split()[1]), head

    def test_one_address_cannot_take_all_places(self):
        self.open_links = []
        wait_until(lambda: self.try_page(), "a free place")
        self.assertEqual([self.page_from("127.0.0.2")[0] for _ in range(5)], [101] * 4 + [503])
        self.assertIn(b"pages of your address", self.page_from("127.0.0.2")[1])
        self.assertEqual(self.page_from("127.0.0.3")[0], 101, "another address finds a place")
        for link in self.open_links:
            link.close()
        wait_until(lambda: self.try_page(), "a free place")
        wait_until(lambda: self.page_from("127.0.0.2")[0] == 101, "a place for the address again")
        self.open_links[-1].close()
        # Connections that send nothing do not keep others out, either.
        port = int(self.address.rsplit(":", 1)[1])
        links = [socket.create_connection(("127.0.0.1", port), 30, ("127.0.0.2", 0)) for _ in range(60)]
        self.assertEqual(get(self.address, "/")[0], 200)
        for link in links:
            link.close()

    def test_memory_of_answers_that_are_not_read_is_bounded(self):
        (pathlib.Path(self.run_.folder) / "page" / "large.bin").write_bytes(bytes(60 << 20))
        host = self.address.removeprefix("http://")
        links = []
        for _ in range(6):
            links.append(connect(self.address))
            links[-1].sendall(f"GET /large.bin HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
            time.sleep(0.3)
        refused = [link for link in links if link.recv(12, socket.MSG_PEEK) == b"HTTP/1.1 503"]
        self.assertEqual(len(refused), 3)
        self.assertIn(b"read slowly", refused[0].recv(4096))
        self.assertLess(memory_mb(self.run_.processes.running["viewer"].pid), 320)
        self.assertEqual(get(self.address, "/")[0], 200, "small answers are sent all the same")
        for link in links:
            link.close()
        wait_until(lambda: get(self.address, "/large.bin", method="HEAD")[0] == 200, "memory for a large answer")

    def try_page(self):
        page = WebSocket(self.address)
        page.close()
        time.sleep(0.2)
        return page.status == 101


class StartTest(unittest.TestCase):
    def start(self, *arguments):
        return subprocess.run([BIN / "vismap-viewer", *arguments], capture_output=True, text=True, timeout=DEADLINE)

    def test_wrong_address_is_a_usage_error(self):
        with tempfile.TemporaryDirectory() as folder:
            processes = Processes(BIN, folder)
            url = processes.start_hub()
            self.addCleanup(processes.stop_all)
            with socket.socket() as taken:
                taken.bind(("127.0.0.1", 0))
                taken.listen()
                in_use = f"127.0.0.1:{taken.getsockname()[1]}"
                for address, said in (("nonsense", "ADDRESS:PORT"), ("localhost:80", "ADDRESS:PORT"), ("1.2.3.4:99999", "ADDRESS:PORT"),
                                      (in_use, "in use")):
                    done = self.start("--lcm-url", url, "--bind", address)
                    self.assertEqual(done.returncode, 2, done.stderr)
                    self.assertIn(said, done.stderr)

    def test_without_a_page_it_says_how_to_build_it(self):
        with tempfile.TemporaryDirectory() as folder:
            run = Run(pathlib.Path(folder))
            self.addCleanup(run.stop)
            status, _, body = get(run.address, "/")
            self.assertEqual(status, 200)
            self.assertIn(b"scripts/page", body)
            status, _, body = get(run.address, "/api/slice?at=0")
            self.assertEqual(status, 503)
            self.assertIn("nothing is known yet", json.loads(body)["error"])
            begin = time.monotonic()
            status, _, body = get(run.address, "/api/cell?at=0,0,0")
            self.assertEqual(status, 504)
            self.assertLess(time.monotonic() - begin, 15)
            self.assertEqual(run.processes.stop("viewer"), 0)


if __name__ == "__main__":
    BIN = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
