#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/result.h"

namespace vismap {

/// Finds out before long work whether its results can be written: creates the folder and its
/// parents where they are missing, writes a file of `bytes` there, and removes it. Fails with the
/// path and the system's reason. Removes the folders that it has created when it fails.
Result<void> ProbeFolder(const std::filesystem::path& folder, uint64_t bytes);

/// The folders of a path that do not exist yet, the deepest first.
class NewFolders {
 public:
  explicit NewFolders(const std::filesystem::path& folder);
  /// Removes those that exist by now and are empty.
  void RemoveEmpty() const;

 private:
  std::vector<std::filesystem::path> folders_;
};

}  // namespace vismap
