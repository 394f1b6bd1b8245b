"""vismap from Python: publish frames, read the live map, its objects and free space, save and load, logs, saved maps.

README.md has every task in about five lines. The world frame is W; lengths are in metres, times are `utime`, microseconds
since 1970. Errors are VismapError, or ValueError for arguments that cannot be right.
"""
from .bus import Bus, Received, Subscription, now_utime
from .clocks import DeviceClock, Newest, Pace
from .distances import Distances, distances, distances_of
from .errors import BusError, LogError, MapError, MessageError, RequestError, VismapError, WaitTimeout
from .frames import Camera, color_of, depth_of, frame_message, publish_frame
from .lcm_types import Message
from .live_map import LiveMap, Mesh, MeshFollower
from .live_octree import LiveOctree
from .logs import LogEvent, LogReader, LogWriter
from .map_file import SavedMap, open_map
from .messages import decode, encode, types, version
from .navigation import Clearance, Frontier, Grid, distance, frontiers, grid
from .objects import MapObject, OrientedBox, get_objects, objects_of
from .octree import FREE, OCCUPIED, UNKNOWN, Octree, read_octree, tree_without
from .requests import Reply, ask, load, reset, save
from .space import LiveSpace, Space, SpaceFollower, space_of
from .status import Status

__version__ = version()
__all__ = [
    "Bus", "BusError", "Camera", "Clearance", "DeviceClock", "Distances", "FREE", "Frontier", "Grid", "LiveMap",
    "LiveOctree", "LiveSpace", "LogError", "LogEvent", "LogReader", "LogWriter", "MapError", "MapObject", "Mesh",
    "MeshFollower", "Message", "MessageError", "Newest", "OCCUPIED", "Octree", "OrientedBox", "Pace", "Received",
    "Reply", "RequestError", "SavedMap", "Space", "SpaceFollower", "Status", "Subscription", "UNKNOWN", "VismapError",
    "WaitTimeout", "ask", "color_of", "decode", "depth_of", "distance", "distances", "distances_of", "encode",
    "frame_message", "frontiers", "get_objects", "grid", "load", "now_utime", "objects_of", "open_map",
    "publish_frame", "read_octree", "reset", "save", "space_of", "tree_without", "types", "version",
]
