#include "mapfile/map_folder.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>

#include "base/printable.h"
#include "mapfile/record_stream.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxName = 100;
constexpr size_t kMaxFiles = 1000;

bool IsPlain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_' || c == '.';
}

bool IsPlainName(const std::string& name) {
  return !name.empty() && name.size() <= kMaxName && name[0] != '.' &&
         std::all_of(name.begin(), name.end(), IsPlain);
}

}  // namespace

Result<void> CheckMapName(const std::string& name) {
  if (IsPlainName(name)) return {};
  return Fail(
      "expected the name of a map, which has 1 to 100 letters, digits, '-', '_' and '.', does not "
      "begin with '.', and is no path; found a name of " +
      std::to_string(name.size()) + " characters: '" + PrintableText(name, kMaxName) + "'");
}

bool LooksLikeMapFile(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;  // opening a pipe could wait for ever
  std::ifstream file(path, std::ios::binary);
  std::array<char, mapfile::kMagic.size()> start{};
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  return file.gcount() == static_cast<std::streamsize>(start.size()) &&
         std::equal(start.begin(), start.end(), mapfile::kMagic.begin());
}

Result<fs::path> MapFolder::PathOf(const std::string& name) const {
  if (const Result<void> checked = CheckMapName(name); !checked)
    return tl::unexpected(checked.error());
  if (folder_.empty()) {
    return Fail(
        "this server has no folder for maps of clients; start it with `map_server { map_folder: "
        "\"...\" }` in its config, or with --map-folder");
  }
  return folder_ / (name.ends_with(".vismap") ? name : name + ".vismap");
}

Result<void> MapFolder::CheckRoom(bool for_new_file) const {
  uint64_t bytes = 0;
  size_t files = 0;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error)) {
    std::error_code ignored;
    const uint64_t size = entry.is_regular_file(ignored) ? entry.file_size(ignored) : 0;
    if (!ignored) bytes += size;
    ++files;
  }
  if (bytes < max_bytes_ && (files < kMaxFiles || !for_new_file)) return {};
  return Fail(folder_.string() + ": the folder for maps is full: it has " + std::to_string(files) +
              " files of " + std::to_string(bytes >> 20) + " MB, and at most " +
              std::to_string(kMaxFiles) + " files or " + std::to_string(max_bytes_ >> 20) +
              " MB (map_server.map_folder_mb) are allowed; remove maps that are not needed");
}

Result<fs::path> MapFolder::ForSaving(const std::string& name) const {
  const Result<fs::path> path = PathOf(name);
  if (!path) return path;
  std::error_code error;
  const fs::file_status status = fs::symlink_status(*path, error);
  const bool is_new = status.type() == fs::file_type::not_found;
  if (!is_new && (status.type() != fs::file_type::regular || !LooksLikeMapFile(*path)))
    return Fail(path->string() + ": this is no saved map, so it is not replaced");
  if (const Result<void> room = CheckRoom(is_new); !room) return tl::unexpected(room.error());
  return path;
}

Result<fs::path> MapFolder::ForLoading(const std::string& name) const {
  const Result<fs::path> path = PathOf(name);
  if (!path) return path;
  std::error_code error;
  const fs::file_status status = fs::symlink_status(*path, error);
  if (status.type() == fs::file_type::not_found)
    return Fail(path->string() + ": there is no map of this name");
  if (status.type() != fs::file_type::regular)
    return Fail(path->string() + ": expected a regular file");
  return path;
}

}  // namespace vismap
