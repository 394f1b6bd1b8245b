"""PNG and JPEG files to arrays: by Pillow or OpenCV when one of them is installed, PNG also without them."""
from __future__ import annotations

import io
import struct
import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import MessageError
from .native import optional_module

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}  # colour type -> samples per pixel
_MOST_PIXELS = 1 << 24
Pixels = npt.NDArray[np.uint8] | npt.NDArray[np.uint16]


def decode_png(data: bytes) -> Pixels:
    """The samples of a PNG file: (H, W) of a grey one, (H, W, 3) or (H, W, 4) of a coloured one, (H, W, 2) of grey with
    transparency; uint16 when it has 16 bits, else uint8. Raises MessageError on data that is damaged, interlaced, has less
    than 8 bits, or has more than 2^24 pixels."""
    chunks = _chunks(data)
    head = next(chunks, None)
    if head is None or head[0] != b"IHDR" or len(head[1]) != 13:
        raise MessageError("a PNG does not begin with its head")
    width, height, bits, kind, packing, filtering, interlaced = struct.unpack(">IIBBBBB", head[1])
    if not 1 <= width * height <= _MOST_PIXELS:
        raise MessageError(f"a PNG has {width}x{height} pixels; at most {_MOST_PIXELS} are decoded")
    if kind not in _CHANNELS or bits not in (8, 16) or (packing, filtering, interlaced) != (0, 0, 0):
        raise MessageError(f"a PNG with {bits} bits, colour type {kind} and interlacing {interlaced} is not decoded here")
    packed, palette = bytearray(), None
    for name, content in chunks:
        if name == b"IDAT":
            packed += content
        elif name == b"PLTE":
            palette = np.frombuffer(content[:len(content) // 3 * 3], np.uint8).reshape(-1, 3)
    pixel = _CHANNELS[kind] * bits // 8
    rows = _unfiltered(_inflate(bytes(packed), height * (1 + width * pixel)), height, width * pixel, pixel)
    if kind == 3:
        if palette is None or int(rows.max()) >= len(palette):
            raise MessageError("a PNG refers to colours that its palette does not have")
        coloured: npt.NDArray[np.uint8] = palette[rows]
        return coloured
    samples: Pixels = rows.view(">u2").astype(np.uint16) if bits == 16 else rows
    return samples.reshape(height, width) if _CHANNELS[kind] == 1 else samples.reshape(height, width, _CHANNELS[kind])


def _chunks(data: bytes) -> Any:
    if not data.startswith(_SIGNATURE):
        raise MessageError("these bytes are no PNG")
    at = len(_SIGNATURE)
    while at + 8 <= len(data):
        size, name = int.from_bytes(data[at:at + 4], "big"), bytes(data[at + 4:at + 8])
        if at + 12 + size > len(data):
            break
        content = bytes(data[at + 8:at + 8 + size])
        if zlib.crc32(name + content) != int.from_bytes(data[at + 8 + size:at + 12 + size], "big"):
            raise MessageError("a PNG is damaged: a checksum does not match")
        if name == b"IEND":
            return
        yield name, content
        at += 12 + size
    raise MessageError("a PNG is cut off")


def _inflate(packed: bytes, size: int) -> bytes:
    try:
        plain = zlib.decompressobj().decompress(packed, size + 1)
    except zlib.error as error:
        raise MessageError(f"a PNG is damaged: {error}") from None
    if len(plain) != size:
        raise MessageError(f"a PNG has {len(plain)} bytes of pixels; expected {size}")
    return plain


def _unfiltered(plain: bytes, height: int, row: int, pixel: int) -> npt.NDArray[np.uint8]:
    lines = np.frombuffer(plain, np.uint8).reshape(height, 1 + row)
    result = np.empty((height, row), np.uint8)
    above = np.zeros(row, np.uint8)
    for number, line in enumerate(lines):
        result[number] = above = _unfiltered_row(int(line[0]), line[1:], above, pixel)
    return result


def _unfiltered_row(kind: int, line: npt.NDArray[np.uint8], above: npt.NDArray[np.uint8], pixel: int) -> npt.NDArray[np.uint8]:
    if kind == 0:
        return line
    if kind == 1:
        return np.cumsum(line.reshape(-1, pixel), axis=0, dtype=np.uint8).reshape(-1)
    if kind == 2:
        return line + above
    if kind not in (3, 4):
        raise MessageError(f"a PNG is damaged: a row has the filter {kind}")
    values, up = line.tolist(), above.tolist()
    for i, b in enumerate(up):
        a, c = (values[i - pixel], up[i - pixel]) if i >= pixel else (0, 0)
        if kind == 3:
            predicted = (a + b) // 2
        else:
            pa, pb, pc = abs(b - c), abs(a - c), abs(a + b - 2 * c)
            predicted = a if pa <= pb and pa <= pc else b if pb <= pc else c
        values[i] = (values[i] + predicted) & 255
    return np.array(values, np.uint8)


def decode_depth_png(data: bytes, height: int, width: int) -> npt.NDArray[np.uint16]:
    """A PNG with one channel of 16 bits and a known size. Raises MessageError on another one."""
    _check_png_size(data, height, width)
    opencv = optional_module("cv2")
    image: Any = None
    if opencv is not None:  # is much faster
        image = opencv.imdecode(np.frombuffer(data, np.uint8), opencv.IMREAD_UNCHANGED)
    if image is None:
        image = decode_png(data)
    if image.dtype != np.uint16 or image.shape != (height, width):
        raise MessageError(f"rgbd_frame_t: depth is a PNG of shape {image.shape} of {image.dtype}; expected "
                           f"{(height, width)} of uint16")
    depth: npt.NDArray[np.uint16] = image
    return depth


def decode_color_file(data: bytes, height: int, width: int) -> npt.NDArray[np.uint8]:
    """A PNG or JPEG of a known size as (H, W, 3) red, green, blue. Raises MessageError on another size, on damaged data, and
    on a JPEG when neither Pillow nor OpenCV is installed."""
    is_png = data.startswith(_SIGNATURE)
    if is_png:
        _check_png_size(data, height, width)
        image = _rgb8(decode_png(data))
    else:
        image = _decode_jpeg(data, height, width)
    if image.shape != (height, width, 3):
        raise MessageError(f"rgbd_frame_t: the colour image has the shape {image.shape}; expected {(height, width, 3)}")
    return image


def _check_png_size(data: bytes, height: int, width: int) -> None:
    found = struct.unpack(">II", data[16:24]) if len(data) >= 24 else (0, 0)
    if found != (width, height):
        raise MessageError(f"rgbd_frame_t: a PNG has {found[0]}x{found[1]} pixels; expected {width}x{height}")


def _rgb8(pixels: Pixels) -> npt.NDArray[np.uint8]:
    eight: npt.NDArray[Any] = (pixels >> 8).astype(np.uint8) if pixels.dtype == np.uint16 else pixels
    if eight.ndim == 2 or eight.shape[2] == 2:
        grey = eight if eight.ndim == 2 else eight[:, :, 0]
        return np.repeat(grey[:, :, None], 3, axis=2)
    return np.ascontiguousarray(eight[:, :, :3])


def _jpeg_size(data: bytes) -> tuple[int, int]:
    """Width and height that the head of a JPEG states; (0, 0) when it has none."""
    at = 2
    while at + 9 <= len(data) and data[at] == 0xff:
        marker, size = data[at + 1], int.from_bytes(data[at + 2:at + 4], "big")
        if 0xc0 <= marker <= 0xcf and marker not in (0xc4, 0xc8, 0xcc):
            height, width = struct.unpack(">HH", data[at + 5:at + 9])
            return width, height
        at += 2 + size
    return 0, 0


def _decode_jpeg(data: bytes, height: int, width: int) -> npt.NDArray[np.uint8]:
    found = _jpeg_size(data) if data.startswith(b"\xff\xd8") else (0, 0)
    if found != (width, height):
        raise MessageError(f"rgbd_frame_t: a JPEG has {found[0]}x{found[1]} pixels; expected {width}x{height}")
    pillow, opencv = optional_module("PIL.Image"), optional_module("cv2")
    if pillow is None and opencv is None:
        raise MessageError("a JPEG is decoded by Pillow or OpenCV, and neither is installed; run: sudo apt-get install python3-pil")
    try:
        if pillow is not None:
            with pillow.open(io.BytesIO(data), formats=["JPEG"]) as image:
                return np.array(image.convert("RGB"), np.uint8)
        decoded = opencv.imdecode(np.frombuffer(data, np.uint8), opencv.IMREAD_COLOR)
    except Exception as error:  # the libraries have many kinds
        raise MessageError(f"rgbd_frame_t: a JPEG cannot be decoded: {error}") from None
    if decoded is None:
        raise MessageError("rgbd_frame_t: a JPEG cannot be decoded")
    return np.ascontiguousarray(decoded[:, :, ::-1])
