"""The live map as numpy arrays: a copy of the surface that follows the updates on MESH_DELTA."""
from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from .bus import Bus
from .errors import MapError
from .messages import types
from .native import checksum64, digest128
from .updates import BlockIndex, Follower, Live, Part


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
    # (N,) number of frames that observed the surface there; 255 = 255 or more, 0 = not known
    seen: npt.NDArray[np.uint8] = field(default_factory=lambda: np.zeros(0, np.uint8))

    def of_instance(self, instance: int) -> Mesh:
        """The part of the surface that belongs to one object: the faces of which all corners do."""
        kept = self.faces[np.all(self.instance[self.faces] == instance, axis=1)]
        used, faces = np.unique(kept, return_inverse=True)
        return Mesh(self.vertices[used], self.normals[used], self.colors[used], self.segment[used], self.instance[used],
                    self.class_id[used], faces.reshape(-1, 3).astype(np.int32), self.map_id, self.revision, self.utime,
                    self.seen[used] if len(self.seen) else self.seen)


@dataclass(frozen=True)
class _Block:
    vertices: npt.NDArray[np.float32]
    normals: npt.NDArray[np.float32]
    colors: npt.NDArray[np.uint8]
    ids: npt.NDArray[np.int32]  # (n, 3): segment, instance, class
    faces: npt.NDArray[np.int32]
    seen: npt.NDArray[np.uint8]
    hash: int

    @property
    def bytes(self) -> int:
        return 500 + 40 * len(self.vertices) + 12 * len(self.faces)


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
    seen = np.frombuffer(message.seen, np.uint8) if hasattr(message, "seen") else np.zeros(message.n_vertices, np.uint8)
    classes = message.class_id.view(np.uint16).astype(np.int32)
    return _Block(_restore(message), normals, colors, _columns(message.segment, message.instance, classes), faces,
                  seen, _hash_of(message))


def _hash_of(message: Any) -> int:
    """That of the block as the first version of its type has it: without `seen`, which stands last."""
    encoded = message.encode()
    if hasattr(message, "seen"):
        fingerprint = types["vismap.mesh_block_v1_t"].FINGERPRINT.to_bytes(8, "big")
        encoded = fingerprint + encoded[8:len(encoded) - message.n_vertices]
    return max(1, checksum64(encoded) or 0)


class MeshFollower(Follower[_Block, Mesh]):
    """A copy of the surface, made of the messages of MESH_DELTA; see Follower. mesh() is its present state."""

    TYPE = "vismap.mesh_delta_t"
    OLDER = ("vismap.mesh_delta_v1_t",)
    WHAT = "surface"

    @property
    def digest(self) -> str:
        """Digest of the surface, the same as `vismap-map digests` prints for an equal one; "" without XXH3."""
        total = sum(block.hash for block in self._blocks.values()) & ((1 << 64) - 1)
        return digest128(struct.pack("<QQ", len(self._blocks), total))

    def mesh(self) -> Mesh:
        """The whole surface, by ascending index of the blocks. Blocks do not share vertices. Do not write to the arrays."""
        return self.copied()

    def _decode_part(self, message: Any) -> Part[_Block]:
        blocks: dict[BlockIndex, _Block | None] = {}
        last: BlockIndex | None = None
        for block in message.blocks:
            index = (int(block.index[0]), int(block.index[1]), int(block.index[2]))
            if last is not None and not last < index:
                raise MapError(f"{self._name(message)}: the blocks are not in ascending order")
            decoded = _decode_block(block)
            blocks[index] = decoded if block.n_vertices else None
            last = index
        return Part(blocks, sum(block.bytes for block in blocks.values() if block is not None))

    def _bytes_of(self, block: _Block) -> int:
        return block.bytes

    def _join(self, blocks: list[tuple[BlockIndex, _Block]]) -> Mesh:
        parts = [block for _, block in blocks]
        first = np.cumsum([0] + [len(block.vertices) for block in parts])

        def stacked(arrays: list[npt.NDArray[Any]], kind: Any) -> npt.NDArray[Any]:
            return np.concatenate(arrays) if arrays else np.zeros((0, 3), kind)
        ids = stacked([block.ids for block in parts], np.int32)
        faces = stacked([block.faces + np.int32(start) for block, start in zip(parts, first)], np.int32)
        return Mesh(stacked([block.vertices for block in parts], np.float32),
                    stacked([block.normals for block in parts], np.float32),
                    stacked([block.colors for block in parts], np.uint8), ids[:, 0].copy(), ids[:, 1].copy(),
                    ids[:, 2].astype(np.uint16), faces, self.map_id, self.revision, self.utime,
                    np.concatenate([block.seen for block in parts]) if parts else np.zeros(0, np.uint8))


class LiveMap(Live[_Block, Mesh]):
    """Follows the surface of the running server; a thread of its own does so. Missed updates are requested again.

        with vismap.Bus() as bus, vismap.LiveMap(bus) as live:
            mesh = live.wait(revision=10)
    """

    def __init__(self, bus: Bus, max_mb: int = 2048) -> None:
        super().__init__(bus, MeshFollower(max_mb << 20), "MESH_DELTA", "mesh")

    def mesh(self) -> Mesh:
        """The surface as far as it is known now; empty, with revision -1, before the first update has come."""
        return self.now()

    def __enter__(self) -> LiveMap:
        return self
