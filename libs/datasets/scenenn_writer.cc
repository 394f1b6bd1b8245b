#include "datasets/scenenn_writer.h"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <system_error>

#include "base/file.h"
#include "codecs/mask_codec.h"

namespace vismap {
namespace {

template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[512];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

std::string PoseText(int64_t index, const Pose& pose) {
  const long long i = index;
  std::string text = Format("%lld %lld %lld\n", i, i, i + 1);
  for (int row = 0; row < 4; ++row) {
    text += Format("%.17g %.17g %.17g %.17g\n", pose.matrix()(row, 0), pose.matrix()(row, 1),
                   pose.matrix()(row, 2), pose.matrix()(row, 3));
  }
  return text;
}

}  // namespace

struct SceneNnWriter::Results {
  nlohmann::json json = nlohmann::json::array();
};

SceneNnWriter::SceneNnWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}
SceneNnWriter::~SceneNnWriter() = default;

void SceneNnWriter::Write(const std::filesystem::path& name, std::span<const uint8_t> bytes) {
  if (!status_) return;
  std::error_code error;
  std::filesystem::create_directories((folder_ / name).parent_path(), error);
  status_ = WriteFileAtomically(folder_ / name, bytes);
}

void SceneNnWriter::Write(const std::filesystem::path& name, const std::string& text) {
  Write(name, {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

void SceneNnWriter::AddFrame(const FrameHeader& header, const Image<uint16_t>& depth,
                             const ColorFile& color) {
  const long long number = header.frame_number;
  Write(Format("image/image%05lld%s", number, color.suffix), color.bytes);
  Write(Format("depth/depth%05lld.png", number), EncodePng16(depth));
  trajectory_ += PoseText(number - 1, header.T_W_C);
  times_ += Format("%lld %lld\n", number, static_cast<long long>(header.utime));
}

void SceneNnWriter::AddDetections(const DetectionSet& set) {
  if (!results_) results_ = std::make_unique<Results>();
  for (const Detection& detection : set.detections) {
    const Mask& mask = detection.mask;
    results_->json.push_back(
        {{"image_id", set.frame_number},
         {"category_id", Raw(detection.class_id)},
         {"score", detection.score},
         {"bbox", {mask.u0, mask.v0, mask.inside.width(), mask.inside.height()}},
         {"segmentation",
          {{"size", {mask.image_height, mask.image_width}},
           {"counts", RunsToString(EncodeMask(mask))}}}});
  }
}

Result<void> SceneNnWriter::Finish() {
  Write("trajectory.log", trajectory_);
  Write("timestamp.txt", times_);
  if (results_) Write("detections.json", results_->json.dump());
  return status_;
}

std::string SceneNnIni(const PinholeCamera& camera, double rate, double depth_unit_m) {
  const std::string unit =
      depth_unit_m == 0.001 ? "" : Format("depth_unit_m %.17g\n", depth_unit_m);
  return Format(
             "depth_width %d\ndepth_height %d\ndepth_fps %.17g\nfx %.17g\nfy %.17g\ncx %.17g\n"
             "cy %.17g\n",
             camera.width, camera.height, rate, camera.fx, camera.fy, camera.cx, camera.cy) +
         unit;
}

std::vector<uint8_t> EncodePng16(const Image<uint16_t>& image) {
  std::vector<uint8_t> bytes;
  cv::imencode(
      ".png", cv::Mat(image.height(), image.width(), CV_16UC1, const_cast<uint16_t*>(image.data())),
      bytes);
  return bytes;
}

}  // namespace vismap
