#!/usr/bin/env python3
"""Two clients that no bus should have, for scripts/soak: one reads slowly, the other attacks the hub and the processes.

Usage: scripts/hostile_clients.py slow|hostile TCPQ_URL [--rate 50] [--seed 1]
slow: subscribes to all channels and reads 2 kB per second; connects again when it is disconnected.
hostile: RATE times per second something that is wrong, chosen at random: garbage, parts of messages, patterns that explode,
connections that read nothing, damaged copies of the messages of others, and requests that are not allowed. It sends no
request that may change the map. Ends with SIGTERM, and prints how often it did what.
"""
import argparse
import collections
import random
import select
import signal
import socket
import struct
import sys
import time

CLIENT, VERSION = 0x287617fb, 0x0100  # greeting of LCM's tcpq protocol
PUBLISH, SUBSCRIBE = 1, 2
PATTERNS = ["(?=" * 40 + "a" + ")*" * 40, "(((a{100}){100}){100})", "[" * 300, "(a|b|ab)*" * 50, ".*" * 1000]
REQUESTS = [("save", "../../evil"), ("save", "/etc/passwd"), ("save", "a\nb"), ("save", "x" * 5000), ("load", "/dev/zero"),
            ("load", "nothing"), ("mesh", ""), ("objects", ""), ("octree", ""), ("snapshot", ""), ("statistics", ""),
            ("\x1b[2J", "")]


def connect(url):
    host, port = url.removeprefix("tcpq://").rsplit(":", 1)
    connection = socket.create_connection((host, int(port)), timeout=5)
    connection.settimeout(2)
    return connection


def hello():
    return struct.pack(">II", CLIENT, VERSION)


def subscribe(pattern):
    name = pattern.encode()
    return struct.pack(">II", SUBSCRIBE, len(name)) + name


def publish(channel, data):
    name = channel.encode()
    return struct.pack(">II", PUBLISH, len(name)) + name + struct.pack(">I", len(data)) + data


def text(value):
    encoded = value.encode() + b"\0"
    return struct.pack(">I", len(encoded)) + encoded


class Overheard:
    """The newest message of each channel, as far as one slow connection hears them."""

    def __init__(self, url):
        self.url, self.newest, self.data, self.connection = url, {}, b"", None

    def listen(self):
        try:
            if self.connection is None:
                self.connection, self.data = connect(self.url), b""
                self.connection.sendall(hello() + subscribe(".*"))
                self.connection.recv(8, socket.MSG_WAITALL)
            while select.select([self.connection], [], [], 0)[0]:
                more = self.connection.recv(1 << 20)
                if not more:
                    raise ConnectionError
                self.data += more
                self.parse()
        except OSError:
            self.connection = None

    def parse(self):
        at = 0
        while at + 8 <= len(self.data):
            _, name = struct.unpack_from(">II", self.data, at)
            if at + 12 + name > len(self.data):
                break
            size, = struct.unpack_from(">I", self.data, at + 8 + name)
            if at + 12 + name + size > len(self.data):
                break
            channel = self.data[at + 8:at + 8 + name].decode()
            self.newest[channel] = self.data[at + 12 + name:at + 12 + name + size]
            at += 12 + name + size
        self.data = self.data[at:]


class Hostile:
    def __init__(self, url, seed):
        self.url, self.random = url, random.Random(seed)
        self.overheard = Overheard(url)
        self.open = collections.deque(maxlen=60)  # connections that stay open; the oldest is closed
        self.sender, self.done = None, collections.Counter()

    def act(self):
        self.overheard.listen()
        action = self.random.choice([self.garbage, self.part, self.pattern, self.deaf, self.damaged, self.damaged,
                                     self.damaged, self.request, self.empty])
        self.done[action.__name__] += 1
        try:
            action()
        except OSError:
            self.sender = None

    def new(self, data):
        connection = connect(self.url)
        connection.sendall(data)
        self.open.append(connection)

    def send(self, channel, data):
        if self.sender is None:
            self.sender = connect(self.url)
            self.sender.sendall(hello())
        self.sender.sendall(publish(channel, data))

    def garbage(self):
        self.new(self.random.randbytes(self.random.randrange(200)))

    def part(self):
        self.new(hello() + struct.pack(">II", PUBLISH, 10) + b"RGBD_FRAME" + struct.pack(">I", 60 << 20) + bytes(1000))

    def pattern(self):
        self.new(hello() + subscribe(self.random.choice(PATTERNS)))

    def deaf(self):
        self.new(hello() + subscribe(".*"))

    def damaged(self):
        if not self.overheard.newest:
            return
        channel = self.random.choice(sorted(self.overheard.newest))
        data = bytearray(self.overheard.newest[channel])
        if channel == "MAP_REQUEST" or len(data) <= 60:
            return
        for _ in range(self.random.randrange(1, 9)):
            # Not in the head of messages with a checksum: a frame with another time would be another valid frame.
            at = self.random.randrange(60) if channel == "STATUS" else self.random.randrange(60, len(data))
            data[at] ^= self.random.randrange(1, 256)
        if self.random.random() < 0.3:
            del data[self.random.randrange(len(data)):]
        self.send(channel, bytes(data))

    def request(self):
        known = self.overheard.newest.get("MAP_REQUEST")  # for the fingerprint of the type
        if known is None:
            return
        verb, path = self.random.choice(REQUESTS)
        now = int(time.time() * 1e6)
        self.send("MAP_REQUEST", known[:8] + struct.pack(">qq", now, self.done["request"]) + text("hostile")
                  + struct.pack(">q", self.random.getrandbits(62)) + text("") + text(verb) + text("") + text(path)
                  + struct.pack(">?7db", False, *[0.0] * 7, -1))

    def empty(self):
        for i in range(200):
            self.send(f"NOTHING_{i}", b"")


def slow(url, stopped):
    while not stopped:
        try:
            with connect(url) as connection:
                connection.sendall(hello() + subscribe(".*"))
                while not stopped and connection.recv(512):
                    time.sleep(0.25)
        except OSError:
            time.sleep(0.5)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["slow", "hostile"])
    parser.add_argument("url")
    parser.add_argument("--rate", type=float, default=50)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    stopped = []
    signal.signal(signal.SIGTERM, lambda *_: stopped.append(True))
    if arguments.what == "slow":
        slow(arguments.url, stopped)
        return
    client = Hostile(arguments.url, arguments.seed)
    while not stopped:
        client.act()
        time.sleep(1 / arguments.rate)
    print(", ".join(f"{name} {count}" for name, count in sorted(client.done.items())), flush=True)


if __name__ == "__main__":
    sys.exit(main())
