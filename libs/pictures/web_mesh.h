#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "objects/objects.h"

namespace vismap {

/// A surface in few bytes, for the page of a report.
struct WebMesh {
  Mesh mesh;          ///< coarser than the map's
  double cell_m = 0;  ///< vertices closer than this were joined [m]; 0 = none were
};

/// Joins vertices of the same owner that look into about the same direction in cubes, which get
/// larger until at most `max_vertices` and 2.5 times as many triangles are left. Vertices that are
/// not finite are left out with their triangles. Owners are never joined, so with more of them than
/// that the mesh stays larger.
WebMesh CoarsenMesh(const Mesh& mesh, size_t max_vertices);

/// The number of vertices whose surface takes less than 10 MB in a report.
inline constexpr size_t kMostReportVertices = 180'000;

/// The surface in the form that report.js reads, base64: u16 positions[3 n] in steps of the
/// bounding box / 65535, u8 colours[3 n], padded to 2 bytes, u16 owners[n] (index into `objects`,
/// 65535 = none), padded to 4 bytes, u32 corners[3 m]; little-endian.
std::string EncodeWebMesh(const Mesh& mesh, std::span<const ObjectSummary> objects);
/// {"vertices": n, "triangles": m, "low": [x, y, z], "high": [x, y, z]} of the bounding box [m].
std::string WebMeshHeader(const Mesh& mesh);

}  // namespace vismap
