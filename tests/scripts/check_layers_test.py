#!/usr/bin/env python3
"""Tests scripts/check_layers.py on small test trees."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

CHECKER = pathlib.Path(__file__).parents[2] / "scripts" / "check_layers.py"


class CheckLayersTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        for path in ("libs/base/result.h", "libs/geometry/image.h", "libs/map/block.h",
                     "libs/mapping/integrate.h", "libs/meshing/mesh.h", "procs/wire/channels.h",
                     "procs/viewer/page.h", "tests/support/analytic_map.h"):
            self.write(path, "#pragma once\n")

    def tearDown(self):
        self.folder.cleanup()

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def run_checker(self):
        done = subprocess.run([sys.executable, CHECKER, self.root], capture_output=True, text=True)
        self.assertEqual(done.stderr, "")
        self.assertEqual(done.returncode, 1 if done.stdout else 0)
        return done.stdout.splitlines()

    def expect(self, path, text, *words):
        """Expects exactly one violation, in this file, whose line contains all the words."""
        self.write(path, text)
        lines = self.run_checker()
        self.assertEqual(len(lines), 1, lines)
        for word in (path,) + words:
            self.assertIn(word, lines[0])
        (self.root / path).unlink()

    def expect_fine(self, path, text):
        self.write(path, text)
        self.assertEqual(self.run_checker(), [])
        (self.root / path).unlink()

    def test_arrows_up_and_across_are_found_with_their_line(self):
        self.expect("libs/geometry/a.h", '#include <vector>\n\n#include "map/block.h"\n',
                    "a.h:3:", "libs/geometry", "map/block.h")
        self.expect("libs/freespace/a.cc", '#include "meshing/mesh.h"\n', "meshing/mesh.h")
        self.expect("libs/mapping/a.cc", '#  include "wire/channels.h"\n', "wire/channels.h")

    def test_arrows_down_are_fine_however_far(self):
        self.expect_fine("libs/meshing/a.cc", '#include "base/result.h"\n#include "meshing/mesh.h"\n')
        self.expect_fine("procs/viewer/main.cc", '#include "meshing/mesh.h"\n#include "viewer/page.h"\n')
        self.expect_fine("libs/base/a.cc", '// #include "meshing/mesh.h"\n#include <vector>\n')

    def test_processes_do_not_include_each_other(self):
        self.expect("procs/map_tool/main.cc", '#include "viewer/page.h"\n', "viewer/page.h")

    def test_tests_see_only_what_their_room_sees(self):
        self.expect("tests/geometry/a_test.cc", '#include "map/block.h"\n', "map/block.h")
        self.expect_fine("tests/map/a_test.cc", '#include "geometry/image.h"\n')
        self.expect_fine("tests/process/a_test.cc", '#include "viewer/page.h"\n')

    def test_support_headers_do_not_smuggle(self):
        self.write("tests/support/analytic_map.h", '#include "map/block.h"\n')
        self.expect_fine("tests/meshing/a_test.cc", '#include "support/analytic_map.h"\n')
        self.expect("tests/geometry/a_test.cc", '#include "support/analytic_map.h"\n',
                    "by way of", "map/block.h")

    def test_outside_libraries_have_their_place(self):
        self.expect("libs/mapping/a.cc", "#include <lcm/lcm-cpp.hpp>\n", "LCM")
        self.expect("libs/mapping/a.cc", "#include <vismap/octree_t.hpp>\n", "LCM")
        self.expect("libs/meshing/a.cc", "#include <octomap/octomap.h>\n", "OctoMap")
        self.expect("libs/freespace/a.cc", "#include <octomap/octomap.h>\n", "OctoMap")
        self.expect("libs/meshing/a.h", "#include <octomap/MCTables.h>\n", "marching")
        self.expect("libs/datasets/a.cc", '#include "map.pb.h"\n', "protobuf")
        self.expect("libs/segmentation/a.h", "#include <opencv2/core.hpp>\n", "OpenCV")
        self.expect("libs/map/a.cc", "#include <tbb/parallel_for.h>\n", "parallel.h")
        self.expect_fine("libs/meshing/a.cc", "#include <octomap/MCTables.h>\n")
        self.expect_fine("tests/freespace/a_test.cc", "#include <octomap/octomap.h>\n")
        self.expect_fine("libs/segmentation/a.cc", "#include <opencv2/core.hpp>\n")
        self.expect_fine("procs/viewer/main.cc", "#include <lcm/lcm-cpp.hpp>\n")

    def test_includes_name_a_room_and_a_file_that_exists(self):
        self.expect("libs/geometry/a.cc", '#include "image.h"\n', "image.h")
        self.expect("libs/geometry/a.cc", '#include "base/none.h"\n', "base/none.h")

    def test_unknown_rooms_are_found(self):
        self.expect("libs/attic/a.cc", "\n", "attic")

    def test_cmake_arrows_are_those_of_the_table(self):
        self.expect("libs/geometry/CMakeLists.txt", "vismap_room(geometry DEPS base map LINK a)\n",
                    "geometry -> map")
        self.expect_fine("libs/geometry/CMakeLists.txt",
                         "vismap_room(geometry DEPS base LINK Eigen3::Eigen)\n")

    def test_no_repository_is_a_usage_error(self):
        done = subprocess.run([sys.executable, CHECKER, self.root / "libs"], capture_output=True)
        self.assertEqual(done.returncode, 2)


if __name__ == "__main__":
    unittest.main()
