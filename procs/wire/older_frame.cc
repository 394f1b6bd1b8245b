#include "wire/older_frame.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace vismap {

rgbd_frame_t ToCurrentVersion(const rgbd_frame_v1_t& older) {
  rgbd_frame_t message{};
  message.utime = older.utime;
  message.seq = older.seq;
  message.source = older.source;
  message.camera_id = older.camera_id;
  message.frame_number = older.frame_number;
  message.after_utime = older.after_utime;
  std::copy(std::begin(older.T_W_C), std::end(older.T_W_C), std::begin(message.T_W_C));
  message.color_camera.width = older.width;
  message.color_camera.height = older.height;
  message.color_camera.fx = older.fx;
  message.color_camera.fy = older.fy;
  message.color_camera.cx = older.cx;
  message.color_camera.cy = older.cy;
  message.depth_camera = message.color_camera;
  message.depth_registered = 1;
  for (const size_t diagonal : {0, 5, 10, 15}) message.T_color_depth[diagonal] = 1;
  message.depth_unit_m = older.depth_unit_m;
  message.depth_encoding = older.depth_encoding;
  message.depth_size = older.depth_size;
  message.depth = older.depth;
  message.color_encoding = older.color_encoding;
  message.color_size = older.color_size;
  message.color = older.color;
  return message;
}

}  // namespace vismap
