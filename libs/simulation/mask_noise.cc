#include "simulation/mask_noise.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/require.h"
#include "codecs/mask_codec.h"
#include "simulation/noise_field.h"

namespace vismap {
namespace {

constexpr double kMaxWavers = 3;       // largest displacement of the border, in deviations
constexpr double kHoleDeviations = 2;  // a hole is where a normal number exceeds this: 2.3 %

/// A random integer in [-limit, limit].
int UpTo(int limit, uint64_t bits) {
  return static_cast<int>(Uniform(bits) * (2 * limit + 1)) - limit;
}

/// An empty mask for a box and a margin around it, limited to the image.
Mask Around(const Eigen::AlignedBox2i& box, int margin, int width, int height) {
  const int u0 = std::max(box.min().x() - margin, 0);
  const int v0 = std::max(box.min().y() - margin, 0);
  const int u1 = std::min(box.max().x() + 1 + margin, width);
  const int v1 = std::min(box.max().y() + 1 + margin, height);
  return {.image_width = width,
          .image_height = height,
          .u0 = u0,
          .v0 = v0,
          .inside = Image<uint8_t>(u1 - u0, v1 - v0)};
}

/// The displacement of a mask's pixels: a common shift, and a smooth field that deforms the border.
class Displacement {
 public:
  Displacement(const MaskNoise& noise, int width, int height, uint64_t key)
      : waver_(noise.waver),
        shift_u_(UpTo(noise.max_shift, Mix(key, 4))),
        shift_v_(UpTo(noise.max_shift, Mix(key, 5))),
        along_u_(width, height, Spacing(), Mix(key, 6)),
        along_v_(width, height, Spacing(), Mix(key, 7)),
        holes_(width, height, Spacing(), Mix(key, 8)) {}

  int U(int v, int u) const { return shift_u_ + Wave(along_u_, v, u); }
  int V(int v, int u) const { return shift_v_ + Wave(along_v_, v, u); }
  bool IsHole(int v, int u) const { return waver_ > 0 && holes_.At(v, u) > kHoleDeviations; }

 private:
  int Spacing() const { return std::max(1, static_cast<int>(std::lround(4 * waver_))); }
  int Wave(const NoiseField& field, int v, int u) const {
    const double wave = std::clamp(field.At(v, u), -kMaxWavers, kMaxWavers);
    return static_cast<int>(std::floor(waver_ * wave + 0.5));
  }

  double waver_;
  int shift_u_, shift_v_;
  NoiseField along_u_, along_v_, holes_;
};

void CutExactly(const Image<uint16_t>& ids, uint16_t id, Mask* mask) {
  for (int v = 0; v < mask->inside.height(); ++v) {
    for (int u = 0; u < mask->inside.width(); ++u)
      mask->inside(v, u) = ids(v + mask->v0, u + mask->u0) == id;
  }
}

/// Sets the mask where the displaced pixel shows the object. Outside of the image, ids are those of
/// the nearest pixel.
void CutDisplaced(const Image<uint16_t>& ids, uint16_t id, const Displacement& from, Mask* mask) {
  for (int v = 0; v < mask->inside.height(); ++v) {
    for (int u = 0; u < mask->inside.width(); ++u) {
      const int row = std::clamp(v + mask->v0 + from.V(v, u), 0, ids.height() - 1);
      const int column = std::clamp(u + mask->u0 + from.U(v, u), 0, ids.width() - 1);
      mask->inside(v, u) = ids(row, column) == id && !from.IsHole(v, u);
    }
  }
}

/// Sets every pixel to `value` if a pixel within `radius` in its row has that value. The result is
/// transposed.
Image<uint8_t> SpreadAlongRows(const Image<uint8_t>& image, uint8_t value, int radius) {
  Image<uint8_t> spread(image.height(), image.width());
  for (int v = 0; v < image.height(); ++v) {
    for (int u = 0; u < image.width(); ++u) {
      const uint8_t* row = image.row(v);
      const uint8_t* end = row + std::min(u + radius, image.width() - 1) + 1;
      const bool near = std::find(row + std::max(u - radius, 0), end, value) != end;
      spread(u, v) = near ? value : row[u];
    }
  }
  return spread;
}

/// Sets every pixel to `value` if a pixel in the square within `radius` has that value.
Image<uint8_t> Spread(const Image<uint8_t>& image, uint8_t value, int radius) {
  if (radius == 0) return image;
  return SpreadAlongRows(SpreadAlongRows(image, value, radius), value, radius);
}

/// The mask with the smallest box around its pixels.
Mask Tight(const Mask& mask) {
  Mask tight = MaskFromImage(mask.inside);
  tight.image_width = mask.image_width;
  tight.image_height = mask.image_height;
  if (tight.inside.empty()) return tight;
  tight.u0 += mask.u0;
  tight.v0 += mask.v0;
  return tight;
}

}  // namespace

Mask NoisyMask(const Image<uint16_t>& ids, uint16_t id, const Eigen::AlignedBox2i& box,
               const MaskNoise& noise, uint64_t key) {
  Require(noise.max_growth >= 0 && noise.max_shift >= 0 && noise.waver >= 0,
          "mask errors are not negative");
  const int reach = noise.max_shift + static_cast<int>(std::ceil(kMaxWavers * noise.waver));
  Mask mask = Around(box, noise.max_growth + reach + 1, ids.width(), ids.height());
  if (reach > 0) {
    CutDisplaced(ids, id, {noise, mask.inside.width(), mask.inside.height(), key}, &mask);
  } else {
    CutExactly(ids, id, &mask);
  }
  const int growth = UpTo(noise.max_growth, Mix(key, 2));
  mask.inside = Spread(mask.inside, growth > 0 ? 1 : 0, std::abs(growth));
  return Tight(mask);
}

}  // namespace vismap
