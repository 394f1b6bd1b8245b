#include "map_server/saved_maps.h"

#include <system_error>
#include <utility>

#include "base/file.h"
#include "mapfile/map_folder.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

fs::path PreviousOf(const fs::path& path) { return path.string() + ".previous"; }
fs::path ReplacedOf(const fs::path& path) { return path.string() + ".replaced"; }

fs::path Absolute(const fs::path& path) {
  std::error_code ignored;
  return fs::absolute(path, ignored).lexically_normal();
}

bool Exists(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

/// How many frames a file was made of; -1 = it cannot be read.
int64_t FramesOf(const fs::path& path) { return FramesOfMapFile(path).value_or(-1); }

/// Gives another name to what is no saved map and would be replaced.
Result<void> MakeWay(const fs::path& path) {
  if (!Exists(path) || LooksLikeMapFile(path)) return {};
  const Result<fs::path> aside = SetAside(path, "unusable");
  if (!aside) return tl::unexpected(aside.error());
  return {};
}

}  // namespace

void SavedMaps::BeginMap(const std::string& map_id) {
  const std::lock_guard lock(*known_);
  map_id_ = map_id;
  revisions_.clear();
}

void SavedMaps::WasLoadedFrom(const fs::path& path, int64_t revision) {
  const std::lock_guard lock(*known_);
  revisions_[Absolute(path)] = revision;
}

bool SavedMaps::HasRevision(const fs::path& path, int64_t revision) const {
  const std::lock_guard lock(*known_);
  const auto known = revisions_.find(Absolute(path));
  return known != revisions_.end() && known->second == revision;
}

bool SavedMaps::WouldLose(const SemanticMap& map, const fs::path& path) {
  return map.voxels.size() == 0 && Exists(path);
}

std::vector<fs::path> SavedMaps::NamesForOld(const fs::path& path, int64_t revision,
                                             const Revisions& known) {
  const auto saved = known.find(Absolute(path));
  const bool of_this_map = saved != known.end();
  if (!Exists(path) || (of_this_map && saved->second == revision)) return {};  // the same again
  std::vector<fs::path> names = {PreviousOf(path)};
  if (!of_this_map && FramesOf(path) >= FramesOf(ReplacedOf(path)))
    names.push_back(ReplacedOf(path));
  return names;
}

Result<SaveInfo> SavedMaps::Save(const SemanticMap& map, const MapMetadata& metadata,
                                 const fs::path& path) {
  const std::lock_guard lock(*saving_);
  if (WouldLose(map, path)) {
    return Fail(path.string() +
                ": not saved, since the map is empty and would replace a saved one");
  }
  for (const fs::path& name : {path, PreviousOf(path), ReplacedOf(path)}) {
    if (const Result<void> done = MakeWay(name); !done) return tl::unexpected(done.error());
  }
  const auto known = [&] {
    const std::lock_guard known_lock(*known_);
    return metadata.map_id == map_id_ ? revisions_ : Revisions();  // else it was replaced meanwhile
  }();
  Result<SaveInfo> saved = SaveMap(map, metadata, path, NamesForOld(path, map.revision, known));
  const std::lock_guard known_lock(*known_);
  if (saved && metadata.map_id == map_id_) revisions_[Absolute(path)] = map.revision;
  return saved;
}

Result<MapSession> ReadSavedMap(const fs::path& path, const MapSessionOptions& options,
                                const std::string& map_id) {
  if (path.empty()) return Fail("no map given to load");
  Result<LoadedMap> loaded = LoadMap(path, MaxMapBytes(options.integration));
  if (!loaded) return tl::unexpected(loaded.error());
  loaded->metadata.map_id = map_id;
  Result<MapSession> session = MapSession::Continue(options, std::move(*loaded));
  if (!session) return Fail(path.string() + ": " + session.error().message);
  return session;
}

Result<RecoveredMap> RecoverMap(const fs::path& path, const MapSessionOptions& options,
                                const std::string& map_id) {
  RecoveredMap recovered;
  for (const fs::path& file : {path, PreviousOf(path), ReplacedOf(path)}) {
    RemoveStaleTemporaries(file);
    if (recovered.session || !Exists(file)) continue;
    Result<MapSession> session = ReadSavedMap(file, options, map_id);
    if (session) {
      recovered.session = std::move(*session);
      recovered.path = file;
      continue;
    }
    const Result<fs::path> aside = SetAside(file, "unusable");
    if (!aside) return Fail(session.error().message + "; " + aside.error().message);
    recovered.unusable.push_back(session.error().message + "; the file is " + aside->string() +
                                 " now");
  }
  return recovered;
}

}  // namespace vismap
