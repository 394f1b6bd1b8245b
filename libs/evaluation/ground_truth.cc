#include "evaluation/ground_truth.h"

#include <map>

namespace vismap {
namespace {

namespace fs = std::filesystem;

// Whether a folder has a file whose name has this ending.
bool HasFile(const fs::path& folder, const std::string& ending) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().filename().string().ends_with(ending)) return true;
  }
  return false;
}

}  // namespace

std::vector<int> GroundTruth::ObjectOfPoints() const {
  std::map<uint32_t, int> index;
  for (size_t i = 0; i < objects.size(); ++i) index[objects[i].label] = static_cast<int>(i);
  std::vector<int> objects_of_points;
  objects_of_points.reserve(labels.size());
  for (const uint32_t label : labels) {
    const auto found = index.find(label);
    objects_of_points.push_back(found == index.end() ? -1 : found->second);
  }
  return objects_of_points;
}

Result<GroundTruth> ReadGroundTruth(const fs::path& folder) {
  std::error_code error;
  const fs::path real = fs::canonical(folder, error);
  if (error) return Fail(folder.string() + ": " + error.message());
  if (!fs::is_directory(real, error))
    return Fail(folder.string() + ": expected a folder, found a file");
  if (HasFile(real, "_vh_clean_2.ply")) return ReadScanNetTruth(real);
  const std::string id = real.filename().string();
  if (fs::exists(real / (id + ".ply")) || fs::exists(real / (id + ".xml")))
    return ReadSceneNnTruth(real);
  return Fail(folder.string() + ": there is no ground truth in this folder; expected " + id +
              ".ply and " + id + ".xml (SceneNN) or *_vh_clean_2.ply (ScanNet)");
}

}  // namespace vismap
