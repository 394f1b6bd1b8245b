#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "map/block_table.h"
#include "navigation/distance_kernels.h"

namespace vismap {

struct SiteFieldOptions {
  int most_half_leaves = 0;      ///< larger distances are kBeyond, 1..kMostHalfLeaves [half leaves]
  bool outside_is_site = false;  ///< whether leaves of blocks that were never set are sites
};

/// The sites of a block, from now on.
struct SiteChange {
  BlockIndex index;
  VoxelBits sites{};
  bool known = false;  ///< whether distances in this block are wanted
};

/// The site nearest to a point.
struct NearestSite {
  double distance = 0;                           ///< to its box [leaves]; 0 = the point is in it
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< the nearest point of its box [leaves]
};

/// Exact distances from the centres of leaves to the nearest faces of sites, which are leaves of
/// one kind: with d = offset of a site in leaves along an axis, the sum over the axes of
/// max(0, 2 |d| - 1)^2, in half leaves squared. They are found along x, then y, then z, and the
/// results of each step are kept; so after a change, only lines are computed again whose input
/// changed in a way that can matter, and a change goes no farther than results differ. Takes about
/// 6 bytes per leaf of a block with values.
class SiteField {
 public:
  using Distances = std::array<uint16_t, kBlockVoxels>;

  /// Along which a step goes through planes of leaves.
  enum class Axis { kY, kZ };

  explicit SiteField(const SiteFieldOptions& options);

  /// Takes over changed blocks, each at most once, and returns the blocks whose distances changed,
  /// ascending. The distances are those of a field that has seen only the last state.
  std::vector<BlockIndex> Update(std::span<const SiteChange> changes);

  /// The distances in a block that is known; nullptr = all are outside_value().
  const Distances* Find(BlockIndex index) const;
  /// The distance in blocks without values: 0 when outside is a site, else kBeyond.
  uint16_t outside_value() const { return outside_value_; }

  /// The site nearest to a point [leaves] in a block that is known; nullopt when none is nearer
  /// than `limit` [leaves], which must be at least one leaf below the largest distance.
  std::optional<NearestSite> Nearest(const Eigen::Vector3d& p, double limit) const;

  /// Memory of the field [bytes], about.
  size_t bytes() const;

 private:
  using RowDistances = std::array<uint8_t, kBlockVoxels>;  // along x [leaves], or kNoneInRow
  template <typename Values>
  using Level = BlockTable<std::unique_ptr<Values>>;
  /// Which changes a step left in a block, for the 64 lines of the next step: the least of all
  /// values before and after, kBeyond where nothing changed.
  using Touched = std::array<uint16_t, kBlockVoxels / kBlockSide>;
  using TouchedBlocks = BlockTable<std::unique_ptr<Touched>>;
  /// For whom a block's values are computed: distances at known leaves need planes above and below
  /// them, and these need rows beside them.
  struct Users {
    uint8_t rows = 0;    // blocks with planes that need its rows
    uint8_t planes = 0;  // known blocks that need its planes
    bool known = false;
  };
  struct Work;
  struct RowTask;
  struct LineTask;
  class RowStep;
  template <Axis kAxis>
  class LineStep;
  class Search;

  bool WantsRows(BlockIndex index) const;
  bool WantsPlanes(BlockIndex index) const;
  bool WantsDistances(BlockIndex index) const;
  bool HasOtherThanSites(BlockIndex index) const;
  const VoxelBits& SitesIn(BlockIndex index) const;

  void TakeChanges(std::span<const SiteChange> changes, Work* work);
  void SetSites(const SiteChange& change, Work* work);
  void SetKnown(BlockIndex index, bool known, Work* work);
  void UsePlanes(BlockIndex index, int more, Work* work);
  void UseRows(BlockIndex index, int more, Work* work);

  std::vector<RowTask> FindRowTasks(const Work& work) const;
  void SpreadAlongRows(BlockIndex index, uint64_t rows, const Work& work,
                       BlockTable<uint64_t>* tasks) const;
  TouchedBlocks UpdateRows(const Work& work);

  template <Axis kAxis>
  std::vector<LineTask> FindLineTasks(const TouchedBlocks& touched,
                                      std::span<const BlockIndex> fresh) const;
  template <Axis kAxis>
  TouchedBlocks UpdateLines(const TouchedBlocks& touched, std::span<const BlockIndex> fresh,
                            std::vector<BlockIndex>* changed);

  uint16_t most_ = 0;  // the largest distance, squared
  int window_ = 0;     // leaves along a line that can matter
  int reach_ = 0;      // blocks along a line that can matter
  bool outside_is_site_ = false;
  uint16_t outside_value_ = kBeyond;
  uint8_t outside_row_ = kNoneInRow;
  VoxelBits outside_sites_{};
  std::array<uint16_t, kMostHalfLeaves> cost_{};  // by leaves along the line

  BlockTable<VoxelBits> sites_;  // of blocks that differ from outside_sites_
  BlockTable<Users> users_;      // only when outside is no site
  Level<RowDistances> rows_;     // blocks in which all values are those outside are left out
  Level<Distances> planes_;      // the least along y of the rows
  Level<Distances> distances_;   // the least along z of the planes
};

}  // namespace vismap
