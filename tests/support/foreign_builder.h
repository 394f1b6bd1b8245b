#pragma once

#include <zlib.h>

#include <cstring>
#include <string>
#include <vector>
#include <vismap/foreign/bot_core/images_t.hpp>
#include <vismap/foreign/bot_core/pose_t.hpp>
#include <vismap/foreign/bot_core/rigid_transform_t.hpp>
#include <vismap/foreign/drake/lcmt_image_array.hpp>
#include <vismap/foreign/drake/lcmt_viewer_draw.hpp>
#include <vismap/foreign/sensor_msgs/CameraInfo.hpp>
#include <vismap/foreign/sensor_msgs/Image.hpp>
#include <vismap/foreign/tf2_msgs/TFMessage.hpp>

#include "geometry/camera.h"
#include "geometry/pose.h"
#include "support/messages.h"
#include "wire/envelope.h"

namespace vismap::foreign_test {

// Messages as DimOS, Drake and bot_core send them, made with lcm-gen's encoders.

using Bytes = std::vector<uint8_t>;

inline constexpr const char* kColorChannel = "/color_image#sensor_msgs.Image";
inline constexpr const char* kDepthChannel = "/depth_image#sensor_msgs.Image";
inline constexpr const char* kInfoChannel = "/camera_info#sensor_msgs.CameraInfo";
inline constexpr const char* kTfChannel = "/tf#tf2_msgs.TFMessage";

/// The depth of SmallSensorFrame as little-endian bytes.
inline Bytes SmallDepthBytes() {
  const Image<uint16_t> depth = SmallSensorFrame().depth;
  Bytes bytes(depth.size() * 2);
  std::memcpy(bytes.data(), depth.data(), bytes.size());
  return bytes;
}

/// Raw RGB of the same size.
inline Bytes SmallColorBytes() {
  Bytes bytes;
  for (int i = 0; i < kSmallCamera.width * kSmallCamera.height; ++i)
    bytes.insert(bytes.end(), {static_cast<uint8_t>(i), static_cast<uint8_t>(i / 7), 90});
  return bytes;
}

inline Bytes Zipped(const Bytes& plain) {
  uLongf size = compressBound(plain.size());
  Bytes packed(size);
  compress2(packed.data(), &size, plain.data(), plain.size(), Z_BEST_SPEED);
  packed.resize(size);
  return packed;
}

inline foreign::std_msgs::Header RosHeader(int64_t utime, const std::string& frame) {
  foreign::std_msgs::Header header{};
  header.stamp.sec = static_cast<int32_t>(utime / 1'000'000);
  header.stamp.nsec = static_cast<int32_t>(utime % 1'000'000 * 1000);
  header.frame_id = frame;
  return header;
}

inline foreign::sensor_msgs::Image RosImage(int64_t utime, const std::string& encoding, Bytes data,
                                            int step, const std::string& frame = "optical") {
  foreign::sensor_msgs::Image image{};
  image.header = RosHeader(utime, frame);
  image.width = kSmallCamera.width;
  image.height = kSmallCamera.height;
  image.encoding = encoding;
  image.step = step;
  image.data = std::move(data);
  image.data_length = static_cast<int32_t>(image.data.size());
  return image;
}
inline Bytes ColorImage(int64_t utime) {
  foreign::sensor_msgs::Image image =
      RosImage(utime, "rgb8", SmallColorBytes(), 3 * kSmallCamera.width);
  return Pack(image);
}
inline Bytes DepthImage(int64_t utime, const std::string& frame = "optical") {
  foreign::sensor_msgs::Image image =
      RosImage(utime, "16UC1", SmallDepthBytes(), 2 * kSmallCamera.width, frame);
  return Pack(image);
}

inline Bytes CameraInfo(int64_t utime) {
  foreign::sensor_msgs::CameraInfo info{};
  info.header = RosHeader(utime, "optical");
  info.width = kSmallCamera.width;
  info.height = kSmallCamera.height;
  info.distortion_model = "plumb_bob";
  info.D = {0, 0, 0, 0, 0};
  info.D_length = 5;
  info.K[0] = kSmallCamera.fx;
  info.K[4] = kSmallCamera.fy;
  info.K[2] = kSmallCamera.cx;
  info.K[5] = kSmallCamera.cy;
  info.K[8] = 1;
  return Pack(info);
}

/// One transform.
inline foreign::geometry_msgs::TransformStamped Transform(int64_t utime, const std::string& parent,
                                                          const std::string& child,
                                                          const Pose& pose) {
  foreign::geometry_msgs::TransformStamped stamped{};
  stamped.header = RosHeader(utime, parent);
  stamped.child_frame_id = child;
  const Eigen::Quaterniond q(pose.rotation());
  stamped.transform.rotation.x = q.x();
  stamped.transform.rotation.y = q.y();
  stamped.transform.rotation.z = q.z();
  stamped.transform.rotation.w = q.w();
  stamped.transform.translation.x = pose.translation().x();
  stamped.transform.translation.y = pose.translation().y();
  stamped.transform.translation.z = pose.translation().z();
  return stamped;
}
inline Bytes Tf(const std::vector<foreign::geometry_msgs::TransformStamped>& transforms) {
  foreign::tf2_msgs::TFMessage message{};
  message.transforms = transforms;
  message.transforms_length = static_cast<int32_t>(transforms.size());
  return Pack(message);
}

/// A body that moves at 0.5 m/s along x and turns at 0.4 rad/s about z.
inline Pose BodyAt(int64_t utime) {
  const double seconds = static_cast<double>(utime) / 1e6;
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(0.5 * seconds, 1, 0.4);
  pose.linear() = Eigen::AngleAxisd(0.4 * seconds, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

/// The optical frame in the body: x right, y down, z forward.
inline Pose OpticalInBody() {
  Pose pose = Pose::Identity();
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  pose.translation() = Eigen::Vector3d(0.2, 0.02, 0.3);
  return pose;
}

/// An image array of Drake with a zipped depth and a zipped RGBA image.
inline Bytes DrakeImages(int64_t utime) {
  foreign::drake::lcmt_image depth{};
  depth.header.frame_name = "depth";
  depth.width = kSmallCamera.width;
  depth.height = kSmallCamera.height;
  depth.row_stride = 2 * depth.width;
  depth.data = Zipped(SmallDepthBytes());
  depth.pixel_format = 5;
  depth.channel_type = 3;
  depth.compression_method = 1;
  depth.size = static_cast<int32_t>(depth.data.size());
  foreign::drake::lcmt_image color = depth;
  color.header.frame_name = "rgb";
  Bytes rgba;
  for (int i = 0; i < depth.width * depth.height; ++i)
    rgba.insert(rgba.end(), {10, 20, static_cast<uint8_t>(i), 255});
  color.data = Zipped(rgba);
  color.size = static_cast<int32_t>(color.data.size());
  color.row_stride = 4 * color.width;
  color.pixel_format = 3;
  color.channel_type = 1;
  foreign::drake::lcmt_image_array array{};
  array.header.utime = utime;
  array.images = {depth, color};
  array.num_images = 2;
  return Pack(array);
}

inline Bytes DrakeDraw(int64_t utime, const std::string& link, const Pose& pose, int robot = 3) {
  foreign::drake::lcmt_viewer_draw draw{};
  draw.timestamp = utime / 1000;
  draw.num_links = 2;
  draw.link_name = {"world", link};
  draw.robot_num = {0, robot};
  const Eigen::Quaternionf q(pose.rotation().cast<float>());
  const Eigen::Vector3f p = pose.translation().cast<float>();
  draw.position = {{0, 0, 0}, {p.x(), p.y(), p.z()}};
  draw.quaternion = {{1, 0, 0, 0}, {q.w(), q.x(), q.y(), q.z()}};
  return Pack(draw);
}

/// Images of bot_core: raw colour and zipped depth.
inline Bytes BotImages(int64_t color_utime, int64_t depth_utime) {
  foreign::bot_core::image_t color{};
  color.utime = color_utime;
  color.width = kSmallCamera.width;
  color.height = kSmallCamera.height;
  color.row_stride = 3 * color.width;
  color.pixelformat = 859981650;
  color.data = SmallColorBytes();
  color.size = static_cast<int32_t>(color.data.size());
  foreign::bot_core::image_t depth = color;
  depth.utime = depth_utime;
  depth.pixelformat = -2;
  depth.data = Zipped(SmallDepthBytes());
  depth.size = static_cast<int32_t>(depth.data.size());
  foreign::bot_core::images_t images{};
  images.utime = depth_utime;
  images.n_images = 2;
  images.image_types = {0, 6};
  images.images = {color, depth};
  return Pack(images);
}

inline Bytes BotPose(int64_t utime, const Pose& pose) {
  foreign::bot_core::pose_t message{};
  message.utime = utime;
  const Eigen::Quaterniond q(pose.rotation());
  const double wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
  std::copy(wxyz, wxyz + 4, message.orientation);
  Eigen::Map<Eigen::Vector3d>(message.pos) = pose.translation();
  return Pack(message);
}

inline Bytes BotTransform(int64_t utime, const Pose& pose) {
  foreign::bot_core::rigid_transform_t message{};
  message.utime = utime;
  const Eigen::Quaterniond q(pose.rotation());
  const double wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
  std::copy(wxyz, wxyz + 4, message.quat);
  Eigen::Map<Eigen::Vector3d>(message.trans) = pose.translation();
  return Pack(message);
}

}  // namespace vismap::foreign_test
