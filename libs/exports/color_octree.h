#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "map/semantic_map.h"

namespace vismap {

/// OctoMap's ColorOcTree (`.ot`) with the leaves of an OcTree (`.bt`) of this map: occupied leaves
/// have the colour that most of their voxels with votes have in a picture of classes (VertexColor),
/// kUnsegmentedColor without any. Free leaves have no colour. It is for looking: eight occupied
/// leaves of different colours are not merged, so that it is larger than the tree for planners.
/// Fails on bytes that are no octree, and on leaves that are no multiple of the voxels.
Result<std::vector<uint8_t>> ColorOctree(std::span<const uint8_t> octree, const SemanticMap& map);

}  // namespace vismap
