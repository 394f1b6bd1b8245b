#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

namespace vismap {

/// A point of an index, and how far it is [m].
struct Neighbour {
  size_t index = 0;
  double distance = 0;
};

/// Nearest points by kd-tree. Ties go to the lower index. Safe to ask from several threads.
class NearestPoints {
 public:
  explicit NearestPoints(std::vector<Eigen::Vector3d> points);
  ~NearestPoints();
  NearestPoints(const NearestPoints&) = delete;
  NearestPoints& operator=(const NearestPoints&) = delete;

  /// The nearest `count` points, near ones first; fewer when there are fewer.
  std::vector<Neighbour> Nearest(const Eigen::Vector3d& p, size_t count) const;
  /// The nearest point; none when there are no points.
  std::optional<Neighbour> Nearest(const Eigen::Vector3d& p) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace vismap
