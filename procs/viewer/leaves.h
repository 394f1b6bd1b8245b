#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>
#include <vismap/map_request_t.hpp>

#include "base/result.h"
#include "viewer/http_rules.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Which leaves: those of an octree that a plane across one axis of W cuts.
struct LeafQuestion {
  int axis = 2;     ///< 0, 1, 2 = x, y, z
  double at_m = 0;  ///< where on this axis
  bool closed = false;
  double inflate_m = 0;  ///< of a closed tree: radius of a robot
};
/// Arguments axis=x|y|z, at=METRES and, optional, layer=raw|closed|inflated and, for the last one,
/// radius=METRES.
Result<LeafQuestion> ReadLeafQuestion(const HttpTarget& target);
/// The request for the whole tree to the octomap exporter.
map_request_t TreeRequest(const LeafQuestion& question);

struct TreeLeaf {
  std::array<double, 3> center_W;  ///< [m]
  double size_m = 0;
  bool occupied = false;  ///< else free
};
struct LeafCut {
  double leaf_m = 0;             ///< edge of the smallest leaf
  std::vector<TreeLeaf> leaves;  ///< the largest first
  size_t left_out = 0;           ///< smaller ones, beyond the limit
};
inline constexpr size_t kMostCutLeaves = 20000;
/// The leaves of a `.bt` stream that the plane cuts; one on a face between two leaves cuts the
/// upper one. Fails as CheckOctree.
Result<LeafCut> CutLeaves(std::span<const uint8_t> tree, int axis, double at_m,
                          size_t most = kMostCutLeaves);
/// {"map_id": ..., "revision": ..., "leaf_m": ..., "left_out": ..., "leaves": [[x, y, z, size_m,
/// 1 free or 2 occupied], ...]}
std::string LeavesText(const LeafCut& cut, const FollowerPosition& position);

}  // namespace vismap
