#include "objects/join_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "base/parallel.h"

namespace vismap {
namespace {

constexpr double kFacesUp = 0.7;   // least upward part of the normal of what supports
constexpr double kMostlyUp = 0.6;  // share of a contact that faces up where something rests
// What touches others along fewer edges than this times the square root of its vertices is held by
// something that the camera did not see, ...
constexpr double kHeld = 0.5;
constexpr double kMostGap = 0.2;                 // ... by a part within this distance [m] ...
constexpr double kMostBeside = 0.25;             // ... above or below it, as a share of its width
constexpr int64_t kLeastFloating = 100;          // least number of vertices
constexpr double kStrays = 0.03;                 // share of the lowest and of the highest vertices
constexpr double kEndShare = 0.25, kEnd = 0.03;  // where a part ends: share of its height, and [m]
// Least number of edges of a contact, divided by the square root of the vertices of the part with
// fewer. A border has two to three edges per voxel, so it is at least about as long as the side of
// a square with the surface of that part.
constexpr double kLeastBorder = 3;
constexpr double kLeastFoot = 0.2;  // least width of a foot, as a share of the height above it

/// The surface of one label outside of all instances.
struct Part {
  bool joinable = false;
  int64_t vertices = 0;
  int64_t rim = 0;  // mesh edges to other labels or instances
  double low = std::numeric_limits<double>::infinity(), high = -low;  // along up [m]
  Eigen::AlignedBox3d bounds_W;      // of the surface, later of the whole [m]; empty = no surface
  Eigen::AlignedBox3d own_bounds_W;  // of the surface [m]
};

/// The border between two parts, the one with the lower label first.
struct PartBorder {
  int64_t edges = 0;
  int64_t facing_up[2] = {0, 0};  // edges whose end on the first or second part faces up
  double heights = 0;             // sum of the heights of all edges [m]
  Eigen::AlignedBox3d bounds_W;   // [m]
};

using LabelPair = std::pair<size_t, size_t>;

double Size(const Eigen::AlignedBox3d& bounds) {
  return bounds.isEmpty() ? 0 : bounds.diagonal().norm();
}

// Where a part begins and ends, without the few vertices that are strays of its label.
void SetHeights(std::vector<double>* heights, Part* part) {
  if (heights->empty()) return;
  const auto strays = static_cast<std::ptrdiff_t>(kStrays * static_cast<double>(heights->size()));
  const auto low = heights->begin() + strays, high = heights->end() - 1 - strays;
  std::nth_element(heights->begin(), low, heights->end());
  part->low = *low;
  std::nth_element(low, high, heights->end());
  part->high = *high;
}

std::vector<Part> MeasureParts(const LabelSurfaces& surfaces, const ObjectOptions& options) {
  std::vector<Part> parts(surfaces.size());
  ParallelFor(parts.size(), 16, [&](size_t label) {
    Part& part = parts[label];
    part.vertices = surfaces[label].vertices;
    std::vector<double> heights;
    for (const Eigen::Vector3f& point_W : surfaces[label].points_W) {
      part.bounds_W.extend(point_W.cast<double>());
      heights.push_back(point_W.cast<double>().dot(options.up_W));
    }
    SetHeights(&heights, &part);
    part.own_bounds_W = part.bounds_W;
  });
  return parts;
}

// What structure each label is; kNone for those of instances.
std::vector<StructureKind> FindStructure(const LabelSurfaces& surfaces,
                                         const std::vector<Part>& parts,
                                         const std::vector<uint8_t>& named,
                                         const ObjectOptions& options) {
  std::vector<SurfacePlane> planes(surfaces.size());
  std::vector<SurfaceSpread> spreads(surfaces.size());
  ParallelFor(surfaces.size(), 1, [&](size_t label) {
    if (named[label] != 0 || surfaces[label].points_W.empty()) return;
    planes[label] = FindPlane(surfaces[label].points_W, surfaces[label].area, options.structure);
    spreads[label] = SpreadOf(surfaces[label].points_W);
  });
  double lowest = std::numeric_limits<double>::infinity();
  for (const Part& part : parts) lowest = std::min(lowest, part.low);
  JoinFlushAreas(spreads, options.structure, &planes);
  auto kinds = NameStructure(planes, options.up_W, lowest, options.structure);
  NameFlushPieces(planes, spreads, options.structure, &kinds);
  return kinds;
}

/// Finds the wholes of the parts of a mesh.
class Wholes {
 public:
  Wholes(const LabelTable& table, const Mesh& mesh, const LabelSurfaces& surfaces,
         const ObjectOptions& options)
      : table_(table), options_(options), parts_(MeasureParts(surfaces, options)) {
    whole_of_.resize(parts_.size());
    std::iota(whole_of_.begin(), whole_of_.end(), size_t{0});
    std::vector<uint8_t> named(parts_.size(), 0);
    for (const MeshVertex& vertex : mesh.vertices) {
      const size_t label = Raw(vertex.segment);
      if (label < named.size() && vertex.instance != InstanceId::kNone) named[label] = 1;
    }
    const auto kinds = FindStructure(surfaces, parts_, named, options);
    large_.resize(parts_.size(), 0);
    for (size_t label = 1; label < parts_.size(); ++label) {
      if (named[label] != 0 || kinds[label] != StructureKind::kNone) continue;
      parts_[label].joinable = Size(parts_[label].bounds_W) <= options.max_whole_size_m;
      large_[label] = parts_[label].joinable ? 0 : 1;
    }
    MeasureContacts(mesh);
  }

  std::vector<SegmentLabel> Join() {
    apart_ = Apart();
    for (const auto& [strength, pair] : ByStrength()) JoinPair(pair);
    Dissolve();
    JoinFloating();
    std::vector<SegmentLabel> joined(parts_.size());
    for (size_t label = 0; label < joined.size(); ++label)
      joined[label] = static_cast<SegmentLabel>(Find(label));
    return joined;
  }

 private:
  void MeasureContacts(const Mesh& mesh) {
    // Neighbouring triangles go along their common edge in opposite directions, so that every edge
    // counts once.
    const auto add = [&](uint32_t from, uint32_t to) {
      if (from > to) return;
      const MeshVertex& x = mesh.vertices[from];
      const MeshVertex& y = mesh.vertices[to];
      if (x.segment == y.segment || (x.instance == y.instance && x.instance != InstanceId::kNone))
        return;
      const auto &a = x.segment < y.segment ? x : y, &b = x.segment < y.segment ? y : x;
      const LabelPair pair{Raw(a.segment), Raw(b.segment)};
      if (pair.first == 0 || pair.second >= parts_.size()) return;
      ++parts_[pair.first].rim;
      ++parts_[pair.second].rim;
      const auto open = [&](size_t label) { return parts_[label].joinable || large_[label] != 0; };
      if (!open(pair.first) || !open(pair.second)) return;
      PartBorder& contact = contacts_[pair];
      ++contact.edges;
      contact.facing_up[0] += FacesUp(a) ? 1 : 0;
      contact.facing_up[1] += FacesUp(b) ? 1 : 0;
      const Eigen::Vector3d middle_W = ((a.position_W + b.position_W) / 2).cast<double>();
      contact.heights += middle_W.dot(options_.up_W);
      contact.bounds_W.extend(middle_W);
    };
    for (const auto& [a, b, c] : mesh.triangles) {
      add(a, b);
      add(b, c);
      add(c, a);
    }
  }

  bool FacesUp(const MeshVertex& vertex) const {
    return vertex.normal_W.cast<double>().dot(options_.up_W) > kFacesUp;
  }

  // The horizontal diagonal of bounds [m].
  double Width(const Eigen::AlignedBox3d& bounds) const {
    const Eigen::Vector3d diagonal_W = bounds.diagonal();
    return (diagonal_W - diagonal_W.dot(options_.up_W) * options_.up_W).norm();
  }

  // Whether `upper` rests on `lower` and could be lifted from it: they touch at the bottom of the
  // one, and at the top of the other or where it faces up. What is too high or too wide for its
  // foot would fall over, so it must be fixed there.
  bool RestsOn(const Part& upper, const Part& lower, const PartBorder& contact,
               int64_t facing_up) const {
    const auto edges = static_cast<double>(contact.edges);
    const double foot = contact.heights / edges;
    const auto is_near = [&](double end, const Part& part) {
      return std::abs(foot - end) <= std::max(kEndShare * (part.high - part.low), kEnd);
    };
    return is_near(upper.low, upper) &&
           (is_near(lower.high, lower) || static_cast<double>(facing_up) >= kMostlyUp * edges) &&
           Width(contact.bounds_W) >= kLeastFoot * (upper.high - foot) &&
           Width(contact.bounds_W) >= 0.5 * Width(upper.own_bounds_W);
  }

  // Whether two parts have a border that is long enough to say something.
  bool Touch(const LabelPair& pair, const PartBorder& contact) const {
    const Part &a = parts_[pair.first], &b = parts_[pair.second];
    if (!a.joinable || !b.joinable) return false;
    const auto vertices = static_cast<double>(std::min(a.vertices, b.vertices));
    return static_cast<double>(contact.edges) >= kLeastBorder * std::sqrt(vertices);
  }

  // Whether masks or the way that two parts touch speak for two things.
  bool AreTwo(const LabelPair& pair, const PartBorder& contact) const {
    const Part &a = parts_[pair.first], &b = parts_[pair.second];
    const float bond = table_.bonds().Between(static_cast<SegmentLabel>(pair.first),
                                              static_cast<SegmentLabel>(pair.second));
    if (bond != 0) return bond < 0;
    return RestsOn(a, b, contact, contact.facing_up[1]) ||
           RestsOn(b, a, contact, contact.facing_up[0]);
  }

  bool MayJoin(const LabelPair& pair, const PartBorder& contact) const {
    return Touch(pair, contact) && !AreTwo(pair, contact);
  }

  // Pairs that are no one thing, also when a third part touches both.
  std::vector<LabelPair> Apart() const {
    std::vector<LabelPair> apart;
    for (const auto& [pair, contact] : contacts_)
      if (Touch(pair, contact) && AreTwo(pair, contact)) apart.push_back(pair);
    return apart;
  }

  // The pairs that may be joined, the strongest first, ties by label.
  std::vector<std::pair<double, LabelPair>> ByStrength() const {
    std::vector<std::pair<double, LabelPair>> sorted;
    for (const auto& [pair, contact] : contacts_) {
      const int64_t rim = std::min(parts_[pair.first].rim, parts_[pair.second].rim);
      const double strength = static_cast<double>(contact.edges) / static_cast<double>(rim);
      if (strength >= options_.min_part_contact && MayJoin(pair, contact))
        sorted.emplace_back(-strength, pair);
    }
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }

  size_t Find(size_t label) const {
    while (whole_of_[label] != label) label = whole_of_[label];
    return label;
  }

  // Whether a part of one whole is no one thing with a part of the other whole.
  bool HoldsTwo(size_t one, size_t other) const {
    return std::any_of(apart_.begin(), apart_.end(), [&](const LabelPair& pair) {
      const size_t a = Find(pair.first), b = Find(pair.second);
      return (a == one && b == other) || (a == other && b == one);
    });
  }

  void JoinPair(const LabelPair& pair) {
    const auto [less, more] = std::minmax({Find(pair.first), Find(pair.second)});
    if (less == more) return;
    const Eigen::AlignedBox3d both = parts_[less].bounds_W.merged(parts_[more].bounds_W);
    if (Size(both) > options_.max_whole_size_m || HoldsTwo(less, more)) return;
    parts_[less].bounds_W = both;
    whole_of_[more] = less;
  }

  // Leaves the wholes in parts that go on into surface around them.
  void Dissolve() {
    std::vector<int64_t> rims(parts_.size(), 0), leaks(parts_.size(), 0);
    for (size_t label = 0; label < parts_.size(); ++label) rims[Find(label)] += parts_[label].rim;
    for (const auto& [pair, contact] : contacts_) {
      const size_t a = Find(pair.first), b = Find(pair.second);
      if (a == b) {
        rims[a] -= 2 * contact.edges;
      } else if (large_[a] != 0 || large_[b] != 0 || MayJoin(pair, contact)) {
        leaks[a] += contact.edges;
        leaks[b] += contact.edges;
      }
    }
    std::vector<size_t> before;
    for (size_t label = 0; label < parts_.size(); ++label) before.push_back(Find(label));
    for (size_t label = 0; label < parts_.size(); ++label) {
      const size_t whole = before[label];
      const bool leaks_out = static_cast<double>(leaks[whole]) >
                             options_.max_whole_leak * static_cast<double>(rims[whole]);
      whole_of_[label] = leaks_out ? label : whole;
    }
  }

  // Joins what floats to the part that must hold it: a lamp's shade to the pole that ends inside
  // it.
  void JoinFloating() {
    std::vector<Part> wholes = MeasureWholes();
    for (size_t i = 0; i < wholes.size(); ++i) {
      if (!parts_[i].joinable || Find(i) != i || wholes[i].vertices < kLeastFloating ||
          IsHeld(wholes[i]))
        continue;
      const size_t holder = FindHolder(i, wholes);
      if (holder == i) continue;
      whole_of_[std::max(i, holder)] = std::min(i, holder);
      wholes = MeasureWholes();
    }
  }

  static bool IsHeld(const Part& part) {
    return static_cast<double>(part.rim) >= kHeld * std::sqrt(static_cast<double>(part.vertices));
  }

  // By label: vertices, bounds and outer rim of the whole of which it is the lowest label.
  std::vector<Part> MeasureWholes() const {
    std::vector<Part> wholes(parts_.size());
    for (size_t label = 1; label < parts_.size(); ++label) {
      Part& whole = wholes[Find(label)];
      whole.rim += parts_[label].rim;
      whole.vertices += parts_[label].vertices;
      if (parts_[label].vertices == 0) continue;
      whole.low = std::min(whole.low, parts_[label].low);
      whole.high = std::max(whole.high, parts_[label].high);
      whole.bounds_W.extend(parts_[label].own_bounds_W);
    }
    for (const auto& [pair, contact] : contacts_) {
      if (Find(pair.first) == Find(pair.second)) wholes[Find(pair.first)].rim -= 2 * contact.edges;
    }
    return wholes;
  }

  // The nearest whole that is held, narrower, and right above or below `floating`; `floating`
  // itself if there is none.
  size_t FindHolder(size_t floating, const std::vector<Part>& wholes) const {
    const Part& part = wholes[floating];
    size_t holder = floating;
    double nearest = kMostGap;
    for (size_t i = 1; i < wholes.size(); ++i) {
      if (i == floating || Find(i) != i || !parts_[i].joinable || !IsHeld(wholes[i])) continue;
      if (wholes[i].vertices < kLeastFloating) continue;
      const Eigen::AlignedBox3d both = part.bounds_W.merged(wholes[i].bounds_W);
      const Eigen::AlignedBox3d offset =
          Eigen::AlignedBox3d(part.bounds_W.center())
              .merged(Eigen::AlignedBox3d(wholes[i].bounds_W.center()));
      const double width = Width(part.bounds_W);
      if (Width(wholes[i].bounds_W) > width) continue;  // it may stand there, on an edge unseen
      const double overlap =
          std::min(part.high, wholes[i].high) - std::max(part.low, wholes[i].low);
      const double height = std::min(part.high - part.low, wholes[i].high - wholes[i].low);
      if (overlap > kEndShare * height) continue;  // beside or inside it
      if (Size(both) > options_.max_whole_size_m || Width(offset) > kMostBeside * width) continue;
      const double gap = part.bounds_W.exteriorDistance(wholes[i].bounds_W);
      if (gap >= nearest || HoldsTwo(floating, i)) continue;
      nearest = gap;
      holder = i;
    }
    return holder;
  }

  const LabelTable& table_;
  const ObjectOptions& options_;
  std::vector<Part> parts_;       // by label; of the lowest label of a whole: bounds of the whole
  std::vector<uint8_t> large_;    // by label: no structure, no instance, and too large for a part
  std::vector<size_t> whole_of_;  // by label: a lower label of the same whole, or itself
  std::map<LabelPair, PartBorder> contacts_;
  std::vector<LabelPair> apart_;
};

}  // namespace

std::vector<SegmentLabel> JoinParts(const LabelTable& table, const Mesh& mesh,
                                    const LabelSurfaces& surfaces, const ObjectOptions& options) {
  return Wholes(table, mesh, surfaces, options).Join();
}

}  // namespace vismap
