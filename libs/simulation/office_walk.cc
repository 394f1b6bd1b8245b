#include <array>
#include <cmath>

#include "base/require.h"
#include "simulation/camera_path.h"
#include "simulation/office.h"
#include "simulation/office_plan.h"

namespace vismap {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A point of the walk [m] and the viewing direction there, both horizontal, in W or in a Leg's
/// frame.
struct Waypoint {
  Vector2d point;
  Vector2d look;
};

/// A straight piece of the corridor. Its frame has x from `corner` along `ahead`, and y to the
/// left.
struct Leg {
  Vector2d corner, ahead;
  double length;

  Waypoint InWorld(const Waypoint& way) const {
    const Vector2d left(-ahead.y(), ahead.x());
    return {corner + way.point.x() * ahead + way.point.y() * left,
            way.look.x() * ahead + way.look.y() * left};
  }
};

/// A room that the walk enters.
struct Visit {
  double along;  ///< distance of the door from the corner [m]
  double side;   ///< side of the door: 1 = left, -1 = right
};

// The way into a room, around in it, and out again. x is along the corridor, from the door; y is
// from the wall into the room.
const std::array<Waypoint, 9> kVisit{{{{-1.3, -1.0}, {1, 0.15}},
                                      {{-0.25, -0.55}, {0.6, 0.8}},
                                      {{0.0, 0.35}, {0.1, 1}},
                                      {{0.3, 1.35}, {-0.25, 0.97}},
                                      {{0.05, 2.05}, {-0.95, 0.3}},
                                      {{-0.35, 1.45}, {-0.7, -0.7}},
                                      {{0.0, 0.35}, {0, -1}},
                                      {{0.3, -0.6}, {0.6, -0.8}},
                                      {{1.3, -1.0}, {1, 0}}}};

constexpr double kCorner = 1.5;  // the walk turns within this distance of a corner [m]

void WalkStraight(const Leg& leg, double from, double to, std::vector<Waypoint>* walk) {
  constexpr double kStep = 2.2;
  const int steps = static_cast<int>(std::ceil((to - from) / kStep));
  for (int i = 1; i < steps; ++i) {
    const double glance = walk->size() % 2 == 0 ? 0.25 : -0.25;
    walk->push_back(leg.InWorld({{from + (to - from) * i / steps, 0}, {1, glance}}));
  }
}

/// Adds the waypoints of one leg: around its first corner to the left, into its rooms, and to the
/// point before the next corner.
void WalkLeg(const Leg& leg, const std::vector<Visit>& visits, std::vector<Waypoint>* walk) {
  double from = kCorner;
  walk->push_back(leg.InWorld({{0, kCorner}, {0, -1}}));
  walk->push_back(leg.InWorld({{0.4, 0.4}, {0.7, -0.7}}));
  walk->push_back(leg.InWorld({{from, 0}, {1, 0}}));
  for (const Visit& visit : visits) {
    WalkStraight(leg, from, visit.along + kVisit.front().point.x(), walk);
    for (const Waypoint& way : kVisit) {
      walk->push_back(leg.InWorld({{visit.along + way.point.x(), visit.side * (1 + way.point.y())},
                                   {way.look.x(), visit.side * way.look.y()}}));
    }
    from = visit.along + kVisit.back().point.x();
  }
  WalkStraight(leg, from, leg.length - kCorner, walk);
}

std::vector<Waypoint> OfficeWaypoints() {
  constexpr double x = office::kPathX, y = office::kPathY;
  std::vector<Waypoint> walk;
  WalkLeg({{-x, -y}, {1, 0}, 2 * x}, {{x - 10.83, -1}, {x, 1}, {x + 8.75, 1}}, &walk);
  WalkLeg({{x, -y}, {0, 1}, 2 * y}, {{y, -1}}, &walk);
  WalkLeg({{x, y}, {-1, 0}, 2 * x}, {{x - 10.83, -1}, {x, 1}, {x + 8.75, 1}}, &walk);
  WalkLeg({{-x, y}, {0, -1}, 2 * y}, {{y + 3.5, -1}}, &walk);
  return walk;
}

/// The walk as two closed curves over a parameter: the camera's position and its viewing direction.
class Walk {
 public:
  explicit Walk(const std::vector<Waypoint>& waypoints) {
    constexpr double kEye = 1.5;
    for (const Waypoint& way : waypoints) {
      eyes_.emplace_back(way.point.x(), way.point.y(), kEye);
      looks_.emplace_back(way.look.x(), way.look.y(), 0);
    }
  }

  double length() const { return static_cast<double>(eyes_.size()); }
  Pose At(double s) const {
    constexpr double kDown = 0.25;  // the view goes down by this per metre ahead
    const Vector3d eye = CurveAt(eyes_, s);
    return LookAt(eye, eye + CurveAt(looks_, s).normalized() - kDown * Vector3d::UnitZ());
  }

 private:
  std::vector<Vector3d> eyes_, looks_;
};

/// The difference between two poses; 1 = 0.35 m or about 13 degrees.
double PoseDifference(const Pose& a, const Pose& b) {
  const double way = (b.translation() - a.translation()).norm() / 0.35;
  const double turn = (b.linear().col(2) - a.linear().col(2)).norm() / 0.23;
  return std::sqrt(way * way + turn * turn);
}

}  // namespace

std::vector<Pose> MakeOfficeWalk(int count) {
  Require(count >= 1, "a walk has at least one pose");
  constexpr int kPieces = 32;  // pieces of the curve between two waypoints
  const Walk walk(OfficeWaypoints());
  const auto pieces = static_cast<size_t>(kPieces * walk.length());
  std::vector<double> effort{0};  // sum from the start to the end of each piece
  for (size_t i = 0; i < pieces; ++i) {
    const double next = i + 1 == pieces ? 0 : static_cast<double>(i + 1) / kPieces;
    const double s = static_cast<double>(i) / kPieces;
    effort.push_back(effort.back() + PoseDifference(walk.At(s), walk.At(next)));
  }
  std::vector<Pose> poses;
  size_t piece = 0;
  for (int i = 0; i < count; ++i) {
    const double wanted = effort.back() * i / count;
    while (effort[piece + 1] <= wanted) ++piece;
    const double part = (wanted - effort[piece]) / (effort[piece + 1] - effort[piece]);
    poses.push_back(walk.At((static_cast<double>(piece) + part) / kPieces));
  }
  return poses;
}

}  // namespace vismap
