#!/usr/bin/env python3
"""scripts/check_names.py finds types of the same name in small made-up trees, and nothing else."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

CHECKER = pathlib.Path(__file__).parents[2] / "scripts" / "check_names.py"


def in_vismap(text):
    return f"#pragma once\nnamespace vismap {{\n{text}\n}}  // namespace vismap\n"


def hidden(text):
    return in_vismap(f"namespace {{\n{text}\n}}  // namespace")


class CheckNamesTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        self.write("libs/map/view.h", in_vismap("struct View {\n  int x = 0;\n};"))

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

    def expect(self, text, path="libs/meshing/view.h", name="vismap::View", other="libs/map/view.h:3"):
        """The two files define one name twice, which is said in one line with both places."""
        self.write(path, text)
        lines = self.run_checker()
        self.assertEqual(len(lines), 1, lines)
        for word in (name + " ", other, path):
            self.assertIn(word, lines[0])
        (self.root / path).unlink()

    def expect_fine(self, text, path="libs/meshing/view.h"):
        self.write(path, text)
        self.assertEqual(self.run_checker(), [])
        (self.root / path).unlink()

    def test_every_kind_of_type_counts(self):
        for kind in ("struct View {", "class View {", "class View final : public std::vector<int> {",
                     "enum View {", "enum class View : int {", "struct alignas(64) View {",
                     "template <typename T>\nclass View\n{", "union View {"):
            self.expect(in_vismap(kind + " };"))

    def test_the_line_is_that_of_the_definition(self):
        self.expect(in_vismap("\n/* one\ntwo */\nstruct View { };"), name="vismap::View",
                    other="libs/meshing/view.h:6")

    def test_processes_and_sources_count(self):
        self.expect(in_vismap("struct View { };"), path="procs/viewer/main.cc")

    def test_a_hidden_type_must_not_have_the_name_of_a_type_in_a_header(self):
        self.expect(hidden("struct View { };"), path="libs/meshing/mesh.cc")
        self.expect(hidden("struct View { };"), path="libs/meshing/mesh.h")

    def test_hidden_types_of_two_sources_may_share_a_name(self):
        self.write("libs/map/a.cc", hidden("struct Own { };"))
        self.expect_fine(hidden("struct Own { };"), path="libs/map/b.cc")
        self.expect(hidden("struct Own { };"), path="libs/map/b.h", name="vismap::Own", other="libs/map/a.cc:4")

    def test_nested_types_are_named_with_what_holds_them(self):
        self.expect_fine(in_vismap("struct Map {\n  struct View { };\n  enum class Kind { kA };\n};"))
        self.expect_fine(in_vismap("inline int F() {\n  struct View { int x; };\n  return 0;\n}"))
        self.expect_fine(in_vismap("struct Map::View { };"))

    def test_other_namespaces_may_use_the_name(self):
        self.expect_fine("namespace vismap::mapfile {\nstruct View { };\n}\n")
        self.expect("namespace vismap {\ninline namespace {\n}\nclass View { };\n}\n")
        self.expect_fine("namespace other {\nstruct View { };\n}\n")

    def test_mentions_are_no_definitions(self):
        self.expect_fine(in_vismap("struct View;\nclass View& Get(struct View* view);\nenum class Kind : int;"))
        self.expect_fine(in_vismap("// struct View { };\n/* class View { }; */\n#define VIEW struct View { };"))
        self.expect_fine(in_vismap('const char* kText = "struct View { };";\n'
                                   'const char* kRaw = R"x(struct View { ")" };)x";\n'
                                   "constexpr int kMany = 1'000'000;\nconstexpr char kBrace = '{';"))
        self.expect_fine("template <>\nstruct std::hash<vismap::View> {\n};\n")

    def test_no_repository_is_a_usage_error(self):
        done = subprocess.run([sys.executable, CHECKER, self.root / "libs"], capture_output=True)
        self.assertEqual(done.returncode, 2)


if __name__ == "__main__":
    unittest.main()
