#include "objects/object_mesh.h"

#include <limits>

namespace vismap {
namespace {

constexpr uint32_t kNoIndex = std::numeric_limits<uint32_t>::max();

// The index in `objects` of the object that owns each segment label; indexed by label.
std::vector<uint32_t> OwnerOfLabel(std::span<const ObjectSummary> objects) {
  std::vector<uint32_t> owner;
  for (uint32_t i = 0; i < objects.size(); ++i) {
    if (objects[i].removed()) continue;  // the rest of its surface belongs to no object
    for (const SegmentLabel label : objects[i].segments) {
      if (Raw(label) >= owner.size()) owner.resize(size_t{Raw(label)} + 1, kNoIndex);
      owner[Raw(label)] = i;
    }
  }
  return owner;
}

// Copies single triangles of a mesh, and each vertex that they use once.
class Cutter {
 public:
  explicit Cutter(const Mesh& mesh) : mesh_(mesh), moved_(mesh.vertices.size(), kNoIndex) {}

  Mesh Cut(const std::vector<uint32_t>& triangles) {
    Mesh part;
    for (const uint32_t i : triangles) {
      const auto& [a, b, c] = mesh_.triangles[i];
      part.triangles.push_back(
          {IndexInPart(a, &part), IndexInPart(b, &part), IndexInPart(c, &part)});
    }
    for (const uint32_t used : used_) moved_[used] = kNoIndex;
    used_.clear();
    return part;
  }

 private:
  // The index of a vertex in the part, to which it is copied at its first use.
  uint32_t IndexInPart(uint32_t vertex, Mesh* part) {
    if (moved_[vertex] == kNoIndex) {
      moved_[vertex] = static_cast<uint32_t>(part->vertices.size());
      part->vertices.push_back(mesh_.vertices[vertex]);
      used_.push_back(vertex);
    }
    return moved_[vertex];
  }

  const Mesh& mesh_;
  std::vector<uint32_t> moved_;
  std::vector<uint32_t> used_;
};

}  // namespace

std::vector<Mesh> CutObjects(const Mesh& mesh, std::span<const ObjectSummary> objects) {
  const std::vector<uint32_t> owner_of_label = OwnerOfLabel(objects);
  const auto owner = [&](uint32_t vertex) {
    const size_t label = Raw(mesh.vertices[vertex].segment);
    return label < owner_of_label.size() ? owner_of_label[label] : kNoIndex;
  };
  std::vector<std::vector<uint32_t>> triangles(objects.size());
  for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    const uint32_t winner = owner(b) == owner(c) ? owner(b) : owner(a);
    if (winner != kNoIndex) triangles[winner].push_back(i);
  }
  Cutter cutter(mesh);
  std::vector<Mesh> parts;
  for (const auto& own : triangles) parts.push_back(cutter.Cut(own));
  return parts;
}

std::string ObjectFileName(const ObjectSummary& object, const std::string& class_name) {
  if (object.discovered()) return "segment_" + std::to_string(Raw(object.segments.at(0)));
  std::string name = "instance_" + std::to_string(Raw(object.instance));
  if (!class_name.empty()) name += '_';
  for (const char c : class_name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    name += plain || c == '-' ? c : '_';
  }
  return name;
}

}  // namespace vismap
