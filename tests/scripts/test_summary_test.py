"""What scripts/test says at its end about a run of ctest."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = pathlib.Path(__file__).parents[2] / "scripts" / "test_summary.py"

PASSED = '<testcase name="map.Passes" status="run"><system-out>[ PASSED ]</system-out></testcase>'
FAILED = ('<testcase name="map.Fails" status="fail"><failure message=""/>'
          '<system-out>Expected: 1\nActual: 2</system-out></testcase>')
SKIPPED = ('<testcase name="map.Skips{}" status="notrun"><skipped message="SKIP_REGULAR_EXPRESSION"/><system-out>'
           '[ RUN      ] Map.Skips\n/a/map_test.cc:33: Skipped\nVISMAP_DATA is not set\n\n'
           '[  SKIPPED ] Map.Skips (0 ms)</system-out></testcase>')
NOT_BUILT = '<testcase name="map.IsNotBuilt" status="notrun"><skipped message="no executable"/><system-out/></testcase>'


def summarize(*cases):
    """Exit code and output of the program for a file with these tests."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "tests.xml"
        path.write_text("<testsuite>" + "".join(cases) + "</testsuite>")
        run = subprocess.run([sys.executable, "-B", PROGRAM, path], capture_output=True, text=True, timeout=60)
    return run.returncode, run.stdout


class TestSummary(unittest.TestCase):
    def test_counts_what_passed(self):
        self.assertEqual(summarize(PASSED, PASSED), (0, "2 passed, 0 failed, 0 skipped\n"))

    def test_shows_the_output_of_a_failed_test(self):
        code, text = summarize(PASSED, FAILED)
        self.assertEqual(code, 1)
        self.assertIn("map.Fails failed; its output:\nExpected: 1\nActual: 2\n", text)
        self.assertEqual(text.splitlines()[-1], "1 passed, 1 failed, 0 skipped")

    def test_groups_skipped_tests_by_reason(self):
        code, text = summarize(PASSED, SKIPPED.format(1), SKIPPED.format(2))
        self.assertEqual(code, 0)
        self.assertIn("    2  VISMAP_DATA is not set\n", text)
        self.assertEqual(text.splitlines()[-1], "1 passed, 0 failed, 2 skipped")

    def test_a_test_that_is_not_built_has_failed(self):
        code, text = summarize(PASSED, NOT_BUILT)
        self.assertEqual(code, 1)
        self.assertIn("This test failed: map.IsNotBuilt\n", text)

    def test_no_tests_at_all_is_a_failure(self):
        self.assertEqual(summarize()[0], 1)


if __name__ == "__main__":
    unittest.main()
