// Rectifying the frames of a RealSense-like sensor, with OpenCV's remap as the baseline. The number
// of threads is the argument.
#include <benchmark/benchmark.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "codecs/color_codec.h"
#include "codecs/frame_codec.h"
#include "rectify/rectified_camera.h"
#include "rectify/rectifier.h"
#include "rectify/rectify_color.h"
#include "rectify/rectify_depth.h"
#include "simulation/realsense.h"
#include "simulation/synthetic_dataset.h"

namespace vismap {
namespace {

const SensorFrame& Frame() {
  static const SensorFrame frame =
      *MakeSyntheticDataset(*ParseSyntheticPath("synthetic:room?camera=realsense&frames=4"), {})
           ->Read(1);
  return frame;
}

void Depth(benchmark::State& state) {
  const ThreadLimit threads(static_cast<int>(state.range(0)));
  const FrameOptics optics = RealSenseOptics();
  const DepthTable table =
      MakeDepthTable(optics.depth, optics.T_color_depth, RectifiedCamera(optics, true));
  const Image<float> depth = DepthInMetres(Frame());
  for (auto _ : state) benchmark::DoNotOptimize(RectifyDepth(depth, table));
}
BENCHMARK(Depth)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

// With the view of depth at its full size, 848x480.
void DepthOfFullView(benchmark::State& state) {
  const ThreadLimit threads(static_cast<int>(state.range(0)));
  const FrameOptics optics = RealSenseOptics();
  const DepthTable table = MakeDepthTable(optics.depth, optics.T_color_depth, optics.depth.pinhole);
  const Image<float> depth = DepthInMetres(Frame());
  for (auto _ : state) benchmark::DoNotOptimize(RectifyDepth(depth, table));
}
BENCHMARK(DepthOfFullView)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void Color(benchmark::State& state) {
  const ThreadLimit threads(static_cast<int>(state.range(0)));
  const FrameOptics optics = RealSenseOptics();
  const ColorTable table = MakeColorTable(optics.color, RectifiedCamera(optics, true));
  const Image<Rgb8> color = *DecodeJpeg(Frame().color);
  for (auto _ : state) benchmark::DoNotOptimize(RectifyColor(color, table));
}
BENCHMARK(Color)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

// All that a frame needs: also its JPEG decoded and encoded again.
void WholeFrame(benchmark::State& state) {
  const ThreadLimit threads(static_cast<int>(state.range(0)));
  Rectifier rectifier;
  for (auto _ : state) benchmark::DoNotOptimize(rectifier.Rectify(Frame()));
}
BENCHMARK(WholeFrame)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

// OpenCV's remap to the same size: it undistorts, but cannot register depth.
void OpenCvRemap(benchmark::State& state) {
  cv::setNumThreads(static_cast<int>(state.range(0)));
  const FrameOptics optics = RealSenseOptics();
  const PinholeCamera to = RectifiedCamera(optics, true);
  const ColorTable table = MakeColorTable(optics.color, to);
  cv::Mat map(to.height, to.width, CV_32FC2), fixed, weights;
  for (int v = 0; v < to.height; ++v) {
    for (int u = 0; u < to.width; ++u) {
      const ColorSource source = table.sources(v, u);
      const float scale = static_cast<float>(1 << table.halvings) / 256;
      map.at<cv::Vec2f>(v, u) = {static_cast<float>(source.x) * scale,
                                 static_cast<float>(source.y) * scale};
    }
  }
  cv::convertMaps(map, cv::noArray(), fixed, weights, CV_16SC2);
  Image<Rgb8> color = *DecodeJpeg(Frame().color);
  Image<float> depth = DepthInMetres(Frame());
  const cv::Mat color_in(color.height(), color.width(), CV_8UC3, color.data());
  const cv::Mat depth_in(depth.height(), depth.width(), CV_32FC1, depth.data());
  cv::Mat color_out, depth_out;
  for (auto _ : state) {
    cv::remap(color_in, color_out, fixed, weights, cv::INTER_LINEAR);
    cv::remap(depth_in, depth_out, fixed, weights, cv::INTER_NEAREST);
  }
}
BENCHMARK(OpenCvRemap)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace vismap

BENCHMARK_MAIN();
