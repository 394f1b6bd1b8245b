#!/usr/bin/env python3
"""What the documents (*.md) mention exists: links, files, options, config keys, names in the code.

Usage: documents_test.py FOLDER_OF_PROGRAMS   (build/release/bin; options are compared with what --help prints)
"""
import concurrent.futures
import functools
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = None  # from the command line
MOST_README_LINES = 150
# Folders that hold documents; all are installed with the package.
FOLDERS = (".", "config", "libs", "libs/python", "procs", "tests")
# What a path in a document may be relative to, besides the document's own folder.
BASES = ("", "libs", "procs", "tests", "config/deploy")
SOURCE_SUFFIXES = (".h", ".cc", ".md", ".py", ".proto", ".lcm", ".cmake", ".txtpb", ".pmd", ".env", ".nft", ".conf", ".svg")
OUTSIDE = ("/", "out/", "build/", "ethz-asl/")  # not in the repository
PACKAGES = ("vismap-dev",)                      # named like a program, and none
FILE_ENDINGS = ("json", "bt", "closed")          # objects.json is no key of the section objects
UNWANTED = "ALGO" + "RITHM"                     # a document that is not in the repository

LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
SPAN = re.compile(r"(`+)(.+?)\1")
PATH = re.compile(r"[\w.@*-]+(/[\w.@*-]+)+/?")
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z0-9-]*")
COMMAND = re.compile(r"(?<![\w./-])(vismap-[a-z][a-z-]*|scripts/[a-z][a-z_-]*)(?![\w.-])")
OTHER_COMMAND = re.compile(r"\blcm-\w+|\s#\s|\s&\s")
SECTION = re.compile(r"\b([a-z_]+) \{([^}]*)\}")
CAMEL = re.compile(r"[A-Z][a-z0-9]+(?:[A-Z][a-z0-9]*)+")
CONSTANT = re.compile(r"[A-Z]+(?:_[A-Z]+)+")


def documents(root):
    return sorted(path for folder in FOLDERS for path in (root / folder).glob("*.md"))


def without_code(text):
    """The text of a document without fenced blocks and code spans, line by line."""
    lines, fenced = [], False
    for line in text.splitlines():
        if line.lstrip().startswith("```"):
            fenced = not fenced
            line = ""
        lines.append("" if fenced else SPAN.sub("", line))
    return lines


def code(text):
    """(line number, code) of every code span, and of every line of a fenced block."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif fenced:
            yield number, line, True
        else:
            for match in SPAN.finditer(line):
                yield number, match.group(2).strip(), False


def anchors(path):
    """The names under which the headings of a document can be linked to, as GitHub makes them."""
    names, fenced = set(), False
    for line in path.read_text().splitlines():
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced and re.match(r"#+ ", line):
            words = re.sub(r"[^\w\- ]", "", line.lstrip("#").strip().lower())
            names.add(words.replace(" ", "-"))
    return names


def check_links(root, path, text):
    """Relative links lead to documents and pictures, which are installed together, and to headings in them."""
    for number, line in enumerate(without_code(text), 1):
        for target in LINK.findall(line):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = target.partition("#")
            file = (path.parent / name).resolve() if name else path
            if not file.is_file() or not file.is_relative_to(root):
                yield number, f"link to {target}: there is no such file"
            elif file.suffix != ".md" and file.parent != root / ".readme":
                yield number, f"link to {target}: neither a document nor in .readme"
            elif anchor and anchor not in anchors(file):
                yield number, f"link to {target}: there is no such heading"


def exists(root, path, name):
    for base in [path.parent] + [root / base for base in BASES]:
        if "*" in name and list(base.glob(name)):
            return True
        if "*" not in name and (base / name).exists():
            return True
    return False


def check_paths(root, path, text):
    tops = tuple(f"{entry.name}/" for entry in root.iterdir() if entry.is_dir())
    for number, span, fenced in code(text):
        if fenced or not PATH.fullmatch(span) or span.startswith(OUTSIDE):
            continue
        if not span.endswith(SOURCE_SUFFIXES) and not span.startswith(tops) and not span.startswith("../"):
            continue
        if not exists(root, path, span):
            yield number, f"there is no file {span}"


@functools.cache
def help_of(*command):
    done = subprocess.run([*command, "--help"], capture_output=True, text=True, timeout=240)
    if done.returncode != 0:
        raise AssertionError(f"{command} --help: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def program_of(root, name):
    """The file that a name like vismap-map or scripts/demo stands for; None = there is none."""
    if name.startswith("scripts/"):
        return root / name if (root / name).is_file() else None
    for file in (BIN / name, root / "scripts" / name.removeprefix("vismap-")):
        if file.is_file():
            return file
    return None


def subcommands_of(file):
    found = re.search(r"^Subcommands:\n((?:  .*\n)+)", help_of(file), re.MULTILINE)
    return set(re.findall(r"^  ([a-z-]+)", found.group(1), re.MULTILINE)) if found else set()


def ask_all_programs():
    """Fills the cache of help_of, several programs at a time."""
    programs = list(BIN.glob("vismap-*"))
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        list(pool.map(help_of, programs))
        commands = [(file, sub) for file in programs for sub in subcommands_of(file)]
        list(pool.map(lambda command: help_of(*command), commands))


def options_of(root, file, words):
    """All options of a program, of its subcommand if the words begin with one; of a script those in its text."""
    if file.parent == root / "scripts":
        return set(OPTION.findall(file.read_text()))
    options = set(OPTION.findall(help_of(file)))
    if words and words[0] in subcommands_of(file):
        options |= set(OPTION.findall(help_of(file, words[0])))
    return options


def check_command(root, name, rest, fenced):
    """A program's name and what follows it, up to the next command."""
    if name in PACKAGES:
        return
    file = program_of(root, name)
    if file is None:
        yield f"there is no program {name}"
        return
    words = rest.split()
    if fenced and file.parent == BIN and subcommands_of(file):
        if words and re.fullmatch(r"[a-z-]+", words[0]) and words[0] not in subcommands_of(file):
            yield f"{name} has no subcommand {words[0]}"
    for option in OPTION.findall(rest):
        if option not in options_of(root, file, words):
            yield f"{name} has no option {option}"


def check_commands(root, path, text):
    for number, line, fenced in code(text):
        line = re.sub(r'"[^"]*"', '""', line)  # what is quoted may be the command of another program
        matches = list(COMMAND.finditer(line))
        for match, following in zip(matches, matches[1:] + [None]):
            rest = line[match.end():following.start() if following else len(line)]
            for problem in check_command(root, match.group(1), OTHER_COMMAND.split(rest)[0], fenced):
                yield number, problem
        if not fenced and OPTION.match(line):  # an option alone: of any program
            programs = list(BIN.glob("vismap-*")) + [file for file in (root / "scripts").iterdir() if file.is_file()]
            option = OPTION.match(line).group()
            if not any(option in options_of(root, file, [sub]) for file in programs
                       for sub in (["" ] if file.parent != BIN else ["", *subcommands_of(file)])):
                yield number, f"no program has the option {option}"


def config_keys(root):
    """Section -> its keys, as options.proto has them."""
    text = re.sub(r"//.*", "", (root / "libs/config/options.proto").read_text())
    messages = {name: set(re.findall(r"(?:optional|repeated) [\w.]+ (\w+) =", body))
                for name, body in re.findall(r"message (\w+) \{(.*?)\n\}", text, re.DOTALL)}
    sections = re.findall(r"optional (\w+) (\w+) =", re.search(r"message Config \{(.*?)\n\}", text, re.DOTALL).group(1))
    return {section: messages[name] for name, section in sections}


def check_keys(root, path, text):
    keys = config_keys(root)
    every_key = set().union(*keys.values())
    for number, span, fenced in code(text):
        for section, key in re.findall(r"(?<![\w/.])([a-z_]+)\.([a-z_A-Z0-9]+)\b", span):
            if not fenced and section in keys and key not in keys[section] and key not in FILE_ENDINGS:
                yield number, f"config section {section} has no key {key}"
        for section, body in SECTION.findall(span):
            if section not in keys:
                yield number, f"there is no config section {section}"
                continue
            for key in re.findall(r"(?<![\"/])\b([a-z_A-Z0-9]+):\s", body):
                if key not in keys[section]:
                    yield number, f"config section {section} has no key {key}"
        alone = re.fullmatch(r"([a-z_]+): \S+", span)
        if alone and not fenced and alone.group(1) not in every_key:
            yield number, f"no config section has a key {alone.group(1)}"


@functools.cache
def default_config():
    """(section, key) -> value, as a program prints them."""
    done = subprocess.run([BIN / "vismap-map-server", "--print-config"], capture_output=True, text=True, timeout=240,
                          check=True)
    values, section = {}, None
    for line in done.stdout.splitlines():
        if line.endswith("{"):
            section = line.split()[0]
        elif ":" in line:
            key, value = line.split(":", 1)
            values[section, key.strip()] = value.strip()
    return values


def stated_values(line):
    """(section, key, value) of `section.key` (value), and of table rows | `section.key` ... | value |."""
    key = r"`([a-z_]+)\.([a-z_A-Z0-9]+)`"
    yield from re.findall(key + r" \(([-\d.e]+|true|false|[A-Z_]+)(?=[,;)])", line)
    cells = line.split("|")
    if len(cells) > 3:
        keys, values = re.findall(key, cells[1]), cells[2].split(",")
        if len(keys) == len(values):
            yield from ((*name, value.strip()) for name, value in zip(keys, values))


def check_values(root, path, text):
    for number, line in enumerate(text.splitlines(), 1):
        for section, key, value in stated_values(line):
            default = default_config().get((section, key))
            if default is not None and default != value and not equal_numbers(default, value):
                yield number, f"{section}.{key} is {default} by default, not {value}"


def equal_numbers(a, b):
    try:
        return float(a) == float(b)
    except ValueError:
        return False


@functools.cache
def words_of_code(root):
    words = set()
    for folder, suffixes in (("libs", (".h", ".cc", ".proto", ".py")), ("procs", (".h", ".cc")), ("lcmtypes", (".lcm",)),
                             ("tests", (".cc",)), ("config", (".env",))):
        for file in (root / folder).rglob("*"):
            if file.suffix in suffixes:
                words.update(re.findall(r"\w+", file.read_text(errors="replace")))
    return words


def check_names(root, path, text):
    for number, span, fenced in code(text):
        if fenced:
            continue
        for name in re.findall(r"\w+", span):
            if (CAMEL.fullmatch(name) or CONSTANT.fullmatch(name)) and name not in words_of_code(root):
                yield number, f"nothing in the code is called {name}"


def check_text(root, path, text):
    for number, line in enumerate(text.splitlines(), 1):
        if UNWANTED in line:
            yield number, f"refers to {UNWANTED}"
    if path == root / "README.md" and len(text.splitlines()) > MOST_README_LINES:
        yield MOST_README_LINES + 1, f"has {len(text.splitlines())} lines; expected at most {MOST_README_LINES}"


def check_references(root):
    """Comments that name a section of a document, as in "libs/METHOD.md, Free space"."""
    for folder in ("libs", "procs", "tests"):
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in (".h", ".cc"):
                continue
            where = file.relative_to(root)
            if UNWANTED in file.read_text(errors="replace"):
                yield f"{where}: refers to {UNWANTED}"
            text = re.sub(r"\s*\n\s*//[/<]*\s*", " ", file.read_text(errors="replace"))
            for name, section in re.findall(r"\b((?:libs|procs|config|tests)/[A-Z]+\.md)(?:, ([A-Z][a-z]*(?: [a-z]+)*))?", text):
                if not (root / name).is_file():
                    yield f"{where}: there is no {name}"
                elif section and not any(section.lower().replace(" ", "-").startswith(anchor) for anchor in anchors(root / name)):
                    yield f"{where}: {name} has no section {section}"


def problems_of(root):
    checks = (check_links, check_paths, check_commands, check_keys, check_values, check_names, check_text)
    for path in documents(root):
        text = path.read_text()
        for check in checks:
            for number, problem in check(root, path, text):
                yield f"{path.relative_to(root)}:{number}: {problem}"
    yield from check_references(root)


def setUpModule():
    ask_all_programs()


class DocumentsTest(unittest.TestCase):
    maxDiff = None

    def test_what_they_mention_exists(self):
        self.assertEqual(list(problems_of(ROOT)), [])

    def test_there_is_one_for_each_folder(self):
        found = {str(path.relative_to(ROOT)) for path in documents(ROOT)}
        self.assertLessEqual({"README.md", "config/README.md", "libs/README.md", "libs/METHOD.md", "procs/README.md",
                              "tests/README.md"}, found)


    def test_rooms_are_those_of_check_layers(self):
        sys.path.insert(0, str(ROOT / "scripts"))
        import check_layers
        rows = re.findall(r"^\| `(\w+)` \|[^|]*\|([^|]*)\|[^|]*\|$", (ROOT / "libs/README.md").read_text(), re.MULTILINE)
        self.assertEqual({room: re.findall(r"\w+", below) for room, below in rows}, check_layers.LIBS)

    def test_every_folder_of_procs_is_described(self):
        text = (ROOT / "procs/README.md").read_text()
        for folder in (ROOT / "procs").iterdir():
            program = "vismap-" + folder.name.removesuffix("_tool").replace("_", "-")
            if folder.is_dir():
                self.assertTrue(f"| `{folder.name}` |" in text or f"| `{program}` |" in text, folder.name)


class CheckerTest(unittest.TestCase):
    """The checks find what they should in a small made-up tree, and nothing else."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()
        self.write("libs/config/options.proto", "message Config {\n  optional Grid grid = 1;\n}\n\n"
                   "message Grid {\n  optional double voxel_size_m = 1;  // optional int32 size = 2\n}\n")
        self.write("libs/map/block.h", "struct MapBlock {};\n")
        self.write("scripts/demo", "case --dataset) ;;\n")
        self.write("libs/README.md", "# The rooms\n\n## What's `here`, and not\n")

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def problems(self, text):
        self.write("README.md", text)
        return list(problems_of(self.root))

    def expect(self, text, *words):
        problems = self.problems(text)
        self.assertEqual(len(problems), 1, problems)
        for word in ("README.md:",) + words:
            self.assertIn(word, problems[0])

    def test_links(self):
        self.expect("[a](libs/METHOD.md)", "libs/METHOD.md")
        self.expect("\n[a](libs/README.md#nowhere)", "README.md:2:", "heading")
        self.expect("[a](libs/map/block.h)", "neither a document")
        self.expect("![a](.readme/a.png)", "no such file")
        self.assertEqual(self.problems("[a](libs/README.md#whats-here-and-not) [b](https://example.org)\n```\n[c](d)\n```"), [])

    def test_paths(self):
        self.expect("`map/voxels.h`", "map/voxels.h")
        self.expect("`libs/maps`", "libs/maps")
        self.assertEqual(self.problems("`map/block.h` `libs/map` `libs/*/*.h` `out/a.h` `/etc/a.env` `objects/*.ply`"), [])

    def test_options(self):
        self.expect("`scripts/demo --data PATH`", "scripts/demo", "--data")
        self.expect("```\nscripts/demos\n```", "scripts/demos")
        self.expect("`vismap-mapp`", "vismap-mapp")
        self.expect("`vismap-map-server --recorder`", "--recorder")
        self.expect("```\nvismap-map infos MAP   # --what\n```", "infos")
        self.expect("```\nvismap-hub & vismap-map info MAP --jsonn\n```", "vismap-map", "--jsonn")
        self.expect("`--no-such-option 3`", "--no-such-option")
        self.assertEqual(self.problems("`--dataset`, `--frames`\n```\nscripts/demo --dataset A # --b\nvismap-map info MAP --json\n"
                                       "lcm-logger --what & vismap-hub --listen A\n```"), [])

    def test_config_keys(self):
        self.expect("`grid.size`", "grid", "size")
        self.expect("`grids { voxel_size_m: 1 }`", "grids")
        self.expect("```\ngrid { voxel_size: 1 }\n```", "voxel_size")
        self.expect("`voxel_size: 1`", "voxel_size")
        self.assertEqual(self.problems("`grid.voxel_size_m` (0.01), `grid { voxel_size_m: 0.01 }`"), [])

    def test_default_values(self):
        self.write("libs/config/options.proto", (ROOT / "libs/config/options.proto").read_text())
        self.expect("`grid.voxel_size_m` (0.02)", "grid.voxel_size_m", "0.01", "0.02")
        self.expect("| `grid.voxel_size_m`, `grid.truncation_voxels` | 0.010, 5 | why |", "truncation_voxels", "5")
        self.expect("`surface.method` (WINDOW_COVARIANCE)", "surface.method", "WINDOW_COVARIANCE")
        self.assertEqual(self.problems("`grid.voxel_size_m` (0.01; why), `grid.truncation_voxels` (all)\n"
                                       "| `grid.voxel_size_m` | 0.01 | why |"), [])

    def test_names(self):
        self.expect("`MapBlocks`", "MapBlocks")
        self.expect("`NO_SUCH_CHANNEL`", "NO_SUCH_CHANNEL")
        self.assertEqual(self.problems("`MapBlock`, OtherWord"), [])

    def test_references_in_comments(self):
        self.write("libs/map/block.h", "/// See libs/README.md. And libs/README.md, The\n/// rooms.\nint a;\n")
        self.assertEqual(self.problems(""), [])
        self.write("libs/map/block.h", "/// See libs/README.md, Halls.\n")
        self.assertEqual(self.problems(""), ["libs/map/block.h: libs/README.md has no section Halls"])
        self.write("libs/map/block.h", "/// See libs/WAY.md.\n")
        self.assertEqual(self.problems(""), ["libs/map/block.h: there is no libs/WAY.md"])
        self.write("libs/map/block.h", f"/// See {UNWANTED} 1.\n")
        self.assertEqual(self.problems(""), [f"libs/map/block.h: refers to {UNWANTED}"])

    def test_length_and_what_is_not_here(self):
        self.assertEqual(self.problems("a\n" * MOST_README_LINES), [])
        self.expect("a\n" * (MOST_README_LINES + 1), "151 lines")
        self.expect(f"see {UNWANTED} 1.2", UNWANTED)


if __name__ == "__main__":
    BIN = pathlib.Path(sys.argv.pop()).resolve()
    unittest.main()
