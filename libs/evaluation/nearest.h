#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

namespace vismap {

/// The index of a point, and its distance [m].
struct Neighbour {
  size_t index = 0;
  double distance = 0;
};

/// Finds nearest points with a kd-tree. Ties go to the lower index. Several threads may search at
/// once.
class NearestPoints {
 public:
  explicit NearestPoints(std::vector<Eigen::Vector3d> points);
  ~NearestPoints();
  NearestPoints(const NearestPoints&) = delete;
  NearestPoints& operator=(const NearestPoints&) = delete;

  /// The nearest `count` points, nearest first; fewer if there are fewer points.
  std::vector<Neighbour> Nearest(const Eigen::Vector3d& p, size_t count) const;
  /// The nearest point; none if there are no points.
  std::optional<Neighbour> Nearest(const Eigen::Vector3d& p) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace vismap
