"""The live map as numpy arrays: a copy of the surface that follows the updates on MESH_DELTA."""
from __future__ import annotations

import logging
import struct
import threading
import time
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Mapping

import numpy as np
import numpy.typing as npt

from . import messages
from .bus import Bus, now_utime
from .errors import BusError, MapError, MessageError, WaitTimeout
from .native import checksum64, digest128

_log = logging.getLogger("vismap")
BlockIndex = tuple[int, int, int]


@dataclass(frozen=True)
class Mesh:
    """The surface of the map in the world frame W, as triangles. N vertices, M triangles."""

    vertices: npt.NDArray[np.float32]  # (N, 3) [m]
    normals: npt.NDArray[np.float32]  # (N, 3) unit vectors that point to free space; 0 = unknown
    colors: npt.NDArray[np.uint8]  # (N, 3) red, green, blue
    segment: npt.NDArray[np.int32]  # (N,) segment labels; 0 = none
    instance: npt.NDArray[np.int32]  # (N,) ids of objects; 0 = none
    class_id: npt.NDArray[np.uint16]  # (N,) classes of the objects; 0 = unknown
    faces: npt.NDArray[np.int32]  # (M, 3) indices of vertices, counter-clockwise when seen from free space
    map_id: str = ""
    revision: int = -1  # of the map: the number of its frames; -1 = there is no map yet
    utime: int = 0  # of the newest frame in the map [us]

    def of_instance(self, instance: int) -> Mesh:
        """The part of the surface that belongs to one object: the faces of which all corners do."""
        kept = self.faces[np.all(self.instance[self.faces] == instance, axis=1)]
        used, faces = np.unique(kept, return_inverse=True)
        return Mesh(self.vertices[used], self.normals[used], self.colors[used], self.segment[used], self.instance[used],
                    self.class_id[used], faces.reshape(-1, 3).astype(np.int32), self.map_id, self.revision, self.utime)


@dataclass(frozen=True)
class _Block:
    vertices: npt.NDArray[np.float32]
    normals: npt.NDArray[np.float32]
    colors: npt.NDArray[np.uint8]
    ids: npt.NDArray[np.int32]  # (n, 3): segment, instance, class
    faces: npt.NDArray[np.int32]
    hash: int

    @property
    def bytes(self) -> int:
        return 500 + 39 * len(self.vertices) + 12 * len(self.faces)


def _columns(*arrays: npt.NDArray[Any]) -> npt.NDArray[Any]:
    return np.stack(arrays, axis=1)


def _restore(message: Any) -> npt.NDArray[np.float32]:
    """Positions of the vertices in W [m], rounded as the C++ code rounds them."""
    steps = _columns(message.x, message.y, message.z).view(np.uint16).astype(np.float32)
    offsets = steps * np.float32(2) / np.float32(65535) - np.float32(0.5)
    edge = float(message.edge_m)
    positions: npt.NDArray[np.float32] = (message.index.astype(np.float64) * edge + offsets.astype(np.float64) * edge).astype(np.float32)
    return positions


def _decode_block(message: Any) -> _Block:
    where = f"mesh block {tuple(int(i) for i in message.index)}"
    if not 0 < message.edge_m < 1e3:
        raise MapError(f"{where}: edge_m is {message.edge_m}, expected (0, 1000) m")
    faces = _columns(message.a, message.b, message.c).astype(np.int32)
    if faces.size and (faces.min() < 0 or faces.max() >= message.n_vertices):
        raise MapError(f"{where}: a triangle refers to a vertex that is not there; there are {message.n_vertices}")
    normals = _columns(message.nx, message.ny, message.nz).astype(np.float32)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    np.divide(normals, lengths, out=normals, where=lengths > 0)
    colors = _columns(*(np.frombuffer(plane, np.uint8) for plane in (message.red, message.green, message.blue)))
    classes = message.class_id.view(np.uint16).astype(np.int32)
    return _Block(_restore(message), normals, colors, _columns(message.segment, message.instance, classes), faces,
                  max(1, checksum64(message.encode()) or 0))


@dataclass(frozen=True)
class _Part:
    blocks: Mapping[BlockIndex, _Block | None]  # None = the block has no surface any more
    bytes: int


class MeshFollower:
    """A copy of the surface, made of the messages of MESH_DELTA. It has no clock and no bus of its own.

    An update applies only to the revision that it is based on, so that the copy always equals an earlier state of the
    map. When one is missing, `in_sync` is False, and `position` is the argument of the request for what is missing.
    """

    def __init__(self, max_bytes: int = 2 << 30, max_wait_s: float = 30.0) -> None:
        self.map_id = ""
        self.revision = -1
        self.utime = 0
        self.in_sync = False
        self.gaps = 0  # how often an update was missing
        self._max_bytes, self._max_wait_s = max_bytes, max_wait_s
        self._blocks: dict[BlockIndex, _Block] = {}
        self._bytes = 0
        self._parts: dict[int, _Part] = {}  # of the update that is being collected
        self._staged: tuple[Any, ...] | None = None
        self._staged_since = 0.0
        self._joined: Mesh | None = None

    @property
    def position(self) -> str:
        """MAP_ID@REVISION of the copy; "" when it is empty."""
        return f"{self.map_id}@{self.revision}" if self.revision >= 0 else ""

    @property
    def digest(self) -> str:
        """Digest of the surface, the same as `vismap-map digests` prints for an equal one; "" without XXH3."""
        total = sum(block.hash for block in self._blocks.values()) & ((1 << 64) - 1)
        return digest128(struct.pack("<QQ", len(self._blocks), total))

    def apply(self, data: bytes, now: float) -> bool:
        """Adds the bytes of a MESH_DELTA at a time [s]. Returns whether the copy has advanced. Raises MapError or
        MessageError on inconsistent bytes; the copy stays as it was."""
        message = messages.decode(data, messages.types["vismap.mesh_delta_t"])
        if not 0 <= message.part < message.parts:
            raise MapError(f"mesh_delta_t of map '{message.map_id}': it is part {message.part} of {message.parts}")
        if not self._wanted(message, now):
            return False
        self._parts[message.part] = self._decode_part(message)
        self._staged_since = now
        if sum(part.bytes for part in self._parts.values()) > self._max_bytes:
            self._drop_parts()
            self._miss()
            raise MapError(f"the surface needs more than the allowed {self._max_bytes} bytes; give LiveMap a larger max_mb")
        if len(self._parts) < message.parts:
            return False
        self._apply_parts(message)
        return True

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

    @staticmethod
    def _decode_part(message: Any) -> _Part:
        blocks: dict[BlockIndex, _Block | None] = {}
        last: BlockIndex | None = None
        for block in message.blocks:
            index = (int(block.index[0]), int(block.index[1]), int(block.index[2]))
            if last is not None and not last < index:
                raise MapError(f"mesh_delta_t of map '{message.map_id}': the blocks are not in ascending order")
            decoded = _decode_block(block)
            blocks[index] = decoded if block.n_vertices else None
            last = index
        return _Part(blocks, sum(block.bytes for block in blocks.values() if block is not None))

    def _apply_parts(self, message: Any) -> None:
        if message.full:
            self._blocks, self._bytes = {}, 0
        for _, part in sorted(self._parts.items()):
            for index, block in part.blocks.items():
                old = self._blocks.pop(index, None)
                self._bytes -= old.bytes if old is not None else 0
                if block is not None:
                    self._blocks[index] = block
                    self._bytes += block.bytes
        self._drop_parts()
        self._joined = None
        self.map_id, self.revision, self.utime, self.in_sync = message.map_id, message.revision, message.utime, True
        if self._bytes > self._max_bytes:
            self._blocks, self._bytes, self.revision = {}, 0, -1
            self._miss()
            raise MapError(f"the surface needs more than the allowed {self._max_bytes} bytes; give LiveMap a larger max_mb")

    def give_up_stale_parts(self, now: float) -> int:
        """Drops the parts of an update of which the others have not come for too long. Returns how many."""
        if self._staged is None or now - self._staged_since < self._max_wait_s:
            return 0
        dropped = len(self._parts)
        self._drop_parts()
        return dropped

    def mesh(self) -> Mesh:
        """The whole surface, by ascending index of the blocks. Blocks do not share vertices. Do not write to the arrays."""
        if self._joined is None:
            self._joined = self._join([self._blocks[index] for index in sorted(self._blocks)])
        return self._joined

    def _join(self, blocks: list[_Block]) -> Mesh:
        first = np.cumsum([0] + [len(block.vertices) for block in blocks])

        def stacked(parts: list[npt.NDArray[Any]], kind: Any) -> npt.NDArray[Any]:
            return np.concatenate(parts) if parts else np.zeros((0, 3), kind)
        ids = stacked([block.ids for block in blocks], np.int32)
        faces = stacked([block.faces + np.int32(start) for block, start in zip(blocks, first)], np.int32)
        return Mesh(stacked([block.vertices for block in blocks], np.float32),
                    stacked([block.normals for block in blocks], np.float32),
                    stacked([block.colors for block in blocks], np.uint8), ids[:, 0].copy(), ids[:, 1].copy(),
                    ids[:, 2].astype(np.uint16), faces, self.map_id, self.revision, self.utime)

    def _drop_parts(self) -> None:
        self._parts, self._staged = {}, None

    def _miss(self) -> None:
        # Staged parts stay, since the other parts of that update may still come.
        self.gaps += self.in_sync
        self.in_sync = False


class LiveMap:
    """Follows the map of the running server; a thread of its own does so. Missed updates are requested again.

        with vismap.Bus() as bus, vismap.LiveMap(bus) as live:
            mesh = live.wait(revision=10)
    """

    _REQUEST_S = 2.0  # between two requests for what is missing
    _TURN_S = 0.25

    def __init__(self, bus: Bus, max_mb: int = 2048) -> None:
        self._bus = bus
        self._follower = MeshFollower(max_mb << 20)
        self._updates = bus.subscribe("MESH_DELTA", capacity=1000)
        self._changed = threading.Condition()
        self._closing = False
        self._next_request = 0.0
        self._error = ""
        self._thread = threading.Thread(target=self._follow, name="vismap live map", daemon=True)
        self._thread.start()

    def mesh(self) -> Mesh:
        """The surface as far as it is known now; empty, with revision -1, before the first update has come."""
        with self._changed:
            return self._follower.mesh()

    @property
    def digest(self) -> str:
        """Digest of the surface; see MeshFollower.digest."""
        with self._changed:
            return self._follower.digest

    @property
    def gaps(self) -> int:
        """How often an update was missing."""
        return self._follower.gaps

    def wait(self, revision: int = 0, timeout: float = 60.0) -> Mesh:
        """The surface once it is complete and has at least `revision` frames. Raises WaitTimeout after `timeout` [s]."""
        with self._changed:
            found = self._changed.wait_for(lambda: self._follower.in_sync and self._follower.revision >= revision, timeout)
            if not found:
                raise WaitTimeout(
                    f"the map has not reached revision {revision} within {timeout:g} s; "
                    + (f"it is at {self._follower.revision}" if self._follower.revision >= 0 else
                       f"no MESH_DELTA came on {self._bus.url}: check with vismap-doctor that vismap-map-server is running")
                    + (f"; {self._error}" if self._error else ""))
            return self._follower.mesh()

    def close(self) -> None:
        """Stops following."""
        self._closing = True
        self._thread.join()
        self._updates.close()

    def __enter__(self) -> LiveMap:
        return self

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
        request = messages.types["vismap.map_request_t"](utime=now_utime(), verb="mesh", argument=self._follower.position)
        fields: Any = request
        fields.request_id = fields.utime
        try:
            self._bus.publish("MAP_REQUEST", request)
        except BusError:
            pass  # it is requested again when the connection is back
