#include "viewer/segment_picture.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/class_names.h"
#include "codecs/color_codec.h"
#include "viewer/page_messages.h"

namespace vismap {
namespace {

constexpr int kMostColumns = 320;  // of the sampled segments
constexpr int kRecordedQuality = 75;
constexpr size_t kMostListed = 4096;  // segments
using SegmentsJson = nlohmann::ordered_json;

// [value, length, value, length, ...] row by row over every step-th pixel.
SegmentsJson RunsOf(const SegmentImage& image, int step, int width, int height) {
  SegmentsJson runs = SegmentsJson::array();
  int32_t value = 0;
  int64_t length = 0;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const auto at = static_cast<int32_t>(image.index(v * step, u * step));
      if (length > 0 && at != value) {
        runs.push_back(value);
        runs.push_back(length);
        length = 0;
      }
      value = at;
      ++length;
    }
  }
  if (length > 0) {
    runs.push_back(value);
    runs.push_back(length);
  }
  return runs;
}

SegmentsJson SegmentsOf(const SegmentImage& image, std::span<const FrameSegment> segments,
                        int full_width, int full_height) {
  const int step = std::max(1, (full_width + kMostColumns - 1) / kMostColumns);
  const int width = (full_width + step - 1) / step, height = (full_height + step - 1) / step;
  SegmentsJson json{{"width", width},
                    {"height", height},
                    {"runs", RunsOf(image, step, width, height)},
                    {"list", SegmentsJson::array()}};
  for (const FrameSegment& segment : segments.first(std::min(segments.size(), kMostListed))) {
    json["list"].push_back({{"pixels", segment.pixels},
                            {"class_id", Raw(segment.class_id)},
                            {"class_name", ClassName(segment.class_id)},
                            {"score", segment.score},
                            {"overlap", segment.overlap},
                            {"detection", static_cast<int32_t>(segment.detection)}});
  }
  return json;
}

}  // namespace

std::string PictureText(int camera_id, int64_t utime, int width, int height,
                        const SegmentImage* image, std::span<const FrameSegment> segments,
                        const std::string& problem) {
  SegmentsJson json{
      {"camera_id", camera_id}, {"utime", utime}, {"width", width}, {"height", height}};
  if (image != nullptr) json["segments"] = SegmentsOf(*image, segments, width, height);
  if (!problem.empty()) json["problem"] = problem;
  return json.dump(-1, ' ', false, SegmentsJson::error_handler_t::replace);
}

std::vector<uint8_t> MakePicture(const SegmentedFrame& frame) {
  const FrameHeader& header = frame.frame.header;
  const bool colored = !frame.frame.color.empty();
  const int camera_id = Raw(header.camera_id);
  return EncodePicture(
      camera_id,
      PictureText(camera_id, header.utime, header.camera.width, header.camera.height, &frame.image,
                  frame.segments, colored ? "" : "the frame has no colour"),
      colored ? EncodeJpeg(frame.frame.color, kRecordedQuality) : std::vector<uint8_t>());
}

}  // namespace vismap
