#pragma once

#include <span>
#include <string>
#include <vector>

#include "exports/outputs.h"
#include "map_server/map_memory.h"
#include "map_server/map_snapshot.h"
#include "objects/object_query.h"
#include "requests/request_server.h"

namespace vismap {

// What a map server answers to requests that only read the map. See map_request_t for the meaning
// of each verb.

/// "objects": which objects the request asks for.
Result<ObjectQuery> QueryOf(const map_request_t& request);
/// "objects": those of `objects` that the query selects, as objects.json.
Result<Answer> AnswerObjects(const MapSnapshot& map, const ObjectQuery& query,
                             const UpDirection& up, const std::vector<ObjectSummary>& objects);
/// "mesh" with the argument "ply": the mesh of the whole map as a PLY file.
Answer AnswerMeshFile(const MapSnapshot& map, const OutputOptions& options);
/// "mesh" for some objects, and "points": their surface as a PLY file, only its vertices for
/// points. Only `places`, the blocks with votes for the objects, are meshed. Fails when none of
/// them has a surface.
Result<Answer> AnswerSurface(const MapSnapshot& map, std::span<const ObjectSummary> objects,
                             std::span<const BlockIndex> places, const MeshingOptions& options,
                             bool points_only);
/// "map": the whole map as a saved one. Its message is the hash of the map.
Answer AnswerMapFile(const MapSnapshot& map);
/// "statistics": figures of the map as JSON, with the digest of what was published on MAP_DELTA and
/// the memory of the server by layer.
Answer AnswerStatistics(const MapSnapshot& map, const std::string& occupancy_digest,
                        const std::vector<MemoryLayer>& memory);
/// "frames": [camera, utime] of every frame in the map as JSON; with the argument "poses", [camera,
/// utime, digest of the pose] (PoseDigest); with "positions=N", [x, y, z] in W [m] of the camera at
/// frame N and those after it, in the order of integration; with "trajectory=N", the same as
/// [camera, x, y, z].
Result<Answer> AnswerFrames(const MapSnapshot& map, const std::string& argument);
/// "cell": why the map shows what it shows at the point "at=x,y,z" [m], see ExplainCell.
Result<Answer> AnswerCell(const MapSnapshot& map, const OccupancyOptions& options,
                          const std::string& argument);

}  // namespace vismap
