#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "base/result.h"

namespace vismap {

/// Fails unless a text can be the name of a map: 1 to 100 letters, digits, '-', '_' and '.', and no
/// '.' at the start. So it is no path, and names no file outside the folder that it is used in.
Result<void> CheckMapName(const std::string& name);

/// Whether a regular file begins like a saved map.
bool LooksLikeMapFile(const std::filesystem::path& path);

/// The folder in which a server keeps the maps that clients of the bus may save and load by name.
/// Clients send names and never paths, so that they can reach no other file.
class MapFolder {
 public:
  /// `folder` is made when a map is saved; empty = clients may neither save nor load. No map is
  /// saved when the files in it have `max_bytes` already.
  explicit MapFolder(std::filesystem::path folder, uint64_t max_bytes = UINT64_MAX)
      : folder_(std::move(folder)), max_bytes_(max_bytes) {}

  /// The path for a map to be saved as `name` (see CheckMapName); ".vismap" is appended when it
  /// does not end with it. Fails unless nothing has this name yet, or a regular file that is a
  /// saved map; and when the folder is full: by size, or since it has 1000 files.
  Result<std::filesystem::path> ForSaving(const std::string& name) const;
  /// The path of the saved map `name`. Fails unless it is a regular file; symbolic links, pipes and
  /// devices are none.
  Result<std::filesystem::path> ForLoading(const std::string& name) const;

  const std::filesystem::path& path() const { return folder_; }

 private:
  Result<std::filesystem::path> PathOf(const std::string& name) const;
  Result<void> CheckRoom(bool for_new_file) const;

  std::filesystem::path folder_;
  uint64_t max_bytes_;
};

}  // namespace vismap
