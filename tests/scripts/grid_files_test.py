#!/usr/bin/env python3
"""An independent reader takes the 2-D grid of the built-in room as nav2's map server does, and the room is in it.

Usage: grid_files_test.py FOLDER_OF_PROGRAMS   (build/release/bin)
"""
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

BIN = None  # from the command line
FREE, OCCUPIED, UNKNOWN = 0, 100, -1


def run(program, *arguments):
    return subprocess.run([BIN / f"vismap-{program}", *map(str, arguments)], capture_output=True, text=True, timeout=240)


def read_yaml(path):
    """The keys of a flat YAML file: numbers, words, lists of numbers."""
    keys = {}
    for line in path.read_text().splitlines():
        name, value = line.split(": ", 1)
        if value.startswith("["):
            keys[name] = [float(number) for number in value.strip("[]").split(",")]
        else:
            keys[name] = float(value) if re.fullmatch(r"-?[\d.e-]+", value) else value
    return keys


def read_pgm(path):
    """(width, height, rows of grey values) of a binary PGM of 8 bits."""
    data = path.read_bytes()
    header = re.match(rb"P5\s+(\d+)\s+(\d+)\s+255\s", data)
    width, height = int(header.group(1)), int(header.group(2))
    pixels = data[header.end():]
    assert len(pixels) == width * height, f"{len(pixels)} pixels"
    return width, height, [pixels[width * row:width * (row + 1)] for row in range(height)]


class Costmap:
    """The map as nav2 has it after LoadMapFromFile, mode trinary."""

    def __init__(self, yaml):
        self.keys = read_yaml(yaml)
        assert self.keys["mode"] == "trinary" and len(self.keys["origin"]) == 3
        self.width, self.height, rows = read_pgm(yaml.parent / self.keys["image"])
        self.rows = [[self.state(grey) for grey in row] for row in reversed(rows)]  # the image's last row has the smallest y

    def state(self, grey):
        shade = grey / 255
        occupied = shade if self.keys["negate"] else 1 - shade
        if occupied > self.keys["occupied_thresh"]:
            return OCCUPIED
        return FREE if occupied < self.keys["free_thresh"] else UNKNOWN

    def at(self, x, y):
        column = math.floor((x - self.keys["origin"][0]) / self.keys["resolution"])
        row = math.floor((y - self.keys["origin"][1]) / self.keys["resolution"])
        return self.rows[row][column]

    def cells(self):
        for row, states in enumerate(self.rows):
            for column, state in enumerate(states):
                yield (self.keys["origin"][0] + (column + 0.5) * self.keys["resolution"],
                       self.keys["origin"][1] + (row + 0.5) * self.keys["resolution"], state)


class GridFilesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        path = pathlib.Path(cls.folder.name)
        (path / "coarse.txtpb").write_text("grid { voxel_size_m: 0.02 }\n")
        mapped = run("offline-mapper", "--dataset", "synthetic:room?frames=40&width=320", "--config", path / "coarse.txtpb",
                     "--out", path / "room")
        assert mapped.returncode == 0, mapped.stderr
        cls.map = path / "room" / "map.vismap"
        cls.exported = run("map", "export", cls.map, "--grid", path / "hall")
        assert cls.exported.returncode == 0, cls.exported.stderr
        cls.grid = Costmap(path / "hall.yaml")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_numbers(self):
        self.assertEqual(self.grid.keys["resolution"], 0.06)  # three voxels, the smallest of at least 5 cm
        self.assertEqual(self.grid.keys["origin"][2], 0)
        free = sum(state == FREE for _, _, state in self.grid.cells()) * 0.06 ** 2
        self.assertGreater(free, 8)  # of a floor of 20 m^2 with furniture on it
        self.assertIn(f"{free:.1f} m^2 free", self.exported.stdout)

    def test_room_is_in_it(self):
        self.assertEqual(self.grid.at(-0.9, -1.58), OCCUPIED)     # the couch
        self.assertEqual(self.grid.at(0, 1.4), FREE)              # the floor before the television
        for x, y, state in self.grid.cells():
            if abs(x) > 2.6 or abs(y) > 2.1:                      # behind the walls
                self.assertNotEqual(state, FREE, (x, y))
        walls = [state for x, y, state in self.grid.cells() if 2.46 < abs(x) < 2.54 and abs(y) < 1.9]
        self.assertEqual(walls.count(FREE), 0)
        self.assertGreater(walls.count(OCCUPIED), 0.9 * len(walls))

    def test_what_cannot_be_made_is_told(self):
        config = pathlib.Path(self.folder.name) / "sideways.txtpb"
        config.write_text("objects { up_W: [0, -1, 0] }\n")
        sideways = run("map", "export", self.map, "--grid", self.folder.name, "--config", config)
        self.assertEqual(sideways.returncode, 1)
        self.assertIn("z axis points upward, but (0, -1, 0) does (objects.up_W)", sideways.stderr)
        missing = run("map", "export", self.map, "--grid", self.folder.name + "/missing/map")
        self.assertEqual(missing.returncode, 1)
        self.assertIn("missing/map.pgm", missing.stderr)
        self.assertEqual(run("map", "export", self.map).returncode, 2)


if __name__ == "__main__":
    BIN = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
