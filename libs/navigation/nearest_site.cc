#include <algorithm>
#include <cmath>

#include "base/require.h"
#include "navigation/site_field.h"

namespace vismap {

// Finds the site nearest to a point. What the field keeps says how near the sites of a plane or of
// a row can be at most, so that nearly all of them are passed over.
class SiteField::Search {
 public:
  Search(const SiteField& field, const Eigen::Vector3d& p, double limit)
      : field_(field),
        p_(p),
        leaf_{Floor(p.x()), Floor(p.y()), Floor(p.z())},
        within_(p.x() - leaf_.x - 0.5, p.y() - leaf_.y - 0.5, p.z() - leaf_.z - 0.5),
        most_squared_(limit * limit),
        rows_(field.rows_),
        planes_(field.planes_),
        sites_(field.sites_) {
    // The nearest site is at most as far as it is from the centre of the leaf, and the way there.
    const uint16_t from_centre = ValueIn(field.Find(BlockOf(leaf_)), leaf_);
    if (from_centre == kBeyond) return;
    const double reachable = std::sqrt(from_centre) / 2 + within_.norm() + 1e-6;
    most_squared_ = std::min(most_squared_, reachable * reachable);
  }

  std::optional<NearestSite> Run() {
    SpreadOut(within_.z(), 0, [&](int k, double gap2) { SearchPlane(leaf_.z + k, gap2); });
    if (!found_) return std::nullopt;
    NearestSite nearest;
    const Eigen::Vector3d low(site_.x, site_.y, site_.z);
    nearest.at = p_.cwiseMax(low).cwiseMin(low + Eigen::Vector3d::Ones());
    nearest.distance = (p_ - nearest.at).norm();
    return nearest;
  }

 private:
  static int32_t Floor(double x) { return static_cast<int32_t>(std::floor(x)); }
  uint16_t ValueIn(const Distances* values, VoxelIndex leaf) const {
    return values == nullptr ? field_.outside_value_
                             : (*values)[static_cast<size_t>(OffsetInBlock(leaf))];
  }

  // Calls `visit(k, gap2)` for k = 0, 1, -1, 2, ... leaves along an axis, with the squared distance
  // across up to the box of those leaves, as long as something there can be near enough.
  template <typename Visit>
  void SpreadOut(double within, double gap2_so_far, const Visit& visit) {
    visit(0, gap2_so_far);
    for (int k = 1;; ++k) {
      const double up = k - 0.5 - within, down = k - 0.5 + within;
      const double up2 = gap2_so_far + up * up, down2 = gap2_so_far + down * down;
      if (up2 >= most_squared_ && down2 >= most_squared_) return;
      if (up2 < most_squared_) visit(k, up2);
      if (down2 < most_squared_) visit(-k, down2);
    }
  }

  void SearchPlane(int32_t z, double gap2) {
    const VoxelIndex leaf{leaf_.x, leaf_.y, z};
    const auto* found = planes_.Find(BlockOf(leaf));
    const uint16_t plane = ValueIn(found != nullptr ? found->get() : nullptr, leaf);
    if (plane == kBeyond) return;
    const double least = std::sqrt(plane) / 2 - within_.head<2>().norm();
    if (gap2 + std::max(0.0, least) * std::max(0.0, least) >= most_squared_) return;
    SpreadOut(within_.y(), gap2, [&](int k, double row_gap2) {
      SearchRow({leaf_.x, leaf_.y + k, z}, row_gap2);
    });
  }

  void SearchRow(VoxelIndex leaf, double gap2) {
    const auto* found = rows_.Find(BlockOf(leaf));
    const int row = found != nullptr ? (**found)[static_cast<size_t>(OffsetInBlock(leaf))]
                                     : field_.outside_row_;
    if (row == kNoneInRow) return;
    if (row == 0) return Take(leaf, gap2);
    const double right = row - 0.5 - within_.x(), left = row - 0.5 + within_.x();
    for (const auto& [x, gap] : {std::pair{leaf.x + row, right}, std::pair{leaf.x - row, left}}) {
      const double squared = gap2 + gap * gap;
      if (squared < most_squared_ && IsSite({x, leaf.y, leaf.z}))
        Take({x, leaf.y, leaf.z}, squared);
    }
  }

  bool IsSite(VoxelIndex leaf) {
    const VoxelBits* found = sites_.Find(BlockOf(leaf));
    const VoxelBits& bits = found != nullptr ? *found : field_.outside_sites_;
    const int offset = OffsetInBlock(leaf);
    return ((bits[static_cast<size_t>(offset / 64)] >> (offset % 64)) & 1) != 0;
  }

  void Take(VoxelIndex site, double squared) {
    if (squared >= most_squared_) return;
    most_squared_ = squared;
    site_ = site;
    found_ = true;
  }

  const SiteField& field_;
  const Eigen::Vector3d& p_;
  VoxelIndex leaf_;         // that the point is in
  Eigen::Vector3d within_;  // the point from the centre of its leaf, each within 0.5 [leaves]
  double most_squared_;     // only what is nearer counts
  Level<RowDistances>::Reader rows_;
  Level<Distances>::Reader planes_;
  BlockTable<VoxelBits>::Reader sites_;
  VoxelIndex site_;
  bool found_ = false;
};

std::optional<NearestSite> SiteField::Nearest(const Eigen::Vector3d& p, double limit) const {
  Require(2 * (limit + 1) <= std::sqrt(most_) + 1e-5,
          "a search ends one leaf before the largest distance of its field");
  return Search(*this, p, limit).Run();
}

}  // namespace vismap
