#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "meshing/marching_cubes.h"
#include "objects/camera_up.h"
#include "objects/oriented_box.h"
#include "objects/structure.h"

namespace vismap {

/// Whether an object is still where it was mapped.
enum class ObjectState : uint8_t {
  kPresent,
  kRemoved,  ///< its place was seen empty, and little or none of its surface is left
};

/// One object of the map as users see it: an instance, whose class a detector has found, or a
/// discovered segment, which has no instance, with those that are parts of the same thing.
struct ObjectSummary {
  InstanceId instance = InstanceId::kNone;      ///< kNone = discovered
  std::vector<SegmentLabel> segments;           ///< ascending; parts of a discovered object
  ClassId class_id = ClassId::kUnknown;         ///< kUnknown = discovered
  std::map<ClassId, double> class_probability;  ///< sums to 1; empty = discovered
  double score = 0;     ///< [0, 1]: confidence that it is an object of this class; 0 = discovered
  int64_t points = 0;   ///< number of surface vertices
  double area = 0;      ///< area of its surface [m^2]
  OrientedBox box;      ///< of its main parts (MainParts), without outliers; unset if removed
  uint32_t frames = 0;  ///< number of frames that observed its most often observed segment
  int64_t first_utime = 0;  ///< time of the first frame that observed it [us]
  int64_t last_utime = 0;   ///< time of the last frame that observed it [us]
  ObjectState state = ObjectState::kPresent;
  int64_t removed_utime = 0;  ///< time of the last frame that saw its place empty [us]; 0 = present
  SurfacePlane plane;         ///< only of discovered segments
  SurfaceSpread spread;       ///< only of discovered segments
  StructureKind structure = StructureKind::kNone;  ///< kNone = not structure

  bool discovered() const { return instance == InstanceId::kNone; }
  bool is_structure() const { return structure != StructureKind::kNone; }
  bool removed() const { return state == ObjectState::kRemoved; }
};

/// The upward direction of a map, and how it is known.
struct UpDirection {
  Eigen::Vector3d up_W = Eigen::Vector3d::UnitZ();  ///< unit length
  std::string reason;                               ///< one phrase
};

struct ObjectOptions {
  Eigen::Vector3d up_W = Eigen::Vector3d::UnitZ();  ///< unit length; third axis of the boxes
  bool up_is_guess = false;         ///< up_W is that of `cameras`, which FindUp may correct
  CameraUp cameras{};               ///< what the poses say about the upward direction
  int min_instance_points = 10;     ///< instances with fewer vertices are not listed
  int min_discovered_points = 100;  ///< discovered segments with fewer vertices are not listed
  /// A discovered segment that is not structure is listed only if at least so many frames observed
  /// it, because one or two frames may have made the same error, ...
  int min_discovered_frames = 3;
  double min_discovered_area_m2 = 0.01;  ///< ... if it has at least this area [m^2] ...
  /// ... and if its area is at least this share of the area that it spans (SpannedArea). The share
  /// is 1 for a flat plate and larger for a solid body. It is small for strips along the borders of
  /// objects and for specks that noise has scattered over a wall.
  double min_discovered_fill = 0.3;
  /// An object was removed if, since it was last observed, at least min_instance_points (or
  /// min_discovered_points) voxels of its surface were seen empty, and its remaining vertices are
  /// fewer than this share of those voxels. 0 = objects are never removed.
  double removed_max_rest = 0.5;
  int removed_max_count = 100;  ///< only so many of the last removed objects are listed
  /// Objects that were removed longer ago than this, counted from the newest frame, are not listed
  /// [s]; 0 = no limit.
  double removed_max_age_s = 7 * 86400;
  double box_outliers = 0.01;   ///< share of the points outside of a box, per axis
  double part_gap_m = 0.05;     ///< parts that are farther than this from the rest [m] ...
  double min_part_share = 0.1;  ///< ... with less than this share of the points are not in its box
  /// Segments without instance that touch are parts of one thing if the border between them is at
  /// least this share of the border of one of them, see JoinParts; 0 = never.
  double min_part_contact = 0.15;
  double max_whole_size_m = 2.2;  ///< diagonal of the bounds of the largest thing of several parts
  /// Largest share of the border of such a thing that is with large surface that is no structure.
  double max_whole_leak = 0.25;
  StructureOptions structure{};
};

/// The objects of a map: instances, then discovered segments, then removed objects (instances
/// before segments), each group in ascending order. Removed objects have class, history and the
/// rest of their surface, but no box. Vertices without a segment belong to no object. `mesh` must
/// be the mesh of this map (ExtractMesh).
///
/// The class of an instance is argmax_c of the sum over its labels l of Psi(l, c) * vertices(l);
/// ties go to the lower class id. The score is the product of three numbers in [0, 1]: the evidence
/// for the instance per frame with a detector (mean over its vertices); the share of the class in
/// all class evidence; and n / (n + 1), where n is the largest Phi(l, instance) of its labels. See
/// libs/METHOD.md, Objects. `up` gets the upward direction that was found.
std::vector<ObjectSummary> SummarizeObjects(const SemanticMap& map, const Mesh& mesh,
                                            const ObjectOptions& options = {},
                                            UpDirection* up = nullptr);

/// The same for ExtractMesh(map) with default options.
std::vector<ObjectSummary> SummarizeObjects(const SemanticMap& map,
                                            const ObjectOptions& options = {});

/// Lets all parts of a discovered object show its first segment.
void ShowWholeObjects(const std::vector<ObjectSummary>& objects, Mesh* mesh);

}  // namespace vismap
