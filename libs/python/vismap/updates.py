"""Copies of what the map server holds, which follow its updates: what the surface and the space have in common."""
from __future__ import annotations

import abc
import logging
import threading
import time
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Generic, Mapping, TypeVar

from . import messages
from .bus import Bus, now_utime
from .errors import BusError, MapError, MessageError, WaitTimeout

_log = logging.getLogger("vismap")
BlockIndex = tuple[int, int, int]
Content = TypeVar("Content")  # of a block
Copied = TypeVar("Copied")  # what a follower hands out


@dataclass(frozen=True)
class Part(Generic[Content]):
    """A part of an update."""

    blocks: Mapping[BlockIndex, Content | None]  # None = the block has nothing any more
    bytes: int


class Follower(abc.ABC, Generic[Content, Copied]):
    """A copy made of the updates on one channel. It has no clock and no bus of its own.

    An update applies only to the revision that it is based on, so that the copy always equals an earlier state of the
    map. When one is missing, `in_sync` is False, and `position` is the argument of the request for what is missing.
    """

    TYPE: str  # of the messages
    OLDER: tuple[str, ...] = ()  # versions of it that old logs hold and that the follower understands, too
    WHAT: str  # is copied, for sentences

    def __init__(self, max_bytes: int = 2 << 30, max_wait_s: float = 30.0) -> None:
        self.map_id = ""
        self.revision = -1
        self.utime = 0
        self.in_sync = False
        self.gaps = 0  # how often an update was missing
        self._max_bytes, self._max_wait_s = max_bytes, max_wait_s
        self._blocks: dict[BlockIndex, Content] = {}
        self._bytes = 0
        self._parts: dict[int, Part[Content]] = {}  # of the update that is being collected
        self._staged: tuple[Any, ...] | None = None
        self._staged_since = 0.0
        self._joined: Copied | None = None

    @property
    def position(self) -> str:
        """MAP_ID@REVISION of the copy; "" when it is empty."""
        return f"{self.map_id}@{self.revision}" if self.revision >= 0 else ""

    @property
    @abc.abstractmethod
    def digest(self) -> str:
        """Digest of the copy, the same as `vismap-map digests` prints for an equal one; "" without XXH3."""

    def apply(self, data: bytes, now: float) -> bool:
        """Adds the bytes of an update at a time [s]. Returns whether the copy has advanced. Raises MapError or
        MessageError on inconsistent bytes; the copy stays as it was."""
        kinds = {messages.types[name].FINGERPRINT: messages.types[name] for name in self.OLDER}
        message = messages.decode(data, kinds.get(int.from_bytes(data[:8], "big"), messages.types[self.TYPE]))
        if not 0 <= message.part < message.parts:
            raise MapError(f"{self._name(message)}: it is part {message.part} of {message.parts}")
        if not self._wanted(message, now):
            return False
        self._parts[message.part] = self._decode_part(message)
        self._staged_since = now
        if sum(part.bytes for part in self._parts.values()) > self._max_bytes:
            self._drop_parts()
            self._miss()
            raise MapError(self._too_large())
        if len(self._parts) < message.parts:
            return False
        self._apply_parts(message)
        return True

    def give_up_stale_parts(self, now: float) -> int:
        """Drops the parts of an update of which the others have not come for too long. Returns how many."""
        if self._staged is None or now - self._staged_since < self._max_wait_s:
            return 0
        dropped = len(self._parts)
        self._drop_parts()
        return dropped

    def copied(self) -> Copied:
        """What the copy is now. Do not write to its arrays."""
        if self._joined is None:
            self._joined = self._join([(index, self._blocks[index]) for index in sorted(self._blocks)])
        return self._joined

    @abc.abstractmethod
    def _decode_part(self, message: Any) -> Part[Content]: ...

    @abc.abstractmethod
    def _bytes_of(self, block: Content) -> int: ...

    @abc.abstractmethod
    def _join(self, blocks: list[tuple[BlockIndex, Content]]) -> Copied: ...

    def _name(self, message: Any) -> str:
        return f"{self.TYPE.split('.')[1]} of map '{message.map_id}'"

    def _too_large(self) -> str:
        return f"the {self.WHAT} needs more than the allowed {self._max_bytes} bytes; give a larger max_mb"

    def _wanted(self, message: Any, now: float) -> bool:
        same_map = message.map_id == self.map_id
        if same_map and self.in_sync and message.revision <= self.revision:
            return False
        whole = (message.map_id, message.revision, message.base_revision, message.full, message.parts)
        if self._staged != whole:
            if not message.full and not (same_map and 0 <= self.revision == message.base_revision):
                self._miss()
                return False
            self._drop_parts()
            self._staged, self._staged_since = whole, now
        return message.part not in self._parts

    def _apply_parts(self, message: Any) -> None:
        if message.full:
            self._blocks, self._bytes = {}, 0
        for _, part in sorted(self._parts.items()):
            for index, block in part.blocks.items():
                if index in self._blocks:
                    self._bytes -= self._bytes_of(self._blocks.pop(index))
                if block is not None:
                    self._blocks[index] = block
                    self._bytes += self._bytes_of(block)
        self._drop_parts()
        self._joined = None
        self.map_id, self.revision, self.utime, self.in_sync = message.map_id, message.revision, message.utime, True
        if self._bytes > self._max_bytes:
            self._blocks, self._bytes, self.revision = {}, 0, -1
            self._miss()
            raise MapError(self._too_large())

    def _drop_parts(self) -> None:
        self._parts, self._staged = {}, None

    def _miss(self) -> None:
        # Staged parts stay, since the other parts of that update may still come.
        self.gaps += self.in_sync
        self.in_sync = False


class Live(Generic[Content, Copied]):
    """Keeps a follower up to date; a thread of its own does so. Missed updates are requested again."""

    _REQUEST_S = 2.0  # between two requests for what is missing
    _TURN_S = 0.25

    def __init__(self, bus: Bus, follower: Follower[Content, Copied], channel: str, verb: str) -> None:
        self._bus, self._follower, self._channel, self._verb = bus, follower, channel, verb
        self._updates = bus.subscribe(channel, capacity=1000)
        self._changed = threading.Condition()
        self._closing = False
        self._next_request = 0.0
        self._error = ""
        self._thread = threading.Thread(target=self._follow, name=f"vismap live {follower.WHAT}", daemon=True)
        self._thread.start()

    @property
    def digest(self) -> str:
        """Digest of the copy; see Follower.digest."""
        with self._changed:
            return self._follower.digest

    @property
    def gaps(self) -> int:
        """How often an update was missing."""
        return self._follower.gaps

    def now(self) -> Copied:
        """The copy as far as it is known now; empty, with revision -1, before the first update has come."""
        with self._changed:
            return self._follower.copied()

    def wait(self, revision: int = 0, timeout: float = 60.0) -> Copied:
        """The copy once it is complete and has at least `revision` frames. Raises WaitTimeout after `timeout` [s]."""
        with self._changed:
            found = self._changed.wait_for(lambda: self._follower.in_sync and self._follower.revision >= revision, timeout)
            if not found:
                raise WaitTimeout(
                    f"the map has not reached revision {revision} within {timeout:g} s; "
                    + (f"it is at {self._follower.revision}" if self._follower.revision >= 0 else
                       f"no {self._channel} came on {self._bus.url}: check with vismap-doctor that vismap-map-server is running")
                    + (f"; {self._error}" if self._error else ""))
            return self._follower.copied()

    def close(self) -> None:
        """Stops following."""
        self._closing = True
        self._thread.join()
        self._updates.close()

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def _follow(self) -> None:
        self._request()
        while not self._closing:
            try:
                received = self._updates.poll(self._TURN_S)
            except BusError:
                return  # the bus was closed
            with self._changed:
                self._follower.give_up_stale_parts(time.monotonic())
                if received is not None:
                    self._apply(received.data)
                in_sync = self._follower.in_sync
            if not in_sync:
                self._request()

    def _apply(self, data: bytes) -> None:
        try:
            if self._follower.apply(data, time.monotonic()):
                self._error = ""
                self._changed.notify_all()
        except (MapError, MessageError) as error:
            self._error = f"an update was left out: {error}"
            _log.warning("%s", self._error)

    def _request(self) -> None:
        if time.monotonic() < self._next_request:
            return
        self._next_request = time.monotonic() + self._REQUEST_S
        request = messages.types["vismap.map_request_t"](utime=now_utime(), verb=self._verb, argument=self._follower.position)
        fields: Any = request
        fields.request_id = fields.utime
        try:
            self._bus.publish("MAP_REQUEST", request)
        except BusError:
            pass  # it is requested again when the connection is back
