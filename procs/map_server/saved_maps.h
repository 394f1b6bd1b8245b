#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "mapfile/map_file.h"
#include "session/map_session.h"

namespace vismap {

/// Saves the map of a server to files, so that no saved map is lost by a mistake or by a request of
/// any client. Beside a file PATH stand
///   PATH.previous  what was saved to PATH before
///   PATH.replaced  another map that was at PATH, for example before a reset: of all that were
///                  replaced, the one with the most frames
class SavedMaps {
 public:
  /// From now on the server has another map, with this id. Nothing of it is saved yet.
  void BeginMap(const std::string& map_id);
  /// The map of the server was read from this file, at this revision.
  void WasLoadedFrom(const std::filesystem::path& path, int64_t revision);
  /// Saves the map of the server, or a copy of it, which another thread may do while this one goes
  /// on. Fails when the map is empty and the file exists, see WouldLose.
  Result<SaveInfo> Save(const SemanticMap& map, const MapMetadata& metadata,
                        const std::filesystem::path& path);

  /// Whether the file has this revision of the map, as far as this process knows.
  bool HasRevision(const std::filesystem::path& path, int64_t revision) const;
  /// Whether saving would replace a file by an empty map.
  static bool WouldLose(const SemanticMap& map, const std::filesystem::path& path);

 private:
  using Revisions = std::map<std::filesystem::path, int64_t>;  // of the map, by absolute path

  static std::vector<std::filesystem::path> NamesForOld(const std::filesystem::path& path,
                                                        int64_t revision, const Revisions& known);

  // Behind pointers, so that this can be moved.
  std::unique_ptr<std::mutex> saving_ = std::make_unique<std::mutex>();  // one save at a time
  std::unique_ptr<std::mutex> known_ = std::make_unique<std::mutex>();   // protects what follows
  std::string map_id_;
  Revisions revisions_;
};

/// What was found at the start of a server.
struct RecoveredMap {
  std::optional<MapSession> session;  ///< nullopt: there is no usable file
  std::filesystem::path path;         ///< of the session
  std::vector<std::string> unusable;  ///< one sentence for each file that was set aside
};

/// Reads the newest usable map of PATH, PATH.previous and PATH.replaced. Files that cannot be used
/// (damaged, foreign, with another voxel grid) get another name, PATH.unusable-1 and so on. Removes
/// what processes that were killed while saving have left. Fails when a file can neither be used
/// nor set aside.
Result<RecoveredMap> RecoverMap(const std::filesystem::path& path, const MapSessionOptions& options,
                                const std::string& map_id);

/// Reads a saved map and gives it `map_id`, so that its revisions are not mistaken for those of the
/// map that was saved. Fails with the path and the reason.
Result<MapSession> ReadSavedMap(const std::filesystem::path& path, const MapSessionOptions& options,
                                const std::string& map_id);

}  // namespace vismap
