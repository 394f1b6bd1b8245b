#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "meshing/mesh.h"

namespace vismap {

/// What the comments of a PLY file tell: `comment map_id ...`, `comment class 62 chair`.
struct PlyInfo {
  std::string map_id;
  std::map<ClassId, std::string> class_names;
  friend bool operator==(const PlyInfo&, const PlyInfo&) = default;
};

/// The largest mesh that is read. With the defaults it needs 4 GB.
struct PlyLimits {
  uint64_t vertices = uint64_t{1} << 26;
  uint64_t triangles = uint64_t{1} << 27;
};

struct PlyFile {
  Mesh mesh;
  PlyInfo info;
};

/// The mesh as binary little-endian PLY. Vertex: float x y z [m, in W] nx ny nz, uchar red green
/// blue, uint segment, uint instance, ushort class. Face: list uchar int vertex_indices. Line
/// breaks in `info` become spaces.
std::vector<uint8_t> EncodePly(const Mesh& mesh, const PlyInfo& info);

/// Reads a binary little-endian PLY. Properties may have any order and any number type. Unknown
/// elements and properties are skipped; missing properties keep their defaults, but x, y and z are
/// required. Polygons become fans of triangles. `label` is read as segment if there is no
/// `segment`, and `vertex_index` like `vertex_indices`. Fails if the file is truncated, if two
/// elements have the same name, if an index is out of range, if an id is not a whole number of its
/// type, or if the mesh is larger than the limits. `name` is the file's name in errors.
Result<PlyFile> DecodePly(std::span<const uint8_t> bytes, const std::string& name,
                          const PlyLimits& limits = {});

/// Writes EncodePly to a file (see WriteFileAtomically).
Result<void> WritePly(const std::filesystem::path& path, const Mesh& mesh, const PlyInfo& info);

/// Whether a file begins as EncodePly begins one: its header has the properties in our order.
bool StartsLikeOurPly(std::istream& file);

/// Reads a PLY file (see DecodePly). Fails, naming the file, also when it is larger than 2 GiB.
Result<PlyFile> ReadPly(const std::filesystem::path& path);

}  // namespace vismap
