#include "wire/segmented_frame.h"

#include <string>
#include <utility>
#include <vector>

#include "base/digest.h"
#include "codecs/frame_codec.h"
#include "codecs/label_codec.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

frame_segment_t EncodeSegment(const FrameSegment& segment) {
  frame_segment_t message{};
  message.pixels = segment.pixels;
  message.detection = Raw(segment.detection);
  message.class_id = Raw(segment.class_id);
  message.score = segment.score;
  message.overlap = segment.overlap;
  return message;
}

Result<FrameSegment> DecodeSegment(const frame_segment_t& message) {
  const auto fraction = [](float value) { return value >= 0 && value <= 1; };
  if (message.detection < -1) return Fail("the index of a detection is below -1");
  if (message.class_id < 0 || message.class_id > 65535) {
    return Fail("class_id is " + std::to_string(message.class_id) + ", expected [0, 65535]");
  }
  if (!fraction(message.score) || !fraction(message.overlap))
    return Fail("score or overlap is outside [0, 1]");
  return FrameSegment{message.pixels, DetectionIndex{message.detection},
                      static_cast<ClassId>(message.class_id), message.score, message.overlap};
}

std::vector<int32_t> CountPixels(const SegmentImage& image) {
  std::vector<int32_t> counts(static_cast<size_t>(image.segment_count));
  for (const SegmentIndex index : image.index.pixels()) {
    if (index != SegmentIndex::kNone) ++counts[static_cast<size_t>(Raw(index))];
  }
  return counts;
}

Result<std::vector<FrameSegment>> DecodeSegments(const segmented_frame_t& message,
                                                 const SegmentImage& image) {
  const std::vector<int32_t> counts = CountPixels(image);
  std::vector<FrameSegment> segments;
  segments.reserve(message.segments.size());
  for (const frame_segment_t& element : message.segments) {
    const size_t i = segments.size();
    const Result<FrameSegment> segment = DecodeSegment(element);
    if (!segment) return Fail("segment " + std::to_string(i) + ": " + segment.error().message);
    if (segment->pixels != counts[i]) {
      return Fail("segment " + std::to_string(i) + " lists " + std::to_string(segment->pixels) +
                  " pixels, but the label image has " + std::to_string(counts[i]));
    }
    segments.push_back(*segment);
  }
  return segments;
}

Result<SegmentImage> DecodeLabels(const segmented_frame_t& message) {
  if (message.label_encoding != segmented_frame_t::LABELS_RLE_ZSTD) {
    return Fail("label_encoding " + std::to_string(message.label_encoding) + " is unknown");
  }
  const camera_t& camera = CameraOf(message.frame);
  Result<SegmentImage> image = DecodeSegmentImage(message.labels, camera.width, camera.height);
  if (image && image->segment_count != message.n_segments) {
    return Fail("the label image has " + std::to_string(image->segment_count) + " segments, but " +
                std::to_string(message.n_segments) + " are listed");
  }
  return image;
}

}  // namespace

segmented_frame_t Encode(const SegmentedFrame& frame, const rgbd_frame_t& sensor) {
  segmented_frame_t message{};
  message.utime = sensor.utime;
  message.frame = sensor;
  message.had_detections = frame.had_detections ? 1 : 0;
  for (const FrameSegment& segment : frame.segments)
    message.segments.push_back(EncodeSegment(segment));
  message.n_segments = static_cast<int32_t>(message.segments.size());
  message.label_encoding = segmented_frame_t::LABELS_RLE_ZSTD;
  message.labels = EncodeSegmentImage(frame.image);
  message.label_size = static_cast<int32_t>(message.labels.size());
  return message;
}

Result<SegmentedFrame> Decode(const segmented_frame_t& message) {
  const std::string where = "segmented_frame_t of utime " + std::to_string(message.utime) + ": ";
  if (message.utime != message.frame.utime)
    return Fail(where + "the utime of its frame is different");
  const Result<SensorFrame> sensor = Decode(message.frame);
  if (!sensor) return Fail(where + sensor.error().message);
  Result<RgbdFrame> frame = DecodeFrame(*sensor);
  if (!frame) return Fail(where + frame.error().message);
  Result<SegmentImage> image = DecodeLabels(message);
  if (!image) return Fail(where + image.error().message);
  Result<std::vector<FrameSegment>> segments = DecodeSegments(message, *image);
  if (!segments) return Fail(where + segments.error().message);
  return SegmentedFrame{std::move(*frame), std::move(*image), std::move(*segments),
                        message.had_detections != 0};
}

std::string DigestInput(const segmented_frame_t& message) {
  const rgbd_frame_t& frame = message.frame;
  Digest digest;
  const auto add_bytes = [&](const std::vector<uint8_t>& bytes) {
    digest.Add(bytes.size());
    digest.AddBytes(bytes.data(), bytes.size());
  };
  const camera_t& camera = CameraOf(frame);
  for (const int64_t number : {frame.utime, int64_t{frame.camera_id}, int64_t{camera.width},
                               int64_t{camera.height}, int64_t{message.had_detections}})
    digest.Add(number);
  for (const double number : {camera.fx, camera.fy, camera.cx, camera.cy, frame.depth_unit_m})
    digest.Add(number);
  digest.AddBytes(frame.T_W_C, sizeof(frame.T_W_C));
  // The first version of rgbd_frame_t had these encodings only.
  const bool first_encodings = frame.depth_encoding == rgbd_frame_t::DEPTH_ZSTD_DELTA &&
                               frame.color_encoding <= rgbd_frame_t::COLOR_JPEG;
  if (!first_encodings) digest.Add(256 * frame.depth_encoding + frame.color_encoding);
  add_bytes(frame.depth);
  add_bytes(frame.color);
  add_bytes(message.labels);
  for (const frame_segment_t& segment : message.segments) {
    digest.Add(segment.detection);
    digest.Add(segment.class_id);
    digest.Add(segment.score);
    digest.Add(segment.overlap);
  }
  return digest.Hex();
}

}  // namespace vismap
