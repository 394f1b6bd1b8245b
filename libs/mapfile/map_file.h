#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "map/map_metadata.h"
#include "map/semantic_map.h"

namespace vismap {

// What lives in this room: saved maps, the only user of their protobuf (.cc files). A file is a
// version, a stream of checksummed protobuf records with the blocks compressed in chunks, and at
// the end what must have come before. The same map and metadata give the same bytes.

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

/// Writes the map, all or nothing (see WriteFileAtomically); the folder must exist.
Result<SaveInfo> SaveMap(const SemanticMap& map, const MapMetadata& metadata,
                         const std::filesystem::path& path);

/// Reads a map that goes on exactly as the saved one would have. Everything is checked (version,
/// checksums, ids, order, counts, and the map's hash), so that a damaged file is an Error that
/// names the file and what was found, whatever its bytes.
Result<LoadedMap> LoadMap(const std::filesystem::path& path);

/// The same on bytes in memory; `name` stands in the error.
std::vector<uint8_t> EncodeMap(const SemanticMap& map, const MapMetadata& metadata);
Result<LoadedMap> DecodeMap(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace vismap
