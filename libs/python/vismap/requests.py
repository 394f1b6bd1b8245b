"""Requests to the map server and their answers: save, load, ask."""
from __future__ import annotations

import json
import math
import time
from dataclasses import dataclass
from typing import Any, Sequence

import numpy as np

from . import messages
from .bus import Bus, Subscription, now_utime
from .errors import BusError, MessageError, RequestError, WaitTimeout

_OCTREE_FACTS = ("data_utime", "bbx_min_W", "bbx_max_W", "resolution_m", "unknown", "shell_m", "inflated_by_m")
_REPEAT_S = 3.0  # a request is sent again so often; the server carries it out once
_last_id = 0

Box = tuple[Sequence[float], Sequence[float]]


@dataclass(frozen=True)
class Reply:
    """The answer to a request."""

    message: str  # one sentence: what was done
    encoding: str  # of the payload: "json", "ply", "bt", "vismap"; "" = none
    payload: bytes
    map_id: str
    revision: int  # of the map that answered: the number of its frames
    octree: dict[str, Any] | None = None  # of an octree: data_utime, bbx_min_W, bbx_max_W, resolution_m, unknown, ...

    def json(self) -> Any:
        """The payload as JSON. Raises RequestError when it is none."""
        if self.encoding != "json":
            raise RequestError(f"the answer is no JSON but {self.encoding or 'a sentence'}: {self.message}")
        try:
            return json.loads(self.payload)
        except ValueError as error:
            raise RequestError(f"the answer is not valid JSON: {error}") from None


def _new_id() -> int:
    global _last_id
    _last_id = max(now_utime(), _last_id + 1)
    return _last_id


def ask(bus: Bus, verb: str, argument: str = "", path: str = "", box_W: Box | None = None, resolution_m: float = 0.0,
        unknown_occupied: bool | None = None, inflate_m: float = 0.0, timeout: float = 30.0,
        without: str = "", color: bool = False) -> Reply:
    """Sends a request to the map server (verbs "octomap...": to the octomap exporter), and waits for the answer.

    verb, argument, path: see procs/README.md, Requests; for example "statistics", "objects", "mesh" with "ply".
    box_W: two corners [m] in W, for objects, trees, grid, distances and frontiers. resolution_m: edge of a leaf, 0 = the
    server's own. unknown_occupied, for trees: False = raw, True, None = closed. inflate_m: radius of the robot, for closed
    trees and frontiers. without: objects that are left out, see tree_without. color, for octree: an .ot stream whose occupied
    leaves have the colour of their class, for looking only; leave unknown_occupied at None. Raises RequestError when the server refuses, WaitTimeout when no answer comes within
    `timeout` [s].
    """
    request: Any = messages.types["vismap.map_request_t"](
        verb=verb, argument=argument, path=path, resolution_m=resolution_m, inflate_m=inflate_m, without=without,
        unknown=-1 if unknown_occupied is None else int(unknown_occupied), tree=int(color))
    request.utime = request.request_id = _new_id()
    if box_W is not None:
        corners = np.asarray(box_W, np.float64)
        if corners.shape != (2, 3) or not np.all(np.isfinite(corners)):
            raise ValueError("box_W must be two corners with three coordinates each [m]")
        request.has_bbx, request.bbx_min_W, request.bbx_max_W = True, corners.min(axis=0), corners.max(axis=0)
    replies = bus.subscribe("MAP_REPLY")
    try:
        return _wait_for_reply(bus, replies, request, timeout)
    finally:
        replies.close()


def _wait_for_reply(bus: Bus, replies: Subscription, request: Any, timeout: float) -> Reply:
    end, next_attempt, error = time.monotonic() + timeout, -math.inf, ""
    while (now := time.monotonic()) < end:
        if now >= next_attempt:
            next_attempt = now + _REPEAT_S
            try:
                bus.publish("MAP_REQUEST", request)
            except BusError as failed:
                error, next_attempt = f" ({failed})", now + 0.25
        received = replies.poll(max(0.0, min(end, next_attempt) - time.monotonic()))
        if received is None:
            continue
        try:
            reply = received.decode()
        except MessageError as damaged:
            error = f" ({damaged})"
            continue
        if (reply.requester, reply.request_id) != (bus.name, request.request_id):
            continue
        if not reply.ok:
            raise RequestError(f"the server rejected the request '{request.verb}': {reply.message}")
        facts = {name: getattr(reply, name) for name in _OCTREE_FACTS} if reply.has_octree else None
        return Reply(reply.message, reply.encoding, reply.payload, reply.map_id, reply.revision, facts)
    raise WaitTimeout(f"no answer to the request '{request.verb}' within {timeout:g} s on {bus.url}{error}; "
                      "check with vismap-doctor that vismap-map-server is running on this bus")


def save(bus: Bus, name: str = "", timeout: float = 60.0) -> str:
    """Saves the map under a name in the folder of the server (map_server.map_folder); "" = to its own file
    (save_on_exit). Returns the sentence that says where. A name has letters, digits, '-', '_' and '.'."""
    return ask(bus, "save", path=name, timeout=timeout).message


def load(bus: Bus, name: str, timeout: float = 60.0) -> str:
    """Replaces the map of the server by the saved map of this name. Returns the sentence that says what was loaded."""
    return ask(bus, "load", path=name, timeout=timeout).message


def reset(bus: Bus, timeout: float = 60.0) -> str:
    """Replaces the map of the server by an empty one with another map_id. Returns the sentence that names it. The map is
    lost unless it was saved."""
    return ask(bus, "reset", timeout=timeout).message
