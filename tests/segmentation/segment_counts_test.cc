#include "segmentation/segment_counts.h"

#include <gtest/gtest.h>

#include "support/random_scenes.h"
#include "support/refine_frames.h"

namespace vismap {
namespace {

using namespace testing_support;

/// The runs of pixels of one segment each, found pixel by pixel.
std::vector<LooseRun> NaiveRuns(const Image<SegmentIndex>& index) {
  std::vector<LooseRun> runs;
  for (int v = 0; v < index.height(); ++v) {
    for (int u = 0; u < index.width(); ++u) {
      if (index(v, u) == SegmentIndex::kNone) continue;
      const bool goes_on = u > 0 && index(v, u - 1) == index(v, u);
      if (!goes_on) runs.push_back({v, u, u, Raw(index(v, u))});
      ++runs.back().end;
    }
  }
  return runs;
}

Image<SegmentIndex> RandomSegments(int width, int height, RandomNumbers* random) {
  Image<SegmentIndex> index(width, height, SegmentIndex::kNone);
  SegmentIndex last = SegmentIndex::kNone;
  for (SegmentIndex& pixel : index.pixels()) {
    if (random->Chance(0.3)) last = static_cast<SegmentIndex>(random->Whole(-1, 4));
    pixel = last;
  }
  return index;
}

TEST(SegmentRuns, EqualTheNaiveOnes) {
  RandomNumbers random(1);
  for (const auto& [width, height] : kOddSizes) {
    const Image<SegmentIndex> index = RandomSegments(width, height, &random);
    const RunTable table = SegmentRuns(index);
    std::vector<LooseRun> runs;
    for (const vismap::Run& run : table.runs())
      runs.push_back({run.v, run.begin, run.end, Raw(index(run.v, run.begin))});
    EXPECT_TRUE(runs == NaiveRuns(index)) << width << "x" << height;
  }
}

TEST(CountSegments, CountsThePixelsOfSegmentsAndThoseOfEachDetection) {
  const DetectionSet set =
      Set({Rectangle(kTable, 0.6F, 0, 0, 150, 20), Rectangle(kCup, 0.9F, 140, 0, 20, 20)});
  const PixelOwnership ownership(set, {}, kWidth, kHeight);
  const SegmentCounts counts = CountSegments(Halves(), ownership);
  EXPECT_EQ(counts.pixels, (std::vector<int32_t>{100 * 140, 100 * 140}));
  ASSERT_EQ(counts.inside.size(), 2u);  // in the order of the ranking, below the rows of no segment
  EXPECT_EQ(counts.inside[0], (std::vector<int32_t>{0, 20 * 10}));
  EXPECT_EQ(counts.inside[1], (std::vector<int32_t>{100 * 10, 40 * 10}));
}

}  // namespace
}  // namespace vismap
