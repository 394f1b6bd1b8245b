// Measures the steps of the segmentation on one 640x480 frame with Kinect noise, and compares each
// with the published method, the naive reference (counter "speedup" = published time / ours).
#include <benchmark/benchmark.h>

#include <chrono>
#include <utility>

#include "base/parallel.h"
#include "geometry/compute_surface.h"
#include "segmentation/refine.h"
#include "segmentation/segment_depth.h"
#include "segmentation/segment_frame.h"
#include "support/analytic_depth.h"
#include "support/published_options.h"

namespace vismap {
namespace {

using testing_support::PublishedOptions;

/// A floor, two walls and forty balls and boards from 1 to 4 m.
Image<float> BenchDepth() {
  TestScene scene;
  scene.planes = {{Eigen::Vector3d(0, 0.94, 0.34), 1.3},
                  {Eigen::Vector3d(0, -0.34, 0.94), 3.6},
                  {Eigen::Vector3d(0.9, 0, 0.43), 2.6}};
  for (int i = 0; i < 40; ++i) {
    const double z = 1.2 + 0.06 * i;
    scene.spheres.push_back(
        {Eigen::Vector3d((i % 7 - 3) * 0.22 * z / 2, (i % 5 - 1) * 0.2, z), 0.06 + 0.01 * (i % 4)});
  }
  return AddNoise(Render(scene).depth, KinectNoise(), 3, 1);
}

/// Twelve masks spread over the image.
DetectionSet BenchDetections() {
  DetectionSet set;
  for (int i = 0; i < 12; ++i) {
    Detection detection{ClassId{62}, 0.7F + 0.02F * static_cast<float>(i), {}};
    detection.mask.image_width = kVga.width;
    detection.mask.image_height = kVga.height;
    detection.mask.u0 = 150 * (i % 4);
    detection.mask.v0 = 150 * (i / 4);
    detection.mask.inside = Image<uint8_t>(170, 160, uint8_t{1});
    set.detections.push_back(std::move(detection));
  }
  return set;
}

SegmentationStageOptions OptionsOf(const benchmark::State& state) {
  return state.range(0) == 0 ? SegmentationStageOptions{} : PublishedOptions();
}

/// range(0): 0 = ours, 1 = published.
void BM_Surface(benchmark::State& state) {
  const Image<float> depth = BenchDepth();
  const SegmentationStageOptions options = OptionsOf(state);
  for (auto _ : state) benchmark::DoNotOptimize(ComputeSurface(depth, kVga, options.surface));
}

void BM_Segment(benchmark::State& state) {
  const SegmentationStageOptions options = OptionsOf(state);
  const SurfaceMap surface = ComputeSurface(BenchDepth(), kVga, options.surface);
  for (auto _ : state) {
    benchmark::DoNotOptimize(SegmentDepth(surface, kVga, options.segmentation));
  }
}

void BM_Refine(benchmark::State& state) {
  const SegmentationStageOptions options = OptionsOf(state);
  RgbdFrame frame;
  frame.header.camera = kVga;
  frame.depth = BenchDepth();
  const SegmentImage image =
      SegmentDepth(ComputeSurface(frame.depth, kVga, options.surface), kVga, options.segmentation);
  const DetectionSet detections = BenchDetections();
  for (auto _ : state) {
    benchmark::DoNotOptimize(RefineWithDetections(frame, image, &detections, options.refine));
  }
}

void BM_Stage(benchmark::State& state) {
  const SegmentationStageOptions options = OptionsOf(state);
  const ThreadLimit limit(static_cast<int>(state.range(1)));
  RgbdFrame frame;
  frame.header.camera = kVga;
  frame.depth = BenchDepth();
  const DetectionSet detections = BenchDetections();
  for (auto _ : state) benchmark::DoNotOptimize(SegmentFrame(frame, &detections, options));
}

void BM_StageSpeedup(benchmark::State& state) {
  RgbdFrame frame;
  frame.header.camera = kVga;
  frame.depth = BenchDepth();
  const DetectionSet detections = BenchDetections();
  const auto seconds = [&](const SegmentationStageOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(SegmentFrame(frame, &detections, options));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  double ours = 0, published = 0;
  for (auto _ : state) {
    ours += seconds(SegmentationStageOptions{});
    published += seconds(PublishedOptions());
  }
  state.counters["speedup"] = published / ours;
}

BENCHMARK(BM_Surface)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_Segment)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_Refine)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_Stage)
    ->Args({0, 1})
    ->Args({0, 2})
    ->Args({1, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(BM_StageSpeedup)->Iterations(3)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace vismap

BENCHMARK_MAIN();
