"""Writes a log of Drake with JPEG colour and 16-bit PNG depth, with the Python that lcm-gen makes of Drake's types.

Usage: write_drake_log.py FOLDER_OF_TYPES LOG JPEG   (the JPEG has 16 x 12 pixels and is the colour of every frame)
"""
import math
import pathlib
import struct
import sys
import zlib

sys.path.insert(0, sys.argv[1])
from drake import lcmt_header, lcmt_image, lcmt_image_array, lcmt_viewer_draw  # noqa: E402

WIDTH, HEIGHT, FRAMES = 16, 12, 5
RGB, DEPTH, LABEL, U8, I16, U16, JPEG, PNG = 1, 5, 6, 1, 2, 3, 2, 3


def header(utime, name):
    made = lcmt_header()
    made.utime, made.frame_name = utime, name
    return made


def png16(rows):
    def chunk(name, content):
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))
    plain = b"".join(b"\0" + struct.pack(f">{len(row)}H", *row) for row in rows)
    head = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 16, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(plain)) + chunk(b"IEND", b"")


def image(utime, name, pixel_format, channel_type, method, data, row_stride):
    made = lcmt_image()
    made.header = header(utime, name)
    made.width, made.height, made.row_stride = WIDTH, HEIGHT, row_stride
    made.pixel_format, made.channel_type, made.compression_method = pixel_format, channel_type, method
    made.data, made.size = data, len(data)
    return made


def images(number, utime, jpeg):
    depth = [[0 if u == 3 else 65535 if u == 4 else 1000 + 10 * u + v + number for u in range(WIDTH)] for v in range(HEIGHT)]
    label = zlib.compress(bytes(2 * WIDTH * HEIGHT))
    made = lcmt_image_array()
    made.header = header(utime, "")
    made.images = [image(utime, "depth", DEPTH, U16, PNG, png16(depth), 2 * WIDTH),
                   image(utime, "rgb", RGB, U8, JPEG, jpeg, 3 * WIDTH),
                   image(utime, "label", LABEL, I16, 1, label, 2 * WIDTH)]
    made.num_images = len(made.images)
    return made.encode()


def draw(utime):
    angle = 0.3 * utime * 1e-6
    made = lcmt_viewer_draw()
    made.timestamp, made.num_links = utime // 1000, 2
    made.link_name, made.robot_num = ["world", "wrist::camera"], [0, 2]
    made.position = [[0, 0, 0], [0.5 * utime * 1e-6, 1, 2]]
    made.quaternion = [[1, 0, 0, 0], [math.cos(angle / 2), 0, 0, math.sin(angle / 2)]]
    return made.encode()


jpeg = pathlib.Path(sys.argv[3]).read_bytes()
events = [(tick * 16000, "DRAKE_VIEWER_DRAW", draw(tick * 16000)) for tick in range(40)]
events += [(100000 * k, "DRAKE_RGBD_CAMERA_IMAGES_wrist", images(k, 100000 * k, jpeg)) for k in range(FRAMES)]
with open(sys.argv[2], "wb") as log:
    for number, (utime, channel, data) in enumerate(sorted(events)):
        log.write(struct.pack(">IqqII", 0xeda1da01, number, utime, len(channel), len(data)) + channel.encode() + data)
