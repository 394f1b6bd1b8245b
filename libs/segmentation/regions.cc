#include "segmentation/regions.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "segmentation/at.h"

namespace vismap {
namespace {

/// Disjoint sets of numbers (union-find); the smallest number of a set represents it.
class DisjointSets {
 public:
  explicit DisjointSets(size_t count) : parent_(count) {
    for (size_t i = 0; i < count; ++i) parent_[i] = static_cast<int32_t>(i);
  }
  int32_t Find(int32_t i) {
    while (parent_[At(i)] != i) i = parent_[At(i)] = parent_[At(parent_[At(i)])];
    return i;
  }
  void Unite(int32_t a, int32_t b) {
    const auto [low, high] = std::minmax({Find(a), Find(b)});
    parent_[At(high)] = low;
  }

 private:
  std::vector<int32_t> parent_;
};

bool AnyLinkDown(const uint8_t* links, int32_t begin, int32_t end) {
  return std::any_of(links + begin, links + end, [](uint8_t bits) { return bits & kLinkDown; });
}

/// Numbers the connected components of the runs from `first` on, by their first pixel; those of
/// fewer than `min_pixels` pixels get the number 0. Returns the highest number.
int32_t ConnectRuns(const Image<uint8_t>& links, int min_pixels, int32_t first, RunTable* table) {
  std::vector<Run>& runs = table->runs();
  for (size_t i = 0; i < runs.size(); ++i) runs[i].region = static_cast<int32_t>(i);
  DisjointSets sets(runs.size());
  for (int v = 1; v < table->height(); ++v) {
    const uint8_t* row = links.row(v - 1);
    ForOverlaps(table->row(v - 1), table->row(v),
                [&](const Run& upper, const Run& lower, int32_t begin, int32_t end) {
                  if (AnyLinkDown(row, begin, end)) sets.Unite(upper.region, lower.region);
                });
  }
  std::vector<int32_t> pixels(runs.size());
  for (Run& run : runs) {
    run.region = sets.Find(run.region);
    pixels[At(run.region)] += run.length();
  }
  // The run that represents a set is its first one, so the sets are numbered by their first pixel.
  std::vector<int32_t> number(runs.size());
  int32_t next = first;
  for (size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].region == static_cast<int32_t>(i) && pixels[i] >= min_pixels) number[i] = next++;
  }
  for (Run& run : runs) run.region = number[At(run.region)];
  return next - 1;
}

/// Writes the runs that have a number into the image.
void Paint(const RunTable& table, bool clear, RegionImage* regions) {
  ParallelFor(At(table.height()), kRunRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    int32_t* pixels = regions->row(v);
    if (clear) std::fill_n(pixels, regions->width(), 0);
    for (const Run& run : table.row(v)) {
      if (run.region != 0) std::fill(pixels + run.begin, pixels + run.end, run.region);
    }
  });
}

/// The pixels from which regions can grow, in row order, as offsets in the image.
std::vector<int32_t> FindFront(const PixelGrid& grid, const RegionImage& regions) {
  const int width = regions.width(), height = regions.height();
  constexpr int kBandRows = 32;
  std::vector<std::vector<int32_t>> bands(At((height + kBandRows - 1) / kBandRows));
  ParallelFor(bands.size(), 1, [&](size_t band) {
    std::vector<uint8_t> front(At(width));
    const int first = static_cast<int>(band) * kBandRows;
    for (int v = first; v < std::min(height, first + kBandRows); ++v) {
      // No pixel is linked with one outside the image, so any row may be given in its place.
      const int above = std::max(v - 1, 0), below = std::min(v + 1, height - 1);
      MarkFront({.links = grid.links.row(v),
                 .has_depth = grid.has_depth.row(v),
                 .has_depth_above = grid.has_depth.row(above),
                 .has_depth_below = grid.has_depth.row(below),
                 .regions = regions.row(v),
                 .regions_above = regions.row(above),
                 .regions_below = regions.row(below)},
                width, front.data());
      for (int u = 0; u < width; ++u) {
        if (front[At(u)]) bands[band].push_back(v * width + u);
      }
    }
  });
  std::vector<int32_t> all;
  for (const auto& band : bands) all.insert(all.end(), band.begin(), band.end());
  return all;
}

/// Queues of pixels, one per edge strength. Every pixel is in at most one queue and once, so that
/// all queues are linked lists in one image of "next" offsets.
class PixelQueues {
 public:
  PixelQueues(int width, int height) : next_(Image<int32_t>::Unset(width, height)) {
    first_.fill(kNone);
    last_.fill(kNone);
  }
  void Push(size_t queue, int32_t pixel) {
    next_.data()[pixel] = kNone;
    if (first_[queue] == kNone) {
      first_[queue] = pixel;
    } else {
      next_.data()[last_[queue]] = pixel;
    }
    last_[queue] = pixel;
  }
  int32_t First(size_t queue) const { return first_[queue]; }
  int32_t Next(int32_t pixel) const { return next_.data()[pixel]; }

  static constexpr int32_t kNone = -1;

 private:
  Image<int32_t> next_;
  std::array<int32_t, 256> first_, last_;
};

}  // namespace

Image<uint8_t> LinkImage(const Image<uint8_t>& joined) {
  const int width = joined.width(), height = joined.height();
  Image<uint8_t> links = Image<uint8_t>::Unset(width, height);
  const std::vector<uint8_t> none(At(width));
  ParallelFor(At(height), kRunRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    LinkPixels(joined.row(v), v > 0 ? joined.row(v - 1) : none.data(), width, links.row(v));
  });
  return links;
}

Regions ConnectedRegions(const PixelGrid& grid, int min_pixels) {
  const int width = grid.links.width(), height = grid.links.height();
  RunTable table(width, height, [&](int v, RunFlags flags) {
    MarkFlat({.has_depth = grid.has_depth.row(v),
              .edge_strength = grid.edge_strength.row(v),
              .links = grid.links.row(v)},
             width, flags);
  });
  const int32_t count = ConnectRuns(grid.links, min_pixels, 1, &table);
  Regions regions{RegionImage::Unset(width, height), count};
  Paint(table, true, &regions.image);
  return regions;
}

void FloodRegions(const PixelGrid& grid, RegionImage* regions) {
  // A pixel waits in the queue of the strongest edge on the way to it, so that all pixels behind
  // weaker edges come first. Within a queue the order is first in, first out.
  const int32_t width = grid.links.width();
  PixelQueues queues(width, grid.links.height());
  int32_t* region = regions->data();
  const auto assign = [&](int32_t from, int32_t to, uint8_t level) {
    if (region[to] != 0) return;  // another region, or this one, was here first
    region[to] = region[from];
    queues.Push(std::max(level, grid.edge_strength.data()[to]), to);
  };
  const auto spread = [&](int32_t from, uint8_t level) {
    const uint8_t bits = grid.links.data()[from];
    if (bits & kLinkRight) assign(from, from + 1, level);
    if (bits & kLinkDown) assign(from, from + width, level);
    if (bits & kLinkLeft) assign(from, from - 1, level);
    if (bits & kLinkUp) assign(from, from - width, level);
  };
  for (const int32_t pixel : FindFront(grid, *regions)) spread(pixel, 0);
  for (size_t level = 0; level < 256; ++level) {
    for (int32_t pixel = queues.First(level); pixel != PixelQueues::kNone;
         pixel = queues.Next(pixel)) {
      spread(pixel, static_cast<uint8_t>(level));
    }
  }
}

void AddMissedRegions(const PixelGrid& grid, int min_pixels, Regions* regions) {
  const int width = grid.links.width(), height = grid.links.height();
  RunTable missed(width, height, [&](int v, RunFlags flags) {
    MarkMissed({.has_depth = grid.has_depth.row(v),
                .regions = regions->image.row(v),
                .links = grid.links.row(v)},
               width, flags);
  });
  regions->count = ConnectRuns(grid.links, min_pixels, regions->count + 1, &missed);
  Paint(missed, false, &regions->image);
}

SegmentImage NumberRegions(const RegionImage& regions) {
  SegmentImage image{Image<SegmentIndex>(regions.width(), regions.height(), SegmentIndex::kNone),
                     0};
  const auto& pixels = regions.pixels();
  const int32_t top = pixels.empty() ? 0 : *std::max_element(pixels.begin(), pixels.end());
  std::vector<int32_t> index(At(top) + 1, -1);
  for (size_t i = 0; i < pixels.size(); ++i) {
    if (pixels[i] == 0) continue;
    int32_t& number = index[At(pixels[i])];
    if (number < 0) number = image.segment_count++;
    image.index.data()[i] = static_cast<SegmentIndex>(number);
  }
  return image;
}

}  // namespace vismap
