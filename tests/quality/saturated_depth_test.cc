// Depth that a camera gives where it measured nothing frees no solid: not what stands behind glass,
// nor what is too dark or too shiny to be seen.
#include <gtest/gtest.h>

#include <cstdio>
#include <stdexcept>

#include "datasets/image_file.h"
#include "evaluation/free_space.h"
#include "evaluation/ground_truth.h"
#include "freespace/coarsen.h"
#include "plausibility/depth_losses.h"
#include "quality/mapped_sequence.h"
#include "simulation/room.h"
#include "simulation/seen_surface.h"
#include "support/pipelines.h"
#include "support/scene_sequence.h"

namespace vismap {
namespace {

using testing_support::ChangedDataset;
using testing_support::MapFrames;
using testing_support::SceneSequence;

constexpr uint16_t kCouch = 10, kCabinet = 11;  // in the room
constexpr double kMostFree = 0.015;             // of the surface of an object

SyntheticOptions RoomOptions(bool noise = true) {
  SyntheticOptions options;
  options.frames = 40;
  options.width = 320;
  options.noise = noise;
  return options;
}

/// The points 3 mm below the surface of an object that some frame sees [m]. Many surfaces lie
/// exactly between two voxels.
std::vector<Eigen::Vector3f> SeenPointsOf(uint16_t id, const SyntheticOptions& options) {
  const Scene scene = MakeScene(options);
  const SceneObject& object = *FindObject(scene, id);
  const LabelledMesh mesh = RenderSeenSurface(options).Triangles(scene, 0.02);
  std::vector<Eigen::Vector3f> points;
  for (size_t i = 0; i < mesh.points_W.size(); ++i) {
    if (mesh.object_ids[i] != id) continue;
    const Eigen::Vector3d& p = mesh.points_W[i];
    Eigen::Vector3d outward;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = 1e-4 * Eigen::Vector3d::Unit(axis);
      outward[axis] = SignedDistance(object, p + step) - SignedDistance(object, p - step);
    }
    points.push_back((p - 0.003 * outward.normalized()).cast<float>());
  }
  return points;
}

/// Sets the depth of all pixels of an object.
SceneSequence::Change GlareOf(uint16_t id, uint16_t millimetres, const Scene& scene) {
  return [=](const FrameHeader& header, SensorFrame* frame) {
    const Image<uint16_t> ids = RenderInstances(scene, header.camera, header.T_W_C);
    for (size_t i = 0; i < ids.size(); ++i) {
      if (ids.data()[i] == id) frame->depth.data()[i] = millimetres;
    }
  };
}

/// Parts of the surface of an object that are free.
struct FreeParts {
  double voxels = 0;  ///< of the points, in voxels of 1 cm
  double leaves = 0;  ///< in leaves of 5 cm, as planners get them
};

FreeParts FreePartsOf(const SemanticMap& map, const std::vector<Eigen::Vector3f>& points) {
  const OccupancyMap voxels = ClassifyMap(map, {});
  const auto part = [&](const OccupancyMap& cells) {
    const CellShares shares = CellsAt(cells, points);
    return static_cast<double>(shares.free) / static_cast<double>(shares.samples);
  };
  return {part(voxels), part(Coarsen(voxels, {.factor = 5}))};
}

struct Glare {
  uint16_t id = 0;
  uint16_t millimetres = 0;  ///< 0 = no return
  bool noise = true;
};

/// Maps a room in which the depth of an object is one value.
FreeParts MapGlare(const Glare& glare, const SegmentationStageOptions& stage, DepthLosses* losses) {
  const SyntheticOptions options = RoomOptions(glare.noise);
  const Scene scene = MakeScene(options);
  DepthNoise noise;
  noise.enabled = options.noise;
  const SceneSequence sequence(scene, MakeHeaders(options), noise,
                               GlareOf(glare.id, glare.millimetres, scene));
  MapSession session({}, {});
  *losses = MapFrames(sequence, stage, SIZE_MAX, &session).depth_losses;
  const FreeParts parts = FreePartsOf(session.map(), SeenPointsOf(glare.id, options));
  std::printf(
      "%s, object %d at %d mm: %.2f %% of its surface is free in voxels, %.2f %% in leaves\n",
      glare.noise ? "noisy" : "clean", glare.id, glare.millimetres, 100 * parts.voxels,
      100 * parts.leaves);
  return parts;
}

TEST(SaturatedDepth, FreesNoSolidInTheRoom) {
  DepthLosses losses;
  const FreeParts none = MapGlare({kCouch, 0, true}, {}, &losses);
  EXPECT_LE(none.leaves, kMostFree);
  for (const uint16_t millimetres : {uint16_t{8000}, uint16_t{12000}}) {
    const FreeParts parts = MapGlare({kCouch, millimetres, true}, {}, &losses);
    EXPECT_GT(losses.saturated + losses.too_far, losses.pixels / 200);
    EXPECT_EQ(millimetres == 8000 ? losses.too_far : losses.saturated, 0);
    EXPECT_EQ(parts.voxels, none.voxels);
    EXPECT_EQ(parts.leaves, none.leaves);
  }
  EXPECT_LE(MapGlare({kCabinet, 8000, true}, {}, &losses).leaves, kMostFree);
  EXPECT_LE(MapGlare({kCouch, 8000, false}, {}, &losses).leaves, kMostFree);
}

TEST(SaturatedDepth, FreesSolidsWhenItIsKept) {
  SegmentationStageOptions stage;
  stage.surface.drop_saturated = false;
  DepthLosses losses;
  EXPECT_GT(MapGlare({kCabinet, 8000, true}, stage, &losses).leaves, 0.5);
  EXPECT_EQ(losses.saturated, 0);
}

TEST(SaturatedDepth, NothingIsTakenForItInFramesWithoutIt) {
  for (const char* name : {"synthetic:room?frames=40", "synthetic:room?frames=40&noise=none",
                           "synthetic:office?frames=100&width=320",
                           "synthetic:office?frames=100&width=320&noise=none"}) {
    const auto dataset = OpenSequence(name, "", {});
    ASSERT_TRUE(dataset);
    DepthLosses losses;
    for (size_t i = 0; i < (*dataset)->size(); ++i) {
      SensorFrame frame = *(*dataset)->Read(i);
      losses.Add(DropSaturatedDepth({}, &frame));
    }
    std::printf("%s: %.4f %% of the pixels\n", name,
                100 * static_cast<double>(losses.saturated) / static_cast<double>(losses.pixels));
    EXPECT_LT(losses.saturated, losses.pixels / 10000) << name;
  }
}

/// The ids of the objects in a frame of a SceneNN folder.
Image<uint16_t> RecordedIds(const std::string& folder, const FrameHeader& header) {
  char name[64];
  std::snprintf(name, sizeof(name), "/mask/mask_image%05d.png",
                static_cast<int>(header.frame_number));
  const auto ids = ReadPng16(folder + name, header.camera.width, header.camera.height);
  if (!ids) throw std::runtime_error(ids.error().message);
  return *ids;
}

TEST(SaturatedDepth, FreesNoSolidInARecordedScene) {
  const auto path = testing_support::RecordedSequence("scenes/101");
  if (!path) GTEST_SKIP() << "VISMAP_DATA is not set, or has no scenes/101";
  constexpr uint32_t kShelf = 19;
  const auto original = OpenSequence(*path, "", {});
  const auto truth = ReadSceneNnTruth(*path);
  ASSERT_TRUE(original && truth);
  std::vector<Eigen::Vector3f> points;
  for (size_t i = 0; i < truth->points_W.size(); ++i) {
    if (truth->labels[i] == kShelf) points.push_back(truth->points_W[i]);
  }
  for (const uint16_t millimetres : {uint16_t{8000}, uint16_t{12000}}) {
    const ChangedDataset changed(**original, [&](SensorFrame* frame) {
      const Image<uint16_t> ids = RecordedIds(*path, frame->header);
      for (size_t pixel = 0; pixel < ids.size(); ++pixel) {
        if (ids.data()[pixel] == kShelf) frame->depth.data()[pixel] = millimetres;
      }
    });
    MapSession session({}, {});
    const MappedSequence done = MapFrames(changed, {}, SIZE_MAX, &session);
    const FreeParts parts = FreePartsOf(session.map(), points);
    std::printf("shelf at %d mm: %.2f %% of its surface is free in voxels, %.2f %% in leaves\n",
                millimetres, 100 * parts.voxels, 100 * parts.leaves);
    EXPECT_GT(done.depth_losses.saturated + done.depth_losses.too_far,
              done.depth_losses.pixels / 50);
    EXPECT_LE(parts.leaves, kMostFree);
  }
}

}  // namespace
}  // namespace vismap
