"""Frames of an RGB-D camera: arrays to messages, and messages to arrays."""
from __future__ import annotations

import math
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import messages
from .bus import Bus, now_utime
from .errors import MessageError
from .images import decode_color_file, decode_depth_png
from .native import zstd_decompress

Depth = npt.NDArray[np.uint16] | npt.NDArray[np.float32] | npt.NDArray[np.float64]
_MOST_PIXELS = 4096 * 4096
_NONE, _BROWN_CONRADY, _EQUIDISTANT = 0, 1, 2
_ZSTD_DELTA, _RAW_16, _PNG_16, _ZLIB_16, _FLOAT_M = 1, 2, 3, 4, 5
_NO_COLOR, _JPEG, _PNG, _GREY = 0, 1, 2, 7
_CHANNELS = {3: 3, 4: 3, 5: 4, 6: 4, 7: 1}  # encoding of raw colour -> bytes per pixel
_RAW = {("rgb", 3): 3, ("bgr", 3): 4, ("rgb", 4): 5, ("bgr", 4): 6}  # order and bytes per pixel -> encoding


@dataclass(frozen=True)
class Camera:
    """The optics of a camera. Pixel centres have whole coordinates.

    distortion: coefficients of the lens; none, or 4, 5 or 8 in OpenCV's order k1 k2 p1 p2 [k3 [k4 k5 k6]] (Brown-Conrady);
    of a fisheye lens 4, k1 k2 k3 k4 (Kannala-Brandt, equidistant).
    """

    width: int  # [px]
    height: int
    fx: float  # focal lengths and principal point [px]
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, ...] = ()
    fisheye: bool = False

    def __post_init__(self) -> None:
        if self.width < 1 or self.height < 1 or self.width * self.height > _MOST_PIXELS:
            raise ValueError(f"the camera has {self.width}x{self.height} pixels; expected at least 1x1 and at most {_MOST_PIXELS} in all")
        numbers = (self.fx, self.fy, self.cx, self.cy, *self.distortion)
        if not all(math.isfinite(number) for number in numbers) or self.fx <= 0 or self.fy <= 0:
            raise ValueError(f"fx, fy, cx, cy and distortion must be finite, and fx and fy positive pixels; found {numbers}")
        allowed = (0, 4) if self.fisheye else (0, 4, 5, 8)
        if len(self.distortion) not in allowed:
            raise ValueError(f"distortion has {len(self.distortion)} coefficients; expected {' or '.join(map(str, allowed))}"
                             f"{' for a fisheye lens' if self.fisheye else ''}")

    def message(self) -> Any:
        """The camera_t."""
        kind = _NONE if not any(self.distortion) else _EQUIDISTANT if self.fisheye else _BROWN_CONRADY
        return messages.types["vismap.camera_t"](
            width=self.width, height=self.height, fx=float(self.fx), fy=float(self.fy), cx=float(self.cx), cy=float(self.cy),
            distortion=kind, coefficients=np.array(self.distortion if kind else (), np.float64))


def check_pose(T: npt.ArrayLike, name: str = "T_W_C") -> npt.NDArray[np.float64]:
    """A pose as a 4x4 matrix. Raises ValueError unless it is finite and rigid, with the last row 0 0 0 1."""
    matrix = np.asarray(T, np.float64)
    if matrix.shape != (4, 4):
        raise ValueError(f"{name} has the shape {matrix.shape}; expected a 4x4 matrix")
    if not np.all(np.isfinite(matrix)):
        raise ValueError(f"{name} has a NaN or infinite entry; do not publish frames without a pose")
    if np.abs(matrix[3] - [0, 0, 0, 1]).max() > 1e-6:
        raise ValueError(f"{name} has the last row {matrix[3]}; expected [0 0 0 1]; is the matrix written column by column?")
    R = matrix[:3, :3]
    off = float(np.abs(R @ R.T - np.eye(3)).max())
    if off > 1e-3 or np.linalg.det(R) < 0:
        raise ValueError(f"{name} is not rigid: |R R^T - I| is {off:.3g} (at most 0.001), det R is {np.linalg.det(R):.3g} (expected +1)")
    return matrix


def frame_message(depth: Depth, T_W_C: npt.ArrayLike, camera: Camera, color: npt.NDArray[np.uint8] | bytes | None = None, *,
                  depth_camera: Camera | None = None, T_color_depth: npt.ArrayLike | None = None, depth_unit_m: float = 0.001,
                  camera_id: int = 0, utime: int | None = None, frame_number: int = -1, color_order: str = "rgb",
                  compress: bool = False) -> Any:
    """The rgbd_frame_t of one frame. Raises ValueError on everything that readers would refuse.

    depth: (H, W) along the optical axis, not along the ray. uint16 in steps of depth_unit_m, 0 and 65535 = not measured;
        or float [m], NaN and what is not above 0 = not measured.
    T_W_C: 4x4, p_W = T_W_C * p_C [m]; C is the colour camera, or the depth camera when there is no colour: x right, y down,
        z forward.
    camera: the optics of the colour camera, and of depth that has the pixels of the colour image.
    color: (H, W, 3) or (H, W, 4) in color_order ("rgb" or "bgr"), (H, W) grey, the bytes of a JPEG or PNG file, or None.
    depth_camera, T_color_depth: of depth that was not carried over to the colour camera: its own optics, and
        p_color = T_color_depth * p_depth [m].
    utime: when the images were taken [us since 1970]; None = now. With camera_id it identifies the frame.
    compress: pack uint16 depth by zlib, for slow networks.
    """
    if camera_id < 0 or not 0 < depth_unit_m <= 1:
        raise ValueError(f"camera_id is {camera_id}, expected at least 0; depth_unit_m is {depth_unit_m}, expected (0, 1] m")
    if (depth_camera is None) != (T_color_depth is None):
        raise ValueError("give both depth_camera and T_color_depth, or none of them when depth is registered to colour")
    if depth_camera is not None and color is None:
        raise ValueError("without colour give the optics of the depth camera as camera, and its pose as T_W_C")
    encoding, content = _encode_depth(np.asarray(depth), depth_camera or camera, compress)
    color_encoding, color_bytes = _encode_color(color, camera, color_order)
    return messages.types["vismap.rgbd_frame_t"](
        utime=now_utime() if utime is None else utime, camera_id=camera_id, frame_number=frame_number, after_utime=-1,
        T_W_C=check_pose(T_W_C).reshape(16), color_camera=camera.message(), depth_camera=(depth_camera or camera).message(),
        depth_registered=depth_camera is None,
        T_color_depth=check_pose(np.eye(4) if T_color_depth is None else T_color_depth, "T_color_depth").reshape(16),
        depth_unit_m=float(depth_unit_m), depth_encoding=encoding, depth=content, color_encoding=color_encoding,
        color=color_bytes)


def publish_frame(bus: Bus, depth: Depth, T_W_C: npt.ArrayLike, camera: Camera,
                  color: npt.NDArray[np.uint8] | bytes | None = None, **options: Any) -> int:
    """Publishes one frame on RGBD_FRAME; arguments as of frame_message(). Returns its utime [us]."""
    message = frame_message(depth, T_W_C, camera, color, **options)
    bus.publish("RGBD_FRAME", message)
    return int(message.utime)


def _encode_depth(depth: npt.NDArray[Any], camera: Camera, compress: bool) -> tuple[int, bytes]:
    if depth.shape != (camera.height, camera.width):
        raise ValueError(f"depth has the shape {depth.shape}; its camera has (height, width) = {(camera.height, camera.width)}")
    if depth.dtype == np.uint16:
        raw = depth.astype("<u2", copy=False).tobytes()
        return (_ZLIB_16, zlib.compress(raw, 1)) if compress else (_RAW_16, raw)
    if depth.dtype.kind == "f":
        return _FLOAT_M, depth.astype("<f4", copy=False).tobytes()
    raise ValueError(f"depth is an array of {depth.dtype}; expected uint16 (steps of depth_unit_m) or float [m]")


def _encode_color(color: npt.NDArray[np.uint8] | bytes | None, camera: Camera, order: str) -> tuple[int, bytes]:
    if color is None:
        return _NO_COLOR, b""
    if isinstance(color, (bytes, bytearray, memoryview)):
        data = bytes(color)
        if data.startswith(b"\xff\xd8\xff"):
            return _JPEG, data
        if data.startswith(b"\x89PNG\r\n\x1a\n"):
            return _PNG, data
        raise ValueError("color is neither an array nor the bytes of a JPEG or PNG file")
    if color.dtype != np.uint8 or color.shape[:2] != (camera.height, camera.width):
        raise ValueError(f"color is an array of {color.dtype} of shape {color.shape}; expected uint8, and the (height, width) of "
                         f"its camera, {(camera.height, camera.width)}")
    if color.ndim == 2:
        return _GREY, color.tobytes()
    encoding = _RAW.get((order, color.shape[2])) if color.ndim == 3 else None
    if encoding is None:
        raise ValueError(f"color has the shape {color.shape} and the order '{order}'; expected 3 or 4 channels, and rgb or bgr")
    return encoding, color.tobytes()


def _depth_size(message: Any) -> tuple[int, int]:
    if hasattr(type(message), "width"):  # the first version of the type
        return message.height, message.width
    registered = message.depth_registered and message.color_encoding != _NO_COLOR
    camera = message.color_camera if registered else message.depth_camera
    return camera.height, camera.width


def depth_of(message: Any) -> npt.NDArray[np.float32]:
    """The depth of an rgbd_frame_t (H, W) [m]; NaN = not measured. Raises MessageError on bytes that are no such image."""
    height, width = _depth_size(message)
    if height < 1 or width < 1 or height * width > _MOST_PIXELS:
        raise MessageError(f"rgbd_frame_t: the depth image has {width}x{height} pixels; at most {_MOST_PIXELS} are decoded")
    size, encoding = 2 * height * width, message.depth_encoding
    if encoding == _FLOAT_M:
        metres = np.frombuffer(_exactly(message.depth, 2 * size), "<f4").astype(np.float32)
        metres[~(np.isfinite(metres) & (metres > 0))] = np.nan
        return metres.reshape(height, width)
    if encoding == _ZSTD_DELTA:
        steps = _unfold(zstd_decompress(message.depth, size))
    elif encoding == _RAW_16:
        steps = np.frombuffer(_exactly(message.depth, size), "<u2")
    elif encoding == _ZLIB_16:
        steps = np.frombuffer(_exactly(_inflate(message.depth, size), size), "<u2")
    elif encoding == _PNG_16:
        steps = decode_depth_png(bytes(message.depth), height, width).reshape(-1)
    else:
        raise MessageError(f"rgbd_frame_t: depth_encoding {encoding} is unknown")
    depth = steps.astype(np.float32) * np.float32(message.depth_unit_m)
    depth[(steps == 0) | (steps == 65535)] = np.nan
    return depth.reshape(height, width)


def color_of(message: Any) -> npt.NDArray[np.uint8] | None:
    """The colour of an rgbd_frame_t as (H, W, 3) red, green, blue; None when there is none. Raises MessageError on bytes that
    are no such image, and on a JPEG when neither Pillow nor OpenCV is installed."""
    encoding = message.color_encoding
    if encoding == _NO_COLOR:
        return None
    if encoding not in _CHANNELS and encoding not in (_JPEG, _PNG):
        raise MessageError(f"rgbd_frame_t: color_encoding {encoding} is unknown")
    camera = message if hasattr(type(message), "width") else message.color_camera  # of the first version of the type
    height, width = camera.height, camera.width
    if height < 1 or width < 1 or height * width > _MOST_PIXELS:
        raise MessageError(f"rgbd_frame_t: the colour image has {width}x{height} pixels; at most {_MOST_PIXELS} are decoded")
    if encoding in (_JPEG, _PNG):
        return decode_color_file(bytes(message.color), height, width)
    channels = _CHANNELS[encoding]
    image = np.frombuffer(_exactly(message.color, height * width * channels), np.uint8).reshape(height, width, channels)
    if channels == 1:
        return np.repeat(image, 3, axis=2)
    return image[:, :, 2::-1].copy() if encoding in (4, 6) else image[:, :, :3].copy()


def _exactly(data: bytes, size: int) -> bytes:
    if len(data) != size:
        raise MessageError(f"rgbd_frame_t: an image has {len(data)} bytes; expected {size}")
    return data


def _inflate(data: bytes, most: int) -> bytes:
    try:
        return zlib.decompressobj().decompress(data, most + 1)
    except zlib.error as error:
        raise MessageError(f"rgbd_frame_t: zlib cannot decompress the depth: {error}") from None


def _unfold(planes: bytes) -> npt.NDArray[np.uint16]:
    """libs/codecs/depth_codec.h: the low bytes of all folded differences, then the high ones."""
    count = len(planes) // 2
    raw = np.frombuffer(planes, np.uint8).astype(np.uint16)
    folded = raw[:count] | raw[count:] << 8
    difference = (folded >> 1) ^ np.where(folded & 1, np.uint16(0xffff), np.uint16(0))
    steps: npt.NDArray[np.uint16] = np.cumsum(difference, dtype=np.uint16)
    return steps
