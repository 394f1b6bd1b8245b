#include "segmentation/mask_sets.h"

#include <algorithm>

namespace vismap {
namespace {

/// Adds the pixels of a mask to one whose box contains its box.
void Add(const Mask& mask, Mask* sum) {
  for (int v = 0; v < mask.inside.height(); ++v) {
    const uint8_t* from = mask.inside.row(v);
    uint8_t* to = sum->inside.row(v + mask.v0 - sum->v0) + (mask.u0 - sum->u0);
    for (int u = 0; u < mask.inside.width(); ++u) to[u] = from[u] != 0 ? 1 : to[u];
  }
}

}  // namespace

int32_t MaskArea(const Mask& mask) {
  const auto& inside = mask.inside.pixels();
  return static_cast<int32_t>(inside.size() -
                              static_cast<size_t>(std::count(inside.begin(), inside.end(), 0)));
}

int32_t SharedArea(const Mask& a, const Mask& b) {
  const int u0 = std::max(a.u0, b.u0), v0 = std::max(a.v0, b.v0);
  const int u1 = std::min(a.u0 + a.inside.width(), b.u0 + b.inside.width());
  const int v1 = std::min(a.v0 + a.inside.height(), b.v0 + b.inside.height());
  int32_t shared = 0;
  for (int v = v0; v < v1; ++v) {
    const uint8_t* in_a = a.inside.row(v - a.v0) + (u0 - a.u0);
    const uint8_t* in_b = b.inside.row(v - b.v0) + (u0 - b.u0);
    for (int i = 0; i < u1 - u0; ++i) shared += in_a[i] != 0 && in_b[i] != 0 ? 1 : 0;
  }
  return shared;
}

Mask UnionOf(const Mask& a, const Mask& b) {
  if (a.inside.empty()) return b;
  if (b.inside.empty()) return a;
  const int u0 = std::min(a.u0, b.u0), v0 = std::min(a.v0, b.v0);
  const int u1 = std::max(a.u0 + a.inside.width(), b.u0 + b.inside.width());
  const int v1 = std::max(a.v0 + a.inside.height(), b.v0 + b.inside.height());
  Mask sum{a.image_width, a.image_height, u0, v0, Image<uint8_t>(u1 - u0, v1 - v0, uint8_t{0})};
  Add(a, &sum);
  Add(b, &sum);
  return sum;
}

}  // namespace vismap
