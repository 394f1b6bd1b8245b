#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exports/outputs.h"
#include "freespace/occupancy_map.h"
#include "mapfile/map_file.h"
#include "viewer/http_rules.h"
#include "viewer/leaves.h"
#include "viewer/slice_distances.h"

namespace vismap {

// What the map server and the octomap exporter answer about a live map, from a map at hand.

/// ID in /api/object/ID.ply; nullopt = it is another path.
std::optional<std::string> ObjectOfPath(const std::string& path);
/// 7 or s12, as pages name objects.
bool IsObjectName(const std::string& name);
/// Says what is expected, and what was found.
HttpAnswer WrongObjectName(const std::string& name);

/// The surfaces of objects as PLY files, as WriteObjectMeshes writes them. Those of the last map
/// are kept for further questions.
class ObjectFiles {
 public:
  /// `name`: see IsObjectName. 400 when the map has no such object, or it has no surface.
  HttpAnswer Ply(const std::shared_ptr<const LoadedMap>& map, const std::string& name,
                 const OutputOptions& options);

 private:
  std::shared_ptr<const LoadedMap> map_;
  std::vector<ObjectSummary> objects_;  // of it
  std::vector<Mesh> surfaces_;          // of each of them
};

/// The `.bt` stream that the question asks for, as the body of the answer; 400 with the reason when
/// there is none.
HttpAnswer TreeOf(const OccupancyMap& space, const LeafQuestion& question, int64_t utime,
                  const OctreeOptions& options);
/// Fails when the slice is too large.
Result<SliceDistances> DistancesIn(const OccupancyMap& space, const Slice& slice,
                                   const SliceQuestion& question, const OctreeOptions& options);

}  // namespace vismap
