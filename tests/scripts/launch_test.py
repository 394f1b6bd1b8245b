#!/usr/bin/env python3
"""Tests scripts/launch with small test programs: starting, restarting, stopping, and errors in the file."""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

REPOSITORY = pathlib.Path(__file__).parents[2]
LAUNCH = REPOSITORY / "scripts" / "launch"
DEADLINE = 60  # longest wait, which only ends a failed test [s]

HUB = """#!/bin/sh
echo tcpq://127.0.0.1:4242
trap 'echo hub >>stops; exit 0' TERM
while :; do sleep 0.05; done
"""
# worker NAME [ignore]: writes its environment to files, then waits until it is stopped.
WORKER = """#!/bin/sh
echo "$LCM_DEFAULT_URL $EXTRA" >"$1.started"
if [ "$2" = ignore ]; then trap '' TERM; else trap 'echo '"$1"' >>stops; exit 0' TERM; fi
echo $$ >"$1.pid"
while :; do sleep 0.05; done
"""


class LaunchTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.program("vismap-hub", HUB)
        self.program("worker", WORKER)
        self.launched = None

    def tearDown(self):
        if self.launched and self.launched.poll() is None:
            self.launched.kill()
            self.launched.wait()
        if self.launched:
            self.launched.stdout.close()
        self.temporary.cleanup()

    def program(self, name, text):
        (self.folder / name).write_text(text)
        (self.folder / name).chmod(0o755)

    def launch(self, text, *arguments):
        (self.folder / "a.pmd").write_text(text)
        self.launched = subprocess.Popen(
            [sys.executable, "-B", LAUNCH, "a.pmd", "--bin", ".", "--out", "out", *arguments], cwd=self.folder,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def finish(self, code):
        output = self.launched.communicate(timeout=DEADLINE)[0]
        self.assertEqual(self.launched.returncode, code, output)
        return output

    def wait_for(self, condition):
        end = time.monotonic() + DEADLINE
        while not condition():
            self.assertLess(time.monotonic(), end, "waited too long")
            time.sleep(0.01)

    def wait_for_file(self, name):
        self.wait_for(lambda: (self.folder / name).exists() and (self.folder / name).read_text().endswith("\n"))
        return (self.folder / name).read_text()

    def wait_for_line(self, word):
        """Waits for an output line with this word and returns it; fails after DEADLINE."""
        return next(line for line in self.launched.stdout if word in line)

    def stops(self):
        return (self.folder / "stops").read_text().split()

    def gone(self, name):
        status = pathlib.Path(f"/proc/{int((self.folder / name).read_text())}/stat")
        return not status.exists() or status.read_text().rsplit(")", 1)[1].split()[0] == "Z"

    def test_starts_the_hub_first_and_stops_in_reverse_order(self):
        self.launch('cmd "a" { exec = "${VISMAP_BIN}/worker a"; }\n'
                    'group "g" { cmd "b" { exec = "EXTRA=${MORE:-less} ./worker b"; } }\n'
                    'cmd "hub" { exec = "${VISMAP_BIN}/vismap-hub --listen 127.0.0.1:0"; }\n')
        self.wait_for_file("a.pid")
        self.assertEqual(self.wait_for_file("b.started"), "tcpq://127.0.0.1:4242 less\n")
        self.wait_for_file("b.pid")
        self.launched.send_signal(signal.SIGTERM)
        output = self.finish(0)
        self.assertEqual(self.stops(), ["b", "a", "hub"])
        self.assertLess(output.index("hub: running"), output.index("a: running"))

    def test_kills_a_process_that_does_not_stop(self):
        self.launch('cmd "a" { exec = "./worker a ignore"; stop_time_allowed = "0.2"; }')
        self.wait_for_file("a.pid")
        self.launched.send_signal(signal.SIGINT)
        self.assertIn("a: killed", self.finish(0))
        self.assertTrue(self.gone("a.pid"))

    def test_second_signal_kills_immediately(self):
        self.launch('cmd "a" { exec = "./worker a ignore"; stop_time_allowed = "3600"; }')
        self.wait_for_file("a.pid")
        self.launched.send_signal(signal.SIGINT)
        self.wait_for_line("stopping")
        self.launched.send_signal(signal.SIGINT)
        self.finish(0)
        self.assertTrue(self.gone("a.pid"))

    def test_killed_launcher_leaves_no_process_behind(self):
        self.launch('cmd "a" { exec = "./worker a"; }')
        self.wait_for_file("a.pid")
        self.launched.kill()
        self.wait_for(lambda: self.gone("a.pid"))

    def test_restarts_a_process_that_ends(self):
        self.program("once", "#!/bin/sh\n[ -e been ] && exec ./worker again\ntouch been\necho oops\nexit 1\n")
        self.launch('cmd "a" { exec = "./once"; auto_respawn = "true"; }')
        self.wait_for_file("again.pid")
        self.launched.send_signal(signal.SIGTERM)
        self.assertIn("a: restarting: it ended with exit code 1: oops", self.finish(0))

    def test_restarted_hub_keeps_the_port_that_it_has_chosen(self):
        self.program("vismap-hub", "#!/bin/sh\n[ -e been ] && echo \"$@\" >again && exec sleep 3600\ntouch been\n"
                                   "echo tcpq://127.0.0.1:4242\nsleep 0.2\nexit 1\n")
        self.launch('cmd "hub" { exec = "${VISMAP_BIN}/vismap-hub --queue-mb 5 --listen 127.0.0.1:0"; '
                    'auto_respawn = "true"; }')
        self.assertEqual(self.wait_for_file("again"), "--queue-mb 5 --listen 127.0.0.1:4242\n")
        self.launched.send_signal(signal.SIGTERM)
        self.finish(0)

    def test_shows_the_reports_of_processes(self):
        self.program("talks", f"""#!{sys.executable}
import os, socket, time
manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
manager.connect(os.environ["NOTIFY_SOCKET"].replace("@", chr(0), 1))
manager.send(b"READY=1")
manager.send(b"STATUS=waiting: for \\x1b[2JDETECTIONS")
time.sleep(3600)
""")
        self.launch('cmd "a" { exec = "./talks"; }')
        self.assertIn("a: waiting: for [2JDETECTIONS (pid", self.wait_for_line("waiting"))
        self.launched.send_signal(signal.SIGTERM)
        self.finish(0)

    def test_permanent_failure_stops_all_and_names_the_reason(self):
        self.launch('cmd "b" { exec = "./worker b"; }\n'
                    'cmd "a" { exec = "sh -c \\"echo no such option; exit 2\\""; auto_respawn = "true"; }')
        output = self.finish(1)
        self.assertIn("a failed: exit code 2", output)
        self.assertIn("no such option", output)
        self.assertIn("out/logs/a.log", output)
        self.assertIn("b: stopped", output)

    def test_restarts_at_most_five_times_in_a_row(self):
        self.program("fails", "#!/bin/sh\necho x >>tries\nexit 1\n")
        self.launch('cmd "a" { exec = "./fails"; auto_respawn = "true"; }')
        self.finish(1)
        self.assertEqual((self.folder / "tries").read_text(), "x\n" * 5)

    def test_missing_program(self):
        self.launch('cmd "a" { exec = "./nowhere"; }')
        self.assertIn("failed: No such file or directory: ./nowhere", self.finish(1))

    def test_until_a_command_has_ended(self):
        self.launch('cmd "a" { exec = "./worker a"; }\ncmd "b" { exec = "true"; }', "--until", "b")
        output = self.finish(0)
        self.assertIn("b: done", output)
        self.assertIn("a: stopped", output)

    def test_commands_of_other_hosts_are_not_started(self):
        text = ('cmd "a" { exec = "true"; host = "robot2"; }\ncmd "c" { exec = "touch c.ran"; deputy = "gpu"; }\n'
                'cmd "b" { exec = "true"; host = "localhost"; }')
        self.launch(text, "--host", "gpu")
        output = self.finish(0)
        self.assertIn("a runs on robot2 and is not started here", output)
        self.assertTrue((self.folder / "c.ran").exists())

    def test_errors_of_the_file_name_the_line(self):
        for text, *words in (
                ('cmd "a" { exec = "true" }', "a.pmd:1:", "';'", "}"),
                ('\n\ncmd a { }', "a.pmd:3:", "double quotes"),
                ('cmd "a" {\n  exce = "true";\n}', "a.pmd:2:", "exce", "auto_respawn"),
                ('cmd "a" {\n  exec = "true";\n  auto_respawn = "maybe";\n}', "a.pmd:3:", "maybe"),
                ('cmd "a" { exec = "true";', "a.pmd:1:", "end of file"),
                ('group "g" {\n cmd "a" { exec = "true"; }\n', "a.pmd:3:", "'}'"),
                ('cmd "a" { exec = "true"; }\n}', "a.pmd:2:", "}"),
                ('cmd "a" { exec = "true"; }\ncmd "a" { exec = "true"; }', "a.pmd:2:", "already"),
                ('\ncmd "a" { }', "a.pmd:2:", "no exec"),
                ('\ncmd "a" { exec = "${NOWHERE_SET}"; }', "a.pmd:2:", "NOWHERE_SET", "--set"),
                ('cmd "a" { exec = "it\'s"; }', "a.pmd:1:", "quotation"),
                ('cmd "../a" { exec = "true"; }', "a.pmd:1:", "letters"),
                ('cmd "a" { exec = "true; }', "a.pmd:1:", "unexpected"),
                ('# nothing\n', "has no cmd"),
                ('cmd "a" { exec = "true"; host = "far"; }', "no cmd for this computer")):
            self.launch(text)
            output = self.finish(2)
            for word in words:
                self.assertIn(word, output, text)
            self.assertNotIn("Traceback", output)
            self.assertFalse((self.folder / "out").exists(), "no process is started, and no log is created")
            self.launched.stdout.close()

    def test_scripts_of_procman_are_accepted(self):
        self.launch('cmd "a" { exec = "true"; }\nscript "go" { start cmd "a"; wait ms 2000; run script "x"; }')
        self.finish(0)

    def test_shipped_files_name_programs_that_exist(self):
        programs = set(path.name for path in REPOSITORY.joinpath("procs").iterdir())
        files = sorted(REPOSITORY.glob("config/launch/*.pmd"))
        self.assertGreaterEqual(len(files), 2)
        for file in files:
            done = subprocess.run([sys.executable, "-B", LAUNCH, file, "--bin", self.folder, "--check", "--set",
                                   "CAMERA=driver"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            for line in done.stdout.splitlines():
                if "/vismap-" in line:
                    program = line.split("/vismap-")[1].split()[0]
                    self.assertIn(program.replace("-", "_"), programs, line)


if __name__ == "__main__":
    os.environ.pop("LCM_DEFAULT_URL", None)
    unittest.main()
