#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "meshing/mesh.h"

namespace vismap {

/// What a PLY file says in its comments: `comment map_id ...`, `comment class 62 chair`.
struct PlyInfo {
  std::string map_id;
  std::map<ClassId, std::string> class_names;
  friend bool operator==(const PlyInfo&, const PlyInfo&) = default;
};

struct PlyFile {
  Mesh mesh;
  PlyInfo info;
};

/// Binary little-endian PLY. Vertex: float x y z nx ny nz, uchar red green blue, uint segment,
/// uint instance, ushort class; face: list uchar int vertex_indices. Line breaks in the info become
/// spaces.
std::vector<uint8_t> EncodePly(const Mesh& mesh, const PlyInfo& info);

/// The mesh of a binary little-endian PLY: any order and number types, unknown elements and
/// properties skipped, missing ones left at their defaults (x y z are needed), polygons cut into
/// fans; `label` is read as segment where there is no `segment`, `vertex_index` as
/// `vertex_indices`. Fails on anything cut short, on indices out of range and on ids that do not
/// fit; `name` opens the error sentence.
Result<PlyFile> DecodePly(std::span<const uint8_t> bytes, const std::string& name);

/// EncodePly to a file, in one piece or not at all (see WriteFileAtomically).
Result<void> WritePly(const std::filesystem::path& path, const Mesh& mesh, const PlyInfo& info);

Result<PlyFile> ReadPly(const std::filesystem::path& path);

}  // namespace vismap
