#include "segmentation/regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace vismap {
namespace {

/// Disjoint sets of region numbers; the smallest number of a set stands for it.
class DisjointSets {
 public:
  int32_t Add() {
    parent_.push_back(static_cast<int32_t>(parent_.size()));
    return parent_.back();
  }
  int32_t Find(int32_t i) {
    while (parent_[At(i)] != i) i = parent_[At(i)] = parent_[At(parent_[At(i)])];
    return i;
  }
  int32_t Unite(int32_t a, int32_t b) {
    a = Find(a);
    b = Find(b);
    const auto [low, high] = std::minmax(a, b);
    parent_[At(high)] = low;
    return low;
  }

 private:
  static size_t At(int32_t i) { return static_cast<size_t>(i); }
  std::vector<int32_t> parent_;
};

/// 4-connected regions over joined pixels where `keep(v, u)`.
template <typename Keep>
RegionImage Connect(const SurfaceMap& surface, const Keep& keep) {
  const int width = surface.joined.width(), height = surface.joined.height();
  RegionImage regions(width, height);
  DisjointSets sets;
  sets.Add();  // 0 = none
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      if (!keep(v, u)) continue;
      const bool west = u > 0 && (surface.joined(v, u - 1) & kJoinedRight);
      const bool north = v > 0 && (surface.joined(v - 1, u) & kJoinedDown);
      const int32_t a = west ? regions(v, u - 1) : 0, b = north ? regions(v - 1, u) : 0;
      regions(v, u) = a && b ? (a == b ? a : sets.Unite(a, b)) : a ? a : b ? b : sets.Add();
    }
  }
  for (int32_t& region : regions.pixels()) region = sets.Find(region);
  return regions;
}

std::vector<int32_t> CountPixels(const RegionImage& regions) {
  std::vector<int32_t> counts(1);
  for (const int32_t region : regions.pixels()) {
    const auto i = static_cast<size_t>(region);
    if (i >= counts.size()) counts.resize(i + 1);
    ++counts[i];
  }
  return counts;
}

/// Calls visit(offset of neighbour) for the neighbours that a pixel is joined with.
template <typename Visit>
void ForJoined(const SurfaceMap& surface, int32_t offset, const Visit& visit) {
  const int32_t width = surface.joined.width();
  const uint8_t* joined = surface.joined.data();
  const int32_t u = offset % width;
  if (joined[offset] & kJoinedRight) visit(offset + 1);
  if (joined[offset] & kJoinedDown) visit(offset + width);
  if (u > 0 && (joined[offset - 1] & kJoinedRight)) visit(offset - 1);
  if (offset >= width && (joined[offset - width] & kJoinedDown)) visit(offset - width);
}

/// What JoinSmallRegions knows of a region.
struct RegionSummary {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  int border = 0;                    ///< joined pixel pairs with other regions
  std::map<int32_t, int> neighbors;  ///< pairs per other region; only of small regions
};

std::vector<RegionSummary> Summarize(const SurfaceMap& surface, const RegionImage& regions,
                                     const std::vector<int32_t>& counts, int min_pixels) {
  std::vector<RegionSummary> summaries(counts.size());
  const auto small = [&](size_t region) { return region && counts[region] < min_pixels; };
  for (int32_t i = 0; i < static_cast<int32_t>(regions.size()); ++i) {
    const int32_t region = regions.data()[i];
    RegionSummary& summary = summaries[static_cast<size_t>(region)];
    if (surface.normals_C.z.data()[i] < 2) {  // not NaN
      summary.normal +=
          Eigen::Vector3d(surface.normals_C.x.data()[i], surface.normals_C.y.data()[i],
                          surface.normals_C.z.data()[i]);
    }
    if (!small(static_cast<size_t>(region))) continue;
    ForJoined(surface, i, [&](int32_t other) {
      const int32_t neighbor = regions.data()[other];
      if (neighbor == region || neighbor == 0) return;
      ++summary.border;
      ++summary.neighbors[neighbor];
    });
  }
  return summaries;
}

/// The large region that `region` is a speck of; 0 = none.
int32_t HostOf(const std::vector<RegionSummary>& summaries, const std::vector<int32_t>& counts,
               size_t region, int min_pixels, double max_angle) {
  const RegionSummary& summary = summaries[region];
  int32_t host = 0;
  int most = summary.border / 2;
  for (const auto& [neighbor, pairs] : summary.neighbors) {
    if (pairs <= most || counts[static_cast<size_t>(neighbor)] < min_pixels) continue;
    host = neighbor;
    most = pairs;
  }
  const Eigen::Vector3d& normal = summaries[static_cast<size_t>(host)].normal;
  const double limit = std::cos(max_angle) * normal.norm() * summary.normal.norm();
  return host && normal.dot(summary.normal) >= limit ? host : 0;
}

}  // namespace

RegionImage ConnectedRegions(const SurfaceMap& surface, const Image<uint8_t>& strength) {
  return Connect(surface,
                 [&](int v, int u) { return surface.radius(v, u) && strength(v, u) == 0; });
}

void FloodRegions(const SurfaceMap& surface, const Image<uint8_t>& strength, RegionImage* regions) {
  // One queue per strength. A pixel waits in the queue of the strongest edge on its way, so that
  // all that is reached over weaker edges comes first; within a queue, first come, first served.
  std::array<std::vector<int32_t>, 256> queues;
  int32_t* region = regions->data();
  const auto spread = [&](int32_t from, int level) {
    ForJoined(surface, from, [&](int32_t to) {
      if (region[to]) return;
      region[to] = region[from];
      queues[static_cast<size_t>(std::max<int>(level, strength.data()[to]))].push_back(to);
    });
  };
  const std::vector<int32_t> seeds = regions->pixels();
  for (int32_t i = 0; i < static_cast<int32_t>(seeds.size()); ++i) {
    if (seeds[static_cast<size_t>(i)]) spread(i, 0);
  }
  for (int level = 0; level < 256; ++level) {
    auto& queue = queues[static_cast<size_t>(level)];
    for (size_t next = 0; next < queue.size(); ++next) spread(queue[next], level);  // queue grows
  }
}

void AddMissedRegions(const SurfaceMap& surface, int min_pixels, RegionImage* regions) {
  RegionImage missed =
      Connect(surface, [&](int v, int u) { return surface.radius(v, u) && (*regions)(v, u) == 0; });
  DropSmallRegions(min_pixels, &missed);
  const int32_t used = *std::max_element(regions->pixels().begin(), regions->pixels().end());
  for (size_t i = 0; i < missed.size(); ++i) {
    if (missed.data()[i]) regions->data()[i] = used + missed.data()[i];
  }
}

void JoinSmallRegions(const SurfaceMap& surface, int min_pixels, double max_angle,
                      RegionImage* regions) {
  const std::vector<int32_t> counts = CountPixels(*regions);
  const auto summaries = Summarize(surface, *regions, counts, min_pixels);
  std::vector<int32_t> becomes(counts.size());
  for (size_t region = 1; region < counts.size(); ++region) {
    const bool small = counts[region] > 0 && counts[region] < min_pixels;
    const int32_t host = small ? HostOf(summaries, counts, region, min_pixels, max_angle) : 0;
    becomes[region] = host ? host : static_cast<int32_t>(region);
  }
  for (int32_t& region : regions->pixels()) region = becomes[static_cast<size_t>(region)];
}

void DropSmallRegions(int min_pixels, RegionImage* regions) {
  const std::vector<int32_t> counts = CountPixels(*regions);
  for (int32_t& region : regions->pixels()) {
    if (counts[static_cast<size_t>(region)] < min_pixels) region = 0;
  }
}

SegmentImage NumberRegions(const RegionImage& regions) {
  SegmentImage image{Image<SegmentIndex>(regions.width(), regions.height(), SegmentIndex::kNone),
                     0};
  const auto& pixels = regions.pixels();
  const int32_t top = pixels.empty() ? 0 : *std::max_element(pixels.begin(), pixels.end());
  std::vector<int32_t> index(static_cast<size_t>(top) + 1, -1);
  for (size_t i = 0; i < pixels.size(); ++i) {
    if (pixels[i] == 0) continue;
    int32_t& number = index[static_cast<size_t>(pixels[i])];
    if (number < 0) number = image.segment_count++;
    image.index.data()[i] = static_cast<SegmentIndex>(number);
  }
  return image;
}

}  // namespace vismap
