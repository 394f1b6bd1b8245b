"""Free space for planners: the newest octree of the octomap exporter, how old it is, and whether it can be trusted."""
from __future__ import annotations

import re
import threading
import time
from dataclasses import dataclass
from types import TracebackType
from typing import Any

from .bus import Bus
from .errors import BusError, MessageError, WaitTimeout
from .octree import Octree

_OVERDUE_S = 1.6  # after so long a message that comes once a second is missing
_NEVER = float("-inf")


def _message_on(channel: str, message: str) -> str:
    """A message of NAVIGATION, unless it begins with the name of another channel and a colon."""
    named = re.match(r"([A-Z_]+): ", message)
    return message if named is None or named.group(1) == channel else ""


@dataclass(frozen=True)
class _Known:
    """What is known at one moment; replaced as a whole."""

    message: Any = None  # the newest octree_t
    since: float = _NEVER  # when it came for the first time
    confirmed: float = _NEVER  # when it was known to be the newest state of the map
    status: Any = None  # the newest navigation_status_t
    exporter: float = _NEVER  # when these were heard last
    server: float = _NEVER
    problem: str = ""  # why a message was not taken


class LiveOctree:
    """Follows one of the octrees that the octomap exporter publishes. A thread of its own receives.

    channel: OCTOMAP, in which unknown space is occupied, for planners; OCTOMAP_INFLATED, grown by the radius of the robot;
    OCTOMAP_COARSE; or OCTOMAP_RAW, without unknown space. max_silence_s: after so long without a word from the exporter or the
    map server, which both speak once a second, the tree is stale.
    """

    def __init__(self, bus: Bus, channel: str = "OCTOMAP", max_silence_s: float = 2.8) -> None:
        self.channel = channel
        self._bus, self._max_silence_s = bus, max_silence_s
        self._known = _Known()
        self._changed = threading.Condition()
        self._parsed: tuple[Any, Octree] | None = None
        self._closing = threading.Event()
        self._messages = bus.subscribe(f"{channel}|NAVIGATION|STATUS")
        self._thread = threading.Thread(target=self._run, name=f"vismap {channel}", daemon=True)
        self._thread.start()

    @property
    def revision(self) -> int:
        """Of the map in the tree: the number of its frames; -1 = there is no tree yet."""
        message = self._known.message
        return -1 if message is None else int(message.revision)

    @property
    def age_s(self) -> float:
        """How long ago the tree was known to be the newest state of the map [s]; inf without one. Up to about 2 s normally."""
        known = self._known
        return float("inf") if known.message is None else time.monotonic() - known.confirmed

    @property
    def why_stale(self) -> str:
        """One sentence: why there is no tree, or why it must be assumed that it is not the newest state of the map. Empty
        when it is."""
        return self._why_stale(self._known)

    def octree(self, max_age_s: float | None = None) -> Octree | None:
        """The newest tree; None when there is none, or with `max_age_s` none that is not stale and as new as that."""
        known = self._known
        if known.message is None or (max_age_s is not None and (self._why_stale(known) or time.monotonic() - known.confirmed > max_age_s)):
            return None
        parsed = self._parsed
        if parsed is None or parsed[0] is not known.message:
            self._parsed = parsed = known.message, Octree.from_message(known.message)
        return parsed[1]

    def wait(self, timeout: float = 10.0, revision: int = 0) -> Octree:
        """Waits for a tree that is not stale, of this revision or a later one. Raises WaitTimeout with the reason."""
        end = time.monotonic() + timeout
        with self._changed:
            while self._why_stale(self._known) or self.revision < revision:
                left = end - time.monotonic()
                if left <= 0:
                    why = self._why_stale(self._known) or f"the newest tree is of revision {self.revision}, not {revision}"
                    raise WaitTimeout(f"no octree within {timeout:g} s on {self._bus.url}: {why}")
                self._changed.wait(min(left, 0.1))
        tree = self.octree()
        assert tree is not None
        return tree

    def _why_silent(self, known: _Known) -> str:
        if not self._bus.connected:
            return "there is no connection to the hub at present"
        if known.exporter == _NEVER:
            return ("nothing was heard of the octomap exporter yet; vismap-octomap-exporter is not running on this bus, or has "
                    "just started")
        exporter, server = time.monotonic() - known.exporter, time.monotonic() - known.server
        if exporter > self._max_silence_s or (server > self._max_silence_s and exporter > _OVERDUE_S):
            return f"the octomap exporter was not heard for {exporter:.1f} s"
        if known.status is None:
            return "nothing was heard on NAVIGATION yet"
        if known.server == _NEVER:
            return "the octomap exporter has not heard a map server yet"
        return f"the map server was not heard for {server:.1f} s" if server > self._max_silence_s else ""

    def _why_stale(self, known: _Known) -> str:
        silent = self._why_silent(known)
        if silent or known.problem:
            return silent or known.problem
        message, status = known.message, known.status
        said = _message_on(self.channel, str(status.message))
        if message is None:
            return f"no tree has come on {self.channel} yet" + (f": {said}" if said else "")
        if status.map_id and status.map_id != message.map_id:
            return f"the map was replaced by another one, of which no tree has come on {self.channel}"
        return said if status.revision > message.revision else ""

    def _run(self) -> None:
        while not self._closing.is_set():
            try:
                received = self._messages.poll(0.1)
            except BusError:
                return
            if received is None:
                continue
            try:
                self._take(received.channel, received.decode(), time.monotonic())
            except MessageError as error:
                if received.channel == self.channel:
                    self._replace(problem=str(error))

    def _take(self, channel: str, message: Any, now: float) -> None:
        known = self._known
        if channel == "STATUS":
            if message.process == "map-server" and message.state != "stopping":
                self._replace(server=now)
        elif channel == "NAVIGATION":
            self._take_status(known, message, now)
        elif known.message is not None and (known.message.map_id, known.message.revision) == (message.map_id, message.revision):
            self._replace(exporter=now, problem="")  # sent again, since the map stands still
        else:
            self._take_tree(known, message, now)

    def _take_tree(self, known: _Known, message: Any, now: float) -> None:
        if message.n_nodes == 0:
            self._replace(exporter=now, problem=f"an empty tree has come on {self.channel}")
        elif self.channel != "OCTOMAP_RAW" and message.unknown == 0:
            self._replace(exporter=now, problem=f"the tree on {self.channel} is raw, and planners would take unknown space for free; "
                          "set octomap_exporter.unknown to OCCUPIED")
        else:
            confirmed = min(now, known.server) if now - known.server > self._max_silence_s else now
            self._replace(message=message, since=now, exporter=now, confirmed=_NEVER if known.status is None else confirmed, problem="")

    def _take_status(self, known: _Known, status: Any, now: float) -> None:
        followed = _NEVER
        if status.server_utime > 0:
            followed = now - max(0, status.published_utime - status.server_utime) * 1e-6
        confirmed, tree = known.confirmed, known.message
        if tree is not None and tree.map_id == status.map_id:
            if status.in_sync and tree.revision == status.revision:
                confirmed = max(confirmed, followed)
            elif confirmed == _NEVER:
                confirmed = min(known.since, followed)
        self._replace(status=status, exporter=now, server=max(known.server, followed), confirmed=confirmed)

    def _replace(self, **changed: Any) -> None:
        with self._changed:
            self._known = _Known(**{**self._known.__dict__, **changed})
            self._changed.notify_all()

    def close(self) -> None:
        """Ends the subscription and the thread. The newest tree stays."""
        self._closing.set()
        self._messages.close()
        self._thread.join()

    def __enter__(self) -> LiveOctree:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()
