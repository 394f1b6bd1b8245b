"""The messages of vismap: their types, read from the `.lcm` texts, and the envelope that all of them have.

`messages.types` has every type by its full name; `messages.rgbd_frame_t` is the same as
`messages.types["vismap.rgbd_frame_t"]`.
"""
from __future__ import annotations

import functools
import pathlib
import re
import struct
from dataclasses import dataclass
from typing import Any

from .errors import MessageError
from .lcm_types import Message, TypeTable, parse_lcm
from .native import checksum64

_PACKAGE = pathlib.Path(__file__).resolve().parent
_MEGABYTE = 1 << 20


def data_file(installed: str, in_tree: str) -> pathlib.Path:
    """A file or folder that belongs to the package: beside it when it is installed, else in the source tree."""
    for path in (_PACKAGE / installed, _PACKAGE.parents[2] / in_tree):
        if path.exists():
            return path
    raise MessageError(f"the package vismap is incomplete: there is neither {_PACKAGE / installed} nor "
                       f"{_PACKAGE.parents[2] / in_tree}; install python3-vismap again")


def _read_types() -> TypeTable:
    folder = data_file("lcmtypes", "lcmtypes")
    # In older/ stand earlier versions of types, so that logs of them can be read.
    files = sorted(folder.glob("*.lcm")) + sorted(folder.glob("older/*.lcm"))
    return TypeTable(layout for file in files for layout in parse_lcm(file.read_text(encoding="utf-8"), str(file)))


types = _read_types()


def __getattr__(name: str) -> Any:
    try:
        return types[f"vismap.{name}"]
    except KeyError:
        raise AttributeError(f"vismap has no message type {name}; it has "
                             f"{', '.join(sorted(known.split('.')[1] for known in types))}") from None


@dataclass(frozen=True)
class Channel:
    """A channel of vismap: its message type, and the size of the largest message [bytes]."""

    type: str
    max_bytes: int


#: All channels. Their order is that of procs/wire/channel_types.cc, on which types_fingerprint() depends.
CHANNELS: dict[str, Channel] = {
    "RGBD_FRAME": Channel("vismap.rgbd_frame_t", 64 * _MEGABYTE),
    "DETECTIONS": Channel("vismap.detections_t", 16 * _MEGABYTE),
    "SEGMENTED_FRAME": Channel("vismap.segmented_frame_t", 64 * _MEGABYTE),
    "MAP_COMMIT": Channel("vismap.frame_commit_t", _MEGABYTE // 16),
    "MAP_DELTA": Channel("vismap.map_delta_t", 64 * _MEGABYTE),
    "MESH_DELTA": Channel("vismap.mesh_delta_t", 64 * _MEGABYTE),
    "OBJECTS": Channel("vismap.object_list_t", 16 * _MEGABYTE),
    "OCTOMAP": Channel("vismap.octree_t", 192 * _MEGABYTE),
    "MAP_REQUEST": Channel("vismap.map_request_t", _MEGABYTE // 16),
    "MAP_REPLY": Channel("vismap.map_reply_t", 192 * _MEGABYTE),
    "STATUS": Channel("vismap.process_status_t", _MEGABYTE // 16),
    "OCTOMAP_RAW": Channel("vismap.octree_t", 192 * _MEGABYTE),
    "OCTOMAP_COARSE": Channel("vismap.octree_t", 192 * _MEGABYTE),
    "OCTOMAP_INFLATED": Channel("vismap.octree_t", 192 * _MEGABYTE),
    "OCTOMAP_DELTA": Channel("vismap.octree_delta_t", 64 * _MEGABYTE),
    "NAVIGATION": Channel("vismap.navigation_status_t", _MEGABYTE // 16),
    "GRID": Channel("vismap.occupancy_grid_t", 192 * _MEGABYTE),
    "DISTANCES": Channel("vismap.distance_field_t", 64 * _MEGABYTE),
    "POSE_CORRECTION": Channel("vismap.pose_correction_t", 32 * _MEGABYTE),
}
MAX_MESSAGE_BYTES = 192 * _MEGABYTE


def max_bytes_of(channel: str) -> int:
    """The size of the largest message that is accepted on a channel [bytes]."""
    known = CHANNELS.get(channel)
    return known.max_bytes if known else MAX_MESSAGE_BYTES


# Fingerprint of an older version of a type -> the current type, and the bytes that it has more at its end (zeros).
_OLDER: dict[int, tuple[str, int]] = {0xdfd3012ff7311f8a: ("vismap.process_status_t", 4)}


def _completed(data: bytes | memoryview) -> bytes | memoryview:
    """The message in the current version of its type."""
    older = _OLDER.get(int.from_bytes(data[:8], "big")) if len(data) >= 8 else None
    if older is None:
        return data
    name, missing = older
    return struct.pack(">Q", types[name].FINGERPRINT) + bytes(data[8:]) + bytes(missing)


def _checksum_offset(data: bytes | memoryview) -> int:
    """Where the checksum stands: behind fingerprint, utime, seq and source."""
    return 28 + int.from_bytes(data[24:28], "big")


def _checksum_after(data: bytes | memoryview, offset: int) -> int | None:
    value = checksum64(data[offset + 8:])
    return None if value is None else value or 1


def _has_checksum(kind: type[Message]) -> bool:
    names = [entry.name for entry in kind.FIELDS[:4]]
    return names == ["utime", "seq", "source", "checksum"]


def decode(data: bytes | memoryview, kind: type[Message] | None = None) -> Any:
    """The message in `data`, also one of an older version of its type.

    kind: the expected type; None = the one that the first eight bytes name. Raises MessageError on an unknown or other
    type, on impossible lengths, on missing or trailing bytes, and on a wrong checksum.
    """
    data = _completed(data)
    fingerprint = int.from_bytes(data[:8], "big") if len(data) >= 8 else 0
    kind = kind or types.by_fingerprint(fingerprint)
    if kind is None:
        raise MessageError(f"a message of {len(data)} bytes has the type fingerprint {fingerprint:016x}, which is no type "
                           "of vismap; the sender uses another version or type")
    message = kind.decode(data)
    if _has_checksum(kind) and message.checksum != 0:
        expected = _checksum_after(data, _checksum_offset(data))
        if expected is not None and expected != message.checksum & ((1 << 64) - 1):
            raise MessageError(f"{kind.TYPE}: the checksum does not match the content; the message was damaged")
    return message


def encode(message: Message) -> bytes:
    """The bytes of a message, with the checksum if the type has one and XXH3 is there; else the checksum is 0."""
    if not _has_checksum(type(message)):
        return message.encode()
    message.checksum = 0
    data = bytearray(message.encode())
    offset = _checksum_offset(memoryview(data))
    value = _checksum_after(memoryview(data), offset)
    if value is not None:
        struct.pack_into(">Q", data, offset, value)
        message.checksum = value - (1 << 64) if value >> 63 else value
    return bytes(data)


@functools.cache
def types_fingerprint() -> int:
    """Digest of all message types, signed 64 bits: processes with another one cannot exchange messages. 0 = unknown."""
    hashes = b"".join(struct.pack("<Q", types[channel.type].FINGERPRINT) for channel in CHANNELS.values())
    value = checksum64(hashes) or 0
    return value - (1 << 64) if value >> 63 else value


@functools.cache
def version() -> str:
    """The version of vismap that this package belongs to."""
    text = data_file("version.txt", "CMakeLists.txt").read_text(encoding="utf-8")
    found = re.search(r"project\(vismap VERSION ([\d.]+)", text)
    return found.group(1) if found else text.strip()
