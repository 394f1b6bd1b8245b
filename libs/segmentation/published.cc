#include "segmentation/published.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"
#include "segmentation/regions.h"

namespace vismap {
namespace {

constexpr size_t kWindowRowGrain = 4;

/// Calls visit(row, column) for the window of side `side` around (v, u), cut at the image border.
template <typename Visit>
void ForWindow(int width, int height, int v, int u, int side, const Visit& visit) {
  const int half = side / 2;
  for (int row = std::max(0, v - half); row <= std::min(height - 1, v + half); ++row) {
    for (int col = std::max(0, u - half); col <= std::min(width - 1, u + half); ++col) {
      visit(row, col);
    }
  }
}

/// The image of flags value(v, u).
template <typename Value>
Image<uint8_t> ForEachPixel(int width, int height, const Value& value) {
  Image<uint8_t> out(width, height);
  ParallelFor(static_cast<size_t>(height), kWindowRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    for (int u = 0; u < width; ++u) out(v, u) = value(v, u) ? 1 : 0;
  });
  return out;
}

/// 1 where any pixel (all pixels) of the 3x3 window is 1.
Image<uint8_t> Dilate(const Image<uint8_t>& in) {
  return ForEachPixel(in.width(), in.height(), [&](int v, int u) {
    bool any = false;
    ForWindow(in.width(), in.height(), v, u, 3, [&](int y, int x) { any |= in(y, x) != 0; });
    return any;
  });
}
Image<uint8_t> Erode(const Image<uint8_t>& in) {
  return ForEachPixel(in.width(), in.height(), [&](int v, int u) {
    bool all = true;
    ForWindow(in.width(), in.height(), v, u, 3, [&](int y, int x) { all &= in(y, x) != 0; });
    return all;
  });
}

/// Whether the depth steps up or down by more than `ratio` of itself in the 3x3 window.
bool IsDepthStep(const SurfaceMap& surface, double ratio, int v, int u) {
  const Image<float>& depth = surface.points_C.z;
  const float z = depth(v, u);
  float low = z, high = z;
  ForWindow(depth.width(), depth.height(), v, u, 3, [&](int y, int x) {
    const float other = surface.points_C.valid(y, x) ? depth(y, x) : 0.0F;
    low = std::min(low, other);
    high = std::max(high, other);
  });
  return std::max(high - z, z - low) > static_cast<float>(ratio) * z;
}

/// Whether no neighbour in the window is concave: rises above the pixel's tangent plane with a
/// normal that is turned away.
bool IsConvex(const SurfaceMap& surface, const SegmentationOptions& options, int v, int u) {
  if (!surface.normals_C.valid(v, u)) return false;
  const Eigen::Vector3f p = surface.points_C.at(v, u), n = surface.normals_C.at(v, u);
  const auto tolerance = static_cast<float>(options.concave_tolerance_m);
  float least = 1;
  ForWindow(surface.joined.width(), surface.joined.height(), v, u, options.convexity_window_px,
            [&](int y, int x) {
              if (!surface.normals_C.valid(y, x)) return;
              const float rise = (surface.points_C.at(y, x) - p).dot(n);
              if (rise >= tolerance) least = std::min(least, n.dot(surface.normals_C.at(y, x)));
            });
  return least > static_cast<float>(options.concave_cosine);
}

/// Links every two neighbours with depth: in the published method only edges separate regions.
Image<uint8_t> LinksByDepth(const Image<uint8_t>& depth) {
  Image<uint8_t> joined(depth.width(), depth.height());
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(v, u) == 0) continue;
      if (depth.Contains(v, u + 1) && depth(v, u + 1)) joined(v, u) |= kJoinedRight;
      if (depth.Contains(v + 1, u) && depth(v + 1, u)) joined(v, u) |= kJoinedDown;
    }
  }
  return LinkImage(joined);
}

/// Assigns every pixel without region to the region of the nearest point in its window; of several
/// equally near to the one with the lowest number.
RegionImage AssignEdgePixels(const SurfaceMap& surface, const RegionImage& regions,
                             const SegmentationOptions& options) {
  RegionImage out = regions;
  const int width = regions.width(), height = regions.height();
  const auto reach = static_cast<float>(options.give_back_distance_m);
  ParallelFor(static_cast<size_t>(height), kWindowRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    for (int u = 0; u < width; ++u) {
      if (regions(v, u) || surface.radius(v, u) == 0) continue;  // not an edge, or without depth
      const Eigen::Vector3f p = surface.points_C.at(v, u);
      float nearest = reach * reach;
      ForWindow(width, height, v, u, options.give_back_window_px, [&](int y, int x) {
        if (regions(y, x) == 0) return;
        const float distance = (surface.points_C.at(y, x) - p).squaredNorm();
        const bool tie = distance == nearest && out(v, u) && regions(y, x) < out(v, u);
        if (!(distance < nearest) && !tie) return;
        nearest = distance;
        out(v, u) = regions(y, x);
      });
    }
  });
  return out;
}

}  // namespace

SegmentImage SegmentAsPublished(const SurfaceMap& surface, int min_pixels,
                                const SegmentationOptions& options) {
  const int width = surface.radius.width(), height = surface.radius.height();
  const Image<uint8_t> convex = Dilate(Erode(
      ForEachPixel(width, height, [&](int v, int u) { return IsConvex(surface, options, v, u); })));
  const Image<uint8_t> steps = Erode(Dilate(ForEachPixel(width, height, [&](int v, int u) {
    return surface.radius(v, u) && IsDepthStep(surface, options.depth_ratio, v, u);
  })));
  const Image<uint8_t> edge =
      ForEachPixel(width, height, [&](int v, int u) { return !convex(v, u) || steps(v, u) != 0; });
  const Image<uint8_t> links = LinksByDepth(surface.radius);
  const Regions regions = ConnectedRegions(
      {.has_depth = surface.radius, .links = links, .edge_strength = edge}, min_pixels);
  return NumberRegions(AssignEdgePixels(surface, regions.image, options));
}

}  // namespace vismap
