#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace vismap {

/// Writes a file so that readers see either all of the old content or all of the new one, even
/// after a power cut: writes a temporary file in the same folder, fsync, rename, fsync of the
/// folder. On failure (folder missing, not writable, disk full) the old file stays, the temporary
/// one is removed, and the Error names the path, the step and the system's reason. The new file has
/// the permissions of the one that it replaces.
Result<void> WriteFileAtomically(const std::filesystem::path& path, std::span<const uint8_t> bytes);
Result<void> WriteFileAtomically(const std::filesystem::path& path, std::string_view text);

/// The same, but the file that was at `path` stays: it gets each of the names `keep_as`, in the
/// same folder, and replaces what has such a name. When writing fails, no file has changed.
Result<void> WriteFileAndKeepOld(const std::filesystem::path& path, std::span<const uint8_t> bytes,
                                 const std::vector<std::filesystem::path>& keep_as);

/// Gives a regular file another name, which is returned: PATH.ENDING-1 with ENDING = `ending`, or
/// the first higher number that no file has.
Result<std::filesystem::path> SetAside(const std::filesystem::path& path,
                                       const std::string& ending);

/// Removes the temporary files of WriteFileAtomically for `path` whose process no longer exists,
/// for example since it was killed. Returns how many.
int RemoveStaleTemporaries(const std::filesystem::path& path);
/// The same for all files of a folder whose name has `part` in it.
int RemoveStaleTemporariesIn(const std::filesystem::path& folder, const std::string& part);

/// Fails when the file to be written is the one that is read.
Result<void> CheckIsNotInput(const std::filesystem::path& input, const std::filesystem::path& out);

/// Creates a folder and its parents where they are missing. The Error names the folder and the
/// system's reason.
Result<void> CreateFolder(const std::filesystem::path& folder);

/// The whole content of a regular file. Fails when it cannot be read, is no regular file (a pipe or
/// a device is never waited for) or is larger than `max_bytes`; the Error names the path and the
/// reason.
Result<std::vector<uint8_t>> ReadFileBytes(const std::filesystem::path& path,
                                           uint64_t max_bytes = uint64_t{1} << 30);

}  // namespace vismap
