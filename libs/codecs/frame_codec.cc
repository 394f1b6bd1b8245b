#include "codecs/frame_codec.h"

#include <cmath>
#include <limits>
#include <string>

#include "codecs/raw_image.h"

namespace vismap {
namespace {

std::string SizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

Result<void> CheckSizes(const SensorFrame& frame) {
  if (frame.optics) return Fail("the frame has not been rectified");
  const PinholeCamera& camera = frame.header.camera;
  if (const auto checked = ValidateCamera(camera); !checked) return Fail(checked.error().message);
  const bool floats = frame.depth.empty();
  const int width = floats ? frame.depth_m.width() : frame.depth.width();
  const int height = floats ? frame.depth_m.height() : frame.depth.height();
  if (width != camera.width || height != camera.height) {
    return Fail("depth is " + SizeText(width, height) + " but the camera " +
                SizeText(camera.width, camera.height));
  }
  if (!floats && !(frame.depth_unit_m > 0 && frame.depth_unit_m <= 1)) {
    return Fail("depth unit is " + std::to_string(frame.depth_unit_m) + " m; expected (0, 1]");
  }
  if (frame.color.empty()) return {};
  if (const auto color =
          CheckColorSize(frame.color_encoding, frame.color, camera.width, camera.height);
      !color)
    return Fail("colour: " + color.error().message);
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

Image<float> DepthInMetres(const SensorFrame& frame) {
  if (!frame.depth.empty()) return DepthInMetres(frame.depth, frame.depth_unit_m);
  Image<float> metres = frame.depth_m;
  for (float& z : metres.pixels()) {
    if (!(z > 0 && std::isfinite(z))) z = std::numeric_limits<float>::quiet_NaN();
  }
  return metres;
}

Image<uint16_t> DepthInSteps(const Image<float>& depth_m, double depth_unit_m) {
  Image<uint16_t> depth(depth_m.width(), depth_m.height());
  const double per_metre = 1 / depth_unit_m;
  for (size_t i = 0; i < depth.size(); ++i) {
    const double steps = std::floor(double{depth_m.data()[i]} * per_metre + 0.5);
    if (steps >= 1 && steps < 65535) depth.data()[i] = static_cast<uint16_t>(steps);
  }
  return depth;
}

std::string FrameText(const FrameHeader& header) {
  return "frame utime " + std::to_string(header.utime) + " of camera " +
         std::to_string(Raw(header.camera_id)) + ": ";
}

Result<RgbdFrame> DecodeFrame(const SensorFrame& frame) {
  if (const auto checked = CheckSizes(frame); !checked) {
    return Fail(FrameText(frame.header) + checked.error().message);
  }
  RgbdFrame decoded{frame.header, DepthInMetres(frame), {}, frame.color_problem};
  if (frame.color.empty()) return decoded;
  const PinholeCamera& camera = frame.header.camera;
  Result<Image<Rgb8>> color =
      DecodeColor(frame.color_encoding, frame.color, camera.width, camera.height);
  if (color) {
    decoded.color = std::move(*color);
  } else {
    decoded.color_problem = FrameText(frame.header) + "colour: " + color.error().message;
  }
  return decoded;
}

}  // namespace vismap
