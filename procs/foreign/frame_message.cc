#include "foreign/frame_message.h"

#include <utility>

namespace vismap {
namespace {

int8_t ColorCode(PixelFormat format) {
  switch (format) {
    case PixelFormat::kRgb:
      return rgbd_frame_t::COLOR_RAW_RGB;
    case PixelFormat::kBgr:
      return rgbd_frame_t::COLOR_RAW_BGR;
    case PixelFormat::kRgba:
      return rgbd_frame_t::COLOR_RAW_RGBA;
    case PixelFormat::kBgra:
      return rgbd_frame_t::COLOR_RAW_BGRA;
    case PixelFormat::kGrey:
      return rgbd_frame_t::COLOR_RAW_GREY;
    case PixelFormat::kJpeg:
      return rgbd_frame_t::COLOR_JPEG;
    case PixelFormat::kPng:
      return rgbd_frame_t::COLOR_PNG;
    default:
      return rgbd_frame_t::COLOR_NONE;
  }
}

int8_t DepthCode(PixelFormat format) {
  switch (format) {
    case PixelFormat::kDepth16Zlib:
      return rgbd_frame_t::DEPTH_ZLIB_16;
    case PixelFormat::kDepthPng:
      return rgbd_frame_t::DEPTH_PNG;
    case PixelFormat::kDepthFloat:
      return rgbd_frame_t::DEPTH_FLOAT_M;
    default:
      return rgbd_frame_t::DEPTH_RAW_16;
  }
}

camera_t ToMessage(const ForeignCamera& camera) {
  camera_t message{};
  message.width = camera.width;
  message.height = camera.height;
  message.fx = camera.fx;
  message.fy = camera.fy;
  message.cx = camera.cx;
  message.cy = camera.cy;
  switch (camera.distortion) {
    case ForeignCamera::Distortion::kNone:
      message.distortion = camera_t::DISTORTION_NONE;
      break;
    case ForeignCamera::Distortion::kBrownConrady:
      message.distortion = camera_t::DISTORTION_BROWN_CONRADY;
      break;
    case ForeignCamera::Distortion::kEquidistant:
      message.distortion = camera_t::DISTORTION_EQUIDISTANT;
      break;
  }
  message.coefficients = camera.coefficients;
  message.num_coefficients = static_cast<int32_t>(camera.coefficients.size());
  return message;
}

void SetMatrix(const Pose& pose, double* matrix) {
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) matrix[4 * row + column] = pose(row, column);
  }
}

}  // namespace

rgbd_frame_t ToMessage(ForeignFrame&& frame, const AdapterCameraOptions& options) {
  rgbd_frame_t message{};
  message.utime = frame.utime;
  message.camera_id = options.camera_id;
  message.frame_number = -1;
  message.after_utime = -1;
  SetMatrix(frame.T_W_C, message.T_W_C);
  message.color_camera = ToMessage(frame.color_camera);
  message.depth_camera = ToMessage(frame.depth_camera);
  message.depth_registered = frame.depth_registered;
  SetMatrix(frame.T_color_depth, message.T_color_depth);
  message.depth_unit_m = options.depth_unit_m;
  message.depth_encoding = DepthCode(frame.depth.format);
  message.depth = std::move(frame.depth.bytes);
  message.depth_size = static_cast<int32_t>(message.depth.size());
  message.color_encoding = rgbd_frame_t::COLOR_NONE;
  if (frame.color) {
    message.color_encoding = ColorCode(frame.color->format);
    message.color = std::move(frame.color->bytes);
    message.color_size = static_cast<int32_t>(message.color.size());
  }
  return message;
}

}  // namespace vismap
