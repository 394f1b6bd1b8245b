"""From the clock of a camera to the clock of the computer, and the pace of a loop."""
from __future__ import annotations

import collections
import math
import threading
import time
from typing import Generic, TypeVar

from .bus import now_utime

Value = TypeVar("Value")

_STEP_US = 10_000  # a clock that jumps by more was set; what is less may be jitter


class DeviceClock:
    """Converts the time stamps of a camera to `utime` [us since 1970].

    A frame arrives some time after it was taken, and that time varies. The smallest difference between arrival and time
    stamp within the last `window_s` is taken for the offset between the clocks, so that the varying part disappears, and
    a slow drift is followed. Arrivals are measured by a clock that is never set, so that the results follow at once when the
    wall clock is set, forward or back. The results of one camera increase, as `utime` must, but when the wall clock is set
    back.

    latency_s: the constant part of the time from the exposure to the arrival, if it is known [s].
    """

    def __init__(self, window_s: float = 30.0, latency_s: float = 0.0) -> None:
        self._window_us, self._latency_us = int(window_s * 1e6), int(latency_s * 1e6)
        self._smallest: collections.deque[tuple[int, int]] = collections.deque()  # arrival, offset; offsets ascending
        self._before: tuple[int, int, int] | None = None  # of the last frame: device, arrival, wall clock minus arrival [us]
        self._last = 0
        self.restarts = 0  # how often the clock of the camera jumped back
        self.steps_back = 0  # how often the wall clock was set back

    def to_utime(self, device_s: float, arrival_utime: int | None = None, arrival_s: float | None = None) -> int:
        """The time of a frame with the time stamp `device_s` [s].

        arrival_utime: when it arrived by the wall clock [us]; None = now. arrival_s: the same moment by a clock that is never
        set, such as time.monotonic() [s]. With arrival_utime alone, a wall clock that is set forward counts only after window_s.
        """
        if not math.isfinite(device_s):
            raise ValueError(f"the time stamp of the camera is {device_s}; expected seconds")
        if arrival_utime is None:
            wall, arrival = _read_clocks()
        else:
            wall, arrival = arrival_utime, arrival_utime if arrival_s is None else round(arrival_s * 1e6)
        device, ahead = round(device_s * 1e6), wall - arrival
        self._notice_jumps(device, arrival, ahead)
        offset = arrival - device
        while self._smallest and self._smallest[-1][1] >= offset:
            self._smallest.pop()
        self._smallest.append((arrival, offset))
        while self._smallest[0][0] < arrival - self._window_us:
            self._smallest.popleft()
        utime = device + self._smallest[0][1] + ahead - self._latency_us
        self._last = max(utime, self._last + 1)
        return self._last

    def _notice_jumps(self, device: int, arrival: int, ahead: int) -> None:
        before, self._before = self._before, (device, arrival, ahead)
        if before is None:
            return
        if device < before[0]:
            self._smallest.clear()
            self.restarts += 1
        if arrival < before[1] - _STEP_US:
            self._smallest.clear()
        if arrival < before[1] - _STEP_US or ahead < before[2] - _STEP_US:
            self._last = 0
            self.steps_back += 1


def _read_clocks() -> tuple[int, int]:
    """The wall clock and a clock that is never set, of one moment [us]."""
    readings = []
    for _ in range(3):  # the process may be interrupted between two clocks
        begin = time.monotonic_ns()
        wall = now_utime()
        end = time.monotonic_ns()
        readings.append((end - begin, wall, (begin + end) // 2000))
    return min(readings)[1:]


class Pace:
    """Lets at most `rate_hz` frames per second through, evenly; 0 = all."""

    def __init__(self, rate_hz: float) -> None:
        self._period = 1e6 / rate_hz if rate_hz > 0 else 0.0
        self._next: float | None = None

    def takes(self, utime: int) -> bool:
        """Whether the frame of this time [us] goes through."""
        # A frame may come a little early, since cameras do not run evenly.
        if self._next is not None and 0 <= self._next - utime - self._period / 4 <= 2 * self._period:
            return False
        late = self._next is None or utime - self._next > self._period or utime < self._next - 2 * self._period
        self._next = utime + self._period if late or self._next is None else self._next + self._period
        return True


class Newest(Generic[Value]):
    """A place for one value between two threads. A value that was not taken is replaced by the next one, and counted in
    `skipped`."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._value: Value | None = None
        self.skipped = 0

    def put(self, value: Value) -> None:
        """Replaces the value."""
        with self._changed:
            self.skipped += self._value is not None
            self._value = value
            self._changed.notify()

    def take(self, timeout: float) -> Value | None:
        """Removes and returns the newest value; None when none comes within `timeout` [s]."""
        with self._changed:
            self._changed.wait_for(lambda: self._value is not None, timeout)
            value, self._value = self._value, None
            return value
