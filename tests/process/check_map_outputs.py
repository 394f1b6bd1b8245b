"""Compares what vismap-adapter has published of a map with the surface and the objects that the map server has.

Reads the messages with the Python that lcm-gen makes of their types.
Usage: check_map_outputs.py FOLDER_OF_TYPES FOLDER_OF_MESSAGES
"""
import json
import math
import pathlib
import struct
import sys

sys.path.insert(0, sys.argv[1])
from drake import lcmt_point_cloud, lcmt_viewer_link_data  # noqa: E402
from nav_msgs import OccupancyGrid  # noqa: E402
from robotlocomotion import viewer2_comms_t  # noqa: E402
from sensor_msgs import PointCloud2  # noqa: E402
from vision_msgs import Detection3DArray  # noqa: E402

FOLDER = pathlib.Path(sys.argv[2])
SPACING_M = 0.05


def read(kind, name):
    return kind.decode((FOLDER / name).read_bytes())


def near(found, expected, tolerance=2e-6):
    assert len(found) == len(expected), (found, expected)
    for a, b in zip(found, expected):
        assert math.isclose(a, b, abs_tol=tolerance), (found, expected)


def read_surface():
    """(x, y, z) as float32 -> (r, g, b) of all vertices of the server's surface."""
    data = (FOLDER / "surface.ply").read_bytes()
    header, body = data.split(b"end_header\n", 1)
    count = int(header.split(b"element vertex ")[1].split()[0])
    size = struct.calcsize("<6f3BIIH")
    return {vertex[:3]: vertex[6:9] for vertex in struct.iter_unpack("<6f3BIIH", body[:size * count])}


def read_objects():
    """Name -> object, of those that are there and are no structure."""
    listed = json.loads((FOLDER / "objects.json").read_text())
    found = {f"instance_{thing['instance']}_{thing['class_name'].replace(' ', '_')}": thing for thing in listed["objects"]}
    return found | {f"segment_{thing['segments'][0]}": thing for thing in listed["discovered"]}


SURFACE, OBJECTS = read_surface(), read_objects()


def cube(point):
    return tuple(math.floor(value / SPACING_M) for value in point)


def check_points(points):
    """One vertex of each cube that has some, with its colour."""
    assert len(points) == len({cube(p) for p in SURFACE}), len(points)
    assert len({cube(p) for p, _ in points}) == len(points)
    for point, color in points:
        assert SURFACE[point] == color, (point, color, SURFACE.get(point))


def check_point_cloud2():
    cloud = read(PointCloud2, "cloud")
    assert cloud.header.frame_id == "world" and cloud.header.seq == 0
    assert (cloud.height, cloud.point_step, cloud.row_step) == (1, 16, 16 * cloud.width)
    assert [(f.name, f.offset, f.datatype, f.count) for f in cloud.fields] == [
        ("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1), ("rgb", 12, 7, 1)]
    assert not cloud.is_bigendian and cloud.is_dense and len(cloud.data) == 16 * cloud.width
    check_points([(p[:3], (p[3] >> 16, p[3] >> 8 & 255, p[3] & 255))
                  for p in struct.iter_unpack("<fffI", bytes(cloud.data))])
    return cloud


def check_drake_cloud():
    cloud = read(lcmt_point_cloud, "drake_cloud")
    assert (cloud.height, cloud.flags, cloud.frame_name) == (1, 2, "world")
    assert (cloud.point_step, cloud.row_step) == (16, 16 * cloud.width)
    assert cloud.filler_size == 0 and cloud.data_size == 16 * cloud.width
    assert [(f.name, f.byte_offset, f.datatype, f.count) for f in cloud.fields] == [
        ("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1), ("rgb", 12, 6, 1)]
    check_points([(p[:3], p[3:6]) for p in struct.iter_unpack("<fffBBBB", bytes(cloud.data))])
    stamp = read(PointCloud2, "cloud").header.stamp
    assert stamp.sec * 1000000 + stamp.nsec // 1000 == cloud.utime


def check_costmap():
    grid = read(OccupancyGrid, "costmap")
    assert grid.header.frame_id == "world"
    near((grid.info.resolution,), (0.05,))
    assert grid.info.width > 20 and grid.info.height > 20
    assert len(grid.data) == grid.info.width * grid.info.height
    assert set(grid.data) == {-1, 0, 100}, set(grid.data)
    orientation = grid.info.origin.orientation
    assert (orientation.x, orientation.y, orientation.z, orientation.w) == (0, 0, 0, 1)
    step = 0.05
    near_occupied, walls = 0, 0
    for x, y, z in SURFACE:
        if not 0.15 < z < 0.95:
            continue
        walls += 1
        column = math.floor((x - grid.info.origin.position.x) / step)
        row = math.floor((y - grid.info.origin.position.y) / step)
        around = [grid.data[v * grid.info.width + u]
                  for v in range(max(0, row - 1), min(grid.info.height, row + 2))
                  for u in range(max(0, column - 1), min(grid.info.width, column + 2))]
        near_occupied += 100 in around
    assert walls > 1000 and near_occupied > 0.98 * walls, (near_occupied, walls)


def check_box(thing, center, size, quaternion_xyzw):
    near(center, thing["center"])
    near(size, thing["size"])
    sign = -1 if quaternion_xyzw[3] < 0 else 1
    near([sign * value for value in quaternion_xyzw], thing["orientation"])


def check_detections():
    array = read(Detection3DArray, "detections")
    assert array.header.frame_id == "world"
    assert len(OBJECTS) >= 3, "the room has several objects"
    names = sorted(d.id for d in array.detections)
    assert names == sorted(OBJECTS), (names, sorted(OBJECTS))
    for found in array.detections:
        thing = OBJECTS[found.id]
        assert found.results_length == 1 and found.header.frame_id == "world"
        hypothesis = found.results[0].hypothesis
        assert hypothesis.class_id == ("" if found.id.startswith("segment") else thing["class_name"])
        near((hypothesis.score,), (thing["score"],))
        pose, size = found.bbox.center, found.bbox.size
        check_box(thing, (pose.position.x, pose.position.y, pose.position.z), (size.x, size.y, size.z),
                  (pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w))


def check_deformable():
    link = read(lcmt_viewer_link_data, "deformable")
    assert link.name == "vismap" and link.robot_num == 0 and link.num_geom == len(link.geom)
    geometries = {g.string_data: g for g in link.geom}
    assert sorted(name[4:] for name in geometries if name.startswith("box/")) == sorted(OBJECTS)
    for name, geometry in geometries.items():
        assert geometry.type == 4 and list(geometry.position) == [0, 0, 0]
        assert list(geometry.quaternion) == [1, 0, 0, 0] and all(0 <= c <= 1 for c in geometry.color)
        vertices, triangles = int(geometry.float_data[0]), int(geometry.float_data[1])
        assert geometry.num_float_data == 2 + 3 * vertices + 3 * triangles and triangles > 0
        points = list(zip(*[iter(geometry.float_data[2:2 + 3 * vertices])] * 3))
        assert all(0 <= index < vertices for index in geometry.float_data[2 + 3 * vertices:])
        thing = OBJECTS[name.split("/")[1]]
        if name.startswith("box/"):
            assert (vertices, triangles) == (8, 12)
            near([sum(p[axis] for p in points) / 8 for axis in range(3)], thing["center"], 1e-5)
            diagonal = max(math.dist(a, b) for a in points for b in points)
            near((diagonal,), (math.hypot(*thing["size"]),), 1e-5)
        else:
            assert all(point in SURFACE for point in points), name


def check_treeviewer():
    message = read(viewer2_comms_t, "director")
    assert (message.format, message.format_version_major, message.format_version_minor) == ("treeviewer_json", 1, 0)
    assert message.num_bytes == len(message.data)
    data = json.loads(bytes(message.data))
    assert data["timestamp"] == message.utime
    shown = {tuple(entry["path"]): entry["geometry"] for entry in data["setgeometry"]}
    surface = shown.pop(("vismap", "surface"))
    assert surface["type"] == "pointcloud"
    assert len(surface["points"]) == read(PointCloud2, "cloud").width == len(surface["channels"]["rgb"])
    for point, color in zip(surface["points"], surface["channels"]["rgb"]):
        exact = struct.unpack("<fff", struct.pack("<fff", *point))
        near(color, [value / 255 for value in SURFACE[exact]])
    places = {tuple(entry["path"]): entry["transform"] for entry in data["settransform"]}
    assert sorted(path[2] for path in shown) == sorted(OBJECTS) and places.keys() == shown.keys()
    for path, geometry in shown.items():
        assert geometry["type"] == "box" and path[:2] == ("vismap", "objects")
        w, x, y, z = places[path]["quaternion"]
        check_box(OBJECTS[path[2]], places[path]["translation"], geometry["lengths"], (x, y, z, w))


for check in (check_point_cloud2, check_drake_cloud, check_costmap, check_detections, check_deformable, check_treeviewer):
    check()
    print(check.__name__)
