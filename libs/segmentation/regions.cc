#include "segmentation/regions.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>
#include <vector>

#include "base/parallel.h"

namespace vismap {
namespace {

constexpr size_t kRowGrain = 16;

size_t At(int32_t i) { return static_cast<size_t>(i); }

/// Disjoint sets of region numbers; the smallest number of a set stands for it.
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

/// Gives linked runs one number, from `first` on by their first pixel, and those of fewer than
/// `min_pixels` the number 0. Returns the highest number.
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
  // The runs of a set come after the one that stands for it, which has its first pixel.
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
  ParallelFor(At(table.height()), kRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    int32_t* pixels = regions->row(v);
    if (clear) std::fill_n(pixels, regions->width(), 0);
    for (const Run& run : table.row(v)) {
      if (run.region != 0) std::fill(pixels + run.begin, pixels + run.end, run.region);
    }
  });
}

/// The pixels from which regions can grow, in row order.
std::vector<int32_t> Front(const Image<uint8_t>& depth, const Image<uint8_t>& links,
                           const RegionImage& regions) {
  const int width = regions.width(), height = regions.height();
  constexpr int kBandRows = 32;
  std::vector<std::vector<int32_t>> bands(At((height + kBandRows - 1) / kBandRows));
  ParallelFor(bands.size(), 1, [&](size_t band) {
    std::vector<uint8_t> front(At(width));
    const int first = static_cast<int>(band) * kBandRows;
    for (int v = first; v < std::min(height, first + kBandRows); ++v) {
      // Outside the image nothing is linked, so that any row may stand for it.
      const int above = std::max(v - 1, 0), below = std::min(v + 1, height - 1);
      MarkFront({links.row(v), depth.row(v), depth.row(above), depth.row(below), regions.row(v),
                 regions.row(above), regions.row(below)},
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

/// Queues of pixels, one per edge strength. Every pixel waits at most once, so that a queue is a
/// chain through one image.
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
  ParallelFor(At(height), kRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    LinkPixels(joined.row(v), v > 0 ? joined.row(v - 1) : none.data(), width, links.row(v));
  });
  return links;
}

Regions ConnectedRegions(const Image<uint8_t>& depth, const Image<uint8_t>& links,
                         const Image<uint8_t>& strength, int min_pixels) {
  const int width = links.width(), height = links.height();
  RunTable table(width, height, [&](int v, RunFlags flags) {
    MarkFlat(depth.row(v), strength.row(v), links.row(v), width, flags);
  });
  Regions regions{RegionImage::Unset(width, height), ConnectRuns(links, min_pixels, 1, &table)};
  Paint(table, true, &regions.image);
  return regions;
}

void FloodRegions(const Image<uint8_t>& depth, const Image<uint8_t>& links,
                  const Image<uint8_t>& strength, RegionImage* regions) {
  // A pixel waits in the queue of the strongest edge on its way, so that all that is reached over
  // weaker edges comes first; within a queue, first come, first served.
  const int32_t width = links.width();
  PixelQueues queues(width, links.height());
  int32_t* region = regions->data();
  const auto take = [&](int32_t from, int32_t to, uint8_t level) {
    if (region[to] != 0) return;
    region[to] = region[from];
    queues.Push(std::max(level, strength.data()[to]), to);
  };
  const auto spread = [&](int32_t from, uint8_t level) {
    const uint8_t bits = links.data()[from];
    if (bits & kLinkRight) take(from, from + 1, level);
    if (bits & kLinkDown) take(from, from + width, level);
    if (bits & kLinkLeft) take(from, from - 1, level);
    if (bits & kLinkUp) take(from, from - width, level);
  };
  for (const int32_t pixel : Front(depth, links, *regions)) spread(pixel, 0);
  for (size_t level = 0; level < 256; ++level) {
    for (int32_t pixel = queues.First(level); pixel != PixelQueues::kNone;
         pixel = queues.Next(pixel)) {
      spread(pixel, static_cast<uint8_t>(level));
    }
  }
}

void AddMissedRegions(const Image<uint8_t>& depth, const Image<uint8_t>& links, int min_pixels,
                      Regions* regions) {
  const int width = links.width(), height = links.height();
  RunTable missed(width, height, [&](int v, RunFlags flags) {
    MarkMissed(depth.row(v), regions->image.row(v), links.row(v), width, flags);
  });
  regions->count = ConnectRuns(links, min_pixels, regions->count + 1, &missed);
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
