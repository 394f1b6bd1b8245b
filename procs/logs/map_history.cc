#include "logs/map_history.h"

#include <algorithm>
#include <set>

namespace vismap {
namespace {

using ByRevision = std::map<int64_t, frame_commit_t>;

// Maps in the order in which their first frames were committed.
struct RecordedMaps {
  std::vector<std::string> order;
  std::map<std::string, ByRevision> integrated;
};

RecordedMaps Sort(const std::vector<frame_commit_t>& commits) {
  RecordedMaps maps;
  for (const frame_commit_t& commit : commits) {
    if (commit.status != frame_commit_t::STATUS_INTEGRATED) continue;
    if (!maps.integrated.contains(commit.map_id)) maps.order.push_back(commit.map_id);
    maps.integrated[commit.map_id].emplace(commit.revision, commit);
  }
  return maps;
}

// Finds the saved map that this map continued: the newest earlier map that reached the revision
// before the first one in `frames`. Adds its frames to `frames` and sets `map` to it. Returns false
// when there is none.
bool PrependSavedMap(const RecordedMaps& maps, size_t* map, ByRevision* frames) {
  const int64_t before = frames->begin()->first - 1;
  while ((*map)-- > 0) {
    const ByRevision& earlier = maps.integrated.at(maps.order[*map]);
    if (!earlier.contains(before)) continue;
    for (const auto& [revision, commit] : earlier) {
      if (revision <= before) frames->emplace(revision, commit);
    }
    return true;
  }
  return false;
}

void CheckComplete(const ByRevision& frames, std::vector<std::string>* remarks) {
  int64_t expected = 1;
  for (const auto& [revision, commit] : frames) {
    if (revision != expected) {
      remarks->push_back("the log has no MAP_COMMIT of the revisions " + std::to_string(expected) +
                         " to " + std::to_string(revision - 1) + " of map " + commit.map_id +
                         ", so the map will differ from the recorded one");
    }
    expected = revision + 1;
  }
}

}  // namespace

MapHistory HistoryOfNewestMap(const std::vector<frame_commit_t>& commits) {
  MapHistory history;
  const RecordedMaps maps = Sort(commits);
  if (maps.order.empty()) return history;
  size_t map = maps.order.size() - 1;
  history.map_id = maps.order.back();
  ByRevision frames = maps.integrated.at(history.map_id);
  while (frames.begin()->first > 1 && PrependSavedMap(maps, &map, &frames)) {
    history.remarks.push_back("map " + history.map_id + " continues a saved map, probably " +
                              maps.order[map]);
  }
  CheckComplete(frames, &history.remarks);
  std::set<FrameKey> taken;
  for (const auto& [revision, commit] : frames) {
    history.integrated.push_back(commit);
    taken.insert(KeyOf(commit));
  }
  for (const frame_commit_t& commit : commits) {
    if (commit.status == frame_commit_t::STATUS_SKIPPED && !taken.contains(KeyOf(commit)))
      history.skipped.emplace(KeyOf(commit), commit.reason);
  }
  return history;
}

}  // namespace vismap
