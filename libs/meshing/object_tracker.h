#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "mapping/integrate.h"
#include "meshing/label_surfaces.h"

namespace vismap {

/// The objects of a growing map, kept up to date with work that depends on what has changed and not
/// on the size of the map: only labels of changed blocks are measured anew, and large ones, floors
/// and walls, only when they have grown by a tenth or a tenth was seen empty. So boxes of large
/// objects may lag a little behind SummarizeObjects; everything else differs by small pieces of
/// surface that that leaves out.
class ObjectTracker {
 public:
  /// Blocks where a label, or one merged into it, has votes.
  using Places = std::function<std::span<const BlockIndex>(SegmentLabel)>;

  /// Forgets everything.
  void Clear() { *this = {}; }
  /// A frame changed the map.
  void NoteChanges(const SemanticMap& map, const MapDelta& delta);
  /// The objects now.
  std::vector<ObjectSummary> Summarize(const SemanticMap& map, const Places& places,
                                       const MeshingOptions& meshing, const ObjectOptions& options);

 private:
  /// What an object was measured from, and what came out.
  struct Measured {
    std::vector<std::pair<SegmentLabel, uint32_t>> from;  // labels and versions of their surfaces
    OrientedBox box;
    SurfacePlane plane;
  };
  using Key = std::pair<InstanceId, SegmentLabel>;  // the latter of discovered segments

  std::vector<SegmentLabel> LabelsToMeasure(const SemanticMap& map, const Places& places);
  void MeasureLabels(const SemanticMap& map, std::span<const SegmentLabel> labels,
                     const Places& places, const MeshingOptions& meshing);
  void MeasureTogether(const SemanticMap& map, std::span<const SegmentLabel> labels,
                       const Places& places, const MeshingOptions& meshing);

  std::set<SegmentLabel> changed_;
  LabelSurfaces surfaces_;
  std::vector<uint32_t> versions_;       // of the surfaces
  std::vector<size_t> blocks_measured_;  // that each surface was made of
  std::map<Key, Measured> measured_;
  Eigen::Vector3d up_W_ = Eigen::Vector3d::Zero();  // that they were measured with
};

}  // namespace vismap
