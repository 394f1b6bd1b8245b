"""From the clock of a camera to the clock of the computer, and the pace of a loop."""
from __future__ import annotations

import collections
import threading
from typing import Generic, TypeVar

from .bus import now_utime

Value = TypeVar("Value")


class DeviceClock:
    """Converts the time stamps of a camera to `utime` [us since 1970].

    A frame arrives some time after it was taken, and that time varies. The smallest difference between arrival and time
    stamp within the last `window_s` is taken for the offset between the clocks, so that the varying part disappears, and
    a slow drift is followed. The results of one camera always increase, as `utime` must.

    latency_s: the constant part of the time from the exposure to the arrival, if it is known [s].
    """

    def __init__(self, window_s: float = 30.0, latency_s: float = 0.0) -> None:
        self._window_us, self._latency_us = int(window_s * 1e6), int(latency_s * 1e6)
        self._smallest: collections.deque[tuple[int, int]] = collections.deque()  # arrival, offset; offsets ascending
        self._last_device: float | None = None
        self._last = 0
        self.restarts = 0  # how often the clock of the camera jumped back

    def to_utime(self, device_s: float, arrival_utime: int | None = None) -> int:
        """The time of a frame with the time stamp `device_s` [s] that arrives now, or at `arrival_utime` [us]."""
        arrival = now_utime() if arrival_utime is None else arrival_utime
        if self._last_device is not None and device_s < self._last_device:
            self._smallest.clear()
            self.restarts += 1
        self._last_device = device_s
        offset = arrival - round(device_s * 1e6)
        while self._smallest and self._smallest[-1][1] >= offset:
            self._smallest.pop()
        self._smallest.append((arrival, offset))
        while self._smallest[0][0] < arrival - self._window_us:
            self._smallest.popleft()
        utime = round(device_s * 1e6) + self._smallest[0][1] - self._latency_us
        self._last = max(utime, self._last + 1)
        return self._last


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
