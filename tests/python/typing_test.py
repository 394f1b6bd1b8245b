#!/usr/bin/env python3
"""mypy --strict finds nothing in the package and in the example driver; every public thing has a docstring."""
import inspect
import os
import shutil
import subprocess
import tempfile
import unittest

from support import PACKAGE, ROOT

import vismap


class TypingTest(unittest.TestCase):
    def test_mypy_strict(self):
        if not shutil.which("mypy"):
            self.skipTest("no mypy")
        with tempfile.TemporaryDirectory() as cache:
            done = subprocess.run(["mypy", "--strict", "--cache-dir", cache, PACKAGE / "vismap", ROOT / "procs/examples/camera_driver.py"],
                                  capture_output=True, text=True, env={**os.environ, "MYPYPATH": str(PACKAGE)}, timeout=280)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_docstrings(self):
        missing = []
        for name in vismap.__all__:
            value = getattr(vismap, name)
            if not (inspect.isclass(value) or inspect.isfunction(value)):
                continue
            members = {name: value}
            if inspect.isclass(value):
                members |= {f"{name}.{key}": member for key, member in vars(value).items() if not key.startswith("_") and inspect.isfunction(member)}
            missing += [key for key, member in members.items() if not inspect.getdoc(member)]
        self.assertEqual(missing, [])


if __name__ == "__main__":
    unittest.main()
