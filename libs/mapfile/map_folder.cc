#include "mapfile/map_folder.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>

#include "mapfile/record_stream.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxName = 100;

bool IsPlain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_' || c == '.';
}

bool IsPlainName(const std::string& name) {
  return !name.empty() && name.size() <= kMaxName && name[0] != '.' &&
         std::all_of(name.begin(), name.end(), IsPlain);
}

}  // namespace

bool LooksLikeMapFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, mapfile::kMagic.size()> start{};
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  return file.gcount() == static_cast<std::streamsize>(start.size()) &&
         std::equal(start.begin(), start.end(), mapfile::kMagic.begin());
}

Result<fs::path> MapFolder::PathOf(const std::string& name) const {
  if (folder_.empty()) {
    return Fail(
        "this server has no folder for maps of clients; start it with `map_server { map_folder: "
        "\"...\" }` in its config, or with --map-folder");
  }
  if (!IsPlainName(name)) {
    return Fail(
        "a request names a map with 1 to 100 letters, digits, '-', '_' and '.', and no path; it "
        "is kept in the folder that the server's config calls map_folder (found a name of " +
        std::to_string(name.size()) + " characters)");
  }
  return folder_ / (name.ends_with(".vismap") ? name : name + ".vismap");
}

Result<fs::path> MapFolder::ForSaving(const std::string& name) const {
  const Result<fs::path> path = PathOf(name);
  if (!path) return path;
  std::error_code error;
  const fs::file_status status = fs::symlink_status(*path, error);
  if (status.type() == fs::file_type::not_found) return path;
  if (status.type() != fs::file_type::regular || !LooksLikeMapFile(*path))
    return Fail(path->string() + ": this is no saved map, so it is not replaced");
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
