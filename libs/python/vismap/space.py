"""Free, occupied and unknown voxels as numpy arrays: a copy of the space that follows the updates on MAP_DELTA."""
from __future__ import annotations

import functools
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from .bus import Bus
from .errors import MapError
from .native import checksum64, digest128, zstd_content_size, zstd_decompress
from .octree import FREE, OCCUPIED, UNKNOWN
from .updates import BlockIndex, Follower, Live, Part

States = npt.NDArray[np.int8]
_SIDE = 8  # voxels along the edge of a block
_VOXELS = _SIDE**3
_HEAD = struct.Struct("<BBdI")  # version, whether it is complete, voxel size [m], number of blocks
_PLANES = 2 * _VOXELS // 8  # of a mixed block: one bit per voxel for free, then for occupied [bytes]
_PER_BLOCK = 13  # its index and its kind [bytes]
_MIXED = 3  # kind of a block; less = all voxels are unknown, free, occupied
_UNIFORM = (UNKNOWN, FREE, OCCUPIED)
_MOST_BLOCKS, _MOST_INDEX = 65536, 1 << 27


@dataclass(frozen=True)
class Space:
    """Voxels of the map, in blocks of 8 x 8 x 8. A voxel with index i covers [i v, (i + 1) v) along each axis of W, v =
    voxel_size_m. Voxels of blocks that are not listed are unknown. N blocks."""

    voxel_size_m: float  # [m]; 0 = there is no map yet
    blocks: npt.NDArray[np.int32]  # (N, 3) indices of the blocks, ascending: that of the first voxel divided by 8
    states: States  # (N, 8, 8, 8) FREE, OCCUPIED or UNKNOWN, by x, y, z in the block
    map_id: str = ""
    revision: int = -1  # of the map: the number of its frames; -1 = there is no map yet
    utime: int = 0  # of the newest frame in the map [us]
    base_revision: int = -1  # of an update: the revision that it changes; -1 = these are all voxels of the map

    def centers_W(self, state: int) -> npt.NDArray[np.float64]:
        """The centres [m] of the voxels with a state, FREE or OCCUPIED, (K, 3)."""
        block, x, y, z = np.nonzero(self.states == state)
        voxels = self.blocks[block].astype(np.int64) * _SIDE + np.stack([x, y, z], axis=1)
        centers: npt.NDArray[np.float64] = (voxels + 0.5) * self.voxel_size_m
        return centers

    def at(self, points_W: npt.ArrayLike) -> States:
        """FREE, OCCUPIED or UNKNOWN at one point (3,) [m] or many (..., 3)."""
        points = np.asarray(points_W, np.float64)
        if points.shape[-1:] != (3,) or not np.all(np.isfinite(points)):
            raise ValueError(f"points_W has the shape {points.shape}; expected (..., 3), all finite [m]")
        if not len(self.blocks):
            return np.full(points.shape[:-1], UNKNOWN, np.int8)
        flat = points.reshape(-1, 3)
        limit = _MOST_INDEX * _SIDE * self.voxel_size_m
        voxels = np.floor(np.clip(flat, -limit, limit) / self.voxel_size_m).astype(np.int64)
        rows = self._rows_of(voxels // _SIDE)
        inside = voxels - voxels // _SIDE * _SIDE
        states = self.states[rows, inside[:, 0], inside[:, 1], inside[:, 2]]
        return np.where(rows >= 0, states, np.int8(UNKNOWN)).reshape(points.shape[:-1])

    @functools.cached_property
    def _row_of(self) -> dict[BlockIndex, int]:
        return {(x, y, z): row for row, (x, y, z) in enumerate(self.blocks.tolist())}

    def _rows_of(self, blocks: npt.NDArray[np.int64]) -> npt.NDArray[np.intp]:
        """Rows of the blocks; -1 = not listed."""
        different, which = np.unique(blocks, axis=0, return_inverse=True)
        rows = np.array([self._row_of.get((x, y, z), -1) for x, y, z in different.tolist()], np.intp)
        found: npt.NDArray[np.intp] = rows[which.reshape(-1)]
        return found


def space_of(message: Any) -> Space:
    """The voxels in a map_delta_t. Raises MapError on a payload that contradicts the message or itself.

    When message.full is set they are (part of) all voxels of the map; else those that have changed since base_revision,
    among them blocks that have become unknown everywhere.
    """
    where = f"map_delta_t of map '{message.map_id}', revision {message.revision}"
    if message.encoding != 1 or not 0 <= message.n_blocks <= _MOST_BLOCKS:
        raise MapError(f"{where}: encoding {message.encoding} with {message.n_blocks} blocks, expected 1 with at most {_MOST_BLOCKS}")
    most = _HEAD.size + message.n_blocks * (_PER_BLOCK + _PLANES)
    size = zstd_content_size(message.payload)
    if not _HEAD.size <= size <= most:
        raise MapError(f"{where}: the payload expands to {size} bytes, expected {_HEAD.size} to {most}")
    raw = zstd_decompress(message.payload, size)
    version, complete, voxel_size_m, count = _HEAD.unpack_from(raw)
    if (version, bool(complete), voxel_size_m, count) != (1, bool(message.full), message.voxel_size_m, message.n_blocks):
        raise MapError(f"{where}: the head of the payload contradicts the message, or has another version than 1")
    if not 1e-4 < voxel_size_m < 1e3:
        raise MapError(f"{where}: the voxel size {voxel_size_m} is no plausible length [m]")
    blocks, states = _unpack(raw[_HEAD.size:], count, where)
    return Space(voxel_size_m, blocks, states, message.map_id, message.revision, message.utime,
                 -1 if message.full else message.base_revision)


def _unpack(raw: bytes, count: int, where: str) -> tuple[npt.NDArray[np.int32], States]:
    if len(raw) < count * _PER_BLOCK:
        raise MapError(f"{where}: blocks are missing")
    steps = np.frombuffer(raw, "<i4", 3 * count).reshape(count, 3)
    blocks = np.cumsum(steps, axis=0, dtype=np.int64)
    if count and np.abs(blocks).max() >= _MOST_INDEX:
        raise MapError(f"{where}: the index of a block is out of range")
    dx, dy, dz = (blocks[1:] - blocks[:-1]).T
    ascends = (dx > 0) | (dx == 0) & ((dy > 0) | (dy == 0) & (dz > 0))
    if not np.all(ascends):
        raise MapError(f"{where}: the blocks are not in ascending order")
    kinds = np.frombuffer(raw, np.uint8, count, 12 * count)
    planes = raw[count * _PER_BLOCK:]
    mixed = np.flatnonzero(kinds == _MIXED)
    if np.any(kinds > _MIXED) or len(planes) != _PLANES * len(mixed):
        raise MapError(f"{where}: a block is of an unknown kind, or voxels are missing or left over")
    states = np.empty((count, _SIDE, _SIDE, _SIDE), np.int8)
    for kind, state in enumerate(_UNIFORM):
        states[kinds == kind] = state
    bits = np.unpackbits(np.frombuffer(planes, np.uint8).reshape(len(mixed), 2, _VOXELS // 8), axis=2, bitorder="little")
    free, occupied = bits[:, 0].astype(bool), bits[:, 1].astype(bool)
    if np.any(free & occupied):
        raise MapError(f"{where}: a voxel is both free and occupied")
    flat = np.where(free, np.int8(FREE), np.where(occupied, np.int8(OCCUPIED), np.int8(UNKNOWN)))
    states[mixed] = flat.reshape(-1, _SIDE, _SIDE, _SIDE).transpose(0, 3, 2, 1)  # z, y, x -> x, y, z
    return blocks.astype(np.int32), states


class SpaceFollower(Follower[States, Space]):
    """A copy of the space, made of the messages of MAP_DELTA; see Follower. space() is its present state."""

    TYPE = "vismap.map_delta_t"
    WHAT = "space"

    def __init__(self, max_bytes: int = 2 << 30, max_wait_s: float = 30.0) -> None:
        super().__init__(max_bytes, max_wait_s)
        self._voxel_size_m = 0.0

    @property
    def digest(self) -> str:
        """Digest of the space, the same as `vismap-map digests` prints for an equal one; "" without XXH3."""
        sums = [0, 0]
        for index, states in self._blocks.items():
            checksum = max(1, checksum64(_content(index, states)) or 0)
            sums = [sums[0] + checksum, sums[1] + _scramble(checksum)]
        return digest128(struct.pack("<dQQQ", self._voxel_size_m, len(self._blocks), *(value % (1 << 64) for value in sums)))

    def space(self) -> Space:
        """All voxels. Do not write to the arrays."""
        return self.copied()

    def _decode_part(self, message: Any) -> Part[States]:
        space = space_of(message)
        if not message.full and space.voxel_size_m != self._voxel_size_m:
            raise MapError(f"{self._name(message)}: the voxels have {space.voxel_size_m} m, those of the copy {self._voxel_size_m} m")
        self._voxel_size_m = space.voxel_size_m
        blocks: dict[BlockIndex, States | None] = {}
        known = np.any(space.states != UNKNOWN, axis=(1, 2, 3))
        for (x, y, z), states, has_some in zip(space.blocks.tolist(), space.states, known.tolist()):
            blocks[(x, y, z)] = states if has_some else None
        return Part(blocks, sum(self._bytes_of(states) for states in blocks.values() if states is not None))

    def _bytes_of(self, block: States) -> int:
        return _VOXELS + 250

    def _join(self, blocks: list[tuple[BlockIndex, States]]) -> Space:
        indices = np.array([index for index, _ in blocks], np.int32).reshape(-1, 3)
        states = np.stack([block for _, block in blocks]) if blocks else np.empty((0, _SIDE, _SIDE, _SIDE), np.int8)
        return Space(self._voxel_size_m, indices, states, self.map_id, self.revision, self.utime)


def _content(index: BlockIndex, states: States) -> bytes:
    """What libs/freespace/occupancy_digest.cc hashes of a block."""
    first = int(states.flat[0])
    if np.all(states == first):
        return struct.pack("<3iI", *index, _UNIFORM.index(first))
    by_z = states.transpose(2, 1, 0).reshape(-1)
    planes = np.packbits(np.stack([by_z == FREE, by_z == OCCUPIED]), axis=1, bitorder="little")
    return struct.pack("<3iI", *index, _MIXED) + planes.tobytes()


def _scramble(value: int) -> int:
    for _ in range(2):
        value = (value ^ value >> 32) * 0xD6E8FEB86659FD93 % (1 << 64)
    return value ^ value >> 32


class LiveSpace(Live[States, Space]):
    """Follows the free and occupied space of the running server, as LiveMap follows its surface.

        with vismap.Bus() as bus, vismap.LiveSpace(bus) as live:
            obstacles = live.wait(revision=10).centers_W(vismap.OCCUPIED)
    """

    def __init__(self, bus: Bus, max_mb: int = 2048) -> None:
        super().__init__(bus, SpaceFollower(max_mb << 20), "MAP_DELTA", "snapshot")

    def space(self) -> Space:
        """The voxels as far as they are known now; empty, with revision -1, before the first update has come."""
        return self.now()

    def __enter__(self) -> LiveSpace:
        return self
