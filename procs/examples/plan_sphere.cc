// A planner to start from: waits for the free space of the map, plans the path of a sphere through
// it with OMPL (RRT*) and FCL, and prints it. Unknown space is an obstacle.
//
// Build it with the CMakeLists.txt beside it, then, while a vismap system runs:
//   ./plan_sphere START GOAL [RADIUS [SECONDS [URL]]] [--channel-prefix PREFIX]
//   ./plan_sphere 1.1,1.2,1.3 4.2,3.6,1.3 0.2 3 tcpq://127.0.0.1:7700
// START and GOAL are points x,y,z of the map [m]. Standard output has one line "x y z" for each
// point of the path. Exit codes: 0 there is a path, 1 there is none, 2 wrong usage.
#include <fcl/fcl.h>
#include <octomap/octomap.h>
#include <ompl/base/MotionValidator.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>
#include <vismap/navigation.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using Eigen::Vector3d;
using States = ob::RealVectorStateSpace::StateType;

constexpr double kWaitForTree = 10;  // [s]
constexpr double kMaxAge = 5;        // of a tree that is planned on [s]
constexpr double kLookAround = 1;    // clearances are searched up to here [m]

std::string Text(const Vector3d& p) {
  char text[96];
  std::snprintf(text, sizeof(text), "(%.2f, %.2f, %.2f)", p.x(), p.y(), p.z());
  return text;
}

std::string Metres(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f m", value);
  return text;
}

Vector3d PointOf(const ob::State* state) { return Vector3d(state->as<States>()->values); }

std::shared_ptr<octomap::OcTree> ReadTree(const vismap::octree_t& message) {
  std::istringstream stream(std::string(message.data.begin(), message.data.end()));
  auto tree = std::make_shared<octomap::OcTree>(message.resolution_m);
  if (!tree->readBinary(stream)) throw std::runtime_error("OctoMap cannot read the tree");
  return tree;
}

/// The space in which the sphere may be: where it touches no occupied leaf of a closed tree. FCL
/// takes everything outside of a tree for free, so the centre must stay within the known bounds,
/// around which the tree has a shell of occupied space.
class Space {
 public:
  Space(const vismap::octree_t& closed, double radius)
      : radius_(radius),
        bounds_(Vector3d(closed.bbx_min_W), Vector3d(closed.bbx_max_W)),
        tree_(ReadTree(closed)),
        object_(std::make_shared<fcl::OcTreed>(tree_)) {
    if (closed.shell_m < radius) {
      throw std::runtime_error("the shell of the tree is " + Metres(closed.shell_m) +
                               " thick, less than the radius; set octree.shell_m");
    }
  }

  const Eigen::AlignedBox3d& bounds() const { return bounds_; }

  bool IsFree(const Vector3d& p) const {
    const fcl::CollisionObjectd sphere(std::make_shared<fcl::Sphered>(radius_),
                                       Eigen::Quaterniond::Identity().toRotationMatrix(), p);
    return bounds_.contains(p) && !Collides(sphere);
  }

  /// Whether the sphere may move straight from a to b: it covers a capsule.
  bool IsFree(const Vector3d& a, const Vector3d& b) const {
    const double length = (b - a).norm();
    if (length < 1e-9) return IsFree(a);
    const auto along = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), b - a);
    const fcl::CollisionObjectd capsule(std::make_shared<fcl::Capsuled>(radius_, length),
                                        along.toRotationMatrix(), (a + b) / 2);
    return bounds_.contains(a) && bounds_.contains(b) && !Collides(capsule);
  }

  struct Obstacle {
    double distance = kLookAround;    ///< 0 inside of it [m]
    std::optional<Vector3d> nearest;  ///< a point of its leaf
  };

  /// The occupied leaf that is nearest to a point.
  Obstacle NearestObstacle(const Vector3d& p) const {
    Obstacle found;
    const auto corner = [&](double side) {
      const Vector3d at = p + Vector3d::Constant(side * kLookAround);
      return octomap::point3d(at.x(), at.y(), at.z());
    };
    for (auto leaf = tree_->begin_leafs_bbx(corner(-1), corner(1)); leaf != tree_->end_leafs_bbx();
         ++leaf) {
      if (!tree_->isNodeOccupied(*leaf)) continue;
      const Vector3d centre(leaf.getX(), leaf.getY(), leaf.getZ());
      const Vector3d half = Vector3d::Constant(leaf.getSize() / 2);
      const Vector3d nearest = p.cwiseMax(centre - half).cwiseMin(centre + half);
      const double distance = (nearest - p).norm();
      if (distance >= found.distance) continue;
      // A little inside of the leaf, so that the point belongs to it.
      found = {distance, nearest + 1e-3 * (centre - nearest)};
    }
    return found;
  }

  /// One sentence: why the sphere cannot be at a point. `raw` tells obstacles from unknown space.
  std::string WhyNot(const std::string& name, const Vector3d& p, const octomap::OcTree& raw) const {
    const std::string where = "the " + name + " " + Text(p);
    if (!bounds_.contains(p)) {
      return where + " is outside of the known space, which is from " + Text(bounds_.min()) +
             " to " + Text(bounds_.max());
    }
    const Obstacle obstacle = NearestObstacle(p);
    const Vector3d at = obstacle.nearest.value_or(p);
    const octomap::OcTreeNode* node = raw.search(at.x(), at.y(), at.z());
    const std::string what = node == nullptr ? "unknown space" : "an obstacle";
    const std::string advice =
        node == nullptr && name == "start"
            ? "; when the robot's own body hid it, see octomap_exporter.clear_start_m in the config"
            : "";
    if (obstacle.distance == 0) return where + " is in " + what + advice;
    return where + " is " + Metres(obstacle.distance) + " from " + what +
           ", nearer than the radius of " + Metres(radius_) + advice;
  }

 private:
  bool Collides(const fcl::CollisionObjectd& body) const {
    fcl::CollisionResultd result;
    return fcl::collide(&object_, &body, fcl::CollisionRequestd(), result) > 0;
  }

  double radius_;
  Eigen::AlignedBox3d bounds_;
  std::shared_ptr<octomap::OcTree> tree_;  // never changed while FCL uses it
  fcl::CollisionObjectd object_;
};

/// Tells OMPL whether straight motions are free, at once and not point by point.
class StraightMotions : public ob::MotionValidator {
 public:
  StraightMotions(const ob::SpaceInformationPtr& information, const Space* space)
      : ob::MotionValidator(information), space_(space) {}
  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return space_->IsFree(PointOf(from), PointOf(to));
  }
  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last_valid) const override {
    last_valid.second = 0;
    if (last_valid.first != nullptr) si_->copyState(last_valid.first, from);
    return checkMotion(from, to);
  }

 private:
  const Space* space_;
};

/// The corners of the path; empty when none was found in time.
std::vector<Vector3d> Plan(const Space& space, const Vector3d& start, const Vector3d& goal,
                           double seconds) {
  auto states = std::make_shared<ob::RealVectorStateSpace>(3);
  ob::RealVectorBounds bounds(3);
  for (unsigned axis = 0; axis < 3; ++axis) {
    bounds.setLow(axis, space.bounds().min()[axis]);
    bounds.setHigh(axis, space.bounds().max()[axis]);
  }
  states->setBounds(bounds);
  og::SimpleSetup setup(states);
  const auto& information = setup.getSpaceInformation();
  setup.setStateValidityChecker(
      [&](const ob::State* state) { return space.IsFree(PointOf(state)); });
  information->setMotionValidator(std::make_shared<StraightMotions>(information, &space));
  ob::ScopedState<> from(states), to(states);
  for (unsigned axis = 0; axis < 3; ++axis) {
    from[axis] = start[axis];
    to[axis] = goal[axis];
  }
  setup.setStartAndGoalStates(from, to);
  setup.setPlanner(std::make_shared<og::RRTstar>(information));
  setup.solve(seconds);
  std::vector<Vector3d> path;
  if (!setup.haveExactSolutionPath()) return path;
  for (const ob::State* state : setup.getSolutionPath().getStates()) path.push_back(PointOf(state));
  return path;
}

bool IsFree(const Space& space, const std::vector<Vector3d>& path) {
  for (size_t i = 1; i < path.size(); ++i) {
    if (!space.IsFree(path[i - 1], path[i])) return false;
  }
  return true;
}

/// Length of a path, and its smallest distance to an obstacle or to unknown space, every 2 cm [m].
struct PathFacts {
  double length = 0, clearance = kLookAround;
};

PathFacts FactsOf(const Space& space, const std::vector<Vector3d>& path) {
  PathFacts facts;
  for (size_t i = 1; i < path.size(); ++i) {
    const double length = (path[i] - path[i - 1]).norm();
    const int steps = std::max(1, static_cast<int>(length / 0.02));
    for (int k = 0; k <= steps; ++k) {
      const Vector3d p = path[i - 1] + (path[i] - path[i - 1]) * k / steps;
      facts.clearance = std::min(facts.clearance, space.NearestObstacle(p).distance);
    }
    facts.length += length;
  }
  return facts;
}

struct Task {
  Vector3d start, goal;
  double radius = 0.2, seconds = 3;
  vismap::NavigationClientOptions navigation;
};

int Refuse(const std::string& sentence) {
  std::cerr << "plan_sphere: " << sentence << "\n";
  return 1;
}

int Run(const Task& task) {
  vismap::NavigationClient navigation(task.navigation);
  navigation.Start();
  using vismap::TreeKind;
  const vismap::FreeSpace closed = navigation.WaitFor(TreeKind::kClosed, kWaitForTree, kMaxAge);
  if (!closed) return Refuse(closed.why);
  const vismap::FreeSpace raw = navigation.WaitFor(TreeKind::kRaw, kWaitForTree, kMaxAge);
  if (!raw) return Refuse(raw.why);
  const Space space(*closed.tree, task.radius);
  const auto seen = ReadTree(*raw.tree);
  for (const auto& [name, point] : {std::pair("start", task.start), std::pair("goal", task.goal)}) {
    if (!space.IsFree(point)) return Refuse(space.WhyNot(name, point, *seen));
  }
  const std::vector<Vector3d> path = Plan(space, task.start, task.goal, task.seconds);
  if (path.empty()) {
    return Refuse("no path through free space was found; unknown space counts as an obstacle");
  }
  // The map may have changed meanwhile.
  const vismap::FreeSpace now = navigation.Newest(TreeKind::kClosed, kMaxAge);
  if (!now) return Refuse(now.why);
  if (now.tree != closed.tree && !IsFree(Space(*now.tree, task.radius), path))
    return Refuse("the map has changed, and the path is not free any more");
  const PathFacts facts = FactsOf(space, path);
  for (const Vector3d& p : path) std::printf("%.4f %.4f %.4f\n", p.x(), p.y(), p.z());
  std::fprintf(stderr,
               "path of %.2f m in %zu pieces; clearance %.3f m, radius %.3f m; revision %lld\n",
               facts.length, path.size() - 1, facts.clearance, task.radius,
               static_cast<long long>(closed.tree->revision));
  return 0;
}

bool ReadPoint(const char* text, Vector3d* point) {
  char end = 0;
  return std::sscanf(text, "%lf,%lf,%lf%c", &point->x(), &point->y(), &point->z(), &end) == 3 &&
         point->allFinite();
}

std::optional<Task> ReadTask(std::vector<std::string> words) {
  Task task;
  const auto prefix = std::find(words.begin(), words.end(), "--channel-prefix");
  if (prefix != words.end()) {
    if (prefix + 1 == words.end()) return std::nullopt;
    task.navigation.channel_prefix = *(prefix + 1);
    words.erase(prefix, prefix + 2);
  }
  if (words.size() < 2 || words.size() > 5) return std::nullopt;
  if (!ReadPoint(words[0].c_str(), &task.start) || !ReadPoint(words[1].c_str(), &task.goal))
    return std::nullopt;
  if (words.size() > 2) task.radius = std::atof(words[2].c_str());
  if (words.size() > 3) task.seconds = std::atof(words[3].c_str());
  if (words.size() > 4) task.navigation.url = words[4];
  if (!(task.radius > 0 && task.radius < kLookAround && task.seconds > 0)) return std::nullopt;
  task.navigation.name = "plan-sphere";
  task.navigation.trees = {vismap::TreeKind::kClosed, vismap::TreeKind::kRaw};
  return task;
}

}  // namespace

int main(int argc, char** argv) {
  const std::optional<Task> task = ReadTask({argv + 1, argv + argc});
  if (!task) {
    std::cerr
        << "usage: plan_sphere X,Y,Z X,Y,Z [RADIUS [SECONDS [URL]]] [--channel-prefix PREFIX]; "
           "the radius is below 1 m\n";
    return 2;
  }
  ompl::msg::setLogLevel(ompl::msg::LOG_ERROR);
  ompl::RNG::setSeed(1);
  try {
    return Run(*task);
  } catch (const std::exception& error) {
    return Refuse(error.what());
  }
}
