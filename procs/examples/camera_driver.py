#!/usr/bin/env python3
"""A driver of an RGB-D camera to start from: replace the class Source, and keep the rest.

As it stands it computes the images of a camera that moves through a small room, so that it can be tried at once:

    vismap-hub & vismap-depth-segmenter --detections none & vismap-map-server &
    procs/examples/camera_driver.py                  # needs python3-vismap, or PYTHONPATH=libs/python in the source tree
    vismap-doctor
"""
from __future__ import annotations

import argparse
import logging
import math
import signal
import sys
import threading
import time
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import vismap


@dataclass(frozen=True)
class Images:
    """What a camera gives at one time."""

    device_s: float  # time stamp of the camera, by its own clock [s]
    color: npt.NDArray[np.uint8]  # (H, W, 3) red, green, blue
    depth: npt.NDArray[np.uint16]  # (H, W) along the optical axis, in steps of Source.depth_unit_m; 0 = not measured


class Source:
    """The camera and its pose. Replace the bodies by calls of your SDK, for example

    - RealSense: pipeline.wait_for_frames(); frame.get_timestamp() / 1000; get_depth_scale(); intrinsics of both streams;
      depth may stay unregistered: give publish_frame depth_camera and T_color_depth (get_extrinsics_to(), whose rotation
      is stored by columns)
    - OAK (depthai): queue.get(); getTimestamp().total_seconds(); depth in millimetres; readCalibration()
    - Azure Kinect: device.get_capture(); device_timestamp_usec / 1e6; transformation.depth_image_to_color_camera()
    """

    depth_unit_m = 0.001

    def __init__(self, rate_hz: float) -> None:
        self.camera = vismap.Camera(320, 240, fx=280.0, fy=280.0, cx=159.5, cy=119.5)
        self._period = 1 / rate_hz
        self._start = time.monotonic()
        self._number = 0

    def wait_for_images(self) -> Images:
        """The next images; waits for them. Raises OSError when the camera has gone."""
        self._number += 1
        device_s = self._number * self._period
        time.sleep(max(0.0, self._start + device_s - time.monotonic()))
        color, depth_m = render_room(self.camera, self._pose_at(device_s))
        return Images(device_s, color, np.round(depth_m / self.depth_unit_m).astype(np.uint16))

    def pose(self, device_s: float) -> npt.NDArray[np.float64] | None:
        """T_W_C (4, 4) at a time of the camera's clock: p_W = T_W_C * p_C [m]; C: x right, y down, z forward. None when it
        is not known, for example while a tracker is lost. A pose of another time bends the map: interpolate."""
        return self._pose_at(device_s)

    def close(self) -> None:
        """Gives the camera back."""

    @staticmethod
    def _pose_at(device_s: float) -> npt.NDArray[np.float64]:
        """A slow swing to and fro in the middle of the room; z of W points up."""
        angle = 0.6 * math.sin(0.5 * device_s)
        forward = np.array([math.cos(angle), math.sin(angle), -0.45])
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        T_W_C = np.eye(4)
        T_W_C[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
        T_W_C[:3, 3] = [0.8, 1.5 + 0.2 * math.sin(0.3 * device_s), 1.4]
        return T_W_C


ROOM = np.array([[0.0, 0.0, 0.0], [4.0, 3.0, 2.5]])  # two corners in W [m]
BOX = np.array([[2.2, 1.2, 0.0], [2.8, 1.8, 0.7]])  # stands in it


def render_room(camera: vismap.Camera, T_W_C: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.float64]]:
    """Colour (H, W, 3) and depth along the optical axis (H, W) [m] of the room with the box."""
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    rays_C = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones(u.shape)], axis=-1)
    rays_W, eye = rays_C @ T_W_C[:3, :3].T, T_W_C[:3, 3]
    rays_W[np.abs(rays_W) < 1e-9] = 1e-9
    to_walls = np.max((ROOM[:, None, None] - eye) / rays_W, axis=0).min(axis=-1)
    sides = (BOX[:, None, None] - eye) / rays_W
    enter, leave = sides.min(axis=0).max(axis=-1), sides.max(axis=0).min(axis=-1)
    hits_box = (enter > 0) & (enter < leave)
    depth = np.where(hits_box, enter, to_walls)
    squares = np.floor((eye + rays_W * depth[..., None]) / 0.25 + 1e-6).astype(np.int64).sum(axis=-1) % 2
    shade = np.where(squares == 0, 200, 110)
    return np.stack([np.where(hits_box, shade, shade // 2), shade, np.where(hits_box, 60, shade)], axis=-1).astype(np.uint8), depth


class Driver:
    """Takes images from the source in one thread, and publishes them in another, so that a slow bus never lets old images
    pile up in the camera: the newest ones replace those that were not published."""

    def __init__(self, bus: vismap.Bus, status: vismap.Status, source: Source, camera_id: int, rate_hz: float) -> None:
        self._bus, self._status, self._source, self._camera_id = bus, status, source, camera_id
        self._clock, self._pace = vismap.DeviceClock(), vismap.Pace(rate_hz)
        self._newest: vismap.Newest[tuple[int, Images]] = vismap.Newest()
        self._failure = ""
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._capture, daemon=True)
        self.published = 0

    def run(self, frames: int) -> str:
        """Publishes frames, so many or (0) until stop() is called. Returns why it ended early; "" = it did not."""
        self._status.set("ready")
        self._thread.start()
        last = time.monotonic()
        while not self._stopping.is_set() and not self._failure and (frames == 0 or self.published < frames):
            taken = self._newest.take(timeout=0.1)
            if taken is not None:
                self._publish(*taken)
                last = time.monotonic()
            elif time.monotonic() - last > 2:
                self._status.set("waiting", "the camera has given no images for two seconds")
        self._stopping.set()
        return self._failure

    def stop(self) -> None:
        self._stopping.set()

    def _capture(self) -> None:
        while not self._stopping.is_set():
            try:
                images = self._source.wait_for_images()
            except Exception as error:  # the SDKs of cameras have errors of many types
                self._failure = f"the camera has gone: {error}"
                return
            # The clock must see all frames, also those that are not published.
            utime = self._clock.to_utime(images.device_s)
            if self._pace.takes(utime):
                self._newest.put((utime, images))

    def _publish(self, utime: int, images: Images) -> None:
        for name, count in (("frames_skipped", self._newest.skipped), ("camera_clock_restarts", self._clock.restarts),
                            ("wall_clock_set_back", self._clock.steps_back)):
            self._status.set_counter(name, count)
        T_W_C = self._source.pose(images.device_s)
        if T_W_C is None:
            self._status.count("frames_without_pose")
            self._status.set("waiting", "there is no pose of the camera")
            return
        self._status.saw_frame(self._camera_id, utime)
        begin = time.monotonic()
        try:
            vismap.publish_frame(self._bus, images.depth, T_W_C, self._source.camera, images.color,
                                 depth_unit_m=self._source.depth_unit_m, camera_id=self._camera_id, utime=utime)
        except vismap.BusError as error:  # the bus connects again by itself, and counts the frame as unsent
            self._status.set("waiting", str(error))
            return
        self._status.add_timing("publish", 1000 * (time.monotonic() - begin))
        self._status.count("frames")
        self._status.set("running")
        self.published += 1


def main() -> int:
    parser = argparse.ArgumentParser(description="Publishes the frames of an RGB-D camera.")
    parser.add_argument("--lcm-url", help="the bus; default $LCM_DEFAULT_URL, else tcpq://127.0.0.1:7700")
    parser.add_argument("--channel-prefix", default="", help="as that of the other processes of vismap")
    parser.add_argument("--name", default="camera-driver", help="name of this instance, unique on the bus")
    parser.add_argument("--camera-id", type=int, default=0, help="identifies the camera")
    parser.add_argument("--rate", type=float, default=10.0, help="frames per second")
    parser.add_argument("--frames", type=int, default=0, help="end after so many frames; 0 = never")
    options = parser.parse_args()
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(message)s")
    if options.rate <= 0 or options.camera_id < 0 or options.frames < 0:
        parser.error("--rate must be positive; --camera-id and --frames must not be negative")
    try:
        with vismap.Bus(options.lcm_url, options.name, channel_prefix=options.channel_prefix) as bus, \
                vismap.Status(bus, "camera-driver") as status:
            source = Source(options.rate)
            driver = Driver(bus, status, source, options.camera_id, options.rate)
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, lambda *_: driver.stop())
            failure = driver.run(options.frames)
            source.close()
    except vismap.VismapError as error:
        logging.error("%s", error)
        return 1
    if failure:
        logging.error("%s", failure)
        return 1
    logging.info("published %d frames", driver.published)
    return 0


if __name__ == "__main__":
    sys.exit(main())
