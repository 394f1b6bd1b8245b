#include "wire/rgbd_frame.h"

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "codecs/color_codec.h"
#include "codecs/depth_codec.h"
#include "wire/envelope.h"

namespace vismap {
namespace {

std::string Where(const rgbd_frame_t& message) {
  return "rgbd_frame_t of camera " + std::to_string(message.camera_id) + ", utime " +
         std::to_string(message.utime) + ": ";
}

Result<std::vector<uint8_t>> DecodeColor(const rgbd_frame_t& message) {
  if (message.color_encoding == rgbd_frame_t::COLOR_NONE) {
    if (message.color_size != 0)
      return Fail(Where(message) + "color_encoding is COLOR_NONE, but color is not empty");
    return std::vector<uint8_t>();
  }
  if (message.color_encoding != rgbd_frame_t::COLOR_JPEG) {
    return Fail(Where(message) + "color_encoding " + std::to_string(message.color_encoding) +
                " is unknown");
  }
  const Result<JpegSize> size = ReadJpegSize(message.color);
  if (!size) return message.color;  // DecodeFrame tells
  if (size->width != message.width || size->height != message.height) {
    return Fail(Where(message) + "the colour image is " + std::to_string(size->width) + "x" +
                std::to_string(size->height) + ", expected the size of the depth image, " +
                std::to_string(message.width) + "x" + std::to_string(message.height));
  }
  return message.color;
}

}  // namespace

rgbd_frame_t Encode(const SensorFrame& frame) {
  rgbd_frame_t message{};
  const FrameHeader& header = frame.header;
  message.utime = header.utime;
  message.camera_id = Raw(header.camera_id);
  message.frame_number = header.frame_number;
  message.after_utime = -1;
  message.width = header.camera.width;
  message.height = header.camera.height;
  message.fx = header.camera.fx;
  message.fy = header.camera.fy;
  message.cx = header.camera.cx;
  message.cy = header.camera.cy;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column)
      message.T_W_C[4 * row + column] = header.T_W_C(row, column);
  }
  message.depth_unit_m = frame.depth_unit_m;
  message.depth_encoding = rgbd_frame_t::DEPTH_ZSTD_DELTA;
  message.depth = EncodeDepth(frame.depth);
  message.depth_size = static_cast<int32_t>(message.depth.size());
  message.color_encoding =
      frame.color_jpeg.empty() ? rgbd_frame_t::COLOR_NONE : rgbd_frame_t::COLOR_JPEG;
  message.color = frame.color_jpeg;
  message.color_size = static_cast<int32_t>(message.color.size());
  return message;
}

Result<FrameHeader> DecodeHeader(const rgbd_frame_t& message) {
  if (message.utime < 0) return Fail(Where(message) + "utime is negative");
  if (message.camera_id < 0) return Fail(Where(message) + "camera_id is negative");
  if (message.frame_number < -1) return Fail(Where(message) + "frame_number is below -1");
  const Result<PinholeCamera> camera = ValidateCamera(
      {message.width, message.height, message.fx, message.fy, message.cx, message.cy});
  if (!camera) return Fail(Where(message) + camera.error().message);
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column)
      matrix(row, column) = message.T_W_C[4 * row + column];
  }
  const Result<Pose> pose = MakePose(matrix);
  if (!pose) return Fail(Where(message) + "T_W_C: " + pose.error().message);
  return FrameHeader{message.utime, CameraId{message.camera_id}, message.frame_number, *camera,
                     *pose};
}

Result<FrameHeader> PeekFrameHeader(std::span<const uint8_t> bytes) {
  const std::optional<MessageHead> head = PeekHead(bytes);
  if (!head || head->fingerprint != rgbd_frame_t::getHash()) {
    return Fail(
        envelope::FingerprintError(bytes, rgbd_frame_t::getTypeName(), rgbd_frame_t::getHash()));
  }
  // Decodes the message up to its images, followed by two empty images.
  static const rgbd_frame_t kEmpty{};
  constexpr size_t kSizeOfDepth = 4, kColor = 1 + 4;
  const size_t images_at =
      static_cast<size_t>(kEmpty.getEncodedSize()) - kSizeOfDepth - kColor + head->source.size();
  if (bytes.size() < images_at)
    return Fail("rgbd_frame_t: truncated after " + std::to_string(bytes.size()) + " bytes");
  std::vector<uint8_t> prefix(bytes.begin(),
                              bytes.begin() + static_cast<std::ptrdiff_t>(images_at));
  prefix.resize(images_at + kSizeOfDepth + kColor, 0);
  rgbd_frame_t message{};
  if (message.decode(prefix.data(), 0, static_cast<int>(prefix.size())) < 0)
    return Fail("rgbd_frame_t: its header cannot be decoded");
  return DecodeHeader(message);
}

Result<SensorFrame> Decode(const rgbd_frame_t& message) {
  const Result<FrameHeader> header = DecodeHeader(message);
  if (!header) return tl::unexpected(header.error());
  if (!(message.depth_unit_m > 0) || message.depth_unit_m > 1) {
    return Fail(Where(message) + "depth_unit_m is " + std::to_string(message.depth_unit_m) +
                ", expected (0, 1]");
  }
  if (message.depth_encoding != rgbd_frame_t::DEPTH_ZSTD_DELTA) {
    return Fail(Where(message) + "depth_encoding " + std::to_string(message.depth_encoding) +
                " is unknown");
  }
  Result<Image<uint16_t>> depth = DecodeDepth(message.depth, message.width, message.height);
  if (!depth) return Fail(Where(message) + "depth: " + depth.error().message);
  Result<std::vector<uint8_t>> color = DecodeColor(message);
  if (!color) return tl::unexpected(color.error());
  return SensorFrame{*header, std::move(*color), std::move(*depth), message.depth_unit_m, {}};
}

}  // namespace vismap
