#include "segmentation/pixel_kernels.h"

#include <cmath>
#include <cstddef>

#include "geometry/vector_clones.h"

// All functions here are cloned: GCC 12 does not vectorise ordinary functions in the same file.

namespace vismap {

VISMAP_VECTOR_CLONES void PackNormals(const float* x, const float* y, const float* z, int width,
                                      uint32_t* __restrict out) {
  for (int u = 0; u < width; ++u) {
    const float known = z[u] == z[u] ? 1.0F : 0.0F;
    const float nx = known > 0 ? x[u] : 0.0F, ny = known > 0 ? y[u] : 0.0F;
    const float nz = known > 0 ? z[u] : 0.0F;
    const auto a = static_cast<int32_t>(nx * 127.0F + 127.5F);
    const auto b = static_cast<int32_t>(ny * 127.0F + 127.5F);
    const auto c = static_cast<int32_t>(nz * 127.0F + 127.5F);
    const int32_t packed = a | b << 8 | c << 16 | 1 << 24;
    out[u] = static_cast<uint32_t>(known > 0 ? packed : 0);
  }
}

int PackedSquare(float chord) {
  const float least = std::floor(chord * 127.0F - 1.7321F);  // sqrt(3), rounded up
  return least > 0 ? static_cast<int>(least * least) : 0;
}

VISMAP_VECTOR_CLONES void MarkFolds(const FoldRow& row, int min_square, int width,
                                    uint8_t* __restrict out) {
  const uint32_t* __restrict normals = row.normals;
  const uint8_t* __restrict has_depth = row.has_depth;
  const uint8_t* __restrict left = row.left, * __restrict right = row.right;
  const uint8_t* __restrict up = row.up, * __restrict down = row.down;
  const int stride = row.stride;
  for (int u = 0; u < width; ++u) {
    const auto l = static_cast<int32_t>(normals[u - left[u]]);
    const auto r = static_cast<int32_t>(normals[u + right[u]]);
    const auto a = static_cast<int32_t>(normals[u - stride * up[u]]);
    const auto b = static_cast<int32_t>(normals[u + stride * down[u]]);
    const int32_t x = (l & 255) - (r & 255), y = (l >> 8 & 255) - (r >> 8 & 255);
    const int32_t z = (l >> 16 & 255) - (r >> 16 & 255);
    const int32_t p = (a & 255) - (b & 255), q = (a >> 8 & 255) - (b >> 8 & 255);
    const int32_t s = (a >> 16 & 255) - (b >> 16 & 255);
    const int32_t known_across = (l >> 24) & (r >> 24), known_along = (a >> 24) & (b >> 24);
    const int32_t across = x * x + y * y + z * z >= min_square ? kFoldAcross : 0;
    const int32_t along = p * p + q * q + s * s >= min_square ? kFoldAlong : 0;
    const int32_t folds = (known_across ? across : 0) | (known_along ? along : 0);
    out[u] = static_cast<uint8_t>(has_depth[u] ? folds : 0);
  }
}

VISMAP_VECTOR_CLONES void LinkPixels(const uint8_t* joined, const uint8_t* above, int width,
                                     uint8_t* __restrict out) {
  for (int u = 0; u < width; ++u)
    out[u] =
        static_cast<uint8_t>((joined[u] & (kLinkRight | kLinkDown)) | (above[u] & kLinkDown) << 2);
  for (int u = 1; u < width; ++u)
    out[u] = static_cast<uint8_t>(out[u] | (joined[u - 1] & kLinkRight) << 2);
}

VISMAP_VECTOR_CLONES void MarkRim(const RimRow& row, int width, uint8_t* __restrict out) {
  const uint8_t *links = row.links, *has_depth = row.has_depth;
  const uint8_t *above = row.has_depth_above, *below = row.has_depth_below;
  for (int u = 0; u < width; ++u) {
    const bool up = above[u] != 0 && (links[u] & kLinkUp) == 0;
    const bool down = below[u] != 0 && (links[u] & kLinkDown) == 0;
    out[u] = (up | down) && has_depth[u] != 0 ? 1 : 0;
  }
  for (int u = 1; u < width; ++u) {
    const bool left = has_depth[u - 1] != 0 && (links[u] & kLinkLeft) == 0;
    out[u] = static_cast<uint8_t>(out[u] | (left && has_depth[u] != 0 ? 1 : 0));
  }
  for (int u = 0; u + 1 < width; ++u) {
    const bool right = has_depth[u + 1] != 0 && (links[u] & kLinkRight) == 0;
    out[u] = static_cast<uint8_t>(out[u] | (right && has_depth[u] != 0 ? 1 : 0));
  }
}

VISMAP_VECTOR_CLONES void MarkFlat(const FlatRow& row, int width, RunFlags out) {
  const uint8_t *has_depth = row.has_depth, *strength = row.edge_strength, *links = row.links;
  uint8_t* __restrict in = out.in;
  uint8_t* __restrict on = out.on;
  for (int u = 0; u < width; ++u) in[u] = has_depth[u] != 0 && strength[u] == 0 ? 1 : 0;
  on[0] = 0;
  for (int u = 1; u < width; ++u)
    on[u] = static_cast<uint8_t>(in[u] & in[u - 1] & (links[u] & kLinkLeft) >> 2);
}

VISMAP_VECTOR_CLONES void MarkMissed(const MissedRow& row, int width, RunFlags out) {
  const uint8_t *has_depth = row.has_depth, *links = row.links;
  const int32_t* regions = row.regions;
  uint8_t* __restrict in = out.in;
  uint8_t* __restrict on = out.on;
  for (int u = 0; u < width; ++u) in[u] = has_depth[u] != 0 && regions[u] == 0 ? 1 : 0;
  on[0] = 0;
  for (int u = 1; u < width; ++u)
    on[u] = static_cast<uint8_t>(in[u] & in[u - 1] & (links[u] & kLinkLeft) >> 2);
}

VISMAP_VECTOR_CLONES void MarkRegions(const int32_t* regions, int width, RunFlags out) {
  uint8_t* __restrict in = out.in;
  uint8_t* __restrict on = out.on;
  for (int u = 0; u < width; ++u) in[u] = regions[u] != 0 ? 1 : 0;
  on[0] = 0;
  for (int u = 1; u < width; ++u)
    on[u] = static_cast<uint8_t>(in[u] & (regions[u] == regions[u - 1] ? 1 : 0));
}

VISMAP_VECTOR_CLONES void MarkSegments(const SegmentIndex* segments, int width, RunFlags out) {
  uint8_t* __restrict in = out.in;
  uint8_t* __restrict on = out.on;
  for (int u = 0; u < width; ++u) in[u] = segments[u] != SegmentIndex::kNone ? 1 : 0;
  on[0] = 0;
  for (int u = 1; u < width; ++u)
    on[u] = static_cast<uint8_t>(in[u] & (segments[u] == segments[u - 1] ? 1 : 0));
}

VISMAP_VECTOR_CLONES void MarkFront(const FrontRow& row, int width, uint8_t* __restrict out) {
  const uint8_t* __restrict links = row.links;
  const uint8_t* __restrict has_depth = row.has_depth;
  const int32_t* __restrict regions = row.regions;
  const uint8_t *has_depth_above = row.has_depth_above, *has_depth_below = row.has_depth_below;
  const int32_t *above = row.regions_above, *below = row.regions_below;
  for (int u = 0; u < width; ++u) {
    const bool up = (links[u] & kLinkUp) != 0 && above[u] == 0 && has_depth_above[u] != 0;
    const bool down = (links[u] & kLinkDown) != 0 && below[u] == 0 && has_depth_below[u] != 0;
    out[u] = (up | down) && regions[u] != 0 ? 1 : 0;
  }
  for (int u = 1; u < width; ++u) {
    const bool left = (links[u] & kLinkLeft) != 0 && regions[u - 1] == 0 && has_depth[u - 1] != 0;
    out[u] = static_cast<uint8_t>(out[u] | (left && regions[u] != 0 ? 1 : 0));
  }
  for (int u = 0; u + 1 < width; ++u) {
    const bool right = (links[u] & kLinkRight) != 0 && regions[u + 1] == 0 && has_depth[u + 1] != 0;
    out[u] = static_cast<uint8_t>(out[u] | (right && regions[u] != 0 ? 1 : 0));
  }
}

}  // namespace vismap
