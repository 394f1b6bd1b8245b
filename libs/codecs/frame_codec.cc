#include "codecs/frame_codec.h"

#include <cmath>
#include <limits>
#include <string>

#include "codecs/color_codec.h"

namespace vismap {
namespace {

std::string SizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

std::string FrameText(const FrameHeader& header) {
  return "frame utime " + std::to_string(header.utime) + " of camera " +
         std::to_string(Raw(header.camera_id)) + ": ";
}

Result<void> CheckSizes(const SensorFrame& frame) {
  const PinholeCamera& camera = frame.header.camera;
  if (const auto checked = ValidateCamera(camera); !checked) return Fail(checked.error().message);
  if (frame.depth.width() != camera.width || frame.depth.height() != camera.height) {
    return Fail("depth is " + SizeText(frame.depth.width(), frame.depth.height()) +
                " but the camera " + SizeText(camera.width, camera.height));
  }
  if (!(frame.depth_unit_m > 0 && frame.depth_unit_m <= 1)) {
    return Fail("depth unit is " + std::to_string(frame.depth_unit_m) + " m; expected (0, 1]");
  }
  if (frame.color_jpeg.empty()) return {};
  const Result<JpegSize> color = ReadJpegSize(frame.color_jpeg);
  if (color && (color->width != camera.width || color->height != camera.height)) {
    return Fail("colour is " + SizeText(color->width, color->height) + " but depth " +
                SizeText(camera.width, camera.height));
  }
  return {};
}

}  // namespace

Image<float> DepthInMetres(const Image<uint16_t>& depth, double depth_unit_m) {
  Image<float> metres(depth.width(), depth.height());
  for (size_t i = 0; i < depth.size(); ++i) {
    const uint16_t steps = depth.data()[i];
    metres.data()[i] = steps == 0 || steps == 65535 ? std::numeric_limits<float>::quiet_NaN()
                                                    : static_cast<float>(steps * depth_unit_m);
  }
  return metres;
}

Result<RgbdFrame> DecodeFrame(const SensorFrame& frame) {
  if (const auto checked = CheckSizes(frame); !checked) {
    return Fail(FrameText(frame.header) + checked.error().message);
  }
  RgbdFrame decoded{
      frame.header, DepthInMetres(frame.depth, frame.depth_unit_m), {}, frame.color_problem};
  if (frame.color_jpeg.empty()) return decoded;
  Result<Image<Rgb8>> color = DecodeJpeg(frame.color_jpeg);
  if (color) {
    decoded.color = std::move(*color);
  } else {
    decoded.color_problem = FrameText(frame.header) + "colour: " + color.error().message;
  }
  return decoded;
}

}  // namespace vismap
