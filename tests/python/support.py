"""What several tests of the Python package use. Importing it makes the package of the source tree importable."""
import pathlib
import re
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "libs" / "python"
sys.path.insert(0, str(PACKAGE))
sys.dont_write_bytecode = True
DEADLINE = 60  # longest wait, which only ends a failed test [s]


def wait_until(condition, what="the condition"):
    end = time.monotonic() + DEADLINE
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"{what} has not come true within {DEADLINE} s")
        time.sleep(0.01)


class Processes:
    """Programs of vismap on a bus of their own."""

    def __init__(self, bin_folder, folder):
        self.bin, self.folder, self.running = pathlib.Path(bin_folder), pathlib.Path(folder), {}

    def start(self, name, *command):
        with open(self.folder / f"{name}.log", "wb") as log, open(self.folder / f"{name}.out", "wb") as out:
            self.running[name] = subprocess.Popen([str(word) for word in command], stdout=out, stderr=log)

    def start_hub(self, listen="127.0.0.1:0"):
        """Starts a hub; returns its URL. Port 0: a free one."""
        self.start("hub", self.bin / "vismap-hub", "--listen", listen)
        out = self.folder / "hub.out"
        wait_until(lambda: b"\n" in out.read_bytes(), "the start of the hub")
        return out.read_text().splitlines()[0]

    def stop(self, name):
        process = self.running.pop(name)
        process.send_signal(signal.SIGTERM)
        return process.wait(timeout=DEADLINE)

    def stop_all(self):
        for name in reversed(list(self.running)):
            if self.running[name].poll() is None:
                self.stop(name)

    def log(self, name):
        return (self.folder / f"{name}.log").read_text(errors="replace")


def python_blocks(markdown):
    """Heading -> the Python text of the first fenced block below it."""
    parts = re.split(r"^## (.*)$", markdown, flags=re.MULTILINE)
    found = {}
    for heading, text in zip(parts[1::2], parts[2::2]):
        block = re.search(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
        if block:
            found[heading] = block.group(1)
    return found
