"""Saved maps: what a .vismap file holds, as numpy arrays."""
from __future__ import annotations

import functools
import os
import pathlib
import struct
from dataclasses import dataclass, field
from typing import Any, BinaryIO, Iterator

import numpy as np
import numpy.typing as npt

from .errors import MapError
from .messages import data_file
from .native import checksum64, zstd_decompress
from .proto import Schema

_MAGIC, _VERSION = b"VISMAP\r\n", 1
_HEAD = struct.Struct("<IIQ")  # kind, length, checksum of a record
_HEADER, _LABELS, _BLOCKS, _END = 1, 2, 3, 4
_MOST_CHUNK_BYTES = 1 << 22
_SIDE, _VOXELS, _SLOTS = 8, 512, 3
_TRUNCATION_STEPS, _WEIGHT_SCALE = 32767, 128.0
_SURFACE, _FREE, _ALL_FREE = 1, 2, 3  # kinds of blocks; 0 = unseen


@functools.cache
def _schema() -> Schema:
    return Schema(data_file("map.proto", "libs/mapfile/map.proto").read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Label:
    """What the map knows of one segment label."""

    label: int
    merged_into: int  # 0 = it is alive; else the record is empty
    frames: int  # in which it was observed
    frames_with_detector: int  # of these, those that a detector had looked at
    pixels: int  # its size in the image, summed over all frames [px]
    first_utime: int  # of the first and the last of its frames [us]
    last_utime: int
    instance_evidence: dict[int, float]  # id of an object -> evidence
    class_evidence: dict[int, float]  # class -> evidence


@dataclass(frozen=True)
class VoxelBlocks:
    """Blocks of 8 x 8 x 8 voxels. Voxel (x, y, z) of a block is at [z, y, x] of the arrays; its centre in W is at
    (8 * index + (x, y, z) + 0.5) * voxel_size_m. S blocks are near a surface, F blocks are partly seen empty."""

    surface_index: npt.NDArray[np.int32]  # (S, 3) positions of blocks near a surface
    distance_m: npt.NDArray[np.float32]  # (S, 8, 8, 8) truncated signed distance [m], positive before the surface
    weight: npt.NDArray[np.float32]  # (S, 8, 8, 8) in observations at 1 m; 0 = never observed
    observations: npt.NDArray[np.uint8]  # (S, 8, 8, 8) number of frames that observed the voxel, at most 255
    colors: npt.NDArray[np.uint8]  # (S, 8, 8, 8, 3) red, green, blue
    labels: npt.NDArray[np.int32]  # (S, 8, 8, 8, 3) segment labels with votes; 0 = no vote. See SavedMap.canonical
    votes: npt.NDArray[np.uint8]  # (S, 8, 8, 8, 3) the votes for them
    free_index: npt.NDArray[np.int32]  # (F, 3)
    free_once: npt.NDArray[np.bool_]  # (F, 8, 8, 8) seen empty at least once
    free_twice: npt.NDArray[np.bool_]  # (F, 8, 8, 8) seen empty at least twice
    all_free_index: npt.NDArray[np.int32]  # (A, 3) blocks that were seen empty everywhere, at least twice


@dataclass(frozen=True)
class Voxels:
    """All observed voxels near a surface, one after the other."""

    centers_W: npt.NDArray[np.float64]  # (N, 3) [m]
    distance_m: npt.NDArray[np.float32]  # (N,) truncated signed distance [m], positive before the surface
    weight: npt.NDArray[np.float32]  # (N,)
    colors: npt.NDArray[np.uint8]  # (N, 3)
    segment: npt.NDArray[np.int32]  # (N,) the label with most votes, alive; 0 = none
    instance: npt.NDArray[np.int32]  # (N,) the object of that label; 0 = none


@dataclass
class SavedMap:
    """A map file. The header and the labels are in memory; blocks are read from the file when they are asked for."""

    path: pathlib.Path
    map_id: str
    revision: int  # number of its frames
    voxel_size_m: float
    truncation_m: float
    last_utime: int  # of its newest frame [us]
    config: str  # protobuf text that the map was made with
    created_by: str
    class_names: dict[int, str]
    utimes: npt.NDArray[np.int64]  # (K,) of the integrated frames [us], in their order
    camera_ids: npt.NDArray[np.int32]  # (K,)
    trajectory: npt.NDArray[np.float64]  # (K, 4, 4) T_W_C: p_W = T_W_C * p_C [m]
    labels: dict[int, Label]
    min_instance_ratio: float
    _first_block: int = field(repr=False, default=0)  # where the records of blocks begin [bytes]

    def canonical(self, label: int) -> int:
        """The alive label that a label was merged into, in one or more steps; itself when it is alive; 0 for 0."""
        while label in self.labels and self.labels[label].merged_into:
            label = self.labels[label].merged_into
        return label if label in self.labels else 0

    def instance_of(self, label: int) -> int:
        """The object that a segment label is read out as; 0 = none."""
        record = self.labels.get(self.canonical(label))
        if record is None or not record.instance_evidence:
            return 0
        instance, evidence = max(record.instance_evidence.items(), key=lambda entry: (entry[1], -entry[0]))
        rest = record.frames_with_detector - evidence
        return instance if evidence > self.min_instance_ratio * rest else 0

    def blocks(self) -> Iterator[VoxelBlocks]:
        """All blocks, by ascending index, in portions of about half a megabyte. Raises MapError on a damaged file."""
        with _open(self.path) as file:
            file.seek(self._first_block)
            number, expected, blocks = 3, None, 0
            while expected is None:
                kind, content = _read_record(self.path, file, number)
                if kind == _END:
                    expected = _schema().decode("End", content)["blocks"]
                elif kind == _BLOCKS:
                    chunk = self._chunk(content, number)
                    blocks += chunk[0]
                    yield chunk[1]
                else:
                    raise MapError(f"{self.path}: record {number} is no chunk of blocks")
                number += 1
            if blocks != expected:
                raise MapError(f"{self.path}: the end record promises {expected} blocks, found {blocks}")

    def voxels(self) -> Voxels:
        """All observed voxels near a surface. Takes about 60 bytes for each; blocks() takes less."""
        parts = [self._observed(blocks) for blocks in self.blocks()]
        segment = np.concatenate([part[4] for part in parts] or [np.zeros(0, np.int32)])
        known, inverse = np.unique(segment, return_inverse=True)
        alive = np.array([self.canonical(int(label)) for label in known], np.int32)
        instances = np.array([self.instance_of(int(label)) for label in known], np.int32)
        empty: tuple[npt.NDArray[Any], ...] = (np.zeros((0, 3)), np.zeros(0, np.float32), np.zeros(0, np.float32),
                                               np.zeros((0, 3), np.uint8))
        joined = [np.concatenate([part[i] for part in parts] or [empty[i]]) for i in range(4)]
        return Voxels(joined[0], joined[1], joined[2], joined[3], alive[inverse], instances[inverse])

    def _observed(self, blocks: VoxelBlocks) -> tuple[npt.NDArray[Any], ...]:
        seen = blocks.weight > 0
        block, z, y, x = np.nonzero(seen)
        voxel = blocks.surface_index[block].astype(np.int64) * _SIDE + np.stack([x, y, z], axis=1)
        best = np.argmax(blocks.votes[seen], axis=1)
        segment = np.take_along_axis(blocks.labels[seen], best[:, None], axis=1)[:, 0]
        return (voxel + 0.5) * self.voxel_size_m, blocks.distance_m[seen], blocks.weight[seen], blocks.colors[seen], segment

    def _chunk(self, content: bytes, number: int) -> tuple[int, VoxelBlocks]:
        try:
            chunk = _schema().decode("BlockChunk", content)
            if chunk["raw_bytes"] > _MOST_CHUNK_BYTES:
                raise MapError(f"its stated size is {chunk['raw_bytes']} bytes, more than any chunk has")
            raw = zstd_decompress(chunk["zstd"], chunk["raw_bytes"])
            return chunk["blocks"], _decode_blocks(raw, chunk["blocks"], len(self.labels), self.truncation_m)
        except MapError as error:
            raise MapError(f"{self.path}: record {number}, a chunk of blocks: {error}") from None


def open_map(path: str | os.PathLike[str]) -> SavedMap:
    """Opens a map file, such as map.vismap. Raises MapError, which names the file, when it is damaged."""
    path = pathlib.Path(path)
    with _open(path) as file:
        prefix = file.read(len(_MAGIC) + 4)
        if len(prefix) < len(_MAGIC) + 4 or not prefix.startswith(_MAGIC):
            raise MapError(f"{path}: it is not a map file of vismap")
        version = int.from_bytes(prefix[len(_MAGIC):], "little")
        if version != _VERSION:
            raise MapError(f"{path}: expected map format {_VERSION}, found {version}")
        records = []
        for number, (kind, name) in enumerate(((_HEADER, "Header"), (_LABELS, "Labels")), 1):
            found, content = _read_record(path, file, number)
            if found != kind:
                raise MapError(f"{path}: expected a header and the labels at the start, found a record of kind {found}")
            try:
                records.append(_schema().decode(name, content))
            except MapError as error:
                raise MapError(f"{path}: record {number}: {error}") from None
        first_block = file.tell()
    return _saved_map(path, records[0], records[1], first_block)


def _saved_map(path: pathlib.Path, header: dict[str, Any], labels: dict[str, Any], first_block: int) -> SavedMap:
    voxel, truncation = header["voxel_size_m"], header["truncation_voxels"]
    if not 1e-4 < voxel < 10 or not 1 <= truncation < 1000:
        raise MapError(f"{path}: the header has a voxel size of {voxel:g} m and a truncation of {truncation:g} voxels")
    poses = header["trajectory"]
    if any(len(pose["T_W_C"]) != 12 for pose in poses):
        raise MapError(f"{path}: a pose does not have 12 numbers")
    trajectory = np.tile(np.eye(4), (len(poses), 1, 1))
    if poses:
        trajectory[:, :3] = np.array([pose["T_W_C"] for pose in poses]).reshape(-1, 3, 4)
    return SavedMap(
        path, _text(header["map_id"]), header["revision"], voxel, truncation * voxel, header["last_utime"],
        _text(header["config"]), _text(header["created_by"]),
        {entry["class_id"]: _text(entry["name"]) for entry in header["class_names"]},
        np.array([pose["utime"] for pose in poses], np.int64), np.array([pose["camera_id"] for pose in poses], np.int32),
        trajectory, {number: _label(path, number, record) for number, record in enumerate(labels["records"], 1)},
        labels["min_instance_ratio"], first_block)


def _label(path: pathlib.Path, number: int, record: dict[str, Any]) -> Label:
    if record["merged_into"] >= number:
        raise MapError(f"{path}: label {number} was merged into a higher one")
    return Label(number, record["merged_into"], record["frames"], record["frames_with_detector"], record["pixels"],
                 record["first_utime"], record["last_utime"], dict(zip(record["instances"], record["instance_evidence"])),
                 dict(zip(record["classes"], record["class_evidence"])))


def _text(content: bytes) -> str:
    return content.decode("utf-8", "replace")


def _open(path: pathlib.Path) -> BinaryIO:
    try:
        return open(path, "rb")
    except OSError as error:
        raise MapError(f"{path}: the map cannot be read ({error.strerror})") from None


def _read_record(path: pathlib.Path, file: BinaryIO, number: int) -> tuple[int, bytes]:
    """Kind and content of the record at the position of the file."""
    at, size = file.tell(), os.fstat(file.fileno()).st_size
    place = f"{path}: record {number} at byte {at} of {size}"
    head = file.read(_HEAD.size)
    if len(head) < _HEAD.size:
        raise MapError(f"{place} is truncated: the file is cut")
    kind, length, checksum = _HEAD.unpack(head)
    if length > size - file.tell():
        raise MapError(f"{place} is truncated: expected {length} bytes, found {size - file.tell()}")
    content = file.read(length)
    own = checksum64(content)
    if own is not None and checksum64(struct.pack("<QQ", own, kind << 32 | length)) != checksum:
        raise MapError(f"{place} is damaged: its checksum is wrong")
    return kind, content


class _Cursor:
    def __init__(self, raw: bytes) -> None:
        self._raw, self._at = raw, 0

    def take(self, kind: Any, *shape: int) -> npt.NDArray[Any]:
        count = int(np.prod(shape, dtype=np.int64))
        size = count * np.dtype(kind).itemsize
        if size > len(self._raw) - self._at:
            raise MapError(f"{size} bytes are expected at byte {self._at}, {len(self._raw) - self._at} are left")
        values = np.frombuffer(self._raw, kind, count, self._at).reshape(shape)
        self._at += size
        return values

    def end(self) -> None:
        if self._at != len(self._raw):
            raise MapError(f"{len(self._raw) - self._at} bytes are left after the blocks")


def _decode_blocks(raw: bytes, blocks: int, labels: int, truncation_m: float) -> VoxelBlocks:
    """See libs/mapfile/block_chunk.cc: the indices of all blocks, their kinds, then each field for all blocks."""
    cursor = _Cursor(raw)
    index, kinds = cursor.take("<i4", blocks, 3), cursor.take(np.uint8, blocks)
    if np.any(kinds > _ALL_FREE):
        raise MapError("a block is of unknown kind")
    count, cube = int(np.sum(kinds == _SURFACE)), (_SIDE, _SIDE, _SIDE)
    low_high = cursor.take(np.uint8, count, 2, *cube).astype(np.uint16)
    distance = cursor.take("<i2", count, *cube)
    observations = cursor.take(np.uint8, count, *cube)
    colors = cursor.take(np.uint8, count, *cube, 3)
    entries = cursor.take(np.uint8, count, *cube, _SLOTS)
    votes = cursor.take(np.uint8, count, *cube, _SLOTS)
    label = np.zeros(entries.shape, np.int32)
    for i in range(count):
        palette = cursor.take("<u4", int(cursor.take(np.uint8, 1)[0]))
        if np.any(palette == 0) or np.any(palette > labels) or entries[i].max() > len(palette):
            raise MapError("a vote is for a segment label that is not there")
        label[i] = np.concatenate([[0], palette]).astype(np.int32)[entries[i]]
    free = cursor.take("<u8", int(np.sum(kinds == _FREE)), 2, _SIDE)
    cursor.end()
    bits = np.unpackbits(free.view(np.uint8).reshape(-1, 2, _VOXELS // 8), axis=2, bitorder="little").astype(np.bool_)
    once_twice = bits.reshape(-1, 2, *cube)
    return VoxelBlocks(index[kinds == _SURFACE], distance.astype(np.float32) * np.float32(truncation_m / _TRUNCATION_STEPS),
                       (low_high[:, 0] | low_high[:, 1] << 8).astype(np.float32) / np.float32(_WEIGHT_SCALE), observations,
                       colors, label, votes, index[kinds == _FREE], once_twice[:, 0], once_twice[:, 1],
                       index[kinds == _ALL_FREE])
