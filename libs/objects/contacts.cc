#include "objects/contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "objects/label_surfaces.h"
#include "objects/structure.h"

namespace vismap {
namespace {

// An object that rises less than this above the plane keeps its vertices there [m].
constexpr double kMinRise = 0.1;

double DistanceTo(const SurfacePlane& plane, const MeshVertex& vertex) {
  return std::abs((vertex.position_W.cast<double>() - plane.point_W).dot(plane.normal_W));
}

class Contacts {
 public:
  Contacts(double distance, const Mesh& mesh) : distance_(distance), mesh_(mesh) {
    FindOwners();
    FindStructure();
    ForEachContact(
        [&](uint32_t rim, SegmentLabel structure, double) { rises_[OwnerOf(rim)][structure] = 0; });
    MeasureRises();
  }

  /// For each vertex, the label of the structure plane that it is assigned to; kNone = unchanged.
  std::vector<SegmentLabel> Structure() const {
    // Pairs compare by distance, then by label, so the result does not depend on the edges' order.
    using Contact = std::pair<double, SegmentLabel>;
    std::vector<Contact> closest(mesh_.vertices.size(), {kInfinity, SegmentLabel::kNone});
    ForEachContact([&](uint32_t rim, SegmentLabel structure, double away) {
      if (rises_[OwnerOf(rim)].at(structure) < kMinRise) return;
      closest[rim] = std::min(closest[rim], {away, structure});
    });
    std::vector<SegmentLabel> structure;
    for (const Contact& contact : closest) structure.push_back(contact.second);
    return structure;
  }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  size_t OwnerOf(uint32_t vertex) const {
    return owner_of_label_[Raw(mesh_.vertices[vertex].segment)];
  }

  // Calls visit(vertex, structure, distance) for every edge from a vertex to a structure plane
  // whose distance from the vertex is at most distance_ [m].
  template <typename Visit>
  void ForEachContact(const Visit& visit) const {
    const auto touch = [&](uint32_t rim, uint32_t beside) {
      const double away = DistanceToStructure(rim, beside);
      if (away <= distance_) visit(rim, mesh_.vertices[beside].segment, away);
    };
    for (const auto& [a, b, c] : mesh_.triangles) {
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
        touch(from, to);
        touch(to, from);
      }
    }
  }

  // Numbers the owners of the surface. An owner is an instance, or a label outside of all
  // instances.
  void FindOwners() {
    std::map<InstanceId, size_t> owner_of_instance;
    for (const MeshVertex& vertex : mesh_.vertices) {
      const size_t label = Raw(vertex.segment);
      if (label >= owner_of_label_.size()) owner_of_label_.resize(label + 1, kNoOwner);
      if (owner_of_label_[label] != kNoOwner) continue;
      size_t owner = rises_.size();
      if (vertex.instance != InstanceId::kNone)
        owner = owner_of_instance.try_emplace(vertex.instance, owner).first->second;
      if (owner == rises_.size()) rises_.emplace_back();
      owner_of_label_[label] = owner;
      if (vertex.instance != InstanceId::kNone) in_instances_.insert(vertex.segment);
    }
  }

  // Fits a plane to every label that is large enough, and keeps those that are planar.
  void FindStructure() {
    const size_t labels = owner_of_label_.size();
    const LabelSurfaces surfaces = CollectSurfaces(mesh_, labels);
    const StructureOptions options;
    planes_.resize(labels);
    ParallelFor(labels, 1, [&](size_t label) {
      const auto segment = static_cast<SegmentLabel>(label);
      if (segment == SegmentLabel::kNone || in_instances_.contains(segment) ||
          surfaces[label].area < options.structure_area_m2)
        return;
      const SurfacePlane plane = FindPlane(surfaces[label].points_W, surfaces[label].area, options);
      if (plane.area >= options.structure_area_m2 && plane.share >= options.structure_share)
        planes_[label] = plane;
    });
  }

  // Distance from the vertex `rim` to the structure plane of the vertex `beside` [m]; kInfinity if
  // `beside` is not structure, or if both are.
  double DistanceToStructure(uint32_t rim, uint32_t beside) const {
    const auto& plane = planes_[Raw(mesh_.vertices[beside].segment)];
    if (!plane || planes_[Raw(mesh_.vertices[rim].segment)]) return kInfinity;
    return DistanceTo(*plane, mesh_.vertices[rim]);
  }

  void MeasureRises() {
    for (const MeshVertex& vertex : mesh_.vertices) {
      for (auto& [segment, rise] : rises_[owner_of_label_[Raw(vertex.segment)]])
        rise = std::max(rise, DistanceTo(*planes_[Raw(segment)], vertex));
    }
  }

  static constexpr size_t kNoOwner = std::numeric_limits<size_t>::max();
  double distance_;
  const Mesh& mesh_;
  std::vector<size_t> owner_of_label_;
  std::set<SegmentLabel> in_instances_;
  std::vector<std::optional<SurfacePlane>> planes_;  // by label; none = the label is not structure
  // By owner, for each structure plane that it touches: its largest distance from the plane [m].
  std::vector<std::map<SegmentLabel, double>> rises_;
};

}  // namespace

void AbsorbContacts(double distance, Mesh* mesh) {
  const std::vector<SegmentLabel> structure = Contacts(distance, *mesh).Structure();
  for (size_t i = 0; i < structure.size(); ++i) {
    if (structure[i] != SegmentLabel::kNone) mesh->vertices[i].segment = structure[i];
  }
}

}  // namespace vismap
