"""Reads message types from `.lcm` texts; encodes and decodes their messages, as the code made by lcm-gen does.

Supported is what LCM 1.3.1 generates for C++ and this project uses: structs with scalars, strings, other structs, and
arrays of these with constant or variable lengths; constants. Enums, and structs that contain themselves, are refused.
"""
from __future__ import annotations

import re
import struct
from dataclasses import dataclass, field
from typing import Any, Callable, Iterable, Iterator, Mapping

import numpy as np

from .errors import MessageError

# Name in LCM -> (code for struct, numpy type on the wire, size [bytes]).
_NUMBERS: dict[str, tuple[str, str, int]] = {
    "int8_t": ("b", ">i1", 1),
    "int16_t": ("h", ">i2", 2),
    "int32_t": ("i", ">i4", 4),
    "int64_t": ("q", ">i8", 8),
    "float": ("f", ">f4", 4),
    "double": ("d", ">f8", 8),
    "boolean": ("?", "?", 1),
    "byte": ("B", ">u1", 1),
}
_INTEGERS = ("int8_t", "int16_t", "int32_t", "int64_t", "byte")
_MASK = (1 << 64) - 1
_TOKEN = re.compile(r"//[^\n]*|/\*.*?\*/|(?P<token>[A-Za-z_][\w.]*|[-+]?(?:0[xX][0-9a-fA-F]+|[\d.]+(?:[eE][-+]?\d+)?)|\S)|\s+",
                    re.DOTALL)


@dataclass(frozen=True)
class Dimension:
    """One dimension of an array: a number, or the name of the field that holds it."""

    text: str

    @property
    def fixed(self) -> bool:
        return self.text[0].isdigit()


@dataclass(frozen=True)
class Field:
    """One field of a message type."""

    name: str
    type: str  # as written; of another package with a dot
    dimensions: tuple[Dimension, ...] = ()


@dataclass
class Layout:
    """One parsed struct: its fields in the order of the bytes, and its constants."""

    package: str
    name: str
    fields: list[Field] = field(default_factory=list)
    constants: dict[str, int | float] = field(default_factory=dict)


class _Tokens:
    def __init__(self, text: str, origin: str) -> None:
        self._origin = origin
        self._tokens = [(m.group("token"), text.count("\n", 0, m.start()) + 1)
                        for m in _TOKEN.finditer(text) if m.group("token")]
        self._at = 0

    def more(self) -> bool:
        return self._at < len(self._tokens)

    def next(self) -> str:
        if not self.more():
            raise self.error("the text ends too early")
        self._at += 1
        return self._tokens[self._at - 1][0]

    def peek(self) -> str:
        return self._tokens[self._at][0] if self.more() else ""

    def expect(self, token: str) -> None:
        found = self.next()
        if found != token:
            raise self.error(f"expected '{token}', found '{found}'")

    def name(self) -> str:
        found = self.next()
        if not re.fullmatch(r"[A-Za-z_][\w.]*", found):
            raise self.error(f"expected a name, found '{found}'")
        return found

    def error(self, what: str) -> MessageError:
        line = self._tokens[min(max(self._at - 1, 0), len(self._tokens) - 1)][1] if self._tokens else 1
        return MessageError(f"{self._origin}:{line}: {what}")


def parse_lcm(text: str, origin: str = "<text>") -> list[Layout]:
    """The structs of one `.lcm` text. `origin` (a path) begins the message of an error."""
    tokens = _Tokens(text, origin)
    package, layouts = "", []
    while tokens.more():
        word = tokens.next()
        if word == "package":
            package = tokens.name()
            tokens.expect(";")
        elif word == "struct":
            layouts.append(_parse_struct(tokens, package))
        else:
            raise tokens.error(f"expected 'package' or 'struct', found '{word}'")
    return layouts


def _parse_struct(tokens: _Tokens, package: str) -> Layout:
    layout = Layout(package, tokens.name())
    tokens.expect("{")
    while tokens.peek() != "}":
        word = tokens.name()
        if word == "const":
            _parse_constants(tokens, layout)
        else:
            _parse_fields(tokens, layout, word)
    tokens.expect("}")
    return layout


def _parse_constants(tokens: _Tokens, layout: Layout) -> None:
    type_name = tokens.name()
    while True:
        name = tokens.name()
        tokens.expect("=")
        value = tokens.next()
        try:
            layout.constants[name] = float(value) if type_name in ("float", "double") else int(value, 0)
        except ValueError:
            raise tokens.error(f"expected a number of type {type_name}, found '{value}'") from None
        if tokens.peek() != ",":
            return tokens.expect(";")
        tokens.expect(",")


def _parse_fields(tokens: _Tokens, layout: Layout, type_name: str) -> None:
    while True:
        name, dimensions = tokens.name(), []
        while tokens.peek() == "[":
            tokens.expect("[")
            dimensions.append(_parse_dimension(tokens, layout))
            tokens.expect("]")
        if any(known.name == name for known in layout.fields):
            raise tokens.error(f"there are two fields {name}")
        layout.fields.append(Field(name, type_name, tuple(dimensions)))
        if tokens.peek() != ",":
            return tokens.expect(";")
        tokens.expect(",")


def _parse_dimension(tokens: _Tokens, layout: Layout) -> Dimension:
    text = tokens.next()
    if text.isdigit():
        return Dimension(text)
    for known in layout.fields:
        if known.name == text and not known.dimensions and known.type in _INTEGERS:
            return Dimension(text)
    raise tokens.error(f"the length '{text}' is neither a number nor an integer field above it")


def _add_char(value: int, char: int) -> int:
    signed = value - (1 << 64) if value >> 63 else value
    return (((signed << 8) ^ (signed >> 55)) + char) & _MASK


def _add_text(value: int, text: str) -> int:
    value = _add_char(value, len(text))
    for char in text.encode():
        value = _add_char(value, char)
    return value


def _own_hash(layout: Layout) -> int:
    """The hash of the fields of one struct, as lcm-gen computes it; without what nested structs add."""
    value = 0x12345678
    for entry in layout.fields:
        value = _add_text(value, entry.name)
        if entry.type in _NUMBERS or entry.type == "string":
            value = _add_text(value, entry.type)
        value = _add_char(value, len(entry.dimensions))
        for dimension in entry.dimensions:
            value = _add_text(_add_char(value, 0 if dimension.fixed else 1), dimension.text)
    return value


class Message:
    """The base of all message types. Construct one with some of its fields: `camera_t(width=640, height=480)`.

    Fields that are not given are 0, False, "", an array of zeros of the stated length, or an empty array. Numbers in
    arrays are numpy arrays, `byte` arrays are `bytes`, arrays of strings and structs are lists. The fields that hold the
    lengths of other fields are set by `encode`.
    """

    __slots__ = ()
    TYPE: str  # "vismap.rgbd_frame_t"
    FINGERPRINT: int  # unsigned, the first eight bytes of a message
    FIELDS: tuple[Field, ...]
    _codec: "_Codec"

    def __init__(self, **values: Any) -> None:
        for name, make in self._codec.defaults:
            object.__setattr__(self, name, values.pop(name) if name in values else make())
        if values:
            raise MessageError(f"{self.TYPE} has no field {', '.join(values)}; it has {', '.join(f.name for f in self.FIELDS)}")

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"{self.TYPE} has no field {name}; it has {', '.join(f.name for f in self.FIELDS)}")

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in self._codec.names:
            raise AttributeError(f"{self.TYPE} has no field {name}; it has {', '.join(f.name for f in self.FIELDS)}")
        object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        def short(value: Any) -> str:
            text = repr(value)
            return text if len(text) <= 60 else f"<{len(value)} elements>" if hasattr(value, "__len__") else text[:57] + "..."
        return f"{self.TYPE}({', '.join(f'{f.name}={short(getattr(self, f.name))}' for f in self.FIELDS)})"

    def encode(self) -> bytes:
        """The message as LCM sends it. Fails when arrays with one length field have different lengths."""
        parts: list[bytes] = [struct.pack(">Q", self.FINGERPRINT)]
        self._codec.encode(self, parts)
        return b"".join(parts)

    @classmethod
    def decode(cls, data: bytes | bytearray | memoryview) -> Any:
        """The message in `data`. Fails on another type, on lengths that do not fit in `data`, and on trailing bytes."""
        view = memoryview(data)
        if len(view) < 8:
            raise MessageError(f"{cls.TYPE}: the message has {len(view)} bytes, expected at least 8")
        found = int.from_bytes(view[:8], "big")
        if found != cls.FINGERPRINT:
            raise MessageError(f"{cls.TYPE}: the type fingerprint is {found:016x}, expected {cls.FINGERPRINT:016x}; "
                               "the sender uses another version or type")
        message, end = cls.decode_from(view, 8)
        if end != len(view):
            raise MessageError(f"{cls.TYPE}: {len(view)} bytes, but its fields end after byte {end}")
        return message

    @classmethod
    def decode_from(cls, view: memoryview, offset: int) -> tuple[Any, int]:
        """The fields that begin at `offset`, without a fingerprint; and the offset behind them."""
        message = cls.__new__(cls)
        return message, cls._codec.decode(message, view, offset)


_Decode = Callable[[Any, memoryview, int], int]
_Encode = Callable[[Any, list[bytes]], None]


def _short(owner: str, name: str, needs: int, left: int) -> MessageError:
    return MessageError(f"{owner}.{name}: the message is truncated, or a length is impossible: "
                        f"{needs} bytes are needed, {left} are left")


def _frozen(array: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    array.flags.writeable = False
    return array


_EMPTY = {name: _frozen(np.empty(0, np.dtype(wire).newbyteorder("="))) for name, (_, wire, _) in _NUMBERS.items()}


class _Codec:
    """Encodes and decodes the fields of one type. Neighbouring scalars are read and written in one step."""

    def __init__(self, layout: Layout, types: Mapping[str, type[Message]]) -> None:
        self.owner = f"{layout.package}.{layout.name}"
        self.names = frozenset(f.name for f in layout.fields)
        self.defaults: list[tuple[str, Callable[[], Any]]] = []
        self.min_size = 0
        self._decoders: list[_Decode] = []
        self._encoders: list[_Encode] = []
        self._types = types
        self._package = layout.package
        # Length field -> the arrays that have this length.
        self._lengths: dict[str, list[tuple[Field, int]]] = {}
        for entry in layout.fields:
            for axis, dimension in enumerate(entry.dimensions):
                if not dimension.fixed:
                    self._lengths.setdefault(dimension.text, []).append((entry, axis))
        scalars: list[Field] = []
        for entry in layout.fields:
            if entry.type in _NUMBERS and not entry.dimensions:
                scalars.append(entry)
                continue
            self._add_scalars(scalars)
            scalars = []
            self._add(entry)
        self._add_scalars(scalars)

    def decode(self, message: Any, view: memoryview, offset: int) -> int:
        for step in self._decoders:
            offset = step(message, view, offset)
        return offset

    def encode(self, message: Any, parts: list[bytes]) -> None:
        for name, arrays in self._lengths.items():
            self._set_length(message, name, arrays)
        for step in self._encoders:
            step(message, parts)

    def _set_length(self, message: Any, name: str, arrays: list[tuple[Field, int]]) -> None:
        found = {entry.name: (np.shape(getattr(message, entry.name))[axis] if len(entry.dimensions) > 1
                              else len(getattr(message, entry.name))) for entry, axis in arrays}
        if len(set(found.values())) > 1:
            raise MessageError(f"{self.owner}: {', '.join(found)} must have the same length, {name}; found "
                               f"{', '.join(str(length) for length in found.values())}")
        object.__setattr__(message, name, next(iter(found.values())))

    def _struct(self, name: str) -> type[Message]:
        return self._types[name if "." in name else f"{self._package}.{name}"]

    def _add_scalars(self, entries: list[Field]) -> None:
        if not entries:
            return
        names = tuple(entry.name for entry in entries)
        packer = struct.Struct(">" + "".join(_NUMBERS[entry.type][0] for entry in entries))
        size, owner, assign = packer.size, self.owner, object.__setattr__
        for entry in entries:
            self.defaults.append((entry.name, bool if entry.type == "boolean" else float if entry.type in ("float", "double") else int))

        def decode(message: Any, view: memoryview, offset: int) -> int:
            if len(view) - offset < size:
                raise _short(owner, names[0], size, len(view) - offset)
            for name, value in zip(names, packer.unpack_from(view, offset)):
                assign(message, name, value)
            return offset + size

        def encode(message: Any, parts: list[bytes]) -> None:
            values = [getattr(message, name) for name in names]
            try:
                parts.append(packer.pack(*values))
            except (struct.error, OverflowError, TypeError) as error:
                told = ", ".join(f"{entry.name} ({entry.type}) = {value!r}" for entry, value in zip(entries, values))
                raise MessageError(f"{owner}: a value does not fit its type: {error}; {told}") from None

        self.min_size += size
        self._decoders.append(decode)
        self._encoders.append(encode)

    def _add(self, entry: Field) -> None:
        if entry.type in _NUMBERS:
            self._add_numbers(entry)
        elif entry.dimensions:
            self._add_list(entry)
        else:
            self._add_one(entry)

    def _element(self, entry: Field) -> tuple[Callable[[memoryview, int], tuple[Any, int]],
                                              Callable[[Any, list[bytes]], None], Callable[[], Any], int]:
        """How one string or struct is decoded, encoded and made; and its smallest size [bytes]."""
        where = f"{self.owner}.{entry.name}"
        if entry.type == "string":
            return (lambda view, offset: _decode_string(view, offset, where),
                    lambda value, parts: _encode_string(value, parts, where), str, 5)
        kind = self._struct(entry.type)
        codec = kind._codec

        def encode(value: Any, parts: list[bytes]) -> None:
            if not isinstance(value, kind):
                raise MessageError(f"{where}: expected a {kind.TYPE}, found {type(value).__name__}")
            codec.encode(value, parts)
        return kind.decode_from, encode, kind, codec.min_size

    def _add_one(self, entry: Field) -> None:
        name, assign = entry.name, object.__setattr__
        decode_element, encode_element, make, min_size = self._element(entry)

        def decode(message: Any, view: memoryview, offset: int) -> int:
            value, end = decode_element(view, offset)
            assign(message, name, value)
            return end

        self.defaults.append((name, make))
        self.min_size += min_size
        self._decoders.append(decode)
        self._encoders.append(lambda message, parts: encode_element(getattr(message, name), parts))

    def _add_list(self, entry: Field) -> None:
        if len(entry.dimensions) > 1:
            raise MessageError(f"{self.owner}.{entry.name}: arrays of {entry.type} with several dimensions are not supported")
        name, dimension, owner, assign = entry.name, entry.dimensions[0], self.owner, object.__setattr__
        decode_element, encode_element, make, min_size = self._element(entry)
        min_size = max(1, min_size)

        def decode(message: Any, view: memoryview, offset: int) -> int:
            count = int(dimension.text) if dimension.fixed else getattr(message, dimension.text)
            if count < 0 or count > (len(view) - offset) // min_size:
                raise _short(owner, name, count * min_size, len(view) - offset)
            values = []
            for _ in range(count):
                value, offset = decode_element(view, offset)
                values.append(value)
            assign(message, name, values)
            return offset

        def encode(message: Any, parts: list[bytes]) -> None:
            values = getattr(message, name)
            if dimension.fixed and len(values) != int(dimension.text):
                raise MessageError(f"{owner}.{name}: expected {dimension.text} elements, found {len(values)}")
            for value in values:
                encode_element(value, parts)

        length = int(dimension.text) if dimension.fixed else 0
        self.defaults.append((name, lambda: [make() for _ in range(length)]))
        self.min_size += length * min_size
        self._decoders.append(decode)
        self._encoders.append(encode)

    def _add_numbers(self, entry: Field) -> None:
        name, owner, assign = entry.name, self.owner, object.__setattr__
        _, wire_name, size = _NUMBERS[entry.type]
        wire, native = np.dtype(wire_name), np.dtype(wire_name).newbyteorder("=")
        dimensions = entry.dimensions
        plain_bytes = entry.type == "byte" and len(dimensions) == 1
        empty = _EMPTY[entry.type]

        def decode(message: Any, view: memoryview, offset: int) -> int:
            shape = [int(d.text) if d.fixed else getattr(message, d.text) for d in dimensions]
            count = 1
            for length in shape:
                if length < 0:
                    raise MessageError(f"{owner}.{name}: its length is {length}")
                count *= length
            end = offset + count * size
            if end > len(view):
                raise _short(owner, name, count * size, len(view) - offset)
            if plain_bytes:
                assign(message, name, bytes(view[offset:end]))
            elif count == 0 and len(shape) == 1:
                assign(message, name, empty)
            else:
                assign(message, name, np.frombuffer(view[offset:end], wire).astype(native).reshape(shape))
            return end

        def encode(message: Any, parts: list[bytes]) -> None:
            parts.append(_number_bytes(getattr(message, name), wire, dimensions, f"{owner}.{name}"))

        fixed = [int(d.text) if d.fixed else 0 for d in dimensions]

        def make() -> Any:
            return bytes(fixed[0]) if plain_bytes else np.zeros(fixed, native)
        self.defaults.append((name, make))
        self.min_size += size * int(np.prod(fixed))
        self._decoders.append(decode)
        self._encoders.append(encode)


def _number_bytes(value: Any, wire: np.dtype[Any], dimensions: tuple[Dimension, ...], where: str) -> bytes:
    array: np.ndarray[Any, Any] = (np.frombuffer(value, np.uint8) if isinstance(value, (bytes, bytearray, memoryview))
                                   else np.asarray(value))
    if array.ndim != len(dimensions):
        raise MessageError(f"{where}: expected {len(dimensions)} dimensions, found an array of shape {array.shape}")
    for length, dimension in zip(array.shape, dimensions):
        if dimension.fixed and length != int(dimension.text):
            raise MessageError(f"{where}: expected {dimension.text} elements, found {length}")
    if array.size == 0:
        return b""
    if wire.kind in "iu" and array.dtype.kind not in "iub":
        raise MessageError(f"{where}: expected whole numbers, found an array of {array.dtype}")
    converted = array.astype(wire)
    if wire.kind in "iu" and array.dtype.newbyteorder("=") != wire.newbyteorder("="):
        if not np.array_equal(converted.astype(array.dtype), array) or bool(np.any((converted < 0) != (array < 0))):
            raise MessageError(f"{where}: a value does not fit into {wire.itemsize} bytes")
    return bytes(converted.tobytes())


def _decode_string(view: memoryview, offset: int, where: str) -> tuple[str, int]:
    left = len(view) - offset - 4
    if left < 1:
        raise MessageError(f"{where}: the message is truncated")
    length = int.from_bytes(view[offset:offset + 4], "big", signed=True)
    if length < 1 or length > left:
        raise MessageError(f"{where}: its length is {length}, but {left} bytes are left")
    content = bytes(view[offset + 4:offset + 4 + length])
    if content.find(b"\0") != length - 1:
        raise MessageError(f"{where}: the text does not end with its only NUL")
    return content[:-1].decode("utf-8", "surrogateescape"), offset + 4 + length


def _encode_string(value: Any, parts: list[bytes], where: str) -> None:
    if not isinstance(value, str):
        raise MessageError(f"{where}: expected a text, found {type(value).__name__}")
    content = value.encode("utf-8", "surrogateescape")
    if b"\0" in content:
        raise MessageError(f"{where}: a text must not contain NUL")
    parts += (struct.pack(">i", len(content) + 1), content, b"\0")


class TypeTable(Mapping[str, type[Message]]):
    """Message types by their full names, such as "vismap.rgbd_frame_t"."""

    def __init__(self, layouts: Iterable[Layout]) -> None:
        self._layouts = {f"{layout.package}.{layout.name}": layout for layout in layouts}
        self._types: dict[str, type[Message]] = {}
        for name in self._layouts:
            self._make(name, ())
        self._by_fingerprint = {kind.FINGERPRINT: kind for kind in self._types.values()}

    def __getitem__(self, name: str) -> type[Message]:
        return self._types[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._types)

    def __len__(self) -> int:
        return len(self._types)

    def by_fingerprint(self, fingerprint: int) -> type[Message] | None:
        """The type with this fingerprint; None when there is none."""
        return self._by_fingerprint.get(fingerprint)

    def _make(self, name: str, parents: tuple[str, ...]) -> type[Message]:
        if name in self._types:
            return self._types[name]
        layout = self._layouts[name]
        if name in parents:
            raise MessageError(f"{name} contains itself, which is not supported")
        value = _own_hash(layout)
        for entry in layout.fields:
            if entry.type not in _NUMBERS and entry.type != "string":
                nested = entry.type if "." in entry.type else f"{layout.package}.{entry.type}"
                if nested not in self._layouts:
                    raise MessageError(f"{name}.{entry.name}: there is no type {nested}")
                value = (value + self._unrotated(nested, parents + (name,))) & _MASK
        self._types[name] = type(layout.name, (Message,), {
            "__slots__": tuple(f.name for f in layout.fields),
            "__doc__": f"The message type {name}.",
            "__module__": __name__,
            "TYPE": name,
            "FINGERPRINT": ((value << 1) | (value >> 63)) & _MASK,
            "FIELDS": tuple(layout.fields),
            "_codec": _Codec(layout, self._types),
            **layout.constants,
        })
        return self._types[name]

    def _unrotated(self, name: str, parents: tuple[str, ...]) -> int:
        """What a nested struct adds to the hash of the one that contains it: its own fingerprint."""
        return self._make(name, parents).FINGERPRINT
