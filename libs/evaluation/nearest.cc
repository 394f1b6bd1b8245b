#include "evaluation/nearest.h"

#include <cmath>
#include <limits>
#include <nanoflann.hpp>

namespace vismap {
namespace {

// Collects the neighbours that a search finds, ordered by distance and then by index. The library
// only offers points that are strictly nearer than worstDist(). So that ties do not depend on the
// order of its tree, worstDist() is the next larger number than the distance of the last neighbour.
class TiedResults {
 public:
  using DistanceType = double;

  TiedResults(size_t capacity, std::vector<Neighbour>* found) : capacity_(capacity), found_(found) {
    found_->clear();
  }
  bool full() const { return found_->size() == capacity_; }
  size_t size() const { return found_->size(); }
  double worstDist() const {
    if (!full()) return std::numeric_limits<double>::max();
    return std::nextafter(found_->back().distance, std::numeric_limits<double>::max());
  }
  bool addPoint(double square, size_t index) {
    const auto before = [&](const Neighbour& n) {
      return n.distance < square || (n.distance == square && n.index < index);
    };
    size_t at = found_->size();
    while (at > 0 && !before((*found_)[at - 1])) --at;
    found_->insert(found_->begin() + static_cast<std::ptrdiff_t>(at), {index, square});
    if (found_->size() > capacity_) found_->pop_back();
    return true;
  }

 private:
  size_t capacity_;
  std::vector<Neighbour>* found_;
};

}  // namespace

struct NearestPoints::Tree {
  struct Cloud {
    std::vector<Eigen::Vector3d> points;
    size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(size_t i, size_t axis) const { return points[i][static_cast<int>(axis)]; }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>,
                                                    Cloud, 3, size_t>;
  explicit Tree(std::vector<Eigen::Vector3d> points)
      : cloud{std::move(points)}, index(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}

  Cloud cloud;
  Index index;
};

NearestPoints::NearestPoints(std::vector<Eigen::Vector3d> points)
    : tree_(points.empty() ? nullptr : std::make_unique<Tree>(std::move(points))) {}

NearestPoints::~NearestPoints() = default;

std::vector<Neighbour> NearestPoints::Nearest(const Eigen::Vector3d& p, size_t count) const {
  std::vector<Neighbour> found;
  if (tree_ == nullptr || count == 0) return found;
  found.reserve(count + 1);
  TiedResults results(count, &found);
  tree_->index.findNeighbors(results, p.data(), nanoflann::SearchParams());
  for (Neighbour& neighbour : found) neighbour.distance = std::sqrt(neighbour.distance);
  return found;
}

std::optional<Neighbour> NearestPoints::Nearest(const Eigen::Vector3d& p) const {
  const std::vector<Neighbour> found = Nearest(p, 1);
  return found.empty() ? std::nullopt : std::optional(found.front());
}

}  // namespace vismap
