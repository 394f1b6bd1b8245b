#include "detection/letterbox.h"

#include <algorithm>
#include <cmath>

#include "base/require.h"

namespace vismap {
namespace {

// Limits x to [0, end]; NaN becomes 0.
float Cut(double x, int end) {
  return x > 0 ? static_cast<float>(std::min(x, static_cast<double>(end))) : 0;
}

}  // namespace

Letterbox FitLetterbox(int image_width, int image_height, int input_width, int input_height) {
  Require(image_width > 0 && image_height > 0 && input_width > 0 && input_height > 0,
          "images and inputs have pixels");
  const double scale = std::min(static_cast<double>(input_width) / image_width,
                                static_cast<double>(input_height) / image_height);
  const auto side = [&](int image, int input) {
    return std::clamp(static_cast<int>(std::lround(image * scale)), 1, input);
  };
  return {image_width,
          image_height,
          input_width,
          input_height,
          side(image_width, input_width),
          side(image_height, input_height)};
}

Box ToImage(const Letterbox& letterbox, const Box& in_input) {
  return {Cut(in_input.u0 / letterbox.scale_u(), letterbox.image_width),
          Cut(in_input.v0 / letterbox.scale_v(), letterbox.image_height),
          Cut(in_input.u1 / letterbox.scale_u(), letterbox.image_width),
          Cut(in_input.v1 / letterbox.scale_v(), letterbox.image_height)};
}

}  // namespace vismap
