// Every sensor preset on depth with that sensor's noise: planes stay whole from 1 to 4 m, and
// objects stay apart.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>

#include "config/config.h"
#include "geometry/compute_surface.h"
#include "segmentation/segment_depth.h"
#include "simulation/builder.h"
#include "simulation/camera_path.h"
#include "simulation/simulate.h"

namespace vismap {
namespace {

/// The errors of an Intel RealSense D400.
DepthNoise RealSenseDepthNoise() {
  DepthNoise noise;
  noise.axial = RealSenseNoise();
  noise.baseline = 0.05;
  noise.disparity_step = 1.0 / 32;
  noise.correlation = 3;
  noise.min_depth = 0.2;
  return noise;
}

/// The errors of a renderer that keeps whole millimetres.
DepthNoise CleanDepthNoise() {
  DepthNoise noise;
  noise.axial = CleanNoise();
  noise.disparity_step = 0;
  noise.correlation = 1;
  noise.edge_dropout = 0;
  noise.grazing_cosine = 0;
  noise.min_depth = 0;
  return noise;
}

struct Sensor {
  std::string name;
  std::string config;  ///< text of the preset for this sensor
  DepthNoise noise;
};

SegmentationStageOptions StageOf(const Sensor& sensor) {
  const auto config = ParseConfig(sensor.config, sensor.name);
  if (!config) throw std::runtime_error(config.error().message);
  return *config;
}

std::string TextOf(const std::string& preset) {
  std::ifstream file(std::string(VISMAP_SOURCE_DIR) + "/config/" + preset);
  return {std::istreambuf_iterator<char>(file), {}};
}

void PrintTo(const Sensor& sensor, std::ostream* out) { *out << sensor.name; }

constexpr uint16_t kFloor = 1, kWall = 2, kLeftBox = 3, kRightBox = 4, kBall = 5;

/// A floor, a wall at distance z, and three things well before it, the larger the farther.
Scene ThingsBeforeAWall(double z) {
  Scene scene{"wall", {}};
  Furniture things(&scene.objects);
  const auto put = [&](const char* name, const Eigen::Vector3d& center,
                       const Eigen::Vector3d& half) {
    things.Put(Builder(things.Unknown(name, {}), {}).Box(center, half));
  };
  const double before = 0.7 * z;
  put("floor", {0, 0, -0.1}, {9, 9, 0.1});
  put("wall", {0, z + 0.1, 2}, {9, 0.1, 2});
  put("left box", {-0.22 * z, before, 0.1 * z}, {0.06 * z, 0.05 * z, 0.1 * z});
  put("right box", {0.22 * z, before, 0.08 * z}, {0.06 * z, 0.05 * z, 0.08 * z});
  things.Put(Builder(things.Unknown("ball", {}), {})
                 .Ellipsoid({0, before, 0.09 * z}, {0.08 * z, 0.08 * z, 0.08 * z}));
  return scene;
}

/// Overlap of each object with the segment that has most of it: shared / all pixels with depth.
std::map<uint16_t, double> BestIous(const Image<uint16_t>& ids, const Image<float>& depth,
                                    const SegmentImage& segments) {
  std::map<uint16_t, std::map<SegmentIndex, double>> shared;
  std::map<SegmentIndex, double> sizes;
  std::map<uint16_t, double> areas;
  for (size_t i = 0; i < ids.size(); ++i) {
    const SegmentIndex segment = segments.index.data()[i];
    if (!(depth.data()[i] > 0)) continue;
    ++areas[ids.data()[i]];
    ++sizes[segment];
    if (segment != SegmentIndex::kNone) ++shared[ids.data()[i]][segment];
  }
  std::map<uint16_t, double> best;
  for (const auto& [id, counts] : shared) {
    for (const auto& [segment, count] : counts)
      best[id] = std::max(best[id], count / (areas[id] + sizes[segment] - count));
  }
  return best;
}

class SensorPreset : public ::testing::TestWithParam<Sensor> {};

TEST_P(SensorPreset, KeepsPlanesWholeAndThingsApartFromOneToFourMetres) {
  const Sensor& sensor = GetParam();
  const SegmentationStageOptions options = StageOf(sensor);
  for (const int width : {640, 320}) {
    const double f = 525.0 * width / 640;
    const PinholeCamera camera{width, width * 3 / 4,     f,
                               f,     0.5 * (width - 1), 0.5 * (width * 3 / 4 - 1)};
    for (const double z : {1.0, 2.0, 3.0, 4.0}) {
      const Scene scene = ThingsBeforeAWall(z);
      const Pose T_W_C = LookAt({0, 0, 0.3 + 0.3 * z}, {0, 0.75 * z, 0.1 * z});
      const Rendering view = Render(scene, camera, T_W_C);
      for (const uint64_t frame : {1u, 2u, 3u, 4u}) {
        const Image<float> depth = AddDepthNoise(view.depth, camera, sensor.noise, frame);
        const SegmentImage segments = SegmentDepth(ComputeSurface(depth, camera, options.surface),
                                                   camera, options.segmentation);
        auto ious = BestIous(view.object_ids, depth, segments);
        const std::string where = sensor.name + ", " + std::to_string(width) + " px, " +
                                  std::to_string(z) + " m, " +
                                  std::to_string(segments.segment_count) + " segments";
        EXPECT_GT(ious[kWall], 0.9) << where;
        EXPECT_GT(ious[kFloor], 0.9) << where;
        for (const uint16_t id : {kLeftBox, kRightBox, kBall})
          EXPECT_GT(ious[id], 0.7) << where << " " << id;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, SensorPreset,
    ::testing::Values(Sensor{"kinect", TextOf("default.txtpb"), DepthNoise()},
                      Sensor{"realsense", TextOf("realsense.txtpb"), RealSenseDepthNoise()},
                      Sensor{"clean", "surface { sensor: CLEAN }", CleanDepthNoise()}),
    [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace vismap
