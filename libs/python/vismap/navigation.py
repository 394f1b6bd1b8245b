"""What planners ask: clearance of points, a grid for wheels, frontiers. The octomap exporter answers."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Sequence

import numpy as np
import numpy.typing as npt

from .bus import Bus
from .errors import MapError
from .messages import decode, types
from .octree import FREE, OCCUPIED, UNKNOWN
from .requests import Box, ask

_MOST_POINTS = 500  # of one request, which has at most 64 kB


@dataclass(frozen=True)
class Clearance:
    """Distances from points to the nearest face of an obstacle and of unknown space, exact up to limit_m; (...) each.

    Space outside of the map is unknown. A distance of limit_m says that nothing is within it.
    """

    distance_m: npt.NDArray[np.float64]  # the smaller of the next two [m]
    obstacle_m: npt.NDArray[np.float64]
    unknown_m: npt.NDArray[np.float64]
    gradient: npt.NDArray[np.float64]  # (..., 3) unit vectors away from what is nearest; 0 where there is none
    nearest: npt.NDArray[np.str_]  # "OBSTACLE", "UNKNOWN", or "NONE" when nothing is within the limit
    limit_m: float
    revision: int  # of the map: the number of its frames


def distance(bus: Bus, points_W: npt.ArrayLike, limit_m: float | None = None, resolution_m: float = 0.0,
             without: str = "", timeout: float = 30.0) -> Clearance:
    """How far one point (3,) or many (..., 3) [m] are from obstacles and from unknown space.

    limit_m: distances are exact up to here; None = as in the exporter's config, or 2 m. resolution_m: edge of a leaf; 0 =
    as in the config. without: objects that are left out, see procs/README.md, Without objects.
    """
    points = np.asarray(points_W, np.float64)
    if points.ndim < 1 or points.shape[-1] != 3 or not np.all(np.isfinite(points)):
        raise ValueError(f"expected finite points with 3 coordinates, found an array of shape {points.shape}")
    flat = points.reshape(-1, 3)
    if len(flat) == 0:
        raise ValueError("expected at least one point")
    rows: list[dict[str, Any]] = []
    for begin in range(0, len(flat), _MOST_POINTS):
        at = ";".join(",".join(repr(float(x)) for x in point) for point in flat[begin:begin + _MOST_POINTS])
        argument = f"at={at}" + ("" if limit_m is None else f";limit={float(limit_m)!r}")
        reply = ask(bus, "clearance", argument, resolution_m=resolution_m, without=without, timeout=timeout)
        answer = reply.json()
        rows += answer["points"]

    def column(name: str) -> npt.NDArray[Any]:
        return np.array([row[name] for row in rows])

    shape = points.shape[:-1]
    return Clearance(column("distance_m").reshape(shape), column("obstacle_m").reshape(shape),
                     column("unknown_m").reshape(shape), column("gradient").reshape(points.shape),
                     column("nearest").reshape(shape), float(answer["limit_m"]), reply.revision)


class Grid:
    """A grid for robots on wheels on the x-y plane of W. Arrays are indexed [y, x].

    states: FREE, OCCUPIED or UNKNOWN (H, W) int8; distances_m: from the centre of a cell to what is not free (H, W);
    floor_m: height of the floor, NaN where there is none (H, W); origin_W: corner of cell [0, 0] (2,) [m].
    """

    def __init__(self, message: Any) -> None:
        """message: an occupancy_grid_t, from GRID or a reply. Raises MapError when it contradicts itself."""
        shape = (message.height, message.width)
        if message.height < 0 or message.width < 0 or message.height * message.width != message.n_cells:
            raise MapError(f"occupancy_grid_t: {message.n_cells} cells, expected {message.height} x {message.width}")
        states = np.frombuffer(bytes(message.states), np.uint8)
        if np.any(states > 2) or not message.resolution_m > 0:
            raise MapError("occupancy_grid_t: expected states 0, 1 or 2, and a resolution above 0")
        self.resolution_m = float(message.resolution_m)
        self.origin_W = np.array(message.origin_W, np.float64)
        self.states = np.array([UNKNOWN, FREE, OCCUPIED], np.int8)[states].reshape(shape)
        self.distances_m = np.asarray(message.distances_m, np.float32).reshape(shape)
        self.floor_m = np.asarray(message.floor_m, np.float32).reshape(shape)
        self.map_id, self.revision, self.utime = str(message.map_id), int(message.revision), int(message.utime)

    def cells(self, points_W: npt.ArrayLike) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp], npt.NDArray[np.bool_]]:
        """Row and column of points (..., 2 or 3) [m], and whether they are inside; (...) each. 0 for those outside."""
        points = np.asarray(points_W, np.float64)[..., :2]
        at = np.floor((points - self.origin_W) / self.resolution_m)
        inside = np.all((at >= 0) & (at < self.states.shape[::-1]), axis=-1)
        clipped = np.where(inside[..., None], at, 0).astype(np.intp)
        return clipped[..., 1], clipped[..., 0], inside

    def state(self, points_W: npt.ArrayLike) -> npt.NDArray[np.int8]:
        """FREE, OCCUPIED or UNKNOWN of points (..., 2 or 3) [m]; UNKNOWN outside of the grid."""
        row, column, inside = self.cells(points_W)
        states: npt.NDArray[np.int8] = np.where(inside, self.states[row, column], UNKNOWN).astype(np.int8)
        return states


def grid(bus: Bus, box_W: Box | None = None, resolution_m: float = 0.0, robot_height_m: float | None = None,
         step_height_m: float | None = None, max_slope_deg: float | None = None, band_m: Sequence[float] | None = None,
         without: str = "", limit_m: float | None = None, timeout: float = 60.0) -> Grid:
    """A grid for wheels of the running map. What is None or 0 is as in the section ground_grid of the exporter's config.

    box_W: two corners [m]; only blocks that it touches. band_m: two heights z of W between which everything counts, in
    place of the floor. without: objects that are left out, see procs/README.md, Without objects. limit_m: distances_m are
    exact up to here.
    """
    options: dict[str, float | None] = {"height": robot_height_m, "step": step_height_m, "slope": max_slope_deg,
                                        "limit": limit_m}
    keys = [f"{key}={float(value)!r}" for key, value in options.items() if value is not None]
    if band_m is not None:
        keys.append("band=" + ",".join(repr(float(height)) for height in band_m))
    reply = ask(bus, "grid", ";".join(keys), box_W=box_W, resolution_m=resolution_m, without=without, timeout=timeout)
    return Grid(decode(reply.payload, types["vismap.occupancy_grid_t"]))


@dataclass(frozen=True)
class Frontier:
    """Free leaves beside unknown ones: where the map can grow."""

    leaves: int  # their number
    center_W: npt.NDArray[np.float64]  # (3,) mean of their centres [m]
    member_W: npt.NDArray[np.float64]  # (3,) centre of the leaf that is nearest to it [m]
    viewpoint_W: npt.NDArray[np.float64] | None  # (3,) from where a robot sees them [m]; None = from nowhere near


def frontiers(bus: Bus, box_W: Box | None = None, robot_radius_m: float = 0.0, resolution_m: float = 0.0,
              without: str = "", cluster_m: float | None = None, least_leaves: int | None = None,
              timeout: float = 60.0) -> list[Frontier]:
    """The frontiers of the running map, the largest first.

    box_W: only those whose centre is in it [m]. robot_radius_m: for viewpoints; 0 = as in the exporter's config. without:
    objects that are left out, see procs/README.md, Without objects. cluster_m: frontiers do not extend beyond cubes of this
    edge; None = 1 m. least_leaves: smaller ones are left out; None = 8.
    """
    options = {"cluster": cluster_m, "least": least_leaves}
    argument = ";".join(f"{key}={float(value)!r}" for key, value in options.items() if value is not None)
    reply = ask(bus, "frontiers", argument, box_W=box_W, resolution_m=resolution_m, inflate_m=robot_radius_m,
                without=without, timeout=timeout)
    return [Frontier(int(row["leaves"]), np.array(row["center_W"]), np.array(row["member_W"]),
                     None if row["viewpoint_W"] is None else np.array(row["viewpoint_W"]))
            for row in reply.json()["frontiers"]]
