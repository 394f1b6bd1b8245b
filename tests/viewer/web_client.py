"""A small client for HTTP and WebSocket, and a model of what the page makes of the messages. Standard library only."""
import base64
import json
import os
import socket
import struct
import time
import urllib.parse

TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10


def connect(address, timeout=30):
    url = urllib.parse.urlparse(address)
    return socket.create_connection((url.hostname, url.port), timeout)


def ask_raw(address, request, timeout=30):
    """Sends bytes; returns all bytes that come until the server closes."""
    with connect(address, timeout) as link:
        link.sendall(request)
        answer = b""
        try:
            while part := link.recv(65536):
                answer += part
        except ConnectionResetError:
            pass
        return answer


def get(address, path, headers=(), method="GET", host=None):
    """(status, headers with lower-case names, body) of a request."""
    host = host or urllib.parse.urlparse(address).netloc
    lines = [f"{method} {path} HTTP/1.1", f"Host: {host}", "Connection: close", *headers, "", ""]
    answer = ask_raw(address, "\r\n".join(lines).encode())
    head, _, body = answer.partition(b"\r\n\r\n")
    first, *rest = head.decode("latin-1").split("\r\n")
    names = {line.partition(":")[0].lower(): line.partition(":")[2].strip() for line in rest}
    return int(first.split()[1]), names, body


class WebSocket:
    def __init__(self, address, path="/live", headers=(), receive_buffer=None):
        host = urllib.parse.urlparse(address).netloc
        key = base64.b64encode(os.urandom(16)).decode()
        self.link = connect(address)
        if receive_buffer:
            self.link.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        lines = [f"GET {path} HTTP/1.1", f"Host: {host}", "Upgrade: websocket", "Connection: Upgrade",
                 "Sec-WebSocket-Version: 13", f"Sec-WebSocket-Key: {key}", *headers, "", ""]
        self.link.sendall("\r\n".join(lines).encode())
        self.buffer = b""
        while b"\r\n\r\n" not in self.buffer:
            part = self.link.recv(4096)
            if not part:
                break
            self.buffer += part
        head, _, self.buffer = self.buffer.partition(b"\r\n\r\n")
        self.status = int(head.split()[1])

    def close(self):
        self.link.close()

    def send(self, opcode, payload, final=True):
        mask = os.urandom(4)
        size = len(payload)
        head = bytes([opcode | (0x80 if final else 0)])
        if size < 126:
            head += bytes([0x80 | size])
        elif size < 65536:
            head += bytes([0x80 | 126]) + struct.pack(">H", size)
        else:
            head += bytes([0x80 | 127]) + struct.pack(">Q", size)
        self.link.sendall(head + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(payload)))

    def send_json(self, value):
        self.send(TEXT, json.dumps(value).encode())

    def _take(self, count):
        while len(self.buffer) < count:
            part = self.link.recv(1 << 20)
            if not part:
                raise EOFError
            self.buffer += part
        taken, self.buffer = self.buffer[:count], self.buffer[count:]
        return taken

    def receive(self):
        """(opcode, payload) of the next message; answers pings. Raises EOFError when the connection ends."""
        while True:
            first, second = self._take(2)
            size = second & 127
            if size == 126:
                size = struct.unpack(">H", self._take(2))[0]
            elif size == 127:
                size = struct.unpack(">Q", self._take(8))[0]
            payload = self._take(size)
            if first & 15 == PING:
                self.send(PONG, payload)
            else:
                return first & 15, payload


class Page:
    """What a page knows: it acknowledges, and keeps blocks, the newest text of each kind, paths and pictures."""

    def __init__(self, address, want=None):
        self.socket = WebSocket(address)
        assert self.socket.status == 101, self.socket.status
        self.blocks, self.texts, self.paths, self.pictures, self.notices = {}, {}, {}, {}, []
        self.bytes = self.acknowledged = self.resets = 0
        self.closed = None
        if want:
            self.socket.send_json({"kind": "want", **want})

    def step(self):
        opcode, payload = self.socket.receive()
        if opcode == TEXT:
            self._take_text(json.loads(payload))
        elif opcode == BINARY:
            self._take_binary(payload)
        elif opcode == CLOSE:
            self.closed = payload[2:].decode()
            raise EOFError

    def run_until(self, condition, seconds=60):
        end = time.monotonic() + seconds
        while not condition(self):
            if time.monotonic() > end:
                raise AssertionError(f"not within {seconds} s; the newest texts: {self.texts.get('map')}")
            self.step()

    def _take_text(self, text):
        self.texts[text["kind"]] = text
        if text["kind"] == "notice":
            self.notices.append(text["text"])
        if text.get("reset"):
            self.blocks.clear()
            self.resets += 1
        if text["kind"] == "map" and text["waiting"] == 0:
            assert (text["digest"], text["blocks"]) == (self.digest(), len(self.blocks)), "a page that lacks nothing is wrong"
        if text["kind"] == "trajectory":
            path = self.paths.setdefault(text["camera_id"], [])
            path[text["from"]:] = text["positions"]

    def _take_binary(self, payload):
        self.bytes += len(payload)
        if self.bytes - self.acknowledged > 1 << 18:
            self.acknowledged = self.bytes
            self.socket.send_json({"kind": "ack", "bytes": self.bytes})
        if payload[0] == 3:
            at = 8
            for _ in range(struct.unpack_from("<I", payload, 4)[0]):
                size = struct.unpack_from("<I", payload, at)[0]
                self._take_block(payload[at + 4:at + 4 + size])
                at += 4 + size
            assert at == len(payload)
        elif payload[0] == 1:
            self._take_block(payload)
        elif payload[0] == 2:
            size = struct.unpack_from("<I", payload, 4)[0]
            self.pictures[payload[1]] = (json.loads(payload[8:8 + size]), payload[8 + size:])

    def _take_block(self, payload):
        flags, i, j, k, edge, revision, vertices, triangles, digest = struct.unpack_from("<xxHiiifIIIQ", payload)
        size = 48 + 24 * vertices + (2 * vertices + 3) // 4 * 4
        size += ((12 if flags & 1 else 6) * triangles + 3) // 4 * 4
        assert edge > 0, "a block without its size"
        assert len(payload) == (size if vertices else 48), (len(payload), size)
        if vertices:
            self.blocks[i, j, k] = (digest, triangles)
        else:
            self.blocks.pop((i, j, k), None)

    def digest(self):
        return f"{sum(digest for digest, _ in self.blocks.values()) % 2**64:016x}"

    def is_level(self):
        """Whether it has all that the newest text about the map says."""
        state = self.texts.get("map")
        return (state is not None and state["waiting"] == 0 and state["digest"] == self.digest()
                and state["blocks"] == len(self.blocks))

    def triangles(self):
        return sum(triangles for _, triangles in self.blocks.values())
