// Things thinner than a voxel stay in the free space that planners get, and go with what they are
// part of.
#include <gtest/gtest.h>

#include <cstdio>

#include "evaluation/free_space.h"
#include "quality/mapped_sequence.h"
#include "simulation/camera_path.h"
#include "simulation/room.h"
#include "support/scene_sequence.h"

namespace vismap {
namespace {

using testing_support::MapFrames;
using testing_support::SceneSequence;

constexpr double kPostLow = 0.9, kPostHigh = 1.5;  // the part that is looked at [m]
const Eigen::Vector3d kPostFoot(-1.7, -0.3, 0);

/// The room with a round post on the floor that is there in frames before `end`.
Scene RoomWithPost(double diameter, int64_t end = INT64_MAX) {
  Scene scene = MakeRoom();
  SceneObject post{.id = 100, .name = "post", .color = {90, 90, 90}, .shapes = {}};
  Shape shape{.kind = Shape::Kind::kCylinder};
  shape.half_size = {diameter / 2, diameter / 2, 0.8};
  shape.T_W_O.translation() = kPostFoot + Eigen::Vector3d(0, 0, 0.8);
  post.shapes.push_back(shape);
  post.end_frame = end;
  scene.objects.push_back(post);
  return scene;
}

/// A camera that goes from side to side and looks at the post from 2.3 to 3 m.
std::vector<FrameHeader> LooksAtPost(int count) {
  const PinholeCamera camera{640, 480, 525, 525, 319.5, 239.5};
  std::vector<FrameHeader> headers;
  for (int i = 0; i < count; ++i) {
    const double s = std::sin(0.17 * i), c = std::cos(0.11 * i);
    headers.push_back(
        {.utime = 100000 * (i + 1),
         .camera_id = CameraId{0},
         .frame_number = i + 1,
         .camera = camera,
         .T_W_C = LookAt({0.8 + 0.2 * c, 1.1 * s, 1.5}, {-1.7, -0.3 + 0.2 * c, 1.1})});
  }
  return headers;
}

/// Points on the surface of the post, without its ends [m].
std::vector<Eigen::Vector3f> PointsOnPost(double diameter) {
  std::vector<Eigen::Vector3f> points;
  for (double z = kPostLow; z < kPostHigh; z += 0.005) {
    for (int i = 0; i < 16; ++i) {
      const double angle = i * M_PI / 8;
      const Eigen::Vector3d around(std::cos(angle), std::sin(angle), 0);
      const Eigen::Vector3d p = kPostFoot + diameter / 2 * around + Eigen::Vector3d(0, 0, z);
      points.push_back(p.cast<float>());
    }
  }
  return points;
}

/// As config/office-2cm.txtpb has it.
MapSessionOptions OfficeOptions() {
  MapSessionOptions options;
  options.grid.voxel_size_m = 0.02;
  options.integration.max_range_m = 3;
  options.integration.free_space_range_m = 3;
  return options;
}

struct PostMap {
  MapSession session;
  OccupancyMap occupancy;
};

PostMap MapScene(const Scene& scene, const std::vector<FrameHeader>& headers,
                 const MapSessionOptions& options) {
  const SceneSequence frames(scene, headers);
  PostMap map{MapSession(options, {}), OccupancyMap(options.grid.voxel_size_m)};
  MapFrames(frames, {}, SIZE_MAX, &map.session);
  map.occupancy = ClassifyMap(map.session.map(), {});
  return map;
}

double FreePart(const CellShares& shares) {
  return static_cast<double>(shares.free) / static_cast<double>(shares.samples);
}

TEST(ThinThings, APostOfHalfAVoxelIsNotFree) {
  for (const double diameter : {0.005, 0.01, 0.02}) {
    const PostMap map = MapScene(RoomWithPost(diameter), LooksAtPost(40), OfficeOptions());
    const CellShares shares = CellsAt(map.occupancy, PointsOnPost(diameter));
    OccupancyOptions without;
    without.thin_hits = 0;
    const double before =
        FreePart(CellsAt(ClassifyMap(map.session.map(), without), PointsOnPost(diameter)));
    std::printf("post of %.0f mm: %.1f %% free, %.1f %% without hits\n", 1e3 * diameter,
                100 * FreePart(shares), 100 * before);
    EXPECT_LT(FreePart(shares), 0.03);
    if (diameter > 0.01) continue;
    EXPECT_GT(before, 0.3) << "else this test shows nothing";
  }
}

TEST(ThinThings, APostThatIsTakenAwayIsFree) {
  const PostMap map = MapScene(RoomWithPost(0.01, 41), LooksAtPost(60), OfficeOptions());
  EXPECT_GT(FreePart(CellsAt(map.occupancy, PointsOnPost(0.01))), 0.97);
}

// Occupied cells that are far from every surface.
int64_t FalseCells(const OccupancyMap& occupancy, const Scene& scene) {
  int64_t cells = 0;
  for (const BlockIndex& index : occupancy.SortedIndices()) {
    for (int i = 0; i < kBlockVoxels; ++i) {
      if (occupancy.At(index).At(i) != CellState::kOccupied) continue;
      const Eigen::Vector3d cell(index.x * kBlockSide + i % kBlockSide,
                                 index.y * kBlockSide + i / kBlockSide % kBlockSide,
                                 index.z * kBlockSide + i / (kBlockSide * kBlockSide));
      const Eigen::Vector3d p = (cell.array() + 0.5) * occupancy.cell_size();
      cells += SignedDistance(scene, p) > 3 * occupancy.cell_size() ? 1 : 0;
    }
  }
  return cells;
}

TEST(ThinThings, NoiseIsNotTakenForThem) {
  const Scene scene = MakeRoom();
  for (const double voxel : {0.01, 0.02}) {
    MapSessionOptions options;
    options.grid.voxel_size_m = voxel;
    const PostMap map = MapScene(scene, MakeHeaders({}), options);
    OccupancyOptions without;
    without.thin_hits = 0;
    const int64_t with_hits = FalseCells(map.occupancy, scene);
    const int64_t before = FalseCells(ClassifyMap(map.session.map(), without), scene);
    std::printf("%.0f cm: %ld occupied cells far from every surface, %ld without hits\n",
                100 * voxel, static_cast<long>(with_hits), static_cast<long>(before));
    EXPECT_LE(with_hits, before + before / 20 + 20);
  }
}

}  // namespace
}  // namespace vismap
