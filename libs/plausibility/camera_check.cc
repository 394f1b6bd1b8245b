#include "plausibility/camera_check.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace vismap {
namespace {

constexpr double kNarrowest = 25, kWidest = 130;  // [degrees]
constexpr double kOffMiddle = 0.2;                // of the image

std::string Sentence(const char* format, const char* what, double value, int pixels, double extra) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, what, value, pixels, extra);
  return text.data();
}

void CheckAngle(const char* axis, const char* name, int pixels, double focal,
                std::vector<std::string>* sentences) {
  const double degrees = 2 * std::atan(pixels / (2 * std::abs(focal))) * 180 / std::numbers::pi;
  if (degrees >= kNarrowest && degrees <= kWidest) return;
  sentences->push_back(Sentence("the focal length %s = %.4g px and the image size of %d px give an "
                                "angle of view of %.3g degrees",
                                axis, focal, pixels, degrees) +
                       " along the " + name + "; are the intrinsics those of another image size?");
}

void CheckMiddle(const char* axis, int pixels, double center, std::vector<std::string>* sentences) {
  const double middle = (pixels - 1) / 2.0;
  if (std::abs(center - middle) <= kOffMiddle * pixels) return;
  sentences->push_back(
      Sentence("the principal point %s = %.4g px is more than a fifth of the image (%d px) off its "
               "middle, %.4g px",
               axis, center, pixels, middle) +
      "; are the intrinsics those of another image size?");
}

}  // namespace

std::vector<std::string> UnusualCamera(const PinholeCamera& camera) {
  std::vector<std::string> sentences;
  CheckAngle("fx", "width", camera.width, camera.fx, &sentences);
  // The height of a wide image may well be seen at a small angle: only impossible ones are told.
  if (2 * std::atan(camera.height / (2 * std::abs(camera.fy))) * 180 / std::numbers::pi > kWidest)
    CheckAngle("fy", "height", camera.height, camera.fy, &sentences);
  CheckMiddle("cx", camera.width, camera.cx, &sentences);
  CheckMiddle("cy", camera.height, camera.cy, &sentences);
  return sentences;
}

}  // namespace vismap
