#include "viewer/mask_overlay.h"

#include <algorithm>
#include <cmath>

#include "base/require.h"

namespace vismap {
namespace {

constexpr float kTint = 0.45F;
constexpr int kPixelsPerLine = 320;  // so many pixels of width make the outline one pixel thicker

uint8_t Mix(uint8_t from, uint8_t to, float share) {
  return static_cast<uint8_t>(std::lround((1 - share) * from + share * to));
}

// The mask at the size of the picture: 1 where the linearly interpolated value is at least 1/2.
Image<uint8_t> Stretch(const Image<uint8_t>& mask, int width, int height) {
  Image<uint8_t> large(width, height);
  const float across = static_cast<float>(mask.width()) / static_cast<float>(width);
  const float down = static_cast<float>(mask.height()) / static_cast<float>(height);
  for (int v = 0; v < height; ++v) {
    const float y = std::min(static_cast<float>(v) * down, static_cast<float>(mask.height() - 1));
    const int top = static_cast<int>(y), bottom = std::min(top + 1, mask.height() - 1);
    const float low = y - static_cast<float>(top);
    for (int u = 0; u < width; ++u) {
      const float x =
          std::min(static_cast<float>(u) * across, static_cast<float>(mask.width() - 1));
      const int left = static_cast<int>(x), right = std::min(left + 1, mask.width() - 1);
      const float far = x - static_cast<float>(left);
      const float value = (1 - low) * ((1 - far) * mask(top, left) + far * mask(top, right)) +
                          low * ((1 - far) * mask(bottom, left) + far * mask(bottom, right));
      large(v, u) = value >= 0.5F ? 1 : 0;
    }
  }
  return large;
}

// Whether the mask has a pixel, and lacks one that is at most `reach` rows or columns away.
bool IsEdge(const Image<uint8_t>& mask, int v, int u, int reach) {
  if (mask(v, u) == 0) return false;
  for (int step = 1; step <= reach; ++step) {
    for (const auto& [y, x] : {std::pair(v - step, u), std::pair(v + step, u),
                               std::pair(v, u - step), std::pair(v, u + step)}) {
      if (mask.Contains(y, x) && mask(y, x) == 0) return true;
    }
  }
  return false;
}

}  // namespace

void DrawMask(const Image<uint8_t>& mask, Rgb8 color, Image<Rgb8>* picture) {
  if (mask.empty() || picture->empty()) return;
  const Image<uint8_t> large = Stretch(mask, picture->width(), picture->height());
  for (int v = 0; v < picture->height(); ++v) {
    for (int u = 0; u < picture->width(); ++u) {
      if (large(v, u) == 0) continue;
      Rgb8& pixel = (*picture)(v, u);
      pixel = {Mix(pixel.r, color.r, kTint), Mix(pixel.g, color.g, kTint),
               Mix(pixel.b, color.b, kTint)};
    }
  }
  DrawOutline(large, color, picture);
}

void DrawOutline(const Image<uint8_t>& mask, Rgb8 color, Image<Rgb8>* picture) {
  Require(mask.width() == picture->width() && mask.height() == picture->height(),
          "the mask has the size of the picture");
  const int reach = 1 + picture->width() / kPixelsPerLine;
  for (int v = 0; v < mask.height(); ++v) {
    for (int u = 0; u < mask.width(); ++u) {
      if (IsEdge(mask, v, u, reach)) (*picture)(v, u) = color;
    }
  }
}

Image<Rgb8> ShrinkPicture(const Image<Rgb8>& picture, int factor) {
  if (factor <= 1) return picture;
  Image<Rgb8> small(picture.width() / factor, picture.height() / factor);
  const int samples = factor * factor;
  for (int v = 0; v < small.height(); ++v) {
    for (int u = 0; u < small.width(); ++u) {
      int red = 0, green = 0, blue = 0;
      for (int i = 0; i < samples; ++i) {
        const Rgb8& pixel = picture(v * factor + i / factor, u * factor + i % factor);
        red += pixel.r;
        green += pixel.g;
        blue += pixel.b;
      }
      small(v, u) = {static_cast<uint8_t>(red / samples), static_cast<uint8_t>(green / samples),
                     static_cast<uint8_t>(blue / samples)};
    }
  }
  return small;
}

}  // namespace vismap
