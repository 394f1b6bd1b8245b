#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/class_names.h"
#include "freespace/occupancy_map.h"
#include "mcap/foxglove_file.h"
#include "meshing/marching_cubes.h"
#include "render/palette.h"
#include "wire/grid_message.h"
#include "wire/object_list.h"

namespace vismap {

// The map as messages of Foxglove, all in the frame "world". Entities of a scene get the time
// `log_us` at which they were recorded, since deletions compare these times and the clock of a
// sequence may jump back.

/// Changes of a surface as foxglove.SceneUpdate. Each block is an entity with the id "i/j/k" and
/// the same triangles; one without triangles is deleted. `reset` deletes all earlier blocks.
FoxgloveMessage SurfaceMessage(std::span<const BlockMesh> changed, bool reset, Coloring coloring,
                               int64_t log_us);

/// A point of a cloud with the ids of what it belongs to.
struct CloudPoint {
  Eigen::Vector3f position_W = Eigen::Vector3f::Zero();
  Rgb8 color;
  SegmentLabel segment = SegmentLabel::kNone;
  InstanceId instance = InstanceId::kNone;
  ClassId class_id = ClassId::kUnknown;
  uint8_t seen = 0;  ///< number of frames, see MeshVertex
};

/// foxglove.PointCloud with x, y, z, red, green, blue, alpha, segment, instance, class and seen.
FoxgloveMessage SurfaceCloudMessage(std::span<const CloudPoint> points, int64_t utime);

/// All objects as foxglove.SceneUpdate, which replaces all earlier ones: each has the id "object
/// 7", or "discovered 12" with its segment, a box, a text, and its numbers as metadata. Removed
/// objects have no box and are left out.
FoxgloveMessage ObjectsMessage(const ObjectList& list, const ClassNamer& class_name,
                               int64_t log_us);

/// The cells of a map that have a state, as foxglove.PointCloud of their centres, with their edge
/// as the field `size`.
FoxgloveMessage CellsMessage(const OccupancyMap& map, CellState state, int64_t utime);

/// foxglove.Grid with red, green, blue, alpha, distance_m, floor_m and state (0 unknown, 1 free, 2
/// occupied), at the median height of the floor. The grid must have at least one cell.
FoxgloveMessage GroundGridMessage(const GridMessage& message);

}  // namespace vismap
