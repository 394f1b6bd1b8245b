#!/usr/bin/env python3
"""Checks the arrows between the rooms of the house: who may include what.

Reads the #include lines of libs/, procs/ and tests/ and the DEPS of every vismap_room(). Prints one line
per violation (file:line: what) and exits 1 when there is one. Usage: check_layers.py [REPOSITORY]
"""
import pathlib
import re
import sys

# Room -> rooms that it may include directly; with each comes what that one may include.
LIBS = {
    "base": [],
    "geometry": ["base"],
    "segmentation": ["geometry"],
    "plausibility": ["segmentation"],
    "codecs": ["segmentation"],
    "rectify": ["codecs"],
    "map": ["geometry"],
    "association": ["segmentation", "map"],
    "mapping": ["association"],
    "meshing": ["map"],
    "objects": ["meshing"],
    "render": ["objects"],
    "freespace": ["map", "codecs"],
    "navigation": ["freespace"],
    "mapfile": ["map"],
    "exports": ["render", "freespace", "mapfile"],
    "pictures": ["exports", "navigation"],
    "datasets": ["codecs"],
    "detection": ["datasets"],
    "simulation": ["datasets", "rectify"],
    "session": ["mapping", "mapfile"],
    "evaluation": ["exports", "datasets", "rectify"],
    "config": ["simulation", "session", "exports", "navigation", "detection"],
}
# Adapters that several processes share. All other folders of procs/ are processes: they may include any
# room of libs/ and these, but not each other.
PROCS = {
    "wire": ["rectify", "exports", "navigation"],
    "runtime": ["wire"],
    "client": ["runtime", "navigation"],
    "requests": ["runtime", "navigation"],
    "foreign": ["wire", "config"],
    "mcap": ["wire"],
    "logs": ["wire", "simulation", "plausibility", "foreign"],
    "queueing": ["runtime"],
    "hub": ["queueing", "settings"],
    "bridge": ["queueing", "settings"],
    "doctor": ["runtime", "settings"],
    "settings": ["runtime", "config"],
    "sequence_mapper": ["runtime", "logs"],
}
# Tests of one room see what the room sees; these folders of tests/ see everything.
# Tests of rooms that read a map may also include the makers, since they need maps to read.
READERS = {"meshing", "objects", "exports", "freespace", "navigation", "mapfile", "render", "pictures"}
OPEN_TESTS = {"process", "client", "quality", "oracle", "support", "bench", "fuzz", "hostile"}

# Outside libraries that have a place: pattern of the include, folders that may, only in .cc files?, why.
OUTSIDE = [
    (r"(lcm/|lcm_guard)", ("procs/", "tests/"), False, "no LCM in libs/"),
    (r"vismap/(\w+|foreign/\w+/\w+)\.hpp", ("procs/", "tests/"), False, "no LCM in libs/"),
    (r"octomap/(MCTables|octomap_types)\.h", ("libs/meshing/", "tests/meshing/", "tests/support/naive/"),
     True,
     "only meshing uses the marching cubes tables"),
    (r"(octomap|dynamicEDT3D|fcl)/", ("tests/freespace/", "tests/exports/", "tests/pictures/", "tests/navigation/", "tests/process/", "tests/client/", "tests/bench/",
                                      "tests/quality/", "tests/support/planner_", "procs/examples/"),
     False, "only tests and examples use OctoMap and what builds on it"),
    (r"ompl/", ("procs/examples/",), False, "only examples plan"),
    (r"(google/protobuf/|.*\.pb\.h)", ("libs/mapfile/", "libs/config/", "procs/mcap/", "tests/mapfile/", "tests/config/", "tests/mcap/"),
     True, "protobuf stays in mapfile, config and mcap"),
    (r"opencv2/dnn", ("libs/detection/",), True, "only detection runs networks"),
    (r"opencv2/", ("libs/", "procs/", "tests/"), True, "OpenCV only in .cc files"),
    (r"nlohmann/json_fwd", ("libs/", "procs/", "tests/"), False, ""),
    (r"nlohmann/(?!json_fwd)", ("libs/", "procs/", "tests/"), True, "JSON only in .cc files"),
    (r"(zstd|zlib|xxhash|turbojpeg)\.h", ("libs/", "procs/", "tests/"), True,
     "compression and hashing only in .cc files"),
    (r"spdlog/", ("procs/runtime/", "tests/runtime/"), True, "libraries do not log"),
    (r"CLI/", ("procs/runtime/",), True, "programs use runtime/command_line.h"),
    (r"boost/", ("procs/viewer/",), True, "only the viewer's web server uses Boost"),
    (r"tbb/", ("libs/base/", "tests/base/"), False, "threads come from base/parallel.h"),
]

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
ROOM = re.compile(r"vismap_room\(\s*(\w+)([^)]*)\)")


def closure(rooms, start):
    """All rooms that `start` may include, itself among them."""
    seen = set()
    todo = [start]
    while todo:
        room = todo.pop()
        if room not in seen:
            seen.add(room)
            todo += rooms[room]
    return seen


def allowed_rooms(folder, room):
    """Rooms that files of libs/ROOM, procs/ROOM or tests/ROOM may include; None = any, of any name."""
    rooms = {**LIBS, **PROCS}
    if folder == "tests":
        if room in OPEN_TESTS:
            return None
        below = closure(rooms, room) if room in rooms else set(rooms)
        if room in READERS:
            below |= closure(rooms, "mapping")
        return below | {room, "support"}
    if room in rooms:
        return closure(rooms, room)
    return set(rooms) | {room} if folder == "procs" else set()


def includes(path):
    for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
        match = INCLUDE.match(line)
        if match:
            yield number, match.group(1) == '"', match.group(2)


def check_outside(relative, target):
    for pattern, folders, only_cc, why in OUTSIDE:
        if re.match(pattern, target):
            if not relative.startswith(folders):
                return why
            return why if only_cc and relative.startswith("libs/") and not relative.endswith(".cc") else None
    return None


def check_inside(root, relative, target, allowed):
    """A quoted include: names a room and a file of it, and the room is allowed."""
    if any(re.match(pattern, target) for pattern, _, _, _ in OUTSIDE):
        return None
    parts = target.split("/")
    if relative.startswith("tests/") and len(parts) == 1 and (root / relative).with_name(target).is_file():
        return None  # a helper beside the test
    if len(parts) < 2 or not any((root / top / target).is_file() for top in ("libs", "procs", "tests")):
        return f'"{target}" is not the path of a file below libs/, procs/ or tests/'
    if allowed is not None and parts[0] not in allowed:
        folder, room = relative.split("/")[:2]
        return f'{folder}/{room} may not include "{target}"'
    return None


def check_file(root, path, relative, allowed, seen=()):
    """Problems of one file. Headers of tests/support count as part of the test that includes them."""
    for number, quoted, target in includes(path):
        outside = check_outside(relative, target)
        if outside:
            yield f"{relative}:{number}: {target}: {outside}"
        if not quoted or outside:
            continue
        problem = check_inside(root, relative, target, allowed)
        if problem:
            yield f"{relative}:{number}: {problem}"
        elif allowed is not None and target.startswith("support/") and target not in seen:
            for nested in check_support(root, target, allowed, seen + (target,)):
                yield f"{relative}:{number}: by way of {nested}"


def check_support(root, target, allowed, seen):
    relative = f"tests/{target}"
    for number, quoted, nested in includes(root / relative):
        if not quoted:
            continue
        if nested.split("/")[0] not in allowed:
            yield f'{relative}:{number}: "{nested}"'
        elif nested.startswith("support/") and nested not in seen:
            yield from check_support(root, nested, allowed, seen + (nested,))


def check_cmake(path, relative):
    """DEPS in CMake are arrows of the table, too."""
    for match in ROOM.finditer(path.read_text()):
        room, rest = match.group(1), match.group(2)
        deps = re.search(r"\bDEPS\b([\w\s]*?)(?=\b(?:LINK|PRIVATE_LINK)\b|$)", rest)
        rooms = {**LIBS, **PROCS}
        if room not in rooms:
            yield f"{relative}: room {room} is not in the table of scripts/check_layers.py"
            continue
        for dep in deps.group(1).split() if deps else []:
            if dep not in ("lcmtypes", "foreign_types") and dep not in closure(rooms, room):
                yield f"{relative}: {room} -> {dep} is not an arrow of the table"


def check(root):
    problems = []
    for folder in ("libs", "procs", "tests"):
        for path in sorted((root / folder).rglob("*")):
            relative = path.relative_to(root).as_posix()
            parts = relative.split("/")
            if path.name == "CMakeLists.txt" and len(parts) > 2:
                problems += check_cmake(path, relative)
            if path.suffix not in (".h", ".cc") or len(parts) < 3:
                continue
            if folder == "libs" and parts[1] not in LIBS:
                problems.append(f"{relative}: room {parts[1]} is not in the table of scripts/check_layers.py")
                continue
            problems += check_file(root, path, relative, allowed_rooms(folder, parts[1]))
    return problems


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[1])
    if not (root / "libs").is_dir():
        print(f"{root}: expected a repository with a folder libs/", file=sys.stderr)
        return 2
    problems = check(root)
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
