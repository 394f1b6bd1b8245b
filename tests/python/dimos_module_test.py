#!/usr/bin/env python3
"""The class for DimOS starts the real adapter: its command line, its log, its end. DimOS itself is not needed: a small
stand-in has the parts of its base class that start a native module.

Usage: dimos_module_test.py FOLDER_OF_PROGRAMS
"""
import enum
import importlib.util
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import types
import typing
import unittest

from support import DEADLINE, ROOT, Processes, wait_until

import vismap

BIN = None  # from the command line
Message = typing.TypeVar("Message")
# The ports of the class -> what the effective config must then have, and the type of the messages.
PORTS = {"color_image": ("color_channel", "sensor_msgs.Image"), "depth_image": ("depth_channel", "sensor_msgs.Image"),
         "camera_info": ("intrinsics_channel", "sensor_msgs.CameraInfo"),
         "depth_camera_info": ("depth_intrinsics_channel", "sensor_msgs.CameraInfo"),
         "global_map": ("cloud_channel", "sensor_msgs.PointCloud2"), "global_costmap": ("costmap_channel", "nav_msgs.OccupancyGrid"),
         "detections_3d": ("detections_channel", "vision_msgs.Detection3DArray")}


class In(typing.Generic[Message]):
    """A port that receives."""


class Out(typing.Generic[Message]):
    """A port that sends."""


class LogFormat(enum.Enum):
    TEXT = "text"
    JSON = "json"


class NativeModuleConfig:
    """The fields of this class are for DimOS, those of a subclass for the program."""

    executable: str
    cwd: str | None = None
    extra_args: list[str] = []
    extra_env: dict[str, str] = {}
    log_format: LogFormat = LogFormat.JSON
    stdin_config: bool = False

    def __init__(self, **values):
        unknown = values.keys() - typing.get_type_hints(type(self)).keys()
        if unknown:
            raise TypeError(f"no fields {unknown}")
        for name, value in values.items():
            setattr(self, name, value)

    def options(self):
        own = typing.get_type_hints(type(self)).keys() - typing.get_type_hints(NativeModuleConfig).keys()
        return {name: getattr(self, name) for name in typing.get_type_hints(type(self)) if name in own and getattr(self, name) is not None}


def text_of(value):
    if isinstance(value, bool):
        return str(value).lower()
    return ",".join(map(str, value)) if isinstance(value, list) else str(value)


class NativeModule:
    """Starts a program with the channels of the ports, as DimOS does."""

    config: NativeModuleConfig

    def __init__(self, channels, **values):
        hints = typing.get_type_hints(type(self))
        self.config = hints["config"](**values)
        self.ports = {name: typing.get_args(hint)[0] for name, hint in hints.items() if typing.get_origin(hint) in (In, Out)}
        self.topics = {name: channels(name, message.msg_name) for name, message in self.ports.items()}
        self.process = None

    def command(self):
        words = [self.config.executable]
        for name, value in {**self.topics, **self.config.options()}.items():
            words += [f"--{name}", text_of(value)]
        return words + self.config.extra_args

    def start(self, stderr):
        line = json.dumps({"topics": self.topics, "config": self.config.options(), "session": {"id": "x"}, "qos": {}}) + "\n"
        self.process = subprocess.Popen(
            self.command(), stdin=subprocess.PIPE, stdout=stderr, stderr=stderr, start_new_session=True,
            cwd=self.config.cwd or pathlib.Path(self.config.executable).resolve().parent,
            env={**os.environ, **self.config.extra_env, "DIMOS_TRANSPORT": "lcm", "RUST_LOG": "info"})
        if self.config.stdin_config:
            self.process.stdin.write(line.encode())
        self.process.stdin.close()


def add_module(name, **members):
    for i in range(1, name.count(".") + 1):
        package = ".".join(name.split(".")[:i])
        sys.modules.setdefault(package, types.ModuleType(package))
    sys.modules[name] = types.ModuleType(name)
    vars(sys.modules[name]).update(members)


def load_class():
    add_module("dimos.core.native_module", LogFormat=LogFormat, NativeModule=NativeModule, NativeModuleConfig=NativeModuleConfig)
    add_module("dimos.core.stream", In=In, Out=Out)
    for full in {message for _, message in PORTS.values()}:
        package, name = full.split(".")
        add_module(f"dimos.msgs.{package}.{name}", **{name: type(name, (), {"msg_name": full})})
    specification = importlib.util.spec_from_file_location("dimos_module", ROOT / "procs" / "adapter" / "dimos_module.py")
    module = importlib.util.module_from_spec(specification)
    sys.modules["dimos_module"] = module
    specification.loader.exec_module(module)
    return module.VismapAdapter


def channel_of(port, message):
    """A blueprint may give every port another name."""
    return f"/robot7/{port}#{message}"


class DimosModuleTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.log = self.folder / "adapter.log"

    def module(self, **values):
        return load_class()(channel_of, executable=str(BIN / "vismap-adapter"), **values)

    def start(self, module):
        with open(self.log, "wb") as log:
            module.start(log)

        def end():
            if module.process.poll() is None:
                module.process.kill()
            module.process.wait()
        self.addCleanup(end)

    def lines(self):
        return [json.loads(line) for line in self.log.read_text().splitlines()]

    def stop_within_two_seconds(self, module):
        begin = time.monotonic()
        module.process.send_signal(signal.SIGTERM)
        code = module.process.wait(timeout=DEADLINE)
        self.assertLess(time.monotonic() - begin, 2)
        self.assertEqual(code, 0, self.log.read_text())

    def test_the_default_executable_is_that_of_the_package(self):
        self.assertEqual(load_class()(channel_of).config.executable, "/usr/bin/vismap-adapter")

    def test_the_command_line_sets_every_port_and_field(self):
        for stdin_config in (False, True):
            module = self.module(lcm_url="tcpq://127.0.0.1:7799", camera_id=7, root="odom", stdin_config=stdin_config)
            self.assertEqual({name: message.msg_name for name, message in module.ports.items()},
                             {name: message for name, (_, message) in PORTS.items()})
            module.config.extra_args = [*module.config.extra_args, "--print-config"] + ["--stdin-config", "true"] * stdin_config
            self.start(module)
            self.assertEqual(module.process.wait(timeout=DEADLINE), 0, self.log.read_text())
            section = re.search(r"^adapter \{\n(.*?)^\}", self.log.read_text(), re.MULTILINE | re.DOTALL).group(1)
            values = dict(re.findall(r"^  (\w+): \"?(.*?)\"?$", section, re.MULTILINE))
            for port, (key, message) in PORTS.items():
                self.assertEqual(values[key], channel_of(port, message), port)
            expected = {"robot_url": "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304", "camera_id": "7", "preset": "DIMOS", "root": "odom"}
            self.assertEqual({key: values[key] for key in expected}, expected)

    def test_without_the_option_the_line_on_the_standard_input_alone_is_enough(self):
        module = self.module()
        module.config.stdin_config = True
        everything = module.command
        module.command = lambda: [module.config.executable, "--stdin-config", "true", "--print-config"]
        self.start(module)
        self.assertEqual(module.process.wait(timeout=DEADLINE), 0, self.log.read_text())
        for port, (key, message) in PORTS.items():
            self.assertIn(f'{key}: "{channel_of(port, message)}"', self.log.read_text())
        self.assertIn("--detections_3d", everything())

    def test_it_joins_both_buses_logs_json_and_goes_within_two_seconds(self):
        processes = Processes(BIN, self.folder)
        self.addCleanup(processes.stop_all)
        url = processes.start_hub()
        module = self.module(lcm_url=url, robot_url=url, camera_id=7)
        with vismap.Bus(url, name="test") as bus:
            states = bus.subscribe("STATUS")
            self.start(module)
            while (status := states.get(DEADLINE).decode()).process != "adapter" or status.state == "starting":
                pass
        self.start_and_stop_another(url)
        processes.stop("hub")
        wait_until(lambda: self.log.stat().st_size > 0, "a word about the lost hub")
        self.stop_within_two_seconds(module)
        self.check_log()

    def start_and_stop_another(self, url):
        """One that still reaches its hub when it is told to go."""
        module = self.module(lcm_url=url, robot_url=url, camera_id=8)
        module.config.extra_args = [*module.config.extra_args, "--name", "adapter-2"]
        with vismap.Bus(url, name="test") as bus:
            states = bus.subscribe("STATUS")
            log, self.log = self.log, self.folder / "another.log"
            self.start(module)
            while (status := states.get(DEADLINE).decode()).source != "adapter-2" or status.state == "starting":
                pass
            self.stop_within_two_seconds(module)
            self.log = log

    def test_it_goes_within_two_seconds_while_there_is_no_hub(self):
        module = self.module(lcm_url="tcpq://127.0.0.1:9", robot_url="tcpq://127.0.0.1:9")
        self.start(module)
        wait_until(lambda: self.log.stat().st_size > 0 or module.process.poll() is not None, "a word of the adapter")
        self.assertIsNone(module.process.poll(), self.log.read_text())
        self.stop_within_two_seconds(module)
        self.check_log()

    def check_log(self):
        lines = self.lines()
        self.assertGreaterEqual(len(lines), 1)
        for line in lines:
            self.assertIn(line["level"], ("debug", "info", "warning", "error"), line)
            self.assertTrue(line["message"], line)
            # DimOS passes all other members on as keywords, beside these of its own.
            self.assertFalse(line.keys() & {"module", "pid", "event", "fields"}, line)


if __name__ == "__main__":
    BIN = pathlib.Path(sys.argv.pop()).resolve()
    unittest.main()
