#pragma once

#include <octomap/octomap.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "geometry/frame.h"
#include "geometry/noise_model.h"

namespace vismap::testing_support {

/// The space that depth cameras saw.
class SeenSpace {
 public:
  /// `depth` as it was measured [m], at the true pose.
  void Add(const FrameHeader& header, Image<float> depth) {
    views_.push_back({header.camera, header.T_W_C.inverse(), std::move(depth)});
  }

  /// Where the body of the robot was nothing else is: within `radius` of these positions [m]. With
  /// a tolerance it may reach `slack` farther, see CoveredUnknownLeaves.
  void AddBody(std::vector<Eigen::Vector3d> path_W, double radius, double slack) {
    path_W_ = std::move(path_W);
    body_radius_ = radius;
    body_slack_ = slack;
  }

  /// Whether a frame measured depth behind the point, within 5 m, or the body was there. With a
  /// `tolerance` [m] the first counts, too, for rays that pass so near, and for depth that ends so
  /// far before the point, or by three standard deviations of the depth.
  bool Contains(const Eigen::Vector3d& p_W, double tolerance) const {
    const double reach = body_radius_ + (tolerance > 0 ? body_slack_ : 0);
    return std::any_of(views_.begin(), views_.end(),
                       [&](const View& view) { return IsSeen(view, p_W, tolerance); }) ||
           std::any_of(path_W_.begin(), path_W_.end(), [&](const Eigen::Vector3d& place_W) {
             return (place_W - p_W).norm() <= reach;
           });
  }

 private:
  struct View {
    PinholeCamera camera;
    Pose T_C_W;
    Image<float> depth;
  };

  static bool IsSeen(const View& view, const Eigen::Vector3d& p_W, double tolerance) {
    const Eigen::Vector3d p_C = view.T_C_W * p_W;
    if (p_C.z() < 0.1 || p_C.z() > 5 + tolerance) return false;
    const Eigen::Vector2d pixel = view.camera.Project(p_C);
    const int reach = static_cast<int>(std::ceil(tolerance * view.camera.fx / p_C.z()));
    const double slack = tolerance > 0 ? tolerance + 3 * KinectNoise().AxialSigma(p_C.z()) : 0;
    const int u = static_cast<int>(std::lround(pixel.x()));
    const int v = static_cast<int>(std::lround(pixel.y()));
    const int step = std::max(reach / 2, 1);
    for (int j = v - reach; j <= v + reach; j += step) {
      for (int i = u - reach; i <= u + reach; i += step) {
        if (view.depth.Contains(j, i) && double{view.depth(j, i)} > p_C.z() - slack) return true;
      }
    }
    return false;
  }

  std::vector<View> views_;
  std::vector<Eigen::Vector3d> path_W_;
  double body_radius_ = 0, body_slack_ = 0;
};

/// What is true of a scene.
struct PlannerTruth {
  std::function<double(const Eigen::Vector3d& p_W)> distance;  ///< to the nearest surface [m]
  SeenSpace seen;
  double tolerance = 0.04;  ///< of what counts as seen [m]
};

/// What space without a leaf is taken for. Collision checkers like FCL take it for free.
enum class AbsentLeaves { kFree, kOccupied };

/// Whether all leaves that a sphere touches are free.
inline bool IsSphereFree(const octomap::OcTree& tree, const Eigen::Vector3d& p_W, double radius,
                         AbsentLeaves absent) {
  const double r = tree.getResolution();
  const Eigen::Array3i low = ((p_W.array() - radius) / r).floor().cast<int>();
  const Eigen::Array3i high = ((p_W.array() + radius) / r).floor().cast<int>();
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) {
        const Eigen::Array3d corner = r * Eigen::Array3d(x, y, z);
        const Eigen::Array3d nearest = p_W.array().max(corner).min(corner + r);
        if ((nearest - p_W.array()).matrix().norm() > radius) continue;
        const Eigen::Array3d center = corner + r / 2;
        const octomap::OcTreeNode* node = tree.search(center.x(), center.y(), center.z());
        if (node == nullptr ? absent == AbsentLeaves::kOccupied : tree.isNodeOccupied(node))
          return false;
      }
    }
  }
  return true;
}

/// The centre of a sphere, and points in it and on it, evenly.
inline std::vector<Eigen::Vector3d> PointsOfSphere(const Eigen::Vector3d& center, double radius) {
  constexpr int kDirections = 24;
  std::vector<Eigen::Vector3d> points{center};
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * i + 1.0) / kDirections, angle = 2.399963 * i;
    const double across = std::sqrt(1 - z * z);
    const Eigen::Vector3d direction(across * std::cos(angle), across * std::sin(angle), z);
    points.push_back(center + radius * direction);
    points.push_back(center + 0.5 * radius * direction);
  }
  return points;
}

/// What a tree says of spheres drawn at random.
struct StateScore {
  int drawn = 0;
  int called_free = 0;
  int colliding = 0;  ///< called free, but nearer to a surface than the radius
  int unseen = 0;     ///< called free, but partly in space that no camera saw
  int usable = 0;     ///< safe in truth: no surface within the radius, and all of it seen
  int usable_called_free = 0;
  double usable_share() const {
    return usable > 0 ? static_cast<double>(usable_called_free) / usable : 0;
  }
};

/// Draws the centres of `count` spheres evenly within `bounds_W`.
inline std::vector<Eigen::Vector3d> DrawCenters(const Eigen::AlignedBox3d& bounds_W, int count) {
  std::mt19937_64 random(19);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Eigen::Vector3d> centers;
  for (int i = 0; i < count; ++i) {
    const double x = unit(random), y = unit(random), z = unit(random);
    centers.push_back(bounds_W.min() +
                      (bounds_W.sizes().array() * Eigen::Array3d(x, y, z)).matrix());
  }
  return centers;
}

/// Whether all of a sphere was seen, see SeenSpace::Contains.
inline bool IsAllSeen(const PlannerTruth& truth, const Eigen::Vector3d& center, double radius,
                      double tolerance) {
  const std::vector<Eigen::Vector3d> points = PointsOfSphere(center, radius);
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& p_W) {
    return truth.seen.Contains(p_W, tolerance);
  });
}

/// Draws `count` spheres evenly within `bounds_W`.
inline StateScore ScoreStates(const octomap::OcTree& tree, const PlannerTruth& truth,
                              const Eigen::AlignedBox3d& bounds_W, int count, double radius,
                              AbsentLeaves absent) {
  const std::vector<Eigen::Vector3d> centers = DrawCenters(bounds_W, count);
  std::vector<StateScore> scores(centers.size());
  ParallelFor(centers.size(), 64, [&](size_t i) {
    StateScore& score = scores[i];
    const bool free = IsSphereFree(tree, centers[i], radius, absent);
    const bool clear = truth.distance(centers[i]) >= radius;
    score.called_free = free;
    score.colliding = free && !clear;
    score.unseen = free && !IsAllSeen(truth, centers[i], radius, truth.tolerance);
    score.usable = clear && IsAllSeen(truth, centers[i], radius, 0);
    score.usable_called_free = score.usable && free;
  });
  StateScore sum{.drawn = count};
  for (const StateScore& score : scores) {
    sum.called_free += score.called_free;
    sum.colliding += score.colliding;
    sum.unseen += score.unseen;
    sum.usable += score.usable;
    sum.usable_called_free += score.usable_called_free;
  }
  return sum;
}

/// The box around the free leaves of a tree [m].
inline Eigen::AlignedBox3d BoundsOfFree(const octomap::OcTree& tree) {
  Eigen::AlignedBox3d box;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (tree.isNodeOccupied(*leaf)) continue;
    const Eigen::Vector3d center(leaf.getX(), leaf.getY(), leaf.getZ());
    box.extend((center.array() - leaf.getSize() / 2).matrix().eval());
    box.extend((center.array() + leaf.getSize() / 2).matrix().eval());
  }
  return box;
}

inline Eigen::AlignedBox3d Wider(const Eigen::AlignedBox3d& box, double by) {
  return {(box.min().array() - by).matrix().eval(), (box.max().array() + by).matrix().eval()};
}

/// Free leaves that reach into what is solid.
struct FalseFree {
  int64_t free = 0;   ///< leaves of the smallest size
  int64_t cells = 0;  ///< of these, with a point more than a millimetre inside something
  double worst = 0;   ///< how far inside [m]
};

/// `distance`: signed, negative inside [m].
inline FalseFree CountFalseFree(const octomap::OcTree& tree,
                                const std::function<double(const Eigen::Vector3d&)>& distance) {
  constexpr int kSamples = 6;  // along each edge
  const double r = tree.getResolution();
  std::vector<Eigen::Vector3d> corners;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (tree.isNodeOccupied(*leaf)) continue;
    const int side = static_cast<int>(std::lround(leaf.getSize() / r));
    const Eigen::Vector3d low =
        Eigen::Vector3d(leaf.getX(), leaf.getY(), leaf.getZ()).array() - leaf.getSize() / 2;
    for (int x = 0; x < side; ++x) {
      for (int y = 0; y < side; ++y) {
        for (int z = 0; z < side; ++z) corners.push_back(low + r * Eigen::Vector3d(x, y, z));
      }
    }
  }
  std::vector<double> deepest(corners.size(), 0);
  ParallelFor(corners.size(), 256, [&](size_t i) {
    if (distance((corners[i].array() + r / 2).matrix()) > r) return;  // nothing is near
    for (int x = 0; x < kSamples; ++x) {
      for (int y = 0; y < kSamples; ++y) {
        for (int z = 0; z < kSamples; ++z) {
          const Eigen::Vector3d p = corners[i] + r / (kSamples - 1) * Eigen::Vector3d(x, y, z);
          deepest[i] = std::max(deepest[i], -distance(p));
        }
      }
    }
  });
  FalseFree result{.free = static_cast<int64_t>(corners.size())};
  for (const double depth : deepest) {
    result.cells += depth > 0.001 ? 1 : 0;
    result.worst = std::max(result.worst, depth);
  }
  return result;
}

inline void Print(const std::string& name, const FalseFree& cells, const StateScore& states) {
  std::printf(
      "%-28s %8ld free leaves, %5ld false (worst %4.1f cm); of %d states %5d called free, "
      "%3d collide, %3d unseen; %.1f %% of %d usable\n",
      name.c_str(), static_cast<long>(cells.free), static_cast<long>(cells.cells),
      100 * cells.worst, states.drawn, states.called_free, states.colliding, states.unseen,
      100 * states.usable_share(), states.usable);
}

}  // namespace vismap::testing_support
