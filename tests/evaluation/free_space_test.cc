#include "evaluation/free_space.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

constexpr int kSide = 32;

// Frames of a wall, seen by a camera at the origin whose optical axis is z: at 1 m, at 5 m, broken.
class WallDataset : public Dataset {
 public:
  explicit WallDataset(size_t frames) : frames_(frames) {}
  std::string name() const override { return "wall"; }
  std::string format() const override { return "synthetic"; }
  size_t size() const override { return frames_; }
  FrameHeader Header(size_t i) const override {
    FrameHeader header;
    header.utime = static_cast<int64_t>(i);
    header.camera = {kSide, kSide, 100, 100, 15.5, 15.5};
    header.T_W_C = Pose::Identity();
    return header;
  }
  Result<SensorFrame> Read(size_t i) const override {
    if (i == 2) return Fail("frame 2 is broken");
    SensorFrame frame;
    frame.header = Header(i);
    frame.depth_unit_m = 0.001;
    frame.depth = Image<uint16_t>(kSide, kSide, i == 0 ? uint16_t{1000} : uint16_t{5000});
    return frame;
  }
  const std::vector<SkippedFrame>& skipped() const override { return skipped_; }
  std::optional<std::string> default_detections_path() const override { return std::nullopt; }

 private:
  size_t frames_;
  std::vector<SkippedFrame> skipped_;
};

// Free up to 0.8 m, occupied from there on.
OccupancyMap MapBeforeWall() {
  OccupancyMap map(0.1);
  for (const int x : {-1, 0}) {
    for (const int y : {-1, 0}) {
      map.Set({x, y, 0}, BlockOccupancy(CellState::kFree));
      map.Set({x, y, 1}, BlockOccupancy(CellState::kOccupied));
    }
  }
  return map;
}

TEST(ScoreRays, SamplesFreeSpaceBeforeTheSurfaceAndTheSurface) {
  const auto score = ScoreRays(MapBeforeWall(), WallDataset(1), {});
  ASSERT_TRUE(score) << score.error().message;
  EXPECT_EQ(score->surface.samples, 16);  // pixels 4, 12, 20, 28
  EXPECT_EQ(score->surface.occupied, 16);
  EXPECT_EQ(score->free.samples, 16 * 6);  // at 0.3, 0.4 ... 0.8 m
  EXPECT_GE(score->free.free, 16 * 5);     // 0.8 m along a slanted ray is less along z
  EXPECT_EQ(score->free.unknown, 0);
}

TEST(ScoreRays, LeavesFarPixelsOut) {
  RayOptions options;
  options.frame_step = 1;
  const auto score = ScoreRays(MapBeforeWall(), WallDataset(2), options);
  ASSERT_TRUE(score) << score.error().message;
  EXPECT_EQ(score->surface.samples, 16);
}

TEST(ScoreRays, LeavesOutAFrameThatCannotBeRead) {
  RayOptions options;
  options.frame_step = 2;
  const auto score = ScoreRays(MapBeforeWall(), WallDataset(3), options);
  ASSERT_TRUE(score) << score.error().message;
  EXPECT_EQ(score->surface.samples, 16) << "those of frame 0";
}

TEST(CountOccupied, WithoutATruthAllCellsAreFar) {
  const OccupiedCells cells = CountOccupied(MapBeforeWall(), {}, 0.15);
  EXPECT_EQ(cells.cells, 4 * kBlockVoxels);
  EXPECT_EQ(cells.far_from_truth, cells.cells);
}

}  // namespace
}  // namespace vismap
