#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <vismap/map_request_t.hpp>

#include "base/result.h"
#include "freespace/octree.h"
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

/// Answers GET /api/leaves from the newest octree that a page asked for, so that a slider that
/// moves does not ask for it again. The tree is checked once, when it comes. All pages together get
/// at most 10 cuts per second, fewer of a tree of more than 2 MB.
class LeafAnswers {
 public:
  static constexpr double kMostPerSecond = 10;
  static constexpr double kBytesPerToken = 2e6;  ///< of a tree that is checked or cut
  static constexpr double kKept = 2;             ///< [s] also when the map has changed

  /// `kept`: how long a tree is kept also when the map has changed [s].
  explicit LeafAnswers(double kept = kKept) : kept_(kept) {}

  /// Whether the tree that is here answers the question about this map. `now` is MonotonicSeconds,
  /// here and below.
  bool Keeps(const LeafQuestion& question, const FollowerPosition& map, double now) const;
  /// Whether a cut is allowed now; else the answer is Refusal().
  bool MayCut(double now);
  static HttpAnswer Refusal();
  /// Cuts the tree that is here.
  HttpAnswer Cut(const LeafQuestion& question, double now);
  /// Keeps the tree that has come for the question, and cuts it. One that several questions asked
  /// for together is checked for the first of them only. 504 when CheckOctree fails.
  HttpAnswer Take(const LeafQuestion& question, const FollowerPosition& position,
                  std::span<const uint8_t> tree, double now);

 private:
  bool IsOf(const LeafQuestion& question) const;
  void Refill(double now);
  void Pay(size_t bytes);
  HttpAnswer CutKept(const LeafQuestion& question);

  double kept_;
  std::optional<OctreeStreamInfo> info_;  // nullopt = no tree is here
  bool closed_ = false;
  double inflate_m_ = 0;
  FollowerPosition position_;
  std::vector<uint8_t> tree_;
  double until_ = 0;                             // MonotonicSeconds
  double tokens_ = kMostPerSecond, filled_ = 0;  // below 0 after a large tree
};

}  // namespace vismap
