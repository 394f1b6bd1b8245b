#pragma once

#include <filesystem>
#include <string>

#include "base/result.h"

namespace vismap {

/// The folder in which a server keeps the maps that clients of the bus may save and load by name.
/// Clients send names and never paths, so that they can reach no other file.
class MapFolder {
 public:
  /// `folder` must exist when a map is saved or loaded; empty = clients may do neither.
  explicit MapFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// The path for a map to be saved as `name`. A name has 1 to 100 letters, digits, '-', '_' and
  /// '.', and does not begin with '.'; ".vismap" is appended when it does not end with it. Fails
  /// unless nothing has this name yet, or a regular file that is a saved map.
  Result<std::filesystem::path> ForSaving(const std::string& name) const;
  /// The path of the saved map `name`. Fails unless it is a regular file; symbolic links, pipes and
  /// devices are none.
  Result<std::filesystem::path> ForLoading(const std::string& name) const;

 private:
  Result<std::filesystem::path> PathOf(const std::string& name) const;

  std::filesystem::path folder_;
};

/// Whether a file begins like a saved map.
bool LooksLikeMapFile(const std::filesystem::path& path);

}  // namespace vismap
