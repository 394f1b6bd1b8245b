#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/enum_names.h"
#include "base/result.h"
#include "freespace/occupancy_map.h"
#include "navigation/site_field.h"

namespace vismap {

struct DistanceOptions {
  /// Distances are exact up to here [m]; more than 0, at most kMostDistanceLeaves leaves.
  double limit_m = 2.0;
};

/// The largest limit [leaves].
inline constexpr int kMostDistanceLeaves = kMostHalfLeaves / 2 - 1;

/// What is nearest to a point.
enum class NearestThing : uint8_t {
  kNone = 0,      ///< neither is within the limit
  kObstacle = 1,  ///< an occupied leaf
  kUnknown = 2,   ///< an unknown leaf, or space outside of the map
};

inline constexpr auto NamesOf(NearestThing) {
  return std::to_array<EnumName<NearestThing>>({{"NONE", NearestThing::kNone},
                                                {"OBSTACLE", NearestThing::kObstacle},
                                                {"UNKNOWN", NearestThing::kUnknown}});
}

/// The distance from a point to the box of the nearest leaf of some kind.
struct Clearance {
  double distance_m = 0;  ///< exact; the limit when nothing is within it [m]
  /// Unit vector in W away from the nearest point of that box: the gradient of the distance. Zero
  /// where the distance is 0 or the limit.
  Eigen::Vector3d away_W = Eigen::Vector3d::Zero();
  NearestThing nearest = NearestThing::kNone;
};

/// Squared distances from the centres of the leaves of a block to the nearest faces, in half leaves
/// squared, by linear index (LinearIndex): the distance [m] is sqrt(value) * leaf / 2. kBeyond =
/// more than the limit.
struct BlockDistances {
  std::array<uint16_t, kBlockVoxels> obstacle{};
  std::array<uint16_t, kBlockVoxels> unknown{};
  friend bool operator==(const BlockDistances&, const BlockDistances&) = default;
};

/// Euclidean distances to the nearest occupied leaf and to the nearest unknown leaf of a map, to
/// the faces of leaves and not to their centres, exact up to a limit. All space outside of the
/// map's blocks is unknown. Updated with the changes of the map; takes about 12 bytes per leaf
/// of blocks that are not unknown everywhere. Several threads may read at the same time; nothing
/// may read during Update.
class DistanceField {
 public:
  /// `leaf_m`: edge of a leaf [m]. Fails on a limit that is out of range; the Error names the key
  /// octomap_exporter.distance_limit_m.
  static Result<DistanceField> Make(double leaf_m, const DistanceOptions& options);

  double leaf_m() const { return leaf_m_; }
  double limit_m() const { return limit_m_; }

  /// Must be called with the blocks of `leaves` that may have changed since the last call. Returns
  /// the blocks whose distances may have changed, ascending. The field is equal to one that has
  /// seen only the last state. Throws std::logic_error when `leaves` has leaves of another size.
  std::vector<BlockIndex> Update(const OccupancyMap& leaves, std::span<const BlockIndex> changed);

  /// The distances at the centres of a block's leaves; nullopt for a block that is unknown
  /// everywhere.
  std::optional<BlockDistances> At(BlockIndex index) const;
  /// All blocks that At has distances of, ascending.
  std::vector<BlockIndex> SortedIndices() const { return leaves_.SortedIndices(); }

  /// Clearance of a point [m], from occupied leaves. 0, with nearest = kUnknown, in a block that is
  /// unknown everywhere, and for a point that is not finite.
  Clearance FromObstacle(const Eigen::Vector3d& p_W) const;
  /// Clearance from unknown leaves. 0 outside of the map.
  Clearance FromUnknown(const Eigen::Vector3d& p_W) const;
  /// The smaller of the two; when they are equal, from the obstacle.
  Clearance From(const Eigen::Vector3d& p_W) const;

  /// Memory of the field [bytes], about.
  size_t bytes() const;

 private:
  DistanceField(double leaf_m, const DistanceOptions& options);
  bool InMap(const Eigen::Vector3d& p) const;
  Clearance ClearanceFrom(const SiteField& field, NearestThing thing,
                          const Eigen::Vector3d& p_W) const;

  double leaf_m_ = 0;
  double limit_m_ = 0;
  uint16_t most_ = 0;                  // square of the limit, in half leaves
  BlockTable<BlockOccupancy> leaves_;  // as at the last Update
  SiteField obstacles_;
  SiteField unknown_;
};

}  // namespace vismap
