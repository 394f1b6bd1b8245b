#include "geometry/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <sstream>

namespace vismap {

std::string CameraText(const PinholeCamera& camera) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), "fx %.6g fy %.6g cx %.6g cy %.6g (%dx%d)", camera.fx,
                camera.fy, camera.cx, camera.cy, camera.width, camera.height);
  return text.data();
}

namespace {

// Whether all pixels along one axis lie within kMaxViewAngleDeg of the optical axis.
bool HasPlausibleView(int pixels, double focal, double center) {
  const double farthest = std::tan(kMaxViewAngleDeg * std::acos(-1) / 180) * focal;
  return center + 0.5 <= farthest && pixels - 0.5 - center <= farthest;
}

}  // namespace

Result<PinholeCamera> ValidateCamera(const PinholeCamera& camera) {
  std::ostringstream text;
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  const auto size = [](int side) { return side >= 1 && side <= kMaxImageSide; };
  const int width = camera.width, height = camera.height;
  if (!size(width) || !size(height) ||
      static_cast<size_t>(width) * static_cast<size_t>(height) > kMaxImagePixels) {
    text << "camera size is " << width << "x" << height << "; expected 1.." << kMaxImageSide
         << " pixels each way and at most " << kMaxImagePixels << " in all";
  } else if (!positive(camera.fx) || !positive(camera.fy)) {
    text << "camera focal lengths are fx " << camera.fx << ", fy " << camera.fy
         << "; expected positive pixels";
  } else if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy)) {
    text << "camera principal point is (" << camera.cx << ", " << camera.cy << "); expected pixels";
  } else if (!HasPlausibleView(width, camera.fx, camera.cx) ||
             !HasPlausibleView(height, camera.fy, camera.cy)) {
    text << "camera with fx " << camera.fx << ", fy " << camera.fy << ", cx " << camera.cx
         << ", cy " << camera.cy << " in an image of " << width << "x" << height
         << " pixels would see more than " << kMaxViewAngleDeg
         << " degrees from its optical axis; expected intrinsics in pixels of this image size";
  } else if (std::max(camera.fx, camera.fy) > kMaxFocalSides * std::max(width, height)) {
    text << "camera focal lengths are fx " << camera.fx << ", fy " << camera.fy
         << " in an image of " << width << "x" << height << " pixels; expected at most "
         << kMaxFocalSides << " times its larger side";
  } else {
    return camera;
  }
  return Fail(text.str());
}

}  // namespace vismap
