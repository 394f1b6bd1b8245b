#!/usr/bin/env python3
"""Tests scripts/deploy-check on simulated computers: programs, systemctl, timedatectl, nft and ip are scripts."""
import os
import pathlib
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import unittest

CHECK = pathlib.Path(__file__).parents[2] / "scripts" / "deploy-check"
SYSTEMCTL = """case "$1" in
  is-system-running) echo running ;;
  list-unit-files) echo "vismap@hub.service enabled enabled"; echo "vismap@map-server.service enabled enabled" ;;
  is-enabled) echo enabled ;;
  is-active) [ "$2" = vismap@hub.service ] && echo active || { echo failed; exit 3; } ;;
esac
"""


class DeployCheckTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)
        for process in ("hub", "map-server"):
            self.program(f"vismap-{process}", f"echo vismap-{process} 1.2.3")
        self.program("timedatectl", "echo yes")
        self.program("systemctl", SYSTEMCTL.replace('{ echo failed; exit 3; }', "echo active"))
        self.program("nft", "echo 'tcp dport 7700 drop'")
        self.program("ip", "echo multicast 239.255.76.67 dev lo")
        (self.folder / "state").mkdir()

    def program(self, name, text):
        path = self.folder / name
        path.write_text(f"#!/bin/sh\n{text}\n")
        path.chmod(0o755)

    def answer(self, answer, address="127.0.0.1"):
        """Starts a server that sends these bytes to one client; returns its port."""
        server = socket.create_server((address, 0))
        self.addCleanup(server.close)

        def serve():
            client, _ = server.accept()
            client.recv(8)
            client.sendall(answer)
            client.close()
        threading.Thread(target=serve, daemon=True).start()
        return server.getsockname()[1]

    def hub(self):
        return f"tcpq://127.0.0.1:{self.answer(struct.pack('>II', 0x287617FA, 0x0100))}"

    def check(self, url, problems):
        environment = {**os.environ, "PATH": f"{self.folder}:/usr/bin:/bin"}
        done = subprocess.run([sys.executable, "-B", CHECK, "--url", url, "--state", self.folder / "state"],
                              capture_output=True, text=True, env=environment)
        self.assertEqual(done.stderr, "")
        self.assertEqual(done.returncode, problems, done.stdout)
        self.assertEqual(done.stdout.count("PROBLEM"), problems, done.stdout)
        self.assertEqual(done.stdout.count("solution: "), problems, "every problem has a command")
        return done.stdout

    def test_complete_computer(self):
        output = self.check(self.hub(), 0)
        for words in ("vismap-hub: vismap-hub 1.2.3", "the hub answers", "clock: synchronised", "is writable",
                      "vismap@map-server.service: enabled, active"):
            self.assertIn("ok       ", output)
            self.assertIn(words, output)

    def test_missing_program_and_other_version(self):
        (self.folder / "vismap-map-server").unlink()
        self.assertIn("apt-get install", self.check(self.hub(), 1))
        self.program("vismap-map-server", "echo vismap-map-server 1.2.4")
        self.assertIn("different versions: 1.2.3, 1.2.4", self.check(self.hub(), 1))

    def test_missing_shared_library(self):
        self.program("ldd", 'echo "  liboctomap.so.1.9 => not found"')
        output = self.check(self.hub(), 2)
        self.assertIn("needs liboctomap.so.1.9, which is not installed", output)
        self.assertIn("--fix-broken", output)

    def test_no_hub(self):
        with socket.create_server(("127.0.0.1", 0)) as server:
            port = server.getsockname()[1]
        output = self.check(f"tcpq://127.0.0.1:{port}", 1)
        self.assertIn("refused", output)
        self.assertIn("enable --now vismap@hub\n", output)

    def test_program_that_is_not_a_hub(self):
        self.assertIn("not a hub", self.check(f"tcpq://127.0.0.1:{self.answer(b'HTTP/1.1')}", 1))

    def test_host_name_as_address(self):
        output = self.check("tcpq://map-computer:7700", 1)
        self.assertIn("is a host name", output)
        self.assertIn("getent ahostsv4 map-computer", output)

    def test_unknown_url(self):
        self.assertIn("LCM_DEFAULT_URL", self.check("tcp:7700", 1))

    def test_multicast_needs_a_route(self):
        self.program("ip", "echo 'RTNETLINK answers: Network is unreachable'; exit 2")
        output = subprocess.run([sys.executable, "-B", CHECK, "--url", "udpm://239.255.76.67:7667"],
                                capture_output=True, text=True,
                                env={**os.environ, "PATH": f"{self.folder}:/usr/bin:/bin"}).stdout
        self.assertIn("ip route add 224.0.0.0/4 dev lo", output)
        self.assertIn("receive buffer: net.core.rmem_max is ", output)

    def test_clock_that_is_not_synchronised(self):
        self.program("timedatectl", "echo no")
        self.assertIn("chrony", self.check(self.hub(), 1))

    def test_failed_unit(self):
        self.program("systemctl", SYSTEMCTL)
        output = self.check(self.hub(), 1)
        self.assertIn("vismap@map-server.service: enabled, failed", output)
        self.assertIn("journalctl -u vismap@map-server.service", output)

    def test_bus_of_several_computers_needs_a_firewall(self):
        self.program("nft", "echo 'table ip x { }'")
        output = self.check("tcpq://192.0.2.1:7700", 2)  # no computer has this address, so no hub answers
        self.assertIn("there is no rule for port 7700", output)
        self.assertIn("on 192.0.2.1: ", output)


if __name__ == "__main__":
    unittest.main()
