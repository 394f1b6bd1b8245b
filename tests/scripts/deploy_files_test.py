#!/usr/bin/env python3
"""Tests the files of config/deploy: systemd and nft accept them, and vismap accepts the arguments in them.

Usage: deploy_files_test.py FOLDER_OF_THE_PROGRAMS
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

DEPLOY = pathlib.Path(__file__).parents[2] / "config" / "deploy"
PROGRAMS = None  # folder, from the command line


def environment_file(path):
    """The assignments of a file, as read by systemd's EnvironmentFile=."""
    lines = [line.strip() for line in path.read_text().splitlines()]
    return dict(line.split("=", 1) for line in lines if line and not line.startswith("#"))


class UnitsTest(unittest.TestCase):
    def setUp(self):
        if not shutil.which("systemd-analyze"):
            self.skipTest("no systemd-analyze")
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.root = pathlib.Path(self.temporary.name)
        self.units = self.root / "lib/systemd/system"
        self.units.mkdir(parents=True)
        for target in pathlib.Path("/lib/systemd/system").glob("*.target"):
            shutil.copy(target, self.units, follow_symlinks=False)
        for unit in DEPLOY.glob("systemd/*"):
            shutil.copy(unit, self.units)
        program = self.root / "usr/bin/vismap-hub"
        program.parent.mkdir(parents=True)
        program.write_text("#!/bin/sh\n")
        program.chmod(0o755)

    def analyze(self, *arguments):
        return subprocess.run(["systemd-analyze", *arguments], capture_output=True, text=True)

    def verify(self):
        return self.analyze("verify", "--man=no", "--recursive-errors=no", f"--root={self.root}",
                            "vismap@hub.service", "vismap.target")

    def test_systemd_accepts_them(self):
        done = self.verify()
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_wrong_value_is_found(self):
        unit = self.units / "vismap@.service"
        unit.write_text(unit.read_text().replace("Restart=always", "Restart=allways"))
        self.assertIn("allways", self.verify().stderr)

    def test_processes_are_sandboxed(self):
        instance = self.root / "vismap@hub.service"
        shutil.copy(self.units / "vismap@.service", instance)
        done = self.analyze("security", "--offline=true", "--threshold=20", str(instance))
        self.assertEqual(done.returncode, 0, done.stdout[-2000:] + done.stderr)


class ArgumentsTest(unittest.TestCase):
    def test_programs_accept_them(self):
        files = [path for path in DEPLOY.rglob("*.env") if path.name != "vismap.env"]
        self.assertGreaterEqual(len(files), 7)
        for path in files:
            arguments = environment_file(path)["VISMAP_ARGS"].replace("/etc/vismap/", f"{DEPLOY}/etc/")
            words = arguments.replace("/usr/share/vismap/config/", f"{DEPLOY.parent}/").split()
            done = subprocess.run([PROGRAMS / f"vismap-{path.stem}", *words, "--print-config"], capture_output=True,
                                  text=True)
            self.assertEqual(done.returncode, 0, f"{path}: {done.stderr}")

    def test_map_server_accepts_the_configs(self):
        files = [*DEPLOY.rglob("*.txtpb"), *DEPLOY.with_name("launch").glob("*.txtpb")]
        self.assertGreaterEqual(len(files), 2)
        for path in files:
            done = subprocess.run([PROGRAMS / "vismap-map-server", "--config", path, "--print-config"],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_urls_are_hubs_with_numeric_addresses(self):
        files = list(DEPLOY.rglob("vismap.env"))
        self.assertEqual(len(files), 3)
        for path in files:
            url = environment_file(path)["LCM_DEFAULT_URL"]
            done = subprocess.run([PROGRAMS / "vismap-depth-segmenter", "--lcm-url", url, "--connect-timeout", "0"],
                                  capture_output=True, text=True)
            self.assertNotEqual(done.returncode, 2, f"{path}: {done.stderr}")

    def test_hub_listens_at_the_url_of_the_others(self):
        for folder in ("etc", "three-computers/map"):
            listen = environment_file(DEPLOY / folder / "hub.env")["VISMAP_ARGS"].split()[1]
            self.assertEqual(environment_file(DEPLOY / folder / "vismap.env")["LCM_DEFAULT_URL"], f"tcpq://{listen}")


class FirewallTest(unittest.TestCase):
    def test_nft_accepts_it(self):
        if not shutil.which("nft", path="/usr/sbin:/usr/bin"):
            self.skipTest("no nft")
        done = subprocess.run(["nft", "-c", "-f", DEPLOY / "firewall/vismap.nft"], capture_output=True, text=True,
                              env={"PATH": "/usr/sbin:/usr/bin"})
        if "Operation not permitted" in done.stderr:
            self.skipTest("nft checks against the kernel, as root only")
        self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    PROGRAMS = pathlib.Path(sys.argv.pop())
    unittest.main()
