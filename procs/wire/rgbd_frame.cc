#include "wire/rgbd_frame.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "codecs/depth_codec.h"
#include "codecs/png_codec.h"
#include "codecs/raw_image.h"
#include "rectify/rectified_camera.h"
#include "wire/envelope.h"
#include "wire/older_frame.h"

namespace vismap {
namespace {

std::string Where(const rgbd_frame_t& message) {
  return "rgbd_frame_t of camera " + std::to_string(message.camera_id) + ", utime " +
         std::to_string(message.utime) + ": ";
}

bool HasColor(const rgbd_frame_t& message) {
  return message.color_encoding != rgbd_frame_t::COLOR_NONE;
}

camera_t EncodeCamera(const LensCamera& lens) {
  camera_t message{};
  message.width = lens.pinhole.width;
  message.height = lens.pinhole.height;
  message.fx = lens.pinhole.fx;
  message.fy = lens.pinhole.fy;
  message.cx = lens.pinhole.cx;
  message.cy = lens.pinhole.cy;
  message.distortion = static_cast<int8_t>(lens.distortion);
  message.coefficients = lens.coefficients;
  message.num_coefficients = static_cast<int32_t>(lens.coefficients.size());
  return message;
}

LensCamera DecodeCamera(const camera_t& message) {
  return {{message.width, message.height, message.fx, message.fy, message.cx, message.cy},
          static_cast<Distortion>(message.distortion),
          message.coefficients};
}

void EncodePose(const Pose& pose, double* elements) {
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) elements[4 * row + column] = pose(row, column);
  }
}

Result<Pose> DecodePose(const double* elements) {
  return MakePose(Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(elements));
}

// Whether the pose of the depth camera counts.
bool UsesBaseline(const rgbd_frame_t& message) {
  return HasColor(message) && message.depth_registered == 0;
}

Result<FrameOptics> DecodeOptics(const rgbd_frame_t& message) {
  FrameOptics optics{DecodeCamera(message.color_camera), DecodeCamera(message.depth_camera),
                     message.depth_registered != 0, Pose::Identity()};
  if (!UsesBaseline(message)) return optics;
  const Result<Pose> pose = DecodePose(message.T_color_depth);
  if (!pose) return Fail("T_color_depth: " + pose.error().message);
  optics.T_color_depth = *pose;
  return optics;
}

// The header and the cameras, in a frame without images.
Result<SensorFrame> DecodeGeometry(const rgbd_frame_t& message) {
  if (message.utime < 0) return Fail("utime is negative");
  if (message.camera_id < 0) return Fail("camera_id is negative");
  if (message.frame_number < -1) return Fail("frame_number is below -1");
  const Result<Pose> pose = DecodePose(message.T_W_C);
  if (!pose) return Fail("T_W_C: " + pose.error().message);
  const Result<FrameOptics> optics = DecodeOptics(message);
  if (!optics) return tl::unexpected(optics.error());
  SensorFrame frame;
  frame.header = {message.utime, CameraId{message.camera_id}, message.frame_number, {}, *pose};
  if (const auto set = SetOptics(*optics, HasColor(message), &frame); !set)
    return tl::unexpected(set.error());
  return frame;
}

// The size of the depth image as it was taken.
const camera_t& DepthCameraOf(const rgbd_frame_t& message) {
  return HasColor(message) && message.depth_registered != 0 ? message.color_camera
                                                            : message.depth_camera;
}

Result<void> DecodeDepthInto(const rgbd_frame_t& message, SensorFrame* frame) {
  const camera_t& camera = DepthCameraOf(message);
  if (message.depth_encoding == rgbd_frame_t::DEPTH_FLOAT_M) {
    Result<Image<float>> depth = DecodeRawFloat(message.depth, camera.width, camera.height);
    if (!depth) return Fail("depth: " + depth.error().message);
    frame->depth_m = std::move(*depth);
    return {};
  }
  if (!(message.depth_unit_m > 0) || message.depth_unit_m > 1) {
    return Fail("depth_unit_m is " + std::to_string(message.depth_unit_m) + ", expected (0, 1]");
  }
  frame->depth_unit_m = message.depth_unit_m;
  const auto decode = [&]() -> Result<Image<uint16_t>> {
    switch (message.depth_encoding) {
      case rgbd_frame_t::DEPTH_ZSTD_DELTA:
        return DecodeDepth(message.depth, camera.width, camera.height);
      case rgbd_frame_t::DEPTH_RAW_16:
        return DecodeRaw16(message.depth, camera.width, camera.height);
      case rgbd_frame_t::DEPTH_PNG:
        return DecodePng16(message.depth, camera.width, camera.height);
      case rgbd_frame_t::DEPTH_ZLIB_16:
        return DecodeZlib16(message.depth, camera.width, camera.height);
      default:
        return Fail("depth_encoding " + std::to_string(message.depth_encoding) +
                    " is unknown; expected 1 to 5");
    }
  };
  Result<Image<uint16_t>> depth = decode();
  if (!depth) return Fail("depth: " + depth.error().message);
  frame->depth = std::move(*depth);
  return {};
}

Result<void> DecodeColorInto(const rgbd_frame_t& message, SensorFrame* frame) {
  if (!HasColor(message)) {
    if (message.color.empty()) return {};
    return Fail("color_encoding is COLOR_NONE, but color is not empty");
  }
  if (message.color_encoding < 0 || message.color_encoding > rgbd_frame_t::COLOR_RAW_GREY) {
    return Fail("color_encoding " + std::to_string(message.color_encoding) +
                " is unknown; expected 0 to 7");
  }
  if (message.color.empty()) {
    return Fail("color is empty, but color_encoding is " + std::to_string(message.color_encoding) +
                "; expected 0, COLOR_NONE");
  }
  frame->color_encoding = static_cast<ColorEncoding>(message.color_encoding);
  const auto checked = CheckColorSize(frame->color_encoding, message.color,
                                      message.color_camera.width, message.color_camera.height);
  if (!checked) return Fail("color: " + checked.error().message);
  frame->color = message.color;
  return {};
}

int32_t BigEndian32(std::span<const uint8_t> bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | bytes[at + i];
  return static_cast<int32_t>(value);
}

// Offset of depth_size in an encoded message [bytes]; nullopt if there are too few bytes.
std::optional<size_t> DepthSizeOffset(std::span<const uint8_t> bytes, const std::string& source) {
  constexpr size_t kUpToCameras = 8 + 4 + 8 + 8 + 16 * 8;  // from checksum to T_W_C
  constexpr size_t kCamera = 4 + 4 + 4 * 8 + 1;            // up to num_coefficients
  constexpr size_t kAfterCameras = 1 + 16 * 8 + 8 + 1;     // up to depth_encoding
  size_t at = envelope::ChecksumOffset(source) + kUpToCameras;
  for (int camera = 0; camera < 2; ++camera) {
    if (at + kCamera + 4 > bytes.size()) return std::nullopt;
    const int32_t coefficients = BigEndian32(bytes, at + kCamera);
    if (coefficients < 0) return std::nullopt;
    at += kCamera + 4 + 8 * static_cast<size_t>(coefficients);
  }
  at += kAfterCameras;
  return at + 4 <= bytes.size() ? std::optional(at) : std::nullopt;
}

// The message with its fields up to `end`, followed by two empty images.
template <typename Message>
std::optional<Message> DecodePrefix(std::span<const uint8_t> bytes, size_t end) {
  constexpr size_t kEmptyImages = 4 + 1 + 4;
  std::vector<uint8_t> prefix(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(end));
  prefix.resize(end + kEmptyImages, 0);
  Message message{};
  if (message.decode(prefix.data(), 0, static_cast<int>(prefix.size())) < 0) return std::nullopt;
  return message;
}

std::optional<rgbd_frame_t> PeekCurrent(std::span<const uint8_t> bytes, size_t total_bytes,
                                        const std::string& source) {
  const std::optional<size_t> depth_size_at = DepthSizeOffset(bytes, source);
  if (!depth_size_at) return std::nullopt;
  auto message = DecodePrefix<rgbd_frame_t>(bytes, *depth_size_at);
  if (!message) return message;
  // Behind depth stand color_encoding and color_size, and nothing else without colour.
  const int64_t without_color =
      static_cast<int64_t>(*depth_size_at) + 4 + BigEndian32(bytes, *depth_size_at) + 1 + 4;
  message->color_encoding = static_cast<int64_t>(total_bytes) > without_color
                                ? rgbd_frame_t::COLOR_JPEG
                                : rgbd_frame_t::COLOR_NONE;
  return message;
}

std::optional<rgbd_frame_t> PeekOlder(std::span<const uint8_t> bytes, const std::string& source) {
  static const rgbd_frame_v1_t kEmpty{};
  constexpr size_t kEmptyImages = 4 + 1 + 4;
  const size_t end = static_cast<size_t>(kEmpty.getEncodedSize()) - kEmptyImages + source.size();
  if (bytes.size() < end) return std::nullopt;
  const auto older = DecodePrefix<rgbd_frame_v1_t>(bytes, end);
  return older ? std::optional(ToCurrentVersion(*older)) : std::nullopt;
}

}  // namespace

rgbd_frame_t Encode(const SensorFrame& frame) {
  rgbd_frame_t message{};
  const FrameHeader& header = frame.header;
  message.utime = header.utime;
  message.camera_id = Raw(header.camera_id);
  message.frame_number = header.frame_number;
  message.after_utime = -1;
  EncodePose(header.T_W_C, message.T_W_C);
  const LensCamera ideal{header.camera};
  message.color_camera = EncodeCamera(frame.optics ? frame.optics->color : ideal);
  message.depth_camera = EncodeCamera(frame.optics ? frame.optics->depth : ideal);
  message.depth_registered = !frame.optics || frame.optics->depth_registered ? 1 : 0;
  EncodePose(frame.optics ? frame.optics->T_color_depth : Pose::Identity(), message.T_color_depth);
  message.depth_unit_m = frame.depth_unit_m;
  message.depth_encoding =
      frame.depth.empty() ? rgbd_frame_t::DEPTH_FLOAT_M : rgbd_frame_t::DEPTH_ZSTD_DELTA;
  message.depth = frame.depth.empty() ? EncodeRawFloat(frame.depth_m) : EncodeDepth(frame.depth);
  message.depth_size = static_cast<int32_t>(message.depth.size());
  message.color_encoding =
      frame.color.empty() ? rgbd_frame_t::COLOR_NONE : static_cast<int8_t>(frame.color_encoding);
  message.color = frame.color;
  message.color_size = static_cast<int32_t>(message.color.size());
  return message;
}

Result<FrameHeader> DecodeHeader(const rgbd_frame_t& message) {
  const Result<SensorFrame> frame = DecodeGeometry(message);
  if (!frame) return Fail(Where(message) + frame.error().message);
  return frame->header;
}

const camera_t& CameraOf(const rgbd_frame_t& message) { return DepthCameraOf(message); }

Result<FrameHeader> PeekFrameHeader(std::span<const uint8_t> bytes, size_t total_bytes) {
  const std::optional<MessageHead> head = PeekHead(bytes);
  if (!head || head->fingerprint != rgbd_frame_t::getHash()) {
    return Fail(
        envelope::FingerprintError(bytes, rgbd_frame_t::getTypeName(), rgbd_frame_t::getHash()));
  }
  const bool current = envelope::ReadFingerprint(bytes) == rgbd_frame_t::getHash();
  const std::optional<rgbd_frame_t> message =
      current ? PeekCurrent(bytes, total_bytes, head->source) : PeekOlder(bytes, head->source);
  if (!message) {
    return Fail("rgbd_frame_t: truncated after " + std::to_string(bytes.size()) +
                " bytes, or its header cannot be decoded");
  }
  return DecodeHeader(*message);
}

Result<SensorFrame> DecodeWithoutDepth(const rgbd_frame_t& message) {
  Result<SensorFrame> frame = DecodeGeometry(message);
  if (!frame) return Fail(Where(message) + frame.error().message);
  if (const auto color = DecodeColorInto(message, &*frame); !color)
    return Fail(Where(message) + color.error().message);
  return frame;
}

Result<SensorFrame> Decode(const rgbd_frame_t& message) {
  Result<SensorFrame> frame = DecodeWithoutDepth(message);
  if (!frame) return frame;
  if (const auto depth = DecodeDepthInto(message, &*frame); !depth)
    return Fail(Where(message) + depth.error().message);
  return frame;
}

}  // namespace vismap
