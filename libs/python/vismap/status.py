"""What a process tells of itself on STATUS, once a second, for vismap-doctor and for people."""
from __future__ import annotations

import collections
import logging
import os
import socket
import statistics
import threading
from types import TracebackType
from typing import Iterable

from . import messages
from .bus import Bus, now_utime
from .errors import BusError, MessageError

_log = logging.getLogger("vismap")
_STATES = ("starting", "ready", "waiting", "running", "stopping")
_MOST_FINDINGS, _MOST_TIMINGS = 16, 10000
_PERIOD_S = 1.0


def _memory_bytes() -> int:
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")
    except (OSError, ValueError, IndexError):
        return 0


class Status:
    """Publishes STATUS once a second and at every change of state, by a thread of its own.

    process: the name of the program, for example "realsense-driver"; the name of the instance is that of the bus. The state
    is "starting" until set() is called. vismap-doctor calls the process healthy while its state is ready or running, or its
    message is empty, while there are no findings, and while no counter grows that ends in ".unsent", ".lost", ".rejected" or
    "dropped".
    """

    def __init__(self, bus: Bus, process: str) -> None:
        self._bus, self._process = bus, process
        self._start_utime = now_utime()
        self._lock = threading.Lock()
        self._state, self._message = "starting", ""
        self._counters: collections.Counter[str] = collections.Counter()
        self._timings: dict[str, list[float]] = {}
        self._findings: list[str] = []
        self._closing = threading.Event()
        self.publish()
        self._thread = threading.Thread(target=self._run, name="vismap status", daemon=True)
        self._thread.start()

    def set(self, state: str, message: str = "") -> None:
        """state: starting, ready, waiting, running or stopping. message: one sentence, such as what it waits for."""
        if state not in _STATES:
            raise ValueError(f"the state is '{state}'; expected one of {', '.join(_STATES)}")
        with self._lock:
            changed, self._state, self._message = state != self._state, state, message
        if changed:
            self.publish()

    def count(self, counter: str, amount: int = 1) -> None:
        """Adds to a counter, a total since the start."""
        with self._lock:
            self._counters[counter] += amount

    def set_counter(self, counter: str, value: int) -> None:
        """Sets a counter."""
        with self._lock:
            self._counters[counter] = value

    def saw_frame(self, camera_id: int, utime: int) -> None:
        """Tells the map server of the newest frame of a camera, so that it can say by how much the map is behind."""
        self.set_counter(f"newest_utime.camera{camera_id}", utime)

    def add_timing(self, stage: str, ms: float) -> None:
        """Adds a duration [ms]; the next STATUS has the median and the maximum of each stage."""
        with self._lock:
            values = self._timings.setdefault(stage, [])
            if len(values) < _MOST_TIMINGS:
                values.append(ms)

    def set_findings(self, sentences: Iterable[str]) -> None:
        """What is wrong or suspect at present, one sentence each; vismap-doctor repeats them."""
        with self._lock:
            self._findings = list(sentences)[:_MOST_FINDINGS]

    def publish(self) -> None:
        """Publishes STATUS now. Without a connection nothing is sent; the next one comes after a second."""
        with self._lock:
            counters = {"memory_bytes": _memory_bytes(), **self._bus_counters(), **self._counters}
            timings, self._timings = self._timings, {}
            message = messages.types["vismap.process_status_t"](
                utime=now_utime(), process=self._process, host=socket.gethostname(), pid=os.getpid(),
                start_utime=self._start_utime, state=self._state, message=self._message, version=messages.version(),
                types_fingerprint=messages.types_fingerprint(), counter_names=list(counters),
                counter_values=list(counters.values()), timing_names=list(timings),
                median_ms=[statistics.median(values) for values in timings.values()],
                max_ms=[max(values) for values in timings.values()], findings=list(self._findings))
        try:
            self._bus.publish("STATUS", message)
        except BusError:
            pass  # the bus counts it
        except MessageError as error:
            _log.warning("STATUS was not published: %s", error)

    def _bus_counters(self) -> dict[str, int]:
        figures = {"received": self._bus.received, "published": self._bus.published, "unsent": self._bus.unsent}
        return {f"{channel}.{figure}": count for figure, counts in figures.items() for channel, count in list(counts.items())
                if count and channel in messages.CHANNELS}

    def _run(self) -> None:
        while not self._closing.wait(_PERIOD_S):
            self.publish()

    def close(self) -> None:
        """Publishes the state stopping, and ends."""
        self._closing.set()
        self._thread.join()
        self.set("stopping")

    def __enter__(self) -> Status:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()
