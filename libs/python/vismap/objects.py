"""The objects of a map, with oriented boxes."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from .bus import Bus
from .errors import MapError
from .requests import Box, ask

_UNIT_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


@dataclass(frozen=True)
class OrientedBox:
    """An upright box around an object, in the world frame W."""

    center_W: npt.NDArray[np.float64]  # (3,) [m]
    size_m: npt.NDArray[np.float64]  # (3,) lengths of the edges [m]
    R_W_B: npt.NDArray[np.float64]  # (3, 3), its columns are the axes of the box: p_W = center_W + R_W_B * p_B

    def corners_W(self) -> npt.NDArray[np.float64]:
        """The eight corners, (8, 3) [m]."""
        corners: npt.NDArray[np.float64] = self.center_W + (_UNIT_CORNERS * self.size_m) @ self.R_W_B.T
        return corners

    def contains(self, points_W: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Whether points (..., 3) [m] are inside; shape (...)."""
        points_B = (np.asarray(points_W, np.float64) - self.center_W) @ self.R_W_B
        inside: npt.NDArray[np.bool_] = np.all(np.abs(points_B) <= self.size_m / 2, axis=-1)
        return inside


@dataclass(frozen=True)
class MapObject:
    """One object of the map."""

    instance: int  # its id, never reused within a map; 0 = a discovered segment without an instance
    class_id: int  # COCO category id; 0 = unknown
    class_name: str  # "" = unknown
    score: float  # confidence, [0, 1]
    class_probabilities: dict[int, float]  # of all classes that detectors took it for; their sum is 1
    segments: tuple[int, ...]  # labels of its segments
    box: OrientedBox | None  # None when it was removed
    points: int  # number of vertices of its surface
    area_m2: float  # of its surface [m^2]
    frames: int  # in which it was seen
    first_utime: int  # of the first and the last of these frames [us]
    last_utime: int
    removed_utime: int  # of the frame in which it was found to be removed [us]; 0 = present
    kind: str = ""  # of a plane that no detector has named, such as "floor"; "" = none, or not told

    @property
    def discovered(self) -> bool:
        """Found by geometry alone, without a class from a detector."""
        return self.instance == 0


def rotation_of(w: float, x: float, y: float, z: float) -> npt.NDArray[np.float64]:
    """The rotation matrix (3, 3) of a quaternion, which need not be normalised. Raises MapError when it is 0 or not finite."""
    norm = float(np.linalg.norm([w, x, y, z]))
    if not 1e-6 < norm < 1e6:
        raise MapError(f"the quaternion ({w}, {x}, {y}, {z}) is no rotation")
    w, x, y, z = w / norm, x / norm, y / norm, z / norm
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def objects_of(message: Any) -> list[MapObject]:
    """The objects of an object_list_t, the message of OBJECTS, in its order: with an instance, discovered, removed."""
    def convert(entry: Any) -> MapObject:
        box = None if entry.removed_utime else OrientedBox(
            np.asarray(entry.center_W, np.float64), np.asarray(entry.size_m, np.float64), rotation_of(*entry.orientation))
        shares = dict(zip(map(int, entry.class_ids), map(float, entry.class_probabilities)))
        return MapObject(entry.instance, entry.class_id, entry.class_name, entry.score, shares,
                         tuple(map(int, entry.segments)), box, entry.points, entry.area_m2, entry.frames,
                         entry.first_utime, entry.last_utime, entry.removed_utime)
    return [convert(entry) for entry in message.objects]


def _from_json(entry: Any) -> MapObject:
    try:
        box = None
        if "center" in entry:
            x, y, z, w = entry["orientation"]
            box = OrientedBox(np.array(entry["center"], np.float64), np.array(entry["size"], np.float64), rotation_of(w, x, y, z))
        name = "" if entry["class_name"] == "unknown" and not entry["class"] else entry["class_name"]
        return MapObject(entry["instance"], entry["class"], name, entry["score"],
                         {int(key): share for key, share in entry.get("class_probabilities", {}).items()},
                         tuple(entry["segments"]), box, entry["points"], entry["area"], entry["frames"],
                         entry["first_utime"], entry["last_utime"], entry.get("removed_utime", 0), entry.get("kind", ""))
    except (KeyError, TypeError, ValueError) as error:
        raise MapError(f"an object in the answer of the server cannot be read: {error!r}; do both have the same version?") from None


def objects_from_json(document: Any) -> list[MapObject]:
    """The objects of a parsed objects.json: with an instance, discovered, planes of the structure, removed."""
    if not isinstance(document, dict):
        raise MapError("objects.json: expected an object at the top")
    return [_from_json(entry) for key in ("objects", "discovered", "structure", "removed") for entry in document.get(key, [])]


def get_objects(bus: Bus, filters: str = "", region_W: Box | None = None, timeout: float = 30.0) -> list[MapObject]:
    """The objects of the running map server.

    filters: "id=7", "id=s12" (a segment) or "class=chair", separated by ';'; "" = all. region_W: two corners [m]; only what
    reaches into this box. An unknown id or class is a RequestError that says what is known.
    """
    return objects_from_json(ask(bus, "objects", filters, box_W=region_W, timeout=timeout).json())
