#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "objects/objects.h"

namespace vismap {

/// A selection of objects. Conditions that are not set do not restrict it.
struct ObjectQuery {
  std::optional<InstanceId> instance;
  std::optional<SegmentLabel> segment;  ///< the object that has this segment label
  std::optional<ClassId> class_id;
  std::optional<Eigen::AlignedBox3d> region_W;  ///< must intersect the object's bounds [m]

  bool all() const { return !instance && !segment && !class_id && !region_W; }
};

/// Parses the id of an object: "7" is instance 7, "s12" or "segment_12" is the object that has
/// segment 12. Sets only that member of `query`. Fails on any other text.
Result<void> SetId(const std::string& text, ObjectQuery* query);
/// Parses a class, given by its COCO name or id. Fails on unknown names.
Result<void> SetClassOf(const std::string& text, ObjectQuery* query);
/// Parses "x0,y0,z0,x1,y1,z1": the lower and the upper corner of a box along the axes of W [m].
/// Fails unless there are six finite numbers with x0 <= x1, y0 <= y1 and z0 <= z1.
Result<void> SetRegion(const std::string& text, ObjectQuery* query);

/// Parses conditions such as "id=7;class=dining table;region=0,0,0,1,1,1", in any order. An empty
/// text selects all objects. Fails on unknown conditions and on values
/// that SetId, SetClassOf or SetRegion reject.
Result<ObjectQuery> ParseObjectQuery(const std::string& text);
/// The text that ParseObjectQuery reads back.
std::string ToText(const ObjectQuery& query);

/// The objects that meet all conditions, in their order. Removed objects have no box, so they are
/// in no region. Fails if no object has the given id; the error lists the instances of the map. The
/// list is empty if the class or the region has no object.
Result<std::vector<ObjectSummary>> SelectObjects(std::span<const ObjectSummary> objects,
                                                 const ObjectQuery& query);

}  // namespace vismap
