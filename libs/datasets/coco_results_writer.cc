#include <nlohmann/json.hpp>

#include "base/file.h"
#include "codecs/mask_codec.h"
#include "datasets/detections_file.h"

namespace vismap {
namespace {

nlohmann::ordered_json EntryOf(int64_t frame_number, const Detection& detection) {
  const Mask& mask = detection.mask;
  nlohmann::ordered_json entry;
  entry["image_id"] = frame_number;
  entry["category_id"] = Raw(detection.class_id);
  entry["score"] = detection.score;
  entry["bbox"] = {mask.u0, mask.v0, mask.inside.width(), mask.inside.height()};
  entry["segmentation"] = {{"size", {mask.image_height, mask.image_width}},
                           {"counts", RunsToString(EncodeMask(mask))}};
  return entry;
}

}  // namespace

Result<void> WriteCocoResults(const std::string& path, std::span<const DetectionSet> frames) {
  std::string text = "[";
  for (const DetectionSet& set : frames) {
    if (set.frame_number < 0 && !set.detections.empty())
      return Fail(path +
                  ": expected frames with a frame_number, by which detections are found again, but "
                  "one frame has none");
    for (const Detection& detection : set.detections) {
      if (detection.class_id == ClassId::kUnknown)
        return Fail(path + ": expected detections with a class, but frame " +
                    std::to_string(set.frame_number) + " has a detection of unknown class");
      text += (text.size() > 1 ? ",\n" : "\n") + EntryOf(set.frame_number, detection).dump();
    }
  }
  return WriteFileAtomically(path, text + "\n]\n");
}

}  // namespace vismap
