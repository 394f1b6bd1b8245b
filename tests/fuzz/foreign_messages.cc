#include "foreign_messages.h"

#include <zlib.h>

#include <opencv2/imgcodecs.hpp>
#include <vismap/foreign/bot_core/images_t.hpp>
#include <vismap/foreign/bot_core/pose_t.hpp>
#include <vismap/foreign/bot_core/rigid_transform_t.hpp>
#include <vismap/foreign/drake/lcmt_image_array.hpp>
#include <vismap/foreign/drake/lcmt_viewer_draw.hpp>
#include <vismap/foreign/geometry_msgs/PoseStamped.hpp>
#include <vismap/foreign/nav_msgs/Odometry.hpp>
#include <vismap/foreign/sensor_msgs/CameraInfo.hpp>
#include <vismap/foreign/sensor_msgs/Image.hpp>
#include <vismap/foreign/tf2_msgs/TFMessage.hpp>

#include "foreign/frame_joiner.h"
#include "foreign/frame_message.h"
#include "wire/channels.h"
#include "wire/envelope.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

using Bytes = std::vector<uint8_t>;

constexpr int kWidth = 8, kHeight = 6;         // of the images
constexpr size_t kContent = size_t{64} << 20;  // of decoded images; a packed one expands 1032 times

/// What the adapter makes of an image: corrected pixels, and the frame that is published.
Result<void> UseImage(ForeignImage image, bool is_color) {
  AdapterCameraOptions options;
  options.swap_red_blue = true;
  options.none_values = {0, 77};
  Result<ForeignImage> corrected = Corrected(std::move(image), is_color, options);
  if (!corrected) return tl::unexpected(corrected.error());
  ForeignFrame frame;
  frame.color_camera = frame.depth_camera = {kWidth, kHeight, 10, 10, 4, 3};
  (is_color ? frame.color.emplace() : frame.depth) = std::move(*corrected);
  const Result<SensorFrame> decoded = Decode(ToMessage(std::move(frame), options));
  return decoded || is_color ? Result<void>() : tl::unexpected(decoded.error());
}

Result<void> UseMessage(std::span<const uint8_t> bytes, ImageRole role) {
  Result<ForeignMessage> message =
      DecodeForeign(bytes, "CAMERA_TO_LOCAL", {role, "world", "body", "camera"});
  if (!message) return tl::unexpected(message.error());
  FrameTree tree({});
  for (const EdgeSample& edge : message->edges) tree.Add(edge, 0);
  (void)tree.Find("world", "body", 5, 5);
  if (message->color) {
    if (const Result<void> used = UseImage(std::move(*message->color), true); !used) return used;
  }
  if (message->depth) return UseImage(std::move(*message->depth), false);
  return {};
}

template <typename Message>
FuzzTarget ForeignTarget(const std::string& type, Message message, size_t most_bytes,
                         ImageRole role = ImageRole::kColor) {
  FuzzTarget target;
  target.type = type;
  target.channel_bytes = most_bytes;
  target.good = Pack(message);
  target.largest_content = target.peak_content = kContent;
  target.decode = [role](std::span<const uint8_t> bytes) { return UseMessage(bytes, role); };
  return target;
}

Bytes Pixels(int bytes_of_pixel) {
  Bytes pixels(static_cast<size_t>(kWidth * kHeight * bytes_of_pixel));
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<uint8_t>(i % 5);
  return pixels;
}

Bytes ZippedPixels(int bytes_of_pixel) {
  const Bytes plain = Pixels(bytes_of_pixel);
  uLongf size = compressBound(plain.size());
  Bytes packed(size);
  compress2(packed.data(), &size, plain.data(), plain.size(), Z_BEST_SPEED);
  packed.resize(size);
  return packed;
}

Bytes Encoded(const char* ending, int type) {
  Bytes bytes;
  cv::imencode(ending, cv::Mat(kHeight, kWidth, type, cv::Scalar::all(77)), bytes);
  return bytes;
}

foreign::sensor_msgs::Image RosImageOf(const std::string& encoding, Bytes data, int step) {
  foreign::sensor_msgs::Image image{};
  image.header.frame_id = "optical";
  image.header.stamp.sec = 5;
  image.width = kWidth;
  image.height = kHeight;
  image.encoding = encoding;
  image.step = step;
  image.data = std::move(data);
  image.data_length = static_cast<int32_t>(image.data.size());
  return image;
}

foreign::drake::lcmt_image DrakeImageOf(int pixel_format, int channel_type, int compression,
                                        int pixel_bytes, Bytes data) {
  foreign::drake::lcmt_image image{};
  image.header.frame_name = "image";
  image.width = kWidth;
  image.height = kHeight;
  image.row_stride = kWidth * pixel_bytes;
  image.pixel_format = static_cast<int8_t>(pixel_format);
  image.channel_type = static_cast<int8_t>(channel_type);
  image.compression_method = static_cast<int8_t>(compression);
  image.data = std::move(data);
  image.size = static_cast<int32_t>(image.data.size());
  return image;
}

foreign::drake::lcmt_image_array ArrayOf(const foreign::drake::lcmt_image& depth,
                                         const foreign::drake::lcmt_image& color) {
  foreign::drake::lcmt_image_array array{};
  array.header.utime = 5;
  array.images = {depth, color};
  array.num_images = 2;
  return array;
}

foreign::drake::lcmt_viewer_draw Draw() {
  foreign::drake::lcmt_viewer_draw draw{};
  draw.num_links = 2;
  draw.link_name = {"world", "body"};
  draw.robot_num = {0, 1};
  draw.position = {{0, 0, 0}, {1, 2, 3}};
  draw.quaternion = {{1, 0, 0, 0}, {1, 0, 0, 0}};
  return draw;
}

foreign::bot_core::images_t BotImagesOf() {
  foreign::bot_core::image_t color{};
  color.width = kWidth;
  color.height = kHeight;
  color.row_stride = 3 * kWidth;
  color.pixelformat = 859981650;
  color.data = Pixels(3);
  color.size = static_cast<int32_t>(color.data.size());
  foreign::bot_core::image_t depth = color;
  depth.data = ZippedPixels(2);
  depth.size = static_cast<int32_t>(depth.data.size());
  foreign::bot_core::images_t images{};
  images.n_images = 2;
  images.image_types = {0, 6};
  images.images = {color, depth};
  return images;
}

foreign::tf2_msgs::TFMessage Transforms() {
  foreign::geometry_msgs::TransformStamped stamped{};
  stamped.header.frame_id = "world";
  stamped.child_frame_id = "body";
  stamped.transform.rotation.w = 1;
  foreign::tf2_msgs::TFMessage message{};
  message.transforms = {stamped, stamped};
  message.transforms_length = 2;
  return message;
}

foreign::sensor_msgs::CameraInfo Info() {
  foreign::sensor_msgs::CameraInfo info{};
  info.distortion_model = "plumb_bob";
  info.D = {0.1, 0, 0, 0, 0};
  info.D_length = 5;
  info.width = kWidth;
  info.height = kHeight;
  return info;
}

}  // namespace

std::vector<FuzzTarget> ForeignFuzzTargets() {
  constexpr size_t kImages = 64 * kMegabyte, kPoses = 4 * kMegabyte;
  foreign::geometry_msgs::PoseStamped pose{};
  pose.header.frame_id = "world";
  pose.pose.orientation.w = 1;
  foreign::nav_msgs::Odometry odometry{};
  odometry.header.frame_id = "world";
  odometry.pose.pose.orientation.w = 1;
  foreign::bot_core::pose_t bot_pose{};
  bot_pose.orientation[0] = 1;
  foreign::bot_core::rigid_transform_t rigid{};
  rigid.quat[0] = 1;
  const auto depth = ImageRole::kDepth;
  return {
      ForeignTarget("sensor_msgs.Image rgb8", RosImageOf("rgb8", Pixels(3), 3 * kWidth), kImages),
      ForeignTarget("sensor_msgs.Image jpeg", RosImageOf("jpeg", Encoded(".jpg", CV_8UC3), 0),
                    kImages),
      ForeignTarget("sensor_msgs.Image 16UC1", RosImageOf("16UC1", Pixels(2), 2 * kWidth), kImages,
                    depth),
      ForeignTarget("sensor_msgs.Image 64FC1", RosImageOf("64FC1", Pixels(8), 8 * kWidth), kImages,
                    depth),
      ForeignTarget("sensor_msgs.Image png", RosImageOf("png", Encoded(".png", CV_16UC1), 0),
                    kImages, depth),
      ForeignTarget("sensor_msgs.CameraInfo", Info(), kPoses),
      ForeignTarget("tf2_msgs.TFMessage", Transforms(), kPoses),
      ForeignTarget("geometry_msgs.PoseStamped", pose, kPoses),
      ForeignTarget("nav_msgs.Odometry", odometry, kPoses),
      ForeignTarget("lcmt_image_array zlib",
                    ArrayOf(DrakeImageOf(5, 3, 1, 2, ZippedPixels(2)),
                            DrakeImageOf(3, 1, 1, 4, ZippedPixels(4))),
                    kImages),
      ForeignTarget("lcmt_image_array png",
                    ArrayOf(DrakeImageOf(5, 3, 3, 2, Encoded(".png", CV_16UC1)),
                            DrakeImageOf(1, 1, 2, 3, Encoded(".jpg", CV_8UC3))),
                    kImages),
      ForeignTarget(
          "lcmt_image_array raw",
          ArrayOf(DrakeImageOf(5, 6, 0, 4, Pixels(4)), DrakeImageOf(2, 1, 0, 3, Pixels(3))),
          kImages),
      ForeignTarget("lcmt_viewer_draw", Draw(), kPoses),
      ForeignTarget("images_t", BotImagesOf(), kImages),
      ForeignTarget("image_t", BotImagesOf().images[1], kImages, depth),
      ForeignTarget("pose_t", bot_pose, kPoses),
      ForeignTarget("rigid_transform_t", rigid, kPoses),
  };
}

}  // namespace vismap
