"""The map and its mesh have the same hashes whatever SIMD level the kernels are compiled for.

Usage: simd_levels_test.py map_hash_clones map_hash_baseline [map_hash_v3]. Looks into the executables, too: the
kernels of the first must be there in clones, those of the others without, or the test would compare like with like.
"""
import pathlib
import re
import subprocess
import sys

# One kernel of each room, as it stands in a mangled name.
KERNELS = ("FitPlanes", "MarkFolds", "PackNormals", "Project", "Judge", "Fuse", "FlagVoxels", "Cross", "Cut")


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def cloned_kernels(program):
    """The kernels of which the program has code for other SIMD levels than the baseline."""
    symbols = [line for line in run("nm", program).splitlines() if ".arch_x86_64_v" in line]
    return {kernel for kernel in KERNELS if any(re.search(rf"\d{kernel}E?[A-Z]", line) for line in symbols)}


def uses_wide_registers(program, kernel):
    """Whether a kernel's code in the program uses AVX registers."""
    lines = run("objdump", "-d", "--no-show-raw-insn", program).splitlines()
    starts = [i for i, line in enumerate(lines) if re.match(rf"[0-9a-f]+ <.*\d{kernel}E?[A-Z].*>:$", line)]
    code = [line for i in starts for line in lines[i + 1:next((j for j in range(i + 1, len(lines)) if not lines[j]),
                                                             len(lines))]]
    return any("%ymm" in line or "%zmm" in line for line in code)


def level_of(program):
    return pathlib.Path(program).name.removeprefix("map_hash_")


def check_code(program, has_clones):
    """What is wrong with the program's kernels: nothing, or one sentence each."""
    level, cloned = level_of(program), cloned_kernels(program)
    if cloned != (set(KERNELS) if has_clones else set()):
        yield f"{level}: clones of {sorted(cloned)}"
    if level != "clones" and uses_wide_registers(program, "FitPlanes") != (level == "v3"):
        yield f"{level}: FitPlanes is not code of this level"


def main():
    programs = sys.argv[1:]
    # Sanitizers switch the clones off, and so do other compilers and processors.
    has_clones = bool(cloned_kernels(programs[0]))
    problems = []
    hashes = {}
    for program in programs:
        output = run(program)
        machine = re.search(r"machine (\S+)", output).group(1)
        if level_of(program) == "v3" and machine == "baseline":
            continue
        hashes[level_of(program)] = re.findall(r"hash (\S+)", output)
        used = machine if level_of(program) == "clones" and has_clones else level_of(program)
        print(f"{level_of(program)}: runs {used} code, hashes {' '.join(hashes[level_of(program)])}")
        if has_clones:
            problems += check_code(program, level_of(program) == "clones")
    if not has_clones:
        print("this build has no clones (sanitizers, or another compiler): all programs run the same code")
    if len({tuple(found) for found in hashes.values()}) != 1 or not all(hashes.values()):
        problems.append(f"the SIMD levels give different maps: {hashes}")
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
