"""Starts processes on a separate bus, for the scripts that measure and test vismap."""
import pathlib
import re
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
BIN = ROOT / "build/release/bin"


class Processes:
    """Running programs, by name. Each can be killed and restarted with the same command."""

    def __init__(self, folder):
        self.folder = folder
        self.commands, self.running, self.kills = {}, {}, {}

    def start(self, name, program, *arguments):
        self.start_command(name, str(BIN / f"vismap-{program}"), *arguments)

    def start_command(self, name, *command):
        self.commands[name] = list(command)
        self.restart(name)

    def restart(self, name):
        with open(self.folder / f"{name}.log", "ab") as log, open(self.folder / f"{name}.out", "ab") as out:
            self.running[name] = subprocess.Popen(self.commands[name], stdout=out, stderr=log)

    def crash(self, name):
        self.running[name].kill()
        self.running[name].wait()
        self.kills[name] = self.kills.get(name, 0) + 1
        self.restart(name)

    def alive(self, name):
        return self.running[name].poll() is None

    def stop(self, name, timeout=60):
        if self.alive(name):
            self.running[name].send_signal(signal.SIGTERM)
        return self.running[name].wait(timeout)

    def stop_all(self):
        for name in reversed(list(self.running)):
            try:
                self.stop(name, 20)
            except subprocess.TimeoutExpired:
                self.running[name].kill()

    def resident_bytes(self, name):
        try:
            text = pathlib.Path(f"/proc/{self.running[name].pid}/status").read_text()
        except OSError:
            return 0
        found = re.search(r"VmRSS:\s+(\d+) kB", text)
        return int(found.group(1)) * 1024 if found else 0


def run(program, *arguments, timeout=600):
    done = subprocess.run([str(BIN / f"vismap-{program}"), *arguments], capture_output=True, text=True, timeout=timeout)
    if done.returncode != 0:
        sys.exit(f"vismap-{program} {' '.join(arguments)} failed:\n{done.stderr}")
    return done.stdout


def start_hub(processes, *options):
    """Starts a hub on a free port, and returns its URL. A restarted hub uses the same port."""
    processes.start("hub", "hub", *options, "--listen", "127.0.0.1:0")
    listening = processes.folder / "hub.out"
    deadline = time.monotonic() + 20
    while b"\n" not in listening.read_bytes():
        if time.monotonic() > deadline:
            sys.exit("vismap-hub did not start within 20 s; see " + str(processes.folder / "hub.log"))
        time.sleep(0.05)
    url = listening.read_text().splitlines()[0]
    processes.commands["hub"][-1] = url.removeprefix("tcpq://")
    return url
