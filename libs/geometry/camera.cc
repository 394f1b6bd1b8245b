#include "geometry/camera.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace vismap {

std::string CameraText(const PinholeCamera& camera) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), "fx %.6g fy %.6g cx %.6g cy %.6g (%dx%d)", camera.fx,
                camera.fy, camera.cx, camera.cy, camera.width, camera.height);
  return text.data();
}

Result<PinholeCamera> ValidateCamera(const PinholeCamera& camera) {
  std::ostringstream text;
  const auto plausible = [](double x) { return std::isfinite(x) && std::abs(x) < 1e6; };
  if (camera.width < 1 || camera.height < 1 || camera.width > 16384 || camera.height > 16384) {
    text << "camera size is " << camera.width << "x" << camera.height
         << "; expected 1..16384 pixels each way";
  } else if (!plausible(camera.fx) || !plausible(camera.fy) || camera.fx <= 0 || camera.fy <= 0) {
    text << "camera focal lengths are fx " << camera.fx << ", fy " << camera.fy
         << "; expected positive pixels";
  } else if (!plausible(camera.cx) || !plausible(camera.cy)) {
    text << "camera principal point is (" << camera.cx << ", " << camera.cy << "); expected pixels";
  } else {
    return camera;
  }
  return Fail(text.str());
}

}  // namespace vismap
