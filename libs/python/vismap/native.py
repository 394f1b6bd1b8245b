"""XXH3 and zstd: from Python packages when they are installed, else from the C libraries that every Debian has."""
from __future__ import annotations

import ctypes
import functools
import importlib
from typing import Any, Callable

from .errors import MapError

Bytes = bytes | bytearray | memoryview


class _Hash128(ctypes.Structure):
    _fields_ = [("low", ctypes.c_uint64), ("high", ctypes.c_uint64)]


@functools.cache
def optional_module(name: str) -> Any:
    """A Python module; None when it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


@functools.cache
def _library(name: str) -> Any:
    try:
        return ctypes.CDLL(name)
    except OSError:
        return None


@functools.cache
def _xxh3_64() -> Callable[[bytes], int] | None:
    package, library = optional_module("xxhash"), _library("libxxhash.so.0")
    if package is not None and hasattr(package, "xxh3_64_intdigest"):
        return lambda data: int(package.xxh3_64_intdigest(data))
    if library is None:
        return None
    function = library.XXH3_64bits
    function.argtypes, function.restype = [ctypes.c_char_p, ctypes.c_size_t], ctypes.c_uint64
    return lambda data: int(function(data, len(data)))


@functools.cache
def _xxh3_128() -> Callable[[bytes], str] | None:
    package, library = optional_module("xxhash"), _library("libxxhash.so.0")
    if package is not None and hasattr(package, "xxh3_128_hexdigest"):
        return lambda data: str(package.xxh3_128_hexdigest(data))
    if library is None:
        return None
    function = library.XXH3_128bits
    function.argtypes, function.restype = [ctypes.c_char_p, ctypes.c_size_t], _Hash128

    def digest(data: bytes) -> str:
        value = function(data, len(data))
        return f"{value.high:016x}{value.low:016x}"
    return digest


def checksum64(data: Bytes) -> int | None:
    """XXH3 of bytes, 64 bits, unsigned; None when there is neither the package xxhash nor libxxhash."""
    function = _xxh3_64()
    return None if function is None else function(bytes(data))


def digest128(data: Bytes) -> str:
    """XXH3 of bytes, 128 bits, as 32 hexadecimal digits; "" when it cannot be computed."""
    function = _xxh3_128()
    return "" if function is None else function(bytes(data))


def zstd_content_size(data: Bytes) -> int:
    """The number of bytes that a zstd frame says that it expands to. Fails when it says none."""
    if len(data) < 5 or bytes(data[:4]) != b"\x28\xb5\x2f\xfd":
        raise MapError("these bytes do not begin like a zstd frame")
    descriptor = data[4]
    single = descriptor >> 5 & 1
    at = 5 + (1 - single) + (0, 1, 2, 4)[descriptor & 3]
    length = (single, 2, 4, 8)[descriptor >> 6]
    if length == 0 or len(data) < at + length:
        raise MapError("a zstd frame does not say to how many bytes it expands")
    return int.from_bytes(data[at:at + length], "little") + (256 if length == 2 else 0)


def zstd_decompress(data: Bytes, size: int) -> bytes:
    """The `size` bytes that a zstd frame expands to. Allocates no more. Fails when the frame is damaged or has another
    size, and when there is neither libzstd nor the package zstandard."""
    library = _library("libzstd.so.1")
    if library is not None:
        return _decompress_by_library(library, bytes(data), size)
    package = optional_module("zstandard")
    if package is None:
        raise MapError("map files are compressed by zstd, and neither libzstd nor the package zstandard is installed; "
                       "run: sudo apt-get install libzstd1")
    try:
        stream = package.ZstdDecompressor().stream_reader(bytes(data))
        expanded = bytes(stream.read(size + 1))
    except package.ZstdError as error:
        raise MapError(f"zstd cannot decompress it: {error}") from None
    if len(expanded) != size:
        raise MapError(f"zstd: expected {size} bytes, found {len(expanded)}{' or more' if len(expanded) > size else ''}")
    return expanded


def _decompress_by_library(library: Any, data: bytes, size: int) -> bytes:
    library.ZSTD_decompress.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t]
    library.ZSTD_decompress.restype = ctypes.c_size_t
    library.ZSTD_isError.argtypes, library.ZSTD_isError.restype = [ctypes.c_size_t], ctypes.c_uint
    library.ZSTD_getErrorName.argtypes, library.ZSTD_getErrorName.restype = [ctypes.c_size_t], ctypes.c_char_p
    buffer = ctypes.create_string_buffer(max(1, size))
    result = library.ZSTD_decompress(ctypes.cast(buffer, ctypes.c_char_p), size, data, len(data))
    if library.ZSTD_isError(result):
        raise MapError(f"zstd cannot decompress it: {library.ZSTD_getErrorName(result).decode()}")
    if result != size:
        raise MapError(f"zstd: expected {size} bytes, found {result}")
    return buffer.raw[:size]


