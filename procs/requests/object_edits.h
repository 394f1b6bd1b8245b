#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "exports/outputs.h"
#include "navigation/without_objects.h"
#include "objects/object_query.h"
#include "requests/request_server.h"

namespace vismap {

/// One condition of map_request_t.without: which objects, and what is wanted in their place.
struct ObjectEditTerm {
  ObjectQuery query;  ///< an instance, a segment or a class
  ObjectAction action = ObjectAction::kLeaveOut;
  double inflate_m = 0;
};

/// Parses map_request_t.without, terms separated by ';':
///   id=7   id=s12   class=cup        these objects are left out
///   id=7:unknown                     their place is unknown
///   class=chair:inflate=0.1          they are larger by this [m]
/// Fails with a sentence that names the term and what is allowed.
Result<std::vector<ObjectEditTerm>> ParseObjectEdits(const std::string& without);

/// The blocks in which a label has votes.
using LabelBlocks = std::function<std::span<const BlockIndex>(SegmentLabel)>;

/// The edits that `without` asks for, for EditObjects. `objects`: those of the map. Fails when a
/// term has no object, and as ParseObjectEdits.
Result<std::vector<ObjectEdit>> ReadEdits(const SemanticMap& map,
                                          std::span<const ObjectSummary> objects,
                                          const LabelBlocks& blocks, const std::string& without);
/// The space of a map that differs after these edits. Fails as EditObjects does.
Result<EditedSpace> EditSpace(const SemanticMap& map, std::span<const ObjectEdit> edits,
                              const OccupancyOptions& options);

/// Both for a map that nothing follows: finds objects and blocks itself, which takes longer.
Result<EditedSpace> EditSpace(const SemanticMap& map, const MapMetadata& metadata,
                              const std::string& without, const OutputOptions& options);

/// Edited space as the answer to a request "occupancy": its blocks, encoded as in MAP_DELTA.
Answer AnswerOccupancy(const EditedSpace& space);
/// The blocks in such an answer. Fails on bytes that are no such answer.
Result<OccupancyDelta> ReadOccupancy(std::span<const uint8_t> payload);

}  // namespace vismap
