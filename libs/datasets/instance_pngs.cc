#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "base/json_text.h"
#include "codecs/mask_codec.h"
#include "datasets/detections_file.h"
#include "datasets/image_file.h"
#include "datasets/text_file.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kAnyFrame = -1;

struct Instance {
  ClassId class_id = ClassId::kUnknown;  ///< kUnknown = the instance is not a detection
  float score = 1;
};

/// The instances by (frame_number or kAnyFrame, id in the PNG).
using InstanceTable = std::map<std::pair<int64_t, int64_t>, Instance>;

/// The instance of an id in a frame; null if the table has no row for it.
const Instance* Find(const InstanceTable& table, int64_t frame_number, int64_t id) {
  auto found = table.find({frame_number, id});
  if (found == table.end()) found = table.find({kAnyFrame, id});
  return found == table.end() ? nullptr : &found->second;
}

class InstancePngs : public DetectionSource {
 public:
  InstancePngs(std::string table_path, InstanceTable table, std::map<int64_t, fs::path> files)
      : table_path_(std::move(table_path)), table_(std::move(table)), files_(std::move(files)) {}

  Result<DetectionSet> ForFrame(const FrameHeader& header) const override {
    DetectionSet set{header.utime, header.camera_id, header.frame_number, {}};
    const auto file = files_.find(header.frame_number);
    if (file == files_.end()) return set;
    const Result<Image<uint16_t>> ids =
        ReadPng16(file->second, header.camera.width, header.camera.height);
    if (!ids) return Fail(ids.error().message);
    auto present = ids->pixels();
    std::sort(present.begin(), present.end());
    present.erase(std::unique(present.begin(), present.end()), present.end());
    for (const uint16_t id : present) {
      if (id == 0) continue;
      const Instance* instance = Find(table_, header.frame_number, id);
      if (instance == nullptr) {
        return Fail(file->second.string() + ": instance " + std::to_string(id) +
                    " is not in the table " + table_path_);
      }
      if (instance->class_id == ClassId::kUnknown) continue;
      set.detections.push_back({instance->class_id, instance->score, MaskOf(*ids, id)});
    }
    return set;
  }

  int64_t size() const override { return -1; }

 private:
  static Mask MaskOf(const Image<uint16_t>& ids, uint16_t id) {
    Image<uint8_t> inside(ids.width(), ids.height());
    std::transform(ids.pixels().begin(), ids.pixels().end(), inside.pixels().begin(),
                   [id](uint16_t pixel) { return static_cast<uint8_t>(pixel == id); });
    return MaskFromImage(inside);
  }

  std::string table_path_;
  InstanceTable table_;
  std::map<int64_t, fs::path> files_;
};

/// A row of either kind of table: numbers by name.
using Row = std::map<std::string, double, std::less<>>;

Result<void> AddRow(const Row& row, InstanceTable* table) {
  const auto value = [&](const char* key, double otherwise) {
    const auto found = row.find(key);
    return found == row.end() ? otherwise : found->second;
  };
  const auto whole = [](double x, double low, double high) {
    return x >= low && x <= high && x == static_cast<double>(static_cast<int64_t>(x));
  };
  const double id = value("id", -1), category = value("category_id", -1);
  const double score = value("score", 1);
  const double frame = value("image_id", static_cast<double>(kAnyFrame));
  const auto fail = [&](const std::string& expected, const char* key) {
    const auto found = row.find(key);
    return Fail("expected " + expected + ", found " +
                (found == row.end() ? "none" : std::to_string(found->second)));
  };
  if (!whole(id, 1, 65535)) return fail("an id in 1..65535", "id");
  if (!whole(category, 0, 65535)) return fail("a category_id in 0..65535", "category_id");
  if (!(score >= 0 && score <= 1)) return fail("a score in [0, 1]", "score");
  if (!whole(frame, -1, 1e15)) return fail("a frame number as image_id", "image_id");
  const std::pair key(static_cast<int64_t>(frame), static_cast<int64_t>(id));
  const Instance instance{static_cast<ClassId>(category), static_cast<float>(score)};
  if (!table->emplace(key, instance).second) {
    return Fail("expected one row per id and frame, found a second row for id " +
                std::to_string(key.second));
  }
  return {};
}

Result<InstanceTable> ParseCsv(const std::string& text) {
  const std::vector<TextLine> lines = SplitLines(text);
  InstanceTable table;
  for (size_t i = 1; i < lines.size(); ++i) {
    const std::string where = "line " + std::to_string(lines[i].number) + ": ";
    if (lines[i].words.size() != lines[0].words.size()) {
      return Fail(where + "expected " + std::to_string(lines[0].words.size()) + " columns, found " +
                  std::to_string(lines[i].words.size()));
    }
    Row row;
    for (size_t column = 0; column < lines[0].words.size(); ++column) {
      const auto number = ParseNumber(lines[i].words[column]);
      if (!number) {
        return Fail(where + "expected only numbers, found \"" +
                    std::string(lines[i].words[column].substr(0, 40)) + "\"");
      }
      row[std::string(lines[0].words[column])] = *number;
    }
    if (const auto added = AddRow(row, &table); !added) return Fail(where + added.error().message);
  }
  return table;
}

Result<InstanceTable> ParseJsonTable(const std::string& text) {
  const Result<nlohmann::json> parsed = ParseJson(text);
  if (!parsed) return tl::unexpected(parsed.error());
  const nlohmann::json& root = *parsed;
  if (!root.is_array()) return Fail("expected a JSON array of objects");
  InstanceTable table;
  for (size_t i = 0; i < root.size(); ++i) {
    const std::string where = "entry " + std::to_string(i) + ": ";
    if (!root[i].is_object())
      return Fail(where + "expected an object, found " + DescribeJson(root[i]));
    Row row;
    for (const auto& [key, value] : root[i].items()) {
      if (value.is_number()) row[key] = value.get<double>();
    }
    if (const auto added = AddRow(row, &table); !added) return Fail(where + added.error().message);
  }
  return table;
}

Result<InstanceTable> ReadTable(const fs::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error().message);
  Result<InstanceTable> table =
      path.extension() == ".json" ? ParseJsonTable(*text) : ParseCsv(*text);
  if (!table) return Fail(path.string() + ": " + table.error().message);
  return table;
}

/// The last number in a file name without extension.
std::optional<int64_t> LastNumber(const std::string& stem) {
  const size_t last = stem.find_last_of("0123456789");
  if (last == std::string::npos) return std::nullopt;
  const size_t before = stem.find_last_not_of("0123456789", last);
  const size_t first = before == std::string::npos ? 0 : before + 1;
  return ParseInteger(std::string_view(stem).substr(first, last + 1 - first));
}

Result<std::map<int64_t, fs::path>> ListPngs(const fs::path& folder) {
  std::map<int64_t, fs::path> files;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (entry->path().extension() != ".png") continue;
    const auto number = LastNumber(entry->path().stem().string());
    if (!number)
      return Fail(entry->path().string() +
                  ": expected a frame number in the file name, found none");
    if (!files.emplace(*number, entry->path()).second) {
      return Fail(folder.string() +
                  ": expected one PNG per frame number, but two PNGs have number " +
                  std::to_string(*number));
    }
  }
  if (error) return Fail(folder.string() + ": the folder cannot be listed: " + error.message());
  if (files.empty()) return Fail(folder.string() + ": expected PNG images, found no PNGs");
  return files;
}

}  // namespace

Result<std::unique_ptr<DetectionSource>> LoadInstancePngs(const std::string& folder,
                                                          const std::string& table_path) {
  fs::path path = table_path;
  if (table_path.empty()) {
    path = fs::path(folder) / "instances.csv";
    if (!fs::exists(path)) path = fs::path(folder) / "instances.json";
  }
  Result<std::map<int64_t, fs::path>> files = ListPngs(folder);
  if (!files) return Fail(files.error().message);
  Result<InstanceTable> table = ReadTable(path);
  if (!table) return Fail(table.error().message);
  return std::make_unique<InstancePngs>(path.string(), std::move(*table), std::move(*files));
}

Result<std::unique_ptr<DetectionSource>> LoadDetections(const std::string& path) {
  std::error_code error;
  return fs::is_directory(path, error) ? LoadInstancePngs(path) : LoadCocoResults(path);
}

}  // namespace vismap
