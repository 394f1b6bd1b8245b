"""vismap-adapter as a native module of DimOS: copy this file into your DimOS project.

    autoconnect(MyCamera.blueprint(), VismapAdapter.blueprint(lcm_url="tcpq://127.0.0.1:7700"))

DimOS starts the program with the channels of the ports and the fields of the configuration. Poses come from the channel
/tf. The map itself is made by vismap's other processes on the bus lcm_url, which `vismap-launch` or systemd start.
"""
from __future__ import annotations

from dimos.core.native_module import LogFormat, NativeModule, NativeModuleConfig
from dimos.core.stream import In, Out
from dimos.msgs.nav_msgs.OccupancyGrid import OccupancyGrid
from dimos.msgs.sensor_msgs.CameraInfo import CameraInfo
from dimos.msgs.sensor_msgs.Image import Image
from dimos.msgs.sensor_msgs.PointCloud2 import PointCloud2
from dimos.msgs.vision_msgs.Detection3DArray import Detection3DArray


class VismapAdapterConfig(NativeModuleConfig):
    executable: str = "/usr/bin/vismap-adapter"
    extra_args: list[str] = ["--log-format", "json"]
    log_format: LogFormat = LogFormat.JSON
    preset: str = "dimos"
    lcm_url: str = "tcpq://127.0.0.1:7700"  # vismap's bus
    robot_url: str = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304"  # DimOS's bus
    root: str = "world"
    camera_id: int = 0


class VismapAdapter(NativeModule):
    config: VismapAdapterConfig
    color_image: In[Image]
    depth_image: In[Image]
    camera_info: In[CameraInfo]
    depth_camera_info: In[CameraInfo]  # used when depth is not registered to colour
    global_map: Out[PointCloud2]  # instead of VoxelGridMapper
    global_costmap: Out[OccupancyGrid]  # instead of CostMapper
    detections_3d: Out[Detection3DArray]  # the objects of the map, with boxes
