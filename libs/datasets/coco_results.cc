#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "codecs/mask_codec.h"
#include "datasets/detections_file.h"
#include "datasets/text_file.h"

namespace vismap {
namespace {

using Json = nlohmann::json;

constexpr uint64_t kMaxFileBytes = uint64_t{1} << 29;

/// A detection of the file. Its mask stays run-length encoded, which needs far less memory.
struct Entry {
  ClassId class_id = ClassId::kUnknown;
  float score = 0;
  int width = 0;
  int height = 0;
  MaskRuns runs;
};

class CocoResults : public DetectionSource {
 public:
  CocoResults(std::string path, std::map<int64_t, std::vector<Entry>> frames)
      : path_(std::move(path)), frames_(std::move(frames)) {}

  Result<DetectionSet> ForFrame(const FrameHeader& header) const override {
    DetectionSet set{header.utime, header.camera_id, header.frame_number, {}};
    const auto found = frames_.find(header.frame_number);
    if (found == frames_.end()) return set;
    for (const Entry& entry : found->second) {
      if (entry.width != header.camera.width || entry.height != header.camera.height) {
        return Fail(path_ + ": image " + std::to_string(header.frame_number) +
                    ": expected masks of the size of the frame, " +
                    std::to_string(header.camera.width) + "x" +
                    std::to_string(header.camera.height) + ", found masks of " +
                    std::to_string(entry.width) + "x" + std::to_string(entry.height));
      }
      Result<Mask> mask = DecodeMask(entry.runs, entry.width, entry.height);
      if (!mask) return Fail(path_ + ": " + mask.error().message);
      set.detections.push_back({entry.class_id, entry.score, std::move(*mask)});
    }
    return set;
  }

  int64_t size() const override {
    int64_t count = 0;
    for (const auto& [number, entries] : frames_) count += static_cast<int64_t>(entries.size());
    return count;
  }
  std::optional<std::pair<int64_t, int64_t>> frame_numbers() const override {
    if (frames_.empty()) return std::nullopt;
    return std::pair(frames_.begin()->first, frames_.rbegin()->first);
  }

 private:
  std::string path_;
  std::map<int64_t, std::vector<Entry>> frames_;
};

/// The start of a JSON value, for error messages.
std::string ShortText(const Json& value) { return DescribeJson(value); }

/// The value of a key, for error messages.
std::string ShortText(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? "no such key" : ShortText(*found);
}

Result<int64_t> IntegerAt(const Json& object, const char* key, int64_t low, int64_t high) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_integer()) {
    return Fail(std::string(key) + ": expected an integer, found " + ShortText(object, key));
  }
  const bool above =
      found->is_number_unsigned() && found->get<uint64_t>() > static_cast<uint64_t>(high);
  if (above || found->get<int64_t>() < low || found->get<int64_t>() > high) {
    return Fail(std::string(key) + " is " + DescribeJson(*found) + "; expected " +
                std::to_string(low) + ".." + std::to_string(high));
  }
  return found->get<int64_t>();
}

Result<float> ScoreOf(const Json& object) {
  const auto found = object.find("score");
  if (found == object.end() || !found->is_number())
    return Fail("score: expected a number, found " + ShortText(object, "score"));
  const double score = found->get<double>();
  if (!(score >= 0 && score <= 1))
    return Fail("score is " + DescribeJson(*found) + "; expected [0, 1]");
  return static_cast<float>(score);
}

Result<MaskRuns> RunsOf(const Json& counts) {
  if (counts.is_string()) return RunsFromString(counts.get_ref<const std::string&>());
  if (!counts.is_array())
    return Fail("counts: expected a string or an array of integers, found " + ShortText(counts));
  MaskRuns runs;
  for (const Json& run : counts) {
    if (!run.is_number_unsigned() || run.get<uint64_t>() > UINT32_MAX) {
      return Fail("counts: expected run lengths, found " + DescribeJson(run));
    }
    runs.push_back(run.get<uint32_t>());
  }
  return runs;
}

Result<void> ReadSegmentation(const Json& object, Entry* entry) {
  const auto segmentation = object.find("segmentation");
  if (segmentation == object.end() || !segmentation->is_object()) {
    return Fail("segmentation: expected an object {\"size\", \"counts\"}, found " +
                ShortText(object, "segmentation"));
  }
  const auto size = segmentation->find("size");
  const auto counts = segmentation->find("counts");
  if (size == segmentation->end() || !size->is_array() || size->size() != 2) {
    return Fail("segmentation size: expected [height, width], found " +
                ShortText(*segmentation, "size"));
  }
  for (const Json& side : *size) {
    if (!side.is_number_unsigned() || side.get<uint64_t>() < 1 || side.get<uint64_t>() > 16384) {
      return Fail("segmentation size: expected 1..16384, found " + DescribeJson(side));
    }
  }
  entry->height = (*size)[0].get<int>();
  entry->width = (*size)[1].get<int>();
  if (counts == segmentation->end())
    return Fail("segmentation: expected the key \"counts\", found no such key");
  Result<MaskRuns> runs = RunsOf(*counts);
  if (!runs) return Fail(runs.error().message);
  entry->runs = std::move(*runs);
  const Result<Mask> mask = DecodeMask(entry->runs, entry->width, entry->height);
  if (!mask) return Fail(mask.error().message);
  return {};
}

Result<std::pair<int64_t, Entry>> ParseEntry(const Json& object) {
  if (!object.is_object()) return Fail("expected an object, found " + ShortText(object));
  const Result<int64_t> image_id = IntegerAt(object, "image_id", 0, INT64_MAX);
  if (!image_id) return Fail(image_id.error().message);
  const Result<int64_t> category = IntegerAt(object, "category_id", 1, UINT16_MAX);
  if (!category) return Fail(category.error().message);
  const Result<float> score = ScoreOf(object);
  if (!score) return Fail(score.error().message);
  Entry entry{.class_id = static_cast<ClassId>(*category), .score = *score, .runs = {}};
  if (const auto read = ReadSegmentation(object, &entry); !read) return Fail(read.error().message);
  return std::pair(*image_id, std::move(entry));
}

}  // namespace

Result<std::unique_ptr<DetectionSource>> LoadCocoResults(const std::string& path) {
  const Result<std::string> text = ReadTextFile(path, kMaxFileBytes);
  if (!text) return Fail(text.error().message);
  const Result<Json> parsed = ParseJson(*text);
  if (!parsed) return Fail(path + ": " + parsed.error().message);
  const Json& root = *parsed;
  if (!root.is_array()) return Fail(path + ": expected a JSON array of COCO results");
  std::map<int64_t, std::vector<Entry>> frames;
  for (size_t i = 0; i < root.size(); ++i) {
    Result<std::pair<int64_t, Entry>> entry = ParseEntry(root[i]);
    if (!entry) {
      return Fail(path + ": entry " + std::to_string(i) + ": " + entry.error().message);
    }
    frames[entry->first].push_back(std::move(entry->second));
  }
  return std::make_unique<CocoResults>(path, std::move(frames));
}

}  // namespace vismap
