// How many frames it takes until free space says that something was removed or put there.
#include <gtest/gtest.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "freespace/coarsener.h"
#include "quality/mapped_sequence.h"
#include "session/map_frame.h"
#include "simulation/simulate.h"
#include "simulation/synthetic_dataset.h"
#include "support/pipelines.h"

namespace vismap {
namespace {

constexpr uint16_t kMovedChair = 8;
constexpr size_t kTour = 80;
constexpr int kLeafFactor = 5;

/// The cells of this size [m] that the surface of the chair runs through and no other object is
/// near: their centres [m].
std::vector<Eigen::Vector3d> CellsOf(const Scene& scene, double size) {
  const SceneObject& chair = *FindObject(scene, kMovedChair);
  Scene others = scene;
  std::erase_if(others.objects, [&](const SceneObject& o) { return o.id == kMovedChair; });
  const Eigen::AlignedBox3d box = BoundingBox(chair);
  const Eigen::Array3i low = (box.min() / size).array().floor().cast<int>();
  const Eigen::Array3i high = (box.max() / size).array().floor().cast<int>();
  std::vector<Eigen::Vector3d> cells;
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) {
        const Eigen::Vector3d p = size * (Eigen::Vector3d(x, y, z).array() + 0.5);
        if (std::abs(SignedDistance(chair, p)) < size / 2 && SignedDistance(others, p) > 0.12)
          cells.push_back(p);
      }
    }
  }
  return cells;
}

using StateTest = bool (*)(CellState);
bool IsFree(CellState state) { return state == CellState::kFree; }
bool IsOccupied(CellState state) { return state == CellState::kOccupied; }
/// What counts in closed trees, and for distances to what is not free.
bool IsNotFree(CellState state) { return state != CellState::kFree; }

/// Counts the frames that show cells until these have a wanted state.
class CellWatch {
 public:
  CellWatch(std::vector<Eigen::Vector3d> cells, StateTest wanted)
      : cells_(std::move(cells)),
        wanted_(wanted),
        shown_(cells_.size(), 0),
        frames_(cells_.size(), INT_MAX) {}

  /// Cells that have the state already do not count.
  void Start(const OccupancyMap& map) {
    for (size_t i = 0; i < cells_.size(); ++i) {
      if (wanted_(map.At(cells_[i]))) frames_[i] = 0;
    }
  }
  /// `depth`: what the camera sees without noise.
  void See(const FrameHeader& header, const Image<float>& depth, const OccupancyMap& map) {
    for (size_t i = 0; i < cells_.size(); ++i) {
      if (!IsShown(cells_[i], header, depth)) continue;
      ++shown_[i];
      if (frames_[i] == INT_MAX && wanted_(map.At(cells_[i]))) frames_[i] = shown_[i];
    }
  }
  struct Figures {
    int median = 0, most = 0;  ///< 95 of 100 cells take at most `most` frames
  };
  Figures Finish(const char* what) const {
    std::vector<int> counted;
    for (size_t i = 0; i < cells_.size(); ++i) {
      if (frames_[i] > 0 && shown_[i] >= 15) counted.push_back(frames_[i]);
    }
    if (counted.size() < 20) return {INT_MAX, INT_MAX};
    std::sort(counted.begin(), counted.end());
    const Figures figures{counted[counted.size() / 2], counted[counted.size() * 95 / 100]};
    std::printf("%s: %zu cells, median %d frames, 95 %% within %d\n", what, counted.size(),
                figures.median, figures.most);
    return figures;
  }

 private:
  // Whether the camera sees the point, or sees past it.
  static bool IsShown(const Eigen::Vector3d& p_W, const FrameHeader& header,
                      const Image<float>& depth) {
    const Eigen::Vector3d p_C = header.T_W_C.inverse() * p_W;
    if (p_C.z() < 0.4) return false;
    const Eigen::Vector2d pixel = header.camera.Project(p_C);
    const int u = static_cast<int>(std::lround(pixel.x()));
    const int v = static_cast<int>(std::lround(pixel.y()));
    return depth.Contains(v, u) && double{depth(v, u)} > p_C.z() - 0.02;
  }

  std::vector<Eigen::Vector3d> cells_;
  StateTest wanted_;
  std::vector<int> shown_, frames_;
};

struct ChairFigures {
  CellWatch::Figures voxels, leaves;
};

/// Maps two tours of the room; the chair changes with the second. One result per state.
std::vector<ChairFigures> Watch(const std::string& change,
                                const std::vector<std::pair<StateTest, const char*>>& wanted) {
  const std::string name = "synthetic:room?frames=80&tours=2&" + change;
  const SyntheticOptions options = *ParseSyntheticPath(name);
  const Scene scene = MakeScene(options), second = SceneInFrame(scene, kTour + 1);
  const std::vector<FrameHeader> headers = MakeHeaders(options);
  const testing_support::InputSequence sequence(name);
  MapSession session({}, {});
  const double size = session.map().voxels.voxel_size();
  OccupancyMap voxels(size);
  Coarsener coarsener(size, {.factor = kLeafFactor});
  const OccupancyMap& leaves = coarsener.coarse();
  std::vector<CellWatch> of_voxels, of_leaves;
  for (const auto& [state, what] : wanted) {
    of_voxels.emplace_back(CellsOf(scene, size), state);
    of_leaves.emplace_back(CellsOf(scene, kLeafFactor * size), state);
  }
  for (size_t frame = 0; frame < headers.size(); ++frame) {
    testing_support::InputFrame input = sequence.Read(frame);
    const MappedFrame done = MapFrame(std::move(input.frame), input.Detections(), {}, &session);
    voxels.Update(session.map(), done.delta.changed_blocks, {});
    coarsener.Update(voxels, done.delta.changed_blocks);
    if (frame + 1 == kTour) {
      for (CellWatch& watch : of_voxels) watch.Start(voxels);
      for (CellWatch& watch : of_leaves) watch.Start(leaves);
    }
    if (frame < kTour) continue;
    const Rendering truth = Render(second, headers[frame].camera, headers[frame].T_W_C);
    for (CellWatch& watch : of_voxels) watch.See(headers[frame], truth.depth, voxels);
    for (CellWatch& watch : of_leaves) watch.See(headers[frame], truth.depth, leaves);
  }
  std::vector<ChairFigures> figures;
  for (size_t i = 0; i < wanted.size(); ++i) {
    const std::string what = wanted[i].second;
    figures.push_back({of_voxels[i].Finish((what + ", voxels").c_str()),
                       of_leaves[i].Finish((what + ", leaves").c_str())});
  }
  return figures;
}

TEST(MovedObjectFrames, ARemovedChairIsFreeAfterAFewFrames) {
  const ChairFigures gone = Watch("remove=8@81", {{IsFree, "removed, until free"}})[0];
  EXPECT_LE(gone.voxels.median, 6);
  EXPECT_LE(gone.voxels.most, 14);
  EXPECT_LE(gone.leaves.median, 6);
  EXPECT_LE(gone.leaves.most, 14);
}

TEST(MovedObjectFrames, AChairPutThereBlocksPlannersBeforeItIsOccupied) {
  const auto figures = Watch("appear=8@81", {{IsNotFree, "put there, until not free"},
                                             {IsOccupied, "put there, until occupied"}});
  const ChairFigures &blocked = figures[0], &there = figures[1];
  EXPECT_LE(blocked.voxels.median, 4);
  EXPECT_LE(blocked.leaves.median, 3);
  EXPECT_LE(blocked.leaves.most, 8);
  EXPECT_LE(there.leaves.median, 4);
  EXPECT_LE(there.leaves.most, 12);
}

}  // namespace
}  // namespace vismap
