#include "wire/detections.h"

#include <string>
#include <utility>

#include "base/require.h"
#include "codecs/mask_codec.h"

namespace vismap {
namespace {

detection_t EncodeDetection(const Detection& detection) {
  const MaskRuns runs = EncodeMask(detection.mask);
  detection_t message{};
  message.class_id = Raw(detection.class_id);
  message.score = detection.score;
  message.runs.assign(runs.begin(), runs.end());
  message.n_runs = static_cast<int32_t>(message.runs.size());
  return message;
}

Result<Detection> DecodeDetection(const detection_t& message, int width, int height) {
  if (message.class_id < 0 || message.class_id > 65535) {
    return Fail("class_id is " + std::to_string(message.class_id) + ", expected [0, 65535]");
  }
  if (!(message.score >= 0 && message.score <= 1)) {
    return Fail("score is " + std::to_string(message.score) + ", expected [0, 1]");
  }
  MaskRuns runs;
  runs.reserve(message.runs.size());
  for (const int32_t run : message.runs) {
    if (run < 0) return Fail("a run of the mask is negative");
    runs.push_back(static_cast<uint32_t>(run));
  }
  Result<Mask> mask = DecodeMask(runs, width, height);
  if (!mask) return tl::unexpected(mask.error());
  return Detection{static_cast<ClassId>(message.class_id), message.score, std::move(*mask)};
}

}  // namespace

detections_t Encode(const DetectionSet& set, int image_width, int image_height) {
  detections_t message{};
  message.utime = set.utime;
  message.camera_id = Raw(set.camera_id);
  message.frame_number = set.frame_number;
  message.image_width = image_width;
  message.image_height = image_height;
  for (const Detection& detection : set.detections) {
    Require(
        detection.mask.image_width == image_width && detection.mask.image_height == image_height,
        "masks have the size of the image");
    message.detections.push_back(EncodeDetection(detection));
  }
  message.n_detections = static_cast<int32_t>(message.detections.size());
  return message;
}

detections_t EncodeDetectorDidNotRun(const FrameHeader& header) {
  detections_t message{};
  message.utime = header.utime;
  message.camera_id = Raw(header.camera_id);
  message.frame_number = header.frame_number;
  return message;
}

bool DetectorRan(const detections_t& message) {
  return message.image_width != 0 || message.image_height != 0 || message.n_detections != 0;
}

Result<DetectionSet> Decode(const detections_t& message) {
  const std::string where = "detections_t of camera " + std::to_string(message.camera_id) +
                            ", utime " + std::to_string(message.utime) + ": ";
  if (message.utime < 0) return Fail(where + "utime is negative");
  if (message.camera_id < 0) return Fail(where + "camera_id is negative");
  if (message.frame_number < -1) return Fail(where + "frame_number is below -1");
  const auto plausible = [](int32_t side) { return side >= 1 && side <= 16384; };
  if (!plausible(message.image_width) || !plausible(message.image_height)) {
    return Fail(where + "image is " + std::to_string(message.image_width) + "x" +
                std::to_string(message.image_height) + ", expected sides in [1, 16384]");
  }
  if (message.n_detections > kMaxDetections) {
    return Fail(where + std::to_string(message.n_detections) + " detections, at most " +
                std::to_string(kMaxDetections) + " are allowed");
  }
  DetectionSet set{message.utime, CameraId{message.camera_id}, message.frame_number, {}};
  size_t mask_pixels = 0;
  for (const detection_t& element : message.detections) {
    Result<Detection> detection =
        DecodeDetection(element, message.image_width, message.image_height);
    if (!detection) {
      return Fail(where + "detection " + std::to_string(set.detections.size()) + ": " +
                  detection.error().message);
    }
    mask_pixels += detection->mask.inside.size();
    if (mask_pixels > kMaxMaskPixels)
      return Fail(where + "the masks cover too many pixels together");
    set.detections.push_back(std::move(*detection));
  }
  return set;
}

}  // namespace vismap
