#!/usr/bin/env python3
"""Checks that one name stands for one type: no two types of libs/ and procs/ have the same full name.

Two definitions of one name in one namespace are undefined behaviour as soon as one program links both, and no
compiler or linker reports it. The names in anonymous namespaces of two .cc files may be equal; but a type in a header
shares its name with no other type, and neither does one outside an anonymous namespace. Prints one line per name that
has several definitions (file:line of each) and exits 1 when there is one. Usage: check_names.py [REPOSITORY]
"""
import collections
import pathlib
import re
import sys

FOLDERS = ("libs", "procs")
ANONYMOUS = ""

# What a definition at namespace scope is made of; everything else is passed over.
NOISE = re.compile(
    r'//[^\n]*|/\*.*?\*/'  # comments
    r'|R"(?P<tag>[^(\s]*)\(.*?\)(?P=tag)"'  # raw strings
    r'|"(?:\\.|[^"\\\n])*"'  # strings
    r"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'"  # characters, but not the ' of 1'000
    r'|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*',  # preprocessor lines
    re.DOTALL | re.MULTILINE)
SCOPE = re.compile(
    r'\b(?:inline\s+)?namespace\b\s*(?P<namespace>[\w:]*)\s*\{'
    r'|\b(?:struct|class|enum(?:\s+(?:class|struct))?|union)\s+(?:alignas\([^)]*\)\s*)?(?:\[\[[^\]]*\]\]\s*)?'
    r'(?P<type>\w+(?:::\w+)*)\s*(?:final\s*)?(?::(?!:)[^;{}()]*)?\{'
    r'|(?P<open>\{)|(?P<close>\})')


def without_noise(text):
    """The text with comments, strings and preprocessor lines blanked; line numbers stay."""
    return NOISE.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)


def definitions(text):
    """Yields (namespaces, name, line) of every type that is defined at namespace scope."""
    text = without_noise(text)
    scopes = []  # per open brace the names of its namespace, or None for any other brace
    for match in SCOPE.finditer(text):
        if match.group("close"):
            if scopes:
                scopes.pop()
        elif match.group("namespace") is not None:
            scopes.append(match.group("namespace").split("::"))
        else:
            name = match.group("type")
            if name and None not in scopes:
                yield sum(scopes, []), name, text.count("\n", 0, match.start("type")) + 1
            scopes.append(None)


def collect(root):
    """Full name -> [(file:line, whether another .cc file may use the name again)]."""
    found = collections.defaultdict(list)
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in (".h", ".cc"):
                continue
            for namespaces, name, line in definitions(path.read_text(errors="replace")):
                full = "::".join([part for part in namespaces if part != ANONYMOUS] + [name])
                own = path.suffix == ".cc" and ANONYMOUS in namespaces
                found[full].append((f"{path.relative_to(root).as_posix()}:{line}", own))
    return found


def check(root):
    for name, places in sorted(collect(root).items()):
        if len(places) > 1 and not all(own for _, own in places):
            yield f"{name} is defined {len(places)} times: " + ", ".join(place for place, _ in places)


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[1])
    if not (root / "libs").is_dir():
        print(f"{root}: expected a repository with a folder libs/", file=sys.stderr)
        return 2
    problems = list(check(root))
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
