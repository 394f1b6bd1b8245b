"""Logs of LCM messages, in the format of lcm-logger. They are read and written event by event, at any size."""
from __future__ import annotations

import os
import pathlib
import struct
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Any, BinaryIO, Iterator

from . import messages
from .bus import now_utime
from .errors import LogError
from .lcm_types import Message
from .messages import MAX_MESSAGE_BYTES

_SYNC = b"\xed\xa1\xda\x01"
_HEAD = struct.Struct(">4sqqii")  # sync word, number, time, size of the channel name, size of the data
_MAX_CHANNEL = 63
_SEARCH_BYTES = 1 << 20


@dataclass(frozen=True)
class LogEvent:
    """One recorded message."""

    number: int
    utime: int  # when it was recorded [us since 1970]
    channel: str
    data: bytes
    offset: int  # of the event in the file [bytes]

    def decode(self) -> Any:
        """The message. Raises MessageError when it is none of vismap's, or damaged."""
        return messages.decode(self.data)


@dataclass(frozen=True)
class LogDamage:
    """A part of a log that is no complete event."""

    offset: int  # [bytes]
    size: int  # [bytes]


class LogReader:
    """Iterates over the events of a log, without loading it: `for event in LogReader("run.lcmlog")`.

    All sizes in the file are checked before they are used. At a damaged part LogError says where it is; with
    `skip_damage=True` reading goes on with the next whole event, and `damage` lists what was passed over.

    channel_prefix: see Bus; events of other channels are left out, and those that are given have no prefix.
    """

    def __init__(self, path: str | os.PathLike[str], skip_damage: bool = False, channel_prefix: str = "") -> None:
        self.path = pathlib.Path(path)
        self.damage: list[LogDamage] = []
        self._skip, self._prefix = skip_damage, channel_prefix
        with self._open() as file:
            self._size = os.fstat(file.fileno()).st_size

    def _open(self) -> BinaryIO:
        try:
            return open(self.path, "rb")
        except OSError as error:
            raise LogError(f"{self.path}: the log cannot be read ({error.strerror})") from None

    def __iter__(self) -> Iterator[LogEvent]:
        with self._open() as file:
            yield from self._events(file)

    def _events(self, file: BinaryIO) -> Iterator[LogEvent]:
        at = 0
        while at < self._size:
            event = self._event_at(file, at)
            if event is None:
                end = self._next_event(file, at + 1)
                self._tell(LogDamage(at, end - at))
                at = end
                continue
            if event.channel.startswith(self._prefix):
                yield replace(event, channel=event.channel[len(self._prefix):]) if self._prefix else event
            at += _HEAD.size + len(event.channel.encode()) + len(event.data)

    def _tell(self, damage: LogDamage) -> None:
        if not self._skip:
            rest = self._size - damage.offset == damage.size
            raise LogError(f"{self.path}: {damage.size} bytes from byte {damage.offset} on are no complete event"
                           + (", up to the end; the recorder was probably interrupted" if rest else "")
                           + "; LogReader(path, skip_damage=True) passes over such parts")
        self.damage.append(damage)

    def _event_at(self, file: BinaryIO, at: int) -> LogEvent | None:
        """The event at an offset; None = there is no complete one."""
        file.seek(at)
        head = file.read(_HEAD.size)
        if len(head) < _HEAD.size:
            return None
        sync, number, utime, name_size, data_size = _HEAD.unpack(head)
        fits = at + _HEAD.size + name_size + data_size <= self._size
        if sync != _SYNC or not 1 <= name_size <= _MAX_CHANNEL or not 0 <= data_size <= MAX_MESSAGE_BYTES or not fits:
            return None
        try:
            channel = file.read(name_size).decode()
        except UnicodeDecodeError:
            return None
        data = file.read(data_size)
        return LogEvent(number, utime, channel, data, at) if len(data) == data_size else None

    def _next_event(self, file: BinaryIO, at: int) -> int:
        """Where the next complete event begins; the size of the file when there is none."""
        while at < self._size:
            file.seek(at)
            window = file.read(_SEARCH_BYTES)
            found = window.find(_SYNC)
            while found >= 0:
                if self._event_at(file, at + found) is not None:
                    return at + found
                found = window.find(_SYNC, found + 1)
            if len(window) < _SEARCH_BYTES:
                break
            at += len(window) - len(_SYNC) + 1
        return self._size


class LogWriter:
    """Writes a log. An existing file is replaced only with `overwrite=True`. channel_prefix: see Bus."""

    def __init__(self, path: str | os.PathLike[str], overwrite: bool = False, channel_prefix: str = "") -> None:
        self.path = pathlib.Path(path)
        self._prefix = channel_prefix
        self._number = 0
        try:
            self._file: BinaryIO = open(self.path, "wb" if overwrite else "xb")
        except FileExistsError:
            raise LogError(f"{self.path} exists; LogWriter(path, overwrite=True) replaces it") from None
        except OSError as error:
            raise LogError(f"{self.path}: the log cannot be written ({error.strerror})") from None

    def write(self, channel: str, message: Message | bytes, utime: int | None = None) -> None:
        """Appends a message. utime: when it was recorded [us since 1970]; None = now."""
        data = messages.encode(message) if isinstance(message, Message) else bytes(message)
        name = (self._prefix + channel).encode()
        if not 1 <= len(name) <= _MAX_CHANNEL:
            raise LogError(f"the channel name '{channel}' has {len(name)} bytes; expected 1 to {_MAX_CHANNEL}")
        head = _HEAD.pack(_SYNC, self._number, now_utime() if utime is None else utime, len(name), len(data))
        try:
            self._file.write(head + name + data)
        except OSError as error:
            raise LogError(f"{self.path}: the log cannot be written ({error.strerror})") from None
        self._number += 1

    def close(self) -> None:
        """Ends the log. Raises LogError when its last part cannot be written."""
        try:
            self._file.close()
        except OSError as error:
            raise LogError(f"{self.path}: the log cannot be written ({error.strerror})") from None

    def __enter__(self) -> LogWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()
