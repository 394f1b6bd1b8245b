#!/usr/bin/env python3
"""Tests config/deploy/firewall between two simulated computers (network namespaces). Needs root, ip and nft."""
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

RULES = pathlib.Path(__file__).parents[2] / "config/deploy/firewall/vismap.nft"
ROBOT, OTHER = f"vismap-r{os.getpid()}", f"vismap-o{os.getpid()}"
TRUSTED, STRANGER = "10.77.0.2", "10.99.0.2"

# Prints "tcp ADDRESS" for each connection and "udp ADDRESS" for each packet on the two ports.
LISTENER = """
import selectors, socket, sys
tcp = socket.create_server(("0.0.0.0", 7700))
udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
udp.bind(("0.0.0.0", 7667))
both = selectors.DefaultSelector()
both.register(tcp, 1)
both.register(udp, 1)
print("listening", flush=True)
while True:
    for key, _ in both.select():
        if key.fileobj is tcp:
            print("tcp", tcp.accept()[1][0], flush=True)
        else:
            print("udp", udp.recvfrom(9)[1][0], flush=True)
"""
# Arguments: PROTOCOL FROM TO. The exit code is 0 if the data was sent.
SENDER = """
import socket, sys
kind, port = {"tcp": (socket.SOCK_STREAM, 7700), "udp": (socket.SOCK_DGRAM, 7667)}[sys.argv[1]]
sender = socket.socket(socket.AF_INET, kind)
sender.settimeout(1)
sender.bind((sys.argv[2], 0))
sender.connect((sys.argv[3], port))
sender.send(b"x")
"""


def ip(*words):
    return subprocess.run(["ip", *words], capture_output=True, text=True)


class FirewallTest(unittest.TestCase):
    def setUp(self):
        os.environ["PATH"] += ":/usr/sbin:/sbin"
        if not shutil.which("ip") or not shutil.which("nft"):
            self.skipTest("no ip or no nft")
        for space in (ROBOT, OTHER):
            made = ip("netns", "add", space)
            if made.returncode != 0:
                self.skipTest(f"no network namespace can be made: {made.stderr.strip()}")
            self.addCleanup(ip, "netns", "delete", space)
            ip("-n", space, "link", "set", "lo", "up")
        for words in (("link", "add", "v0", "netns", ROBOT, "type", "veth", "peer", "name", "v0", "netns", OTHER),
                      ("-n", ROBOT, "address", "add", "10.77.0.1/24", "dev", "v0"),
                      ("-n", ROBOT, "address", "add", "10.99.0.1/24", "dev", "v0"),
                      ("-n", OTHER, "address", "add", f"{TRUSTED}/24", "dev", "v0"),
                      ("-n", OTHER, "address", "add", f"{STRANGER}/24", "dev", "v0"),
                      ("-n", ROBOT, "link", "set", "v0", "up"), ("-n", OTHER, "link", "set", "v0", "up")):
            done = ip(*words)
            self.assertEqual(done.returncode, 0, f"ip {' '.join(words)}: {done.stderr}")
        self.listener = self.inside(ROBOT, LISTENER, stdout=subprocess.PIPE, text=True)
        self.addCleanup(self.listener.stdout.close)
        self.addCleanup(self.listener.wait)
        self.addCleanup(self.listener.kill)
        self.assertEqual(self.listener.stdout.readline(), "listening\n")

    def inside(self, space, program, *arguments, **options):
        return subprocess.Popen(["ip", "netns", "exec", space, sys.executable, "-c", program, *arguments], **options)

    def send(self, space, *arguments):
        return self.inside(space, SENDER, *arguments, stderr=subprocess.DEVNULL).wait(timeout=60) == 0

    def test_only_computers_of_the_robot_can_connect(self):
        self.assertTrue(self.send(OTHER, "tcp", STRANGER, "10.99.0.1"), "without the rules, any computer can connect")
        self.assertTrue(self.send(OTHER, "udp", TRUSTED, "10.77.0.1"))
        self.assertEqual({self.listener.stdout.readline(), self.listener.stdout.readline()},
                         {f"tcp {STRANGER}\n", f"udp {TRUSTED}\n"})
        for _ in range(2):  # loading the rules again is no error and does not duplicate them
            loaded = subprocess.run(["ip", "netns", "exec", ROBOT, "nft", "-f", RULES], capture_output=True, text=True)
            if "not supported" in loaded.stderr:
                self.skipTest(f"this kernel has no nftables: {loaded.stderr}")
            self.assertEqual((loaded.returncode, loaded.stderr), (0, ""))
        self.assertFalse(self.send(OTHER, "tcp", STRANGER, "10.99.0.1"))
        self.assertFalse(self.send(OTHER, "tcp", STRANGER, "10.77.0.1"))
        self.send(OTHER, "udp", TRUSTED, "10.77.0.1")
        self.send(OTHER, "udp", STRANGER, "10.99.0.1")
        self.assertTrue(self.send(OTHER, "tcp", TRUSTED, "10.77.0.1"))
        self.assertEqual(self.listener.stdout.readline(), f"tcp {TRUSTED}\n", "nothing else arrived before")
        self.assertTrue(self.send(ROBOT, "udp", "127.0.0.1", "127.0.0.1"))
        self.assertEqual(self.listener.stdout.readline(), "udp 127.0.0.1\n", "nothing else arrived before")
        self.assertTrue(self.send(ROBOT, "tcp", "127.0.0.1", "127.0.0.1"))
        self.assertEqual(self.listener.stdout.readline(), "tcp 127.0.0.1\n")


if __name__ == "__main__":
    unittest.main()
