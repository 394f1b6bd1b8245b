#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "objects/objects.h"

namespace vismap {

/// Which objects of a map somebody asks for; what is not set does not restrict.
struct ObjectQuery {
  std::optional<InstanceId> instance;
  std::optional<SegmentLabel> segment;  ///< the object that has this segment label
  std::optional<ClassId> class_id;
  std::optional<Eigen::AlignedBox3d> region_W;  ///< the object's box must reach into it [m]

  bool all() const { return !instance && !segment && !class_id && !region_W; }
};

/// An id as people write it: "7" = instance 7, "s12" or "segment_12" = the object of segment 12.
/// Fails on anything else; the other members of `query` stay.
Result<void> SetId(const std::string& text, ObjectQuery* query);
/// A class by COCO name or id. Fails on unknown names.
Result<void> SetClassOf(const std::string& text, ObjectQuery* query);
/// "x0,y0,z0,x1,y1,z1": two corners of a box in W, first the smaller numbers [m]. Fails unless
/// there are six finite numbers in that order.
Result<void> SetRegion(const std::string& text, ObjectQuery* query);

/// "id=7;class=dining table;region=0,0,0,1,1,1": any of these, in any order; empty = all.
Result<ObjectQuery> ParseObjectQuery(const std::string& text);
/// The text that ParseObjectQuery reads back.
std::string ToText(const ObjectQuery& query);

/// The objects that were asked for, in their order. Removed ones have no place, so they are in no
/// region. Fails when no object has the id, naming those that there are. No object of a class, or
/// in a region, is an empty list.
Result<std::vector<ObjectSummary>> SelectObjects(std::span<const ObjectSummary> objects,
                                                 const ObjectQuery& query);

}  // namespace vismap
