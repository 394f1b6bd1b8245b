#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "objects/block_surfaces.h"
#include "objects/label_surfaces.h"

namespace vismap {

/// The objects of a growing map, with work that depends on what has changed and not on the size of
/// the map: they are read from the surfaces of blocks that were meshed anyway, and only what has
/// changed is measured anew; what is large, floors and walls, only when it is another tenth larger
/// or smaller. So boxes of large objects may lag a little behind SummarizeObjects; everything else
/// differs by small pieces of surface that that leaves out, and by a few vertices at rims.
class ObjectTracker {
 public:
  /// Blocks where a label, or one merged into it, has votes.
  using Places = std::function<std::span<const BlockIndex>(SegmentLabel)>;

  /// Forgets everything.
  void Clear() { *this = {}; }
  /// The objects now. `surfaces` = of the map as it is.
  std::vector<ObjectSummary> Summarize(const SemanticMap& map, const BlockSurfaces& surfaces,
                                       const Places& places, const ObjectOptions& options);

 private:
  /// What an object was measured from, and what came out.
  struct Measured {
    std::vector<std::pair<SegmentLabel, uint32_t>> from;  // labels and versions of their surfaces
    int64_t points = 0;
    OrientedBox box;
    SurfacePlane plane;
    SurfaceSpread spread;
  };
  using Key = std::pair<InstanceId, SegmentLabel>;  // the latter of discovered segments

  void LevelWhenGrown(const SemanticMap& map, const BlockSurfaces& surfaces, const Places& places,
                      const ObjectOptions& options, LabelSurfaces amounts);

  std::map<Key, Measured> measured_;
  Eigen::Vector3d up_W_ = Eigen::Vector3d::UnitZ();  // that they were measured with
  double leveled_area_ = 0;                          // from which that was found [m^2]
};

}  // namespace vismap
