"""Reads the messages that map_messages_test.cc wrote, with the Python that lcm-gen makes of the types.

Usage: read_map_messages.py FOLDER_OF_TYPES FOLDER_OF_MESSAGES
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
POINTS = [(0.5, 0.25, 1.5, (255, 128, 1)), (-2.0, 3.0, 0.125, (10, 20, 30))]


def read(kind, name):
    return kind.decode((FOLDER / name).read_bytes())


def near(found, expected):
    assert len(found) == len(expected), (found, expected)
    for a, b in zip(found, expected):
        assert math.isclose(a, b, abs_tol=1e-6), (found, expected)


def check_point_cloud2():
    cloud = read(PointCloud2, "cloud")
    assert (cloud.header.frame_id, cloud.header.stamp.sec, cloud.header.stamp.nsec) == ("world", 1760000000, 250000)
    assert (cloud.height, cloud.width, cloud.point_step, cloud.row_step) == (1, 2, 16, 32)
    assert [(f.name, f.offset, f.datatype, f.count) for f in cloud.fields] == [
        ("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1), ("rgb", 12, 7, 1)]
    assert not cloud.is_bigendian and cloud.is_dense
    for point, (x, y, z, (r, g, b)) in zip(struct.iter_unpack("<fffI", bytes(cloud.data)), POINTS):
        near(point[:3], (x, y, z))
        assert point[3] == (r << 16 | g << 8 | b), hex(point[3])


def check_drake_cloud():
    cloud = read(lcmt_point_cloud, "drake_cloud")
    assert (cloud.utime, cloud.width, cloud.height, cloud.flags) == (1760000000000250, 2, 1, 2)
    assert (cloud.point_step, cloud.row_step, cloud.filler_size, cloud.data_size) == (16, 32, 0, 32)
    assert [(f.name, f.byte_offset, f.datatype, f.count) for f in cloud.fields] == [
        ("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1), ("rgb", 12, 6, 1)]
    for point, (x, y, z, rgb) in zip(struct.iter_unpack("<fffBBBB", bytes(cloud.data)), POINTS):
        near(point[:3], (x, y, z))
        assert point[3:6] == rgb, point


def check_costmap():
    grid = read(OccupancyGrid, "costmap")
    assert (grid.info.width, grid.info.height) == (3, 2), (grid.info.width, grid.info.height)
    near((grid.info.resolution, grid.info.origin.position.x, grid.info.origin.position.y), (0.1, -0.1, 0.2))
    assert grid.info.origin.orientation.w == 1
    assert list(grid.data) == [0, -1, 100, -1, -1, 0], list(grid.data)  # rows along +y


def check_detections():
    array = read(Detection3DArray, "detections")
    assert array.header.frame_id == "world"
    assert [d.id for d in array.detections] == ["instance_7_chair", "segment_12"]
    chair = array.detections[0]
    assert chair.results[0].hypothesis.class_id == "chair"
    near((chair.results[0].hypothesis.score,), (0.75,))
    center = chair.bbox.center
    near((center.position.x, center.position.y, center.position.z), (1, 2, 0.5))
    near((chair.bbox.size.x, chair.bbox.size.y, chair.bbox.size.z), (0.4, 0.6, 0.9))
    near((center.orientation.x, center.orientation.y, center.orientation.z, center.orientation.w),
         (0, 0, math.sin(0.25), math.cos(0.25)))


def check_deformable():
    link = read(lcmt_viewer_link_data, "deformable")
    assert link.name == "vismap" and link.num_geom == 3
    assert [g.string_data for g in link.geom] == [
        "surface/instance_7_chair", "box/instance_7_chair", "box/segment_12"]
    for geometry in link.geom:
        assert geometry.type == 4 and list(geometry.quaternion) == [1, 0, 0, 0]
        vertices, triangles = int(geometry.float_data[0]), int(geometry.float_data[1])
        assert geometry.num_float_data == 2 + 3 * vertices + 3 * triangles
        assert all(0 <= index < vertices for index in geometry.float_data[2 + 3 * vertices:])
    near(link.geom[0].float_data, (3, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2))
    corners = list(zip(*[iter(link.geom[1].float_data[2:26])] * 3))
    near([sum(c[axis] for c in corners) / 8 for axis in range(3)], (1, 2, 0.5))
    near((max(c[2] for c in corners) - min(c[2] for c in corners),), (0.9,))


def check_treeviewer():
    message = read(viewer2_comms_t, "director")
    assert (message.format, message.format_version_major, message.format_version_minor) == ("treeviewer_json", 1, 0)
    data = json.loads(bytes(message.data))
    assert data["delete"] == [{"path": ["vismap", "objects", "instance_3_cup"]}]
    surface, chair, _ = data["setgeometry"]
    assert surface["geometry"]["type"] == "pointcloud"
    near(surface["geometry"]["points"][1], (-2, 3, 0.125))
    near(surface["geometry"]["channels"]["rgb"][0], (1, 128 / 255, 1 / 255))
    assert chair["path"] == ["vismap", "objects", "instance_7_chair"]
    assert chair["geometry"]["type"] == "box"
    near(chair["geometry"]["lengths"], (0.4, 0.6, 0.9))
    place = data["settransform"][0]["transform"]
    near(place["translation"], (1, 2, 0.5))
    near(place["quaternion"], (math.cos(0.25), 0, 0, math.sin(0.25)))


for check in (check_point_cloud2, check_drake_cloud, check_costmap, check_detections, check_deformable,
              check_treeviewer):
    check()
    print(check.__name__)
