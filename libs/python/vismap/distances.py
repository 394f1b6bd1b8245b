"""Distances at the centres of leaves, in blocks: the answer to the verb distances, and the messages of DISTANCES."""
from __future__ import annotations

import functools
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from .bus import Bus
from .errors import MapError
from .messages import decode, types
from .native import zstd_content_size, zstd_decompress
from .requests import Box, ask
from .updates import BlockIndex

Lengths = npt.NDArray[np.float32]
_SIDE = 8  # leaves along the edge of a block
_LEAVES = _SIDE**3
_COUNT = struct.Struct("<I")
_PER_BLOCK = 13  # its index, and whether it has distances [bytes]
_VALUES = 4 * _LEAVES  # of a block that has distances [bytes]
_BEYOND = 32767  # more than the limit
_MOST_BLOCKS, _MOST_INDEX = 16384, 1 << 27


@dataclass(frozen=True)
class Distances:
    """Distances from the centres of leaves to the nearest face of an obstacle and of unknown space, in blocks of 8 x 8 x 8
    leaves. A leaf with index i covers [i r, (i + 1) r) along each axis of W, r = resolution_m. N blocks."""

    resolution_m: float  # edge of a leaf [m]
    limit_m: float  # distances are exact up to here; what is farther away is limit_m [m]
    blocks: npt.NDArray[np.int32]  # (N, 3) indices of the blocks, ascending: that of the first leaf divided by 8
    obstacle_m: Lengths  # (N, 8, 8, 8) by x, y, z in the block [m]; 0 in occupied leaves, and in blocks that are unknown everywhere
    unknown_m: Lengths  # (N, 8, 8, 8) [m]; 0 in unknown leaves
    map_id: str
    revision: int  # of the map: the number of its frames
    utime: int  # of the newest frame in the map [us]
    base_revision: int  # of an update: the revision that it changes; -1 = these are all blocks that were asked for

    def at(self, points_W: npt.ArrayLike) -> tuple[Lengths, Lengths]:
        """Distance to obstacles and to unknown space, (...) each [m], from the centre of the leaf around one point (3,) [m] or
        many (..., 3). A point is at most half the diagonal of a leaf nearer to something. 0 where there is no block."""
        points = np.asarray(points_W, np.float64)
        if points.shape[-1:] != (3,) or not np.all(np.isfinite(points)):
            raise ValueError(f"points_W has the shape {points.shape}; expected (..., 3), all finite [m]")
        limit = _MOST_INDEX * _SIDE * self.resolution_m
        leaves = np.floor(np.clip(points.reshape(-1, 3), -limit, limit) / self.resolution_m).astype(np.int64)
        rows = np.array([self._row_of.get((x, y, z), -1) for x, y, z in (leaves // _SIDE).tolist()], np.intp)
        inside = leaves % _SIDE
        found = rows >= 0
        lengths = []
        for values in (self.obstacle_m, self.unknown_m):
            flat = np.zeros(len(rows), np.float32)
            flat[found] = values[(rows[found], *inside[found].T)]
            lengths.append(flat.reshape(points.shape[:-1]))
        return lengths[0], lengths[1]

    @functools.cached_property
    def _row_of(self) -> dict[BlockIndex, int]:
        return {(x, y, z): row for row, (x, y, z) in enumerate(self.blocks.tolist())}


def distances(bus: Bus, box_W: Box, limit_m: float | None = None, resolution_m: float = 0.0, without: str = "",
              timeout: float = 60.0) -> Distances:
    """Distances in all blocks of 8 x 8 x 8 leaves that a box touches. The octomap exporter answers.

    box_W: two corners [m]. limit_m: distances are exact up to here; None = as in the exporter's config, or 2 m. resolution_m:
    edge of a leaf; 0 = as in the config. without: objects that are left out, see procs/README.md, Without objects.
    """
    argument = "" if limit_m is None else f"limit={float(limit_m)!r}"
    reply = ask(bus, "distances", argument, box_W=box_W, resolution_m=resolution_m, without=without, timeout=timeout)
    return distances_of(decode(reply.payload, types["vismap.distance_field_t"]))


def distances_of(message: Any) -> Distances:
    """The distances in a distance_field_t, of a reply or of DISTANCES. Raises MapError on a payload that contradicts the
    message or itself. On DISTANCES, a message with part and parts has a part of an update."""
    where = f"distance_field_t of map '{message.map_id}', revision {message.revision}"
    if message.encoding != 1 or not 0 <= message.n_blocks <= _MOST_BLOCKS:
        raise MapError(f"{where}: encoding {message.encoding} with {message.n_blocks} blocks, expected 1 with at most {_MOST_BLOCKS}")
    if not 0 < message.resolution_m <= 1000 or not 0 < message.limit_m <= 1e6:
        raise MapError(f"{where}: leaves of {message.resolution_m} m and a limit of {message.limit_m} m; expected lengths above 0")
    size, most = zstd_content_size(message.payload), _COUNT.size + message.n_blocks * (_PER_BLOCK + _VALUES)
    if not _COUNT.size <= size <= most:
        raise MapError(f"{where}: the payload expands to {size} bytes, expected {_COUNT.size} to {most}")
    raw = zstd_decompress(message.payload, size)
    if _COUNT.unpack_from(raw)[0] != message.n_blocks:
        raise MapError(f"{where}: the payload has another number of blocks than the message")
    blocks, squares = _unpack(raw[_COUNT.size:], message.n_blocks, where)
    lengths = np.sqrt(squares, dtype=np.float32) * np.float32(message.resolution_m / 2)
    lengths[squares == _BEYOND] = message.limit_m
    return Distances(message.resolution_m, message.limit_m, blocks, lengths[0], lengths[1], message.map_id, message.revision,
                     message.utime, -1 if message.full else message.base_revision)


def _unpack(raw: bytes, count: int, where: str) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.uint16]]:
    """Indices (N, 3), and squared distances in half leaves to obstacles and unknown leaves (2, N, 8, 8, 8)."""
    if len(raw) < count * _PER_BLOCK:
        raise MapError(f"{where}: blocks are missing")
    blocks = np.frombuffer(raw, "<i4", 3 * count).reshape(count, 3)
    dx, dy, dz = np.diff(blocks.astype(np.int64), axis=0).T
    if not np.all((dx > 0) | (dx == 0) & ((dy > 0) | (dy == 0) & (dz > 0))):
        raise MapError(f"{where}: the blocks are not in ascending order")
    if np.any(np.abs(blocks.astype(np.int64)) >= _MOST_INDEX):
        raise MapError(f"{where}: the index of a block is out of range")
    kinds = np.frombuffer(raw, np.uint8, count, 12 * count)
    values = np.frombuffer(raw, np.uint8, offset=_PER_BLOCK * count)
    known = np.flatnonzero(kinds)
    if np.any(kinds > 1) or len(values) != len(known) * _VALUES:
        raise MapError(f"{where}: distances are missing or left over")
    low_high = values.reshape(len(known), 2, 2, _SIDE, _SIDE, _SIDE).astype(np.uint16)  # to what, byte, z, y, x
    joined = low_high[:, :, 0] | low_high[:, :, 1] << np.uint16(8)
    if np.any(joined > _BEYOND):
        raise MapError(f"{where}: a distance is above {_BEYOND}")
    squares = np.zeros((2, count, _SIDE, _SIDE, _SIDE), np.uint16)
    squares[:, known] = joined.transpose(1, 0, 4, 3, 2)
    return blocks.astype(np.int32), squares
