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

/// Keeps the list of objects of a growing map up to date. The cost depends on what has changed and
/// not on the size of the map: the surface comes from the block meshes that exist anyway, and an
/// object is measured again only when its surface has changed. A large object, such as a floor or a
/// wall, is measured again only when its number of vertices has changed by a tenth. So the result
/// differs a little from that of SummarizeObjects: the boxes of large objects may be older; small
/// components, islands and contacts are as the block meshes have them; and a few vertices at the
/// border of the observed space are missing.
class ObjectTracker {
 public:
  /// Returns the blocks in which a label, or a label that was merged into it, has votes.
  using Places = std::function<std::span<const BlockIndex>(SegmentLabel)>;

  /// Forgets everything.
  void Clear() { *this = {}; }
  /// The current objects. `surfaces` and `places` must be up to date with `map`.
  std::vector<ObjectSummary> Summarize(const SemanticMap& map, const BlockSurfaces& surfaces,
                                       const Places& places, const ObjectOptions& options);

  /// The upward direction of the boxes of the last Summarize.
  const UpDirection& up() const { return up_; }

 private:
  /// What an object was last measured from, and the result.
  struct Measured {
    std::vector<std::pair<SegmentLabel, uint32_t>> from;  // labels and versions of their surfaces
    int64_t points = 0;                                   // number of vertices of the object
    OrientedBox box;
    SurfacePlane plane;
    SurfaceSpread spread;
  };
  // An object is known by its instance, or, if it is discovered, by its segment.
  using Key = std::pair<InstanceId, SegmentLabel>;

  void UpdateUp(const SemanticMap& map, const BlockSurfaces& surfaces, const Places& places,
                const ObjectOptions& options, LabelSurfaces amounts);

  std::map<Key, Measured> measured_;
  UpDirection up_;      // of all boxes
  double up_area_ = 0;  // area of all surface when it was estimated [m^2]
};

}  // namespace vismap
