#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "map/map_metadata.h"
#include "map/semantic_map.h"

namespace vismap {

// This room saves and loads maps. A file is a format version, then protobuf records with checksums:
// header, labels, blocks in compressed chunks, and an end record with the counts and the map's
// hash. The same map and metadata give the same bytes.

struct SaveInfo {
  std::filesystem::path path;  ///< absolute
  uint64_t bytes = 0;
  std::string map_hash;
};

struct LoadedMap {
  SemanticMap map;
  MapMetadata metadata;
  std::string map_hash;
};

/// Writes the map to a file; the folder must exist. The file that was there stays under the names
/// `keep_old_as`, see WriteFileAndKeepOld; without names it is replaced.
Result<SaveInfo> SaveMap(const SemanticMap& map, const MapMetadata& metadata,
                         const std::filesystem::path& path,
                         const std::vector<std::filesystem::path>& keep_old_as = {});

/// The memory that a loaded map may take unless another limit is given [bytes].
inline constexpr size_t kDefaultMaxMapBytes = size_t{2048} << 20;

/// Reads a map. Integrating frames into it gives the same results as into the map that was saved.
/// Version, checksums, ids, order, counts and the map's hash are checked: a damaged file gives an
/// Error that names the file and what was found. Fails, too, when the map would need more memory
/// than `max_bytes`, before it is allocated; the file itself may have as many bytes.
Result<LoadedMap> LoadMap(const std::filesystem::path& path,
                          size_t max_bytes = kDefaultMaxMapBytes);

/// The same in memory. `name` begins the message of an error.
std::vector<uint8_t> EncodeMap(const SemanticMap& map, const MapMetadata& metadata);
Result<LoadedMap> DecodeMap(std::span<const uint8_t> bytes, const std::string& name,
                            size_t max_bytes = kDefaultMaxMapBytes);

/// How many frames a saved map was made of, from the start of the file alone. Fails when that
/// cannot be read.
Result<int64_t> FramesOfMapFile(const std::filesystem::path& path);

}  // namespace vismap
