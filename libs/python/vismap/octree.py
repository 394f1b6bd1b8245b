"""Free, occupied and unknown space: a reader of OctoMap's .bt and .ot streams, and queries on it."""
from __future__ import annotations

import functools
import os
import pathlib
import re
import struct
from array import array
from typing import Any, Iterator

import numpy as np
import numpy.typing as npt

from .bus import Bus
from .errors import MapError
from .requests import Box, ask

_DEPTH = 16  # levels below the root
_ORIGIN = 1 << (_DEPTH - 1)  # the key of the leaf that begins at 0
_MOST_NODES = 50_000_000
_BT, _OT = b"# Octomap OcTree binary file", b"# Octomap OcTree file"

FREE, OCCUPIED, UNKNOWN = 0, 1, -1


@functools.lru_cache(maxsize=None)
def _children_of(word: int) -> tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]]:
    """Inner children (the highest first), free leaves and occupied leaves of a node of a .bt stream."""
    kinds: tuple[list[int], ...] = ([], [], [], [])
    for child in range(8):
        kinds[word >> (2 * child) & 3].append(child)
    return tuple(reversed(kinds[3])), tuple(kinds[1]), tuple(kinds[2])


class Octree:
    """Space in leaves of different sizes. Coordinates are in the frame of the map, W [m].

    resolution_m: edge length of the smallest leaf. Build one by read_octree(), Octree.from_message(), Octree.from_bytes()
    or Octree.open(). All queries take one point (3,) or many (..., 3).
    """

    def __init__(self, resolution_m: float, codes: npt.NDArray[np.uint64], depths: npt.NDArray[np.uint8],
                 occupied: npt.NDArray[np.bool_]) -> None:
        """codes: where each leaf begins, as interleaved bits of the keys z, y, x; depths: its level, 16 = smallest."""
        order = np.argsort(codes, kind="stable")
        self.resolution_m = resolution_m
        self._begin = codes[order]
        self._span = np.uint64(1) << (np.uint64(3) * (np.uint64(_DEPTH) - depths[order].astype(np.uint64)))
        self._occupied = occupied[order]
        if np.any(self._begin[1:] < self._begin[:-1] + self._span[:-1]):
            raise MapError("octree: two leaves overlap")
        edges = np.exp2(float(_DEPTH) - depths[order].astype(np.float64)) * resolution_m
        corners = np.stack([_compact(self._begin >> np.uint64(axis)) for axis in range(3)], axis=1)
        self._low = (corners.astype(np.float64) - _ORIGIN) * resolution_m  # (N, 3) lower corners [m]
        self._edge = edges  # (N,) [m]
        self._obstacle_low = self._low[self._occupied]
        self._obstacle_high = self._obstacle_low + edges[self._occupied, None]

    def __len__(self) -> int:
        """Number of leaves."""
        return len(self._begin)

    @classmethod
    def from_bytes(cls, data: bytes) -> Octree:
        """Reads a .bt or .ot stream with its text header. Raises MapError on everything that OctoMap cannot have written."""
        header, at = _read_header(data)
        if header["id"] != "OcTree":
            raise MapError(f"octree: the tree is of type {header['id']}; expected OcTree")
        try:
            resolution, size = float(header["res"]), int(header["size"])
        except ValueError:
            raise MapError(f"octree: the header has res {header['res']} and size {header['size']}; expected numbers") from None
        if not 1e-6 < resolution < 1e6 or not 0 <= size <= _MOST_NODES:
            raise MapError(f"octree: the header has res {resolution:g} and size {size}; at most {_MOST_NODES} nodes are read")
        parse = _parse_bt if data.startswith(_BT) else _parse_ot
        codes, depths, occupied = parse(memoryview(data)[at:], size)
        return cls(resolution, np.frombuffer(codes, np.uint64), np.frombuffer(depths, np.uint8),
                   np.frombuffer(occupied, np.uint8).astype(np.bool_))

    @classmethod
    def from_message(cls, message: Any) -> Octree:
        """The octree in an octree_t, the message of OCTOMAP."""
        return cls.from_bytes(message.data)

    @classmethod
    def open(cls, path: str | os.PathLike[str]) -> Octree:
        """Reads a file, such as octree.bt."""
        try:
            return cls.from_bytes(pathlib.Path(path).read_bytes())
        except OSError as error:
            raise MapError(f"{path}: the octree cannot be read ({error.strerror})") from None
        except MapError as error:
            raise MapError(f"{path}: {error}") from None

    def state(self, points_W: npt.ArrayLike) -> npt.NDArray[np.int8]:
        """FREE, OCCUPIED or UNKNOWN of each point [m]; shape (...). What no leaf covers is unknown."""
        points = _points(points_W)
        keys = np.floor(points / self.resolution_m) + _ORIGIN
        inside = np.all((keys >= 0) & (keys < 2 * _ORIGIN), axis=-1)
        clipped = np.clip(np.nan_to_num(keys), 0, 2 * _ORIGIN - 1).astype(np.uint64)
        codes = _spread(clipped[..., 0]) | _spread(clipped[..., 1]) << np.uint64(1) | _spread(clipped[..., 2]) << np.uint64(2)
        states = np.full(codes.shape, UNKNOWN, np.int8)
        if len(self._begin) == 0:
            return states
        leaf = np.maximum(np.searchsorted(self._begin, codes, side="right") - 1, 0)
        found = inside & (self._begin[leaf] <= codes) & (codes < self._begin[leaf] + self._span[leaf])
        states[found] = self._occupied[leaf[found]]
        return states

    def is_free(self, points_W: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Whether each point [m] is in free space; shape (...). Unknown space is not free."""
        free: npt.NDArray[np.bool_] = self.state(points_W) == FREE
        return free

    def is_occupied(self, points_W: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Whether each point [m] is in occupied space; shape (...)."""
        occupied: npt.NDArray[np.bool_] = self.state(points_W) == OCCUPIED
        return occupied

    def distance(self, points_W: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Distance of each point to the nearest occupied leaf [m]; 0 inside of one, inf when there is none; shape (...).

        What is unknown counts as no obstacle, unless the tree was read with unknown_occupied=True.
        """
        points = _points(points_W)
        flat = points.reshape(-1, 3)
        return np.array([self._nearest(point)[0] for point in flat]).reshape(points.shape[:-1])

    def nearest_obstacle(self, point_W: npt.ArrayLike) -> tuple[float, npt.NDArray[np.float64]]:
        """Distance of one point to the nearest occupied leaf [m], and the point (3,) of that leaf which is nearest."""
        point = _points(point_W)
        if point.shape != (3,):
            raise ValueError(f"expected one point with 3 coordinates, found an array of shape {point.shape}")
        return self._nearest(point)

    def leaves(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.bool_]]:
        """Centres (N, 3) [m], edge lengths (N,) [m], and whether they are occupied (N,), of all leaves."""
        return self._low + self._edge[:, None] / 2, self._edge, self._occupied

    def _nearest(self, point: npt.NDArray[np.float64]) -> tuple[float, npt.NDArray[np.float64]]:
        if len(self._obstacle_low) == 0:
            return float("inf"), np.full(3, np.nan)
        nearest = np.clip(point, self._obstacle_low, self._obstacle_high)
        squared = np.sum((nearest - point) ** 2, axis=1)
        best = int(np.argmin(squared))
        return float(np.sqrt(squared[best])), nearest[best]


def read_octree(bus: Bus, box_W: Box | None = None, resolution_m: float = 0.0, unknown_occupied: bool = False,
                timeout: float = 60.0) -> Octree:
    """The octree of the running map server.

    box_W: two corners [m]; only what is inside. resolution_m: edge of the smallest leaf; 0 = the server's own.
    unknown_occupied: unknown space inside of the box counts as occupied, as a careful planner wants it.
    """
    reply = ask(bus, "octree", box_W=box_W, resolution_m=resolution_m, unknown_occupied=unknown_occupied, timeout=timeout)
    return Octree.from_bytes(reply.payload)


def tree_without(bus: Bus, without: str, box_W: Box | None = None, resolution_m: float = 0.0, inflate_m: float = 0.0,
                 timeout: float = 60.0) -> Octree:
    """A closed octree without some objects, to plan how to grasp them: their place is free, what they hid is not.

    without: "id=7", "id=s12" (a segment) or "class=cup", several separated by ";"; behind each may stand ":unknown", then its
    place is unknown, or ":inflate=0.1", then it is larger by this [m]. box_W: two corners [m]; only what is inside, which is
    faster. inflate_m: radius of the robot. The octomap exporter answers. Raises RequestError when there is no such object.
    """
    reply = ask(bus, "octomap", box_W=box_W, resolution_m=resolution_m, unknown_occupied=True, inflate_m=inflate_m,
                timeout=timeout, without=without)
    return Octree.from_bytes(reply.payload)


def _points(points_W: npt.ArrayLike) -> npt.NDArray[np.float64]:
    points = np.asarray(points_W, np.float64)
    if points.ndim < 1 or points.shape[-1] != 3:
        raise ValueError(f"expected points with 3 coordinates, found an array of shape {points.shape}")
    return points


def _spread(values: npt.NDArray[np.uint64]) -> npt.NDArray[np.uint64]:
    """Moves bit i of 16-bit numbers to bit 3 i."""
    for shift, mask in ((32, 0x001f00000000ffff), (16, 0x001f0000ff0000ff), (8, 0x100f00f00f00f00f),
                        (4, 0x10c30c30c30c30c3), (2, 0x1249249249249249)):
        values = (values | values << np.uint64(shift)) & np.uint64(mask)
    return values


def _compact(values: npt.NDArray[np.uint64]) -> npt.NDArray[np.uint64]:
    """The inverse of _spread: takes the bits 0, 3, 6, ..."""
    values = values & np.uint64(0x1249249249249249)
    for shift, mask in ((2, 0x10c30c30c30c30c3), (4, 0x100f00f00f00f00f), (8, 0x001f0000ff0000ff), (16, 0x001f00000000ffff),
                        (32, 0x00000000001fffff)):
        values = (values | values >> np.uint64(shift)) & np.uint64(mask)
    return values


def _read_header(data: bytes) -> tuple[dict[str, str], int]:
    """The fields of the text header, and where the nodes begin."""
    if not data.startswith((_BT, _OT)):
        raise MapError("octree: the bytes do not begin as a .bt or .ot file of OctoMap")
    found = re.search(rb"^data\n", data[:4096], re.MULTILINE)
    if not found:
        raise MapError("octree: the header has no end; expected a line 'data'")
    header = dict(line.split(None, 1) for line in data[:found.start()].decode("latin-1").splitlines()
                  if not line.startswith("#") and len(line.split(None, 1)) == 2)
    missing = {"id", "size", "res"} - header.keys()
    if missing:
        raise MapError(f"octree: the header has no {', '.join(sorted(missing))}")
    return header, found.end()


_Leaves = tuple["array[int]", "array[int]", "array[int]"]


def _check_end(found: int, size: int, left: int) -> None:
    if found != size:
        raise MapError(f"octree: the header promises {size} nodes, found {found}")
    if left:
        raise MapError(f"octree: {left} bytes are left after the last node")


def _parse_bt(data: memoryview, size: int) -> _Leaves:
    """Leaves of a .bt stream: two bytes for every inner node, its subtrees behind it."""
    codes, depths, occupied = array("Q"), array("B"), array("B")
    if size == 0:
        _check_end(0, 0, len(data))
        return codes, depths, occupied
    words: Iterator[tuple[Any, ...]] = struct.iter_unpack("<H", data[:len(data) // 2 * 2])
    stack, nodes, read = [(0, 0)], 1, 0
    while stack:
        code, depth = stack.pop()
        entry = next(words, None)
        if entry is None or depth >= _DEPTH:
            raise MapError("octree: the nodes are truncated" if entry is None else "octree: the tree is deeper than 16 levels")
        read += 1
        inner, free, full = _children_of(entry[0])
        depth += 1
        shift = 3 * (_DEPTH - depth)
        for child in free:
            codes.append(code | child << shift)
            depths.append(depth)
            occupied.append(0)
        for child in full:
            codes.append(code | child << shift)
            depths.append(depth)
            occupied.append(1)
        nodes += len(inner) + len(free) + len(full)
        if nodes > size:
            raise MapError(f"octree: the header promises {size} nodes, found more")
        for child in inner:
            stack.append((code | child << shift, depth))
    _check_end(nodes, size, len(data) - 2 * read)
    return codes, depths, occupied


def _parse_ot(data: memoryview, size: int) -> _Leaves:
    """Leaves of an .ot stream: log odds (float) and a mask of the children for every node, its subtrees behind it."""
    codes, depths, occupied = array("Q"), array("B"), array("B")
    if size == 0:
        _check_end(0, 0, len(data))
        return codes, depths, occupied
    if len(data) < 5 * size:
        raise MapError(f"octree: the nodes are truncated: expected {5 * size} bytes, found {len(data)}")
    entries: Iterator[tuple[Any, ...]] = struct.iter_unpack("<fB", data[:5 * size])
    stack, read = [(0, 0)], 0
    while stack:
        code, depth = stack.pop()
        entry = next(entries, None)
        if entry is None or depth > _DEPTH:
            raise MapError(f"octree: the header promises {size} nodes, found more" if entry is None
                           else "octree: the tree is deeper than 16 levels")
        read += 1
        log_odds, mask = entry
        if mask == 0:
            codes.append(code)
            depths.append(depth)
            occupied.append(log_odds >= 0)
            continue
        if depth == _DEPTH:
            raise MapError("octree: the tree is deeper than 16 levels")
        shift = 3 * (_DEPTH - depth - 1)
        for child in range(7, -1, -1):
            if mask >> child & 1:
                stack.append((code | child << shift, depth + 1))
    _check_end(read, size, len(data) - 5 * read)
    return codes, depths, occupied
