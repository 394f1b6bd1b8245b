#include "viewer/version_table.h"

#include <limits>
#include <utility>

namespace vismap {

void VersionTable::KeepOnly(std::span<const int64_t> moments) {
  versions_ = 0;
  for (auto block = blocks_.begin(); block != blocks_.end(); ++block) {
    Versions& versions = block.value();
    Versions kept;
    for (size_t i = 0; i < versions.size(); ++i) {
      const int64_t until =
          i + 1 < versions.size() ? versions[i + 1].frames : std::numeric_limits<int64_t>::max();
      const auto moment = std::lower_bound(moments.begin(), moments.end(), versions[i].frames);
      if (moment != moments.end() && *moment < until) kept.push_back(versions[i]);
    }
    versions_ += kept.size();
    versions = std::move(kept);
  }
}

void VersionTable::CollectPlaces(std::vector<SpillFile::Place*>* places) {
  for (auto block = blocks_.begin(); block != blocks_.end(); ++block) {
    for (BlockVersion& version : block.value()) {
      if (version.place.size > 0) places->push_back(&version.place);
    }
  }
}

}  // namespace vismap
