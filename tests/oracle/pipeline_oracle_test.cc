// Compares the whole pipeline with the naive one, and with itself for other numbers of threads, on
// the built-in room and on recorded sequences.
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "support/naive/surface_checks.h"
#include "support/pipelines.h"

namespace vismap {
namespace {

using testing_support::InputFrame;
using testing_support::InputSequence;
using testing_support::MapFast;
using testing_support::MapNaively;

/// A few frames of a sequence.
struct Excerpt {
  const char* name;  ///< of a folder below VISMAP_DATA, or synthetic:...
  int frames, stride;
};

/// Names the case by its sequence.
void PrintTo(const Excerpt& excerpt, std::ostream* out) { *out << excerpt.name; }

class Pipeline : public ::testing::TestWithParam<Excerpt> {
 protected:
  void SetUp() override {
    const Excerpt& excerpt = GetParam();
    std::optional<std::string> path = excerpt.name;
    if (!IsSyntheticPath(excerpt.name)) path = testing_support::RecordedSequence(excerpt.name);
    if (!path) GTEST_SKIP() << "VISMAP_DATA is not set, or has no " << excerpt.name;
    inputs_ = InputSequence(*path, {excerpt.stride, excerpt.frames, CameraId{0}}).ReadAll();
    ASSERT_EQ(inputs_.size(), static_cast<size_t>(excerpt.frames));
  }

  std::vector<InputFrame> inputs_;
};

TEST_P(Pipeline, SurfacesAndSegmentsEqualTheNaiveOnes) {
  for (const InputFrame& input : inputs_) {
    SCOPED_TRACE(input.frame.header.frame_number);
    const PinholeCamera& camera = input.frame.header.camera;
    const Image<float> depth = naive::FillHoles(input.frame.depth, {});
    const SurfaceMap fast = ComputeSurface(depth, camera, {});
    const SurfaceMap slow = naive::ComputeSurface(depth, camera, {});
    naive::ExpectEqualSurfaces(fast, slow);
    EXPECT_TRUE(SegmentDepth(fast, camera, {}).index ==
                naive::SegmentDepth(fast, camera, {}).index);
  }
}

TEST_P(Pipeline, MapHasTheHashOfTheNaiveOne) {
  const VoxelGridOptions grid{0.02, 4};
  const SemanticMap fast = MapFast(inputs_, grid);
  EXPECT_EQ(HashMap(fast), HashMap(MapNaively(inputs_, grid)));
  EXPECT_GT(MeasureMemory(fast.voxels).surface_blocks, 100u);
  EXPECT_GT(fast.labels.Alive().size(), 3u);
}

TEST_P(Pipeline, MapHasTheSameHashWith1And2And4Threads) {
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    hashes.push_back(HashMap(MapFast(inputs_, {0.01, 4})));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

INSTANTIATE_TEST_SUITE_P(All, Pipeline,
                         ::testing::Values(Excerpt{"synthetic:room?frames=40&width=161", 4, 2},
                                           Excerpt{"7scenes", 4, 7}, Excerpt{"scenes/101", 3, 5}));

}  // namespace
}  // namespace vismap
