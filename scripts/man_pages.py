#!/usr/bin/env python3
"""Writes a manual page for every program, from what the program says with --help, by help2man (a Debian package).

Usage: scripts/man_pages.py BIN_FOLDER SCRIPTS_FOLDER OUT_FOLDER VERSION
BIN_FOLDER holds the programs vismap-*, SCRIPTS_FOLDER the scripts that are installed as vismap-launch and
vismap-deploy-check; OUT_FOLDER gets vismap-*.1.gz.
"""
import gzip
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


SCRIPTS = ["launch", "deploy-check"]


def help_of(program, *verb):
    done = subprocess.run([str(program), *verb, "--help"], capture_output=True, text=True, timeout=30)
    if done.returncode != 0 or not done.stdout.strip():
        sys.exit(f"man_pages.py: {program} {' '.join(verb)} --help failed: {done.stderr.strip()}")
    return done.stdout


def summary_of(text):
    """What the program does, as the line NAME of a manual page says it: without a capital letter and a full stop."""
    sentences = [line for line in text.splitlines() if line and not re.match(r"\s|[Uu]sage:", line)]
    summary = sentences[0].strip().rstrip(".")
    return summary[0].lower() + summary[1:]


def verbs_of(text):
    """The subcommands that a help text lists."""
    _, _, listed = text.partition("\nSubcommands:\n")
    return re.findall(r"^  ([a-z][a-z-]*) ", listed, re.MULTILINE)


def escaped(text):
    """Text as roff shows it unchanged."""
    return "\n".join("\\&" + line.replace("\\", "\\e").replace("-", "\\-") for line in text.splitlines())


def sections(program, name, text):
    """The part that help2man includes: one section per subcommand, with the lines of its help that are its own."""
    common = set(text.splitlines())
    parts = []
    for verb in verbs_of(text):
        lines = help_of(program, verb).splitlines()
        own = "\n".join(line for line in lines if line not in common or not line.startswith("  "))
        parts.append(f"[{name} {verb}]\n.nf\n{escaped(own)}\n.fi\n")
    parts.append("[SEE ALSO]\nThe documents in /usr/share/doc/vismap, of which README.md names the others.\n")
    return "\n".join(parts)


def write_page(program, name, out, version):
    text = help_of(program)
    with tempfile.TemporaryDirectory() as folder:
        include = pathlib.Path(folder) / "include"
        include.write_text(sections(program, name, text))
        shown = pathlib.Path(folder) / name  # help2man takes the name of the program from its file
        shown.symlink_to(program.resolve())
        page = subprocess.run(["help2man", "--no-info", "--section=1", f"--name={summary_of(text)}",
                               f"--include={include}", f"--version-string={name} {version}", str(shown)],
                              capture_output=True, text=True, timeout=60)
    if page.returncode != 0:
        sys.exit(f"man_pages.py: help2man failed for {name}: {page.stderr.strip()}")
    with open(out / f"{name}.1.gz", "wb") as file, gzip.GzipFile("", "wb", fileobj=file, mtime=0) as packed:
        packed.write(page.stdout.encode())


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    programs, scripts, out = (pathlib.Path(word) for word in sys.argv[1:4])
    if not shutil.which("help2man"):
        sys.exit("man_pages.py: help2man is missing; install it with: apt-get install help2man")
    out.mkdir(parents=True, exist_ok=True)
    pages = [(program, program.name) for program in sorted(programs.glob("vismap-*"))]
    pages += [(scripts / script, f"vismap-{script}") for script in SCRIPTS]
    for program, name in pages:
        write_page(program, name, out, sys.argv[4])


if __name__ == "__main__":
    main()
