"""A small reader of protobuf: decodes messages by the text of their `.proto` file, so that no generated code is needed.

Supported is what libs/mapfile/map.proto uses: proto3 messages with numbers, bytes, nested messages, and lists of these.
"""
from __future__ import annotations

import re
import struct
from dataclasses import dataclass
from typing import Any

from .errors import MapError

_MASK = (1 << 64) - 1
_VARINTS = ("uint32", "uint64", "int32", "int64", "bool")
_FIXED = {"double": ("<d", 8, 1), "float": ("<f", 4, 5)}  # code, size, wire type
_LENGTH_DELIMITED = 2


@dataclass(frozen=True)
class _Field:
    name: str
    type: str
    repeated: bool


class Schema:
    """The messages of one `.proto` text."""

    def __init__(self, text: str) -> None:
        text = re.sub(r"//[^\n]*", "", text)
        self._messages = {name: {int(number): _Field(field, kind, bool(repeated)) for repeated, kind, field, number
                                 in re.findall(r"(repeated\s+)?(\w+)\s+(\w+)\s*=\s*(\d+)\s*;", body)}
                          for name, body in re.findall(r"message\s+(\w+)\s*\{([^}]*)\}", text)}
        for name, fields in self._messages.items():
            for field in fields.values():
                known = field.type in _VARINTS or field.type in _FIXED or field.type == "bytes"
                if not known and field.type not in self._messages:
                    raise MapError(f"{name}.{field.name}: the type {field.type} is not supported")

    def decode(self, name: str, data: bytes | memoryview) -> dict[str, Any]:
        """The fields of a message, all of them: absent ones are 0, b"", [] or, of a message, None. Raises MapError."""
        fields = self._messages[name]
        values: dict[str, Any] = {field.name: self._absent(field) for field in fields.values()}
        view, at = memoryview(data), 0
        while at < len(view):
            key, at = _varint(view, at)
            content, wire, at = _content(view, at, key & 7)
            field = fields.get(key >> 3)
            if field is None:
                continue  # of a newer version
            found = self._values(name, field, content, wire)
            if field.repeated:
                values[field.name] += found
            elif found:
                values[field.name] = found[-1]
        return values

    @staticmethod
    def _absent(field: _Field) -> Any:
        if field.repeated:
            return []
        return 0 if field.type in _VARINTS else 0.0 if field.type in _FIXED else b"" if field.type == "bytes" else None

    def _values(self, name: str, field: _Field, content: int | memoryview, wire: int) -> list[Any]:
        """The values that one entry of the wire holds: several of a packed list."""
        if field.type in _VARINTS:
            if isinstance(content, int) and wire == 0:
                return [_number(content, field.type)]
            if isinstance(content, memoryview) and wire == _LENGTH_DELIMITED and field.repeated:
                return [_number(value, field.type) for value in _packed_varints(content)]
        elif field.type in _FIXED and isinstance(content, memoryview):
            code, size, own = _FIXED[field.type]
            if wire in (own, _LENGTH_DELIMITED if field.repeated else own) and len(content) % size == 0:
                return [value for (value,) in struct.iter_unpack(code, content)]
        elif isinstance(content, memoryview) and wire == _LENGTH_DELIMITED:
            return [bytes(content) if field.type == "bytes" else self.decode(field.type, content)]
        raise MapError(f"{name}.{field.name} is not of type {field.type}")


def _varint(view: memoryview, at: int) -> tuple[int, int]:
    value = 0
    for shift in range(0, 70, 7):
        if at >= len(view):
            break
        byte = view[at]
        at += 1
        value |= (byte & 0x7f) << shift
        if byte < 0x80:
            return value & _MASK, at
    raise MapError("a number of the record is truncated or too long")


def _packed_varints(view: memoryview) -> list[int]:
    values, at = [], 0
    while at < len(view):
        value, at = _varint(view, at)
        values.append(value)
    return values


def _number(value: int, kind: str) -> Any:
    if kind == "bool":
        return value != 0
    if kind == "uint32":
        return value & 0xffffffff
    if kind == "int32":
        value &= 0xffffffff
        return value - (1 << 32) if value >> 31 else value
    return value - (1 << 64) if kind == "int64" and value >> 63 else value


def _content(view: memoryview, at: int, wire: int) -> tuple[int | memoryview, int, int]:
    """What stands behind a key: a number or bytes; the wire type; and where the next key stands."""
    if wire == 0:
        value, at = _varint(view, at)
        return value, wire, at
    if wire == _LENGTH_DELIMITED:
        size, at = _varint(view, at)
    elif wire in (1, 5):
        size = 8 if wire == 1 else 4
    else:
        raise MapError(f"the record has an entry of the unknown wire type {wire}")
    if size > len(view) - at:
        raise MapError(f"the record is truncated: {size} bytes are expected, {len(view) - at} are left")
    return view[at:at + size], wire, at + size
