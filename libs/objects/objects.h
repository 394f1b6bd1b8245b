#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "meshing/marching_cubes.h"
#include "objects/oriented_box.h"
#include "objects/structure.h"

namespace vismap {

/// Whether a thing still stands where the map had it.
enum class ObjectState : uint8_t {
  kPresent,
  kRemoved,  ///< the camera saw past where it stood; little or no surface of it is left
};

/// One thing in the map as users see it: an instance that a detector named, or a discovered
/// segment.
struct ObjectSummary {
  InstanceId instance = InstanceId::kNone;      ///< kNone = discovered
  std::vector<SegmentLabel> segments;           ///< ascending; one for a discovered segment
  ClassId class_id = ClassId::kUnknown;         ///< kUnknown = discovered
  std::map<ClassId, double> class_probability;  ///< sums to 1; empty = discovered
  double score = 0;         ///< [0, 1]: how surely this is an object of this class; 0 = discovered
  int64_t points = 0;       ///< surface vertices
  double area = 0;          ///< of its surface [m^2]
  OrientedBox box;          ///< of its main parts, without outliers
  uint32_t frames = 0;      ///< in which its best-seen segment was observed
  int64_t first_utime = 0;  ///< [us]
  int64_t last_utime = 0;   ///< of the last frame that saw it there [us]
  ObjectState state = ObjectState::kPresent;
  int64_t removed_utime = 0;  ///< of the frame that found it gone; 0 = present [us]
  SurfacePlane plane;         ///< of a discovered segment
  SurfaceSpread spread;       ///< of a discovered segment
  StructureKind structure = StructureKind::kNone;  ///< kNone = a thing

  bool discovered() const { return instance == InstanceId::kNone; }
  bool is_structure() const { return structure != StructureKind::kNone; }
  bool removed() const { return state == ObjectState::kRemoved; }
};

struct ObjectOptions {
  Eigen::Vector3d up_W = Eigen::Vector3d::UnitZ();  ///< unit; third axis of the boxes
  bool up_is_guess = false;                         ///< the surface may know better, see LevelUp
  int min_instance_points = 10;     ///< instances with fewer surface vertices are left out
  int min_discovered_points = 100;  ///< the same for segments without an instance
  /// Segments without an instance that are no structure either are things only if so many frames
  /// saw them: one or two may be wrong in the same way ...
  int min_discovered_frames = 3;
  double min_discovered_area = 0.01;  ///< ... with at least so much surface [m^2] ...
  /// ... that is at least this part of what they span (SpannedArea): less are shreds along the rims
  /// of things, or specks that noise has scattered over a wall. A plate's is 1, a body's is more.
  double min_discovered_fill = 0.3;
  /// Removed: less surface is left [points] than this part of what was seen empty since the object
  /// was last seen [voxels], which is at least as much as the two numbers above ask for. 0 = never.
  double removed_max_rest = 0.5;
  int removed_max_count = 100;  ///< of what was removed, the last so many are listed
  /// What was found gone longer before the newest frame is not listed; 0 = for ever [s].
  double removed_max_age = 7 * 86400;
  double box_outliers = 0.01;   ///< share of the points that a box may leave outside per axis
  double part_gap = 0.05;       ///< parts of an object farther from it than this [m] ...
  double min_part_share = 0.1;  ///< ... with less than this share of it are not in its box
  StructureOptions structure{};
};

/// Instances in ascending order, then discovered segments in ascending order; then what was
/// removed, in the same order: with class, history and what is left of the surface, without box.
/// Segments without any label are nobody's. `mesh` is the mesh of this map (ExtractMesh), from
/// which the surface is read.
///
/// The class of an instance is the argmax over classes of sum over its labels of Psi(l, c) times
/// vertices of l (ALGORITHM 4.6), ties to the lower class. The score is the product of: the share
/// of frames with a detector in which the instance was confirmed (mean over vertices), the share of
/// the class in the evidence, and n / (n + 1) for n confirmations.
std::vector<ObjectSummary> SummarizeObjects(const SemanticMap& map, const Mesh& mesh,
                                            const ObjectOptions& options = {});

/// The same with a mesh of its own, made with default options.
std::vector<ObjectSummary> SummarizeObjects(const SemanticMap& map,
                                            const ObjectOptions& options = {});

}  // namespace vismap
