#include "pictures/web_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "base/base64.h"

namespace vismap {
namespace {

constexpr uint32_t kNoVertex = UINT32_MAX;
constexpr double kTrianglesPerVertex = 2.5;
constexpr double kGrowth = 1.3;  // of the cubes from one trial to the next

// Which vertices become one.
struct ClusterKey {
  int32_t x = 0, y = 0, z = 0;
  uint32_t segment = 0, instance = 0;
  int facing = 0;  // the axis that the normal is nearest to, and its sign
  friend bool operator==(const ClusterKey&, const ClusterKey&) = default;
};

struct ClusterHash {
  size_t operator()(const ClusterKey& key) const {
    uint64_t hash = 0;
    for (const auto part :
         {static_cast<uint32_t>(key.x), static_cast<uint32_t>(key.y), static_cast<uint32_t>(key.z),
          key.segment, key.instance, static_cast<uint32_t>(key.facing)})
      hash = (hash ^ part) * 0x9E3779B97F4A7C15ull + (hash >> 31);
    return static_cast<size_t>(hash);
  }
};

int FacingOf(const Eigen::Vector3f& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return 2 * static_cast<int>(axis) + (normal[axis] < 0 ? 1 : 0);
}

ClusterKey KeyOf(const MeshVertex& vertex, double cell_m) {
  const auto at = [&](int axis) {
    const double cell = std::floor(static_cast<double>(vertex.position_W[axis]) / cell_m);
    return static_cast<int32_t>(std::clamp(cell, -1e9, 1e9));
  };
  return {
      at(0), at(1), at(2), Raw(vertex.segment), Raw(vertex.instance), FacingOf(vertex.normal_W)};
}

struct Cluster {
  MeshVertex vertex;  // of the first member
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), normal = position, color = position;
  double count = 0;

  void Add(const MeshVertex& member) {
    if (count == 0) vertex = member;
    position += member.position_W.cast<double>();
    normal += member.normal_W.cast<double>();
    color += Eigen::Vector3d(member.color.r, member.color.g, member.color.b);
    ++count;
  }
  MeshVertex Mean() const {
    MeshVertex mean = vertex;
    const auto channel = [&](int i) { return static_cast<uint8_t>(std::lround(color[i] / count)); };
    mean.position_W = (position / count).cast<float>();
    if (normal.norm() > 0) mean.normal_W = normal.normalized().cast<float>();
    mean.color = {channel(0), channel(1), channel(2)};
    return mean;
  }
};

Mesh Joined(const Mesh& mesh, double cell_m) {
  std::unordered_map<ClusterKey, uint32_t, ClusterHash> index;
  std::vector<Cluster> clusters;
  std::vector<uint32_t> cluster_of(mesh.vertices.size(), kNoVertex);
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const MeshVertex& vertex = mesh.vertices[i];
    if (!vertex.position_W.allFinite()) continue;
    const auto [found, added] =
        index.try_emplace(KeyOf(vertex, cell_m), static_cast<uint32_t>(clusters.size()));
    if (added) clusters.emplace_back();
    clusters[found->second].Add(vertex);
    cluster_of[i] = found->second;
  }
  Mesh joined;
  for (const Cluster& cluster : clusters) joined.vertices.push_back(cluster.Mean());
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array<uint32_t, 3> corners{cluster_of[a], cluster_of[b], cluster_of[c]};
    if (std::count(corners.begin(), corners.end(), kNoVertex) > 0) continue;
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[0] == corners[2]) continue;
    joined.triangles.push_back(corners);
  }
  return joined;
}

bool Fits(const Mesh& mesh, size_t max_vertices) {
  return mesh.vertices.size() <= max_vertices &&
         static_cast<double>(mesh.triangles.size()) <=
             kTrianglesPerVertex * static_cast<double>(max_vertices);
}

struct Bounds {
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Ones();
};

Bounds BoundsOf(const Mesh& mesh) {
  if (mesh.vertices.empty()) return {};
  Bounds bounds{mesh.vertices[0].position_W.cast<double>(),
                mesh.vertices[0].position_W.cast<double>()};
  for (const MeshVertex& vertex : mesh.vertices) {
    bounds.low = bounds.low.cwiseMin(vertex.position_W.cast<double>());
    bounds.high = bounds.high.cwiseMax(vertex.position_W.cast<double>());
  }
  bounds.high = bounds.high.cwiseMax((bounds.low.array() + 1e-6).matrix());
  return bounds;
}

template <typename Number>
void Append(Number value, std::vector<uint8_t>* bytes) {
  std::array<uint8_t, sizeof(Number)> raw;
  std::memcpy(raw.data(), &value,
              sizeof value);  // little-endian, as all computers that we build for
  bytes->insert(bytes->end(), raw.begin(), raw.end());
}

/// Finds the object of a vertex.
class OwnerIndex {
 public:
  explicit OwnerIndex(std::span<const ObjectSummary> objects) {
    for (size_t i = 0; i < objects.size() && i < kNone; ++i) {
      const ObjectSummary& object = objects[i];
      if (object.removed()) continue;
      if (object.instance != InstanceId::kNone) instances_[object.instance] = i;
      for (const SegmentLabel segment : object.segments) segments_.try_emplace(segment, i);
    }
  }
  uint16_t Of(const MeshVertex& vertex) const {
    if (vertex.instance != InstanceId::kNone) {
      const auto found = instances_.find(vertex.instance);
      return found == instances_.end() ? kNone : static_cast<uint16_t>(found->second);
    }
    const auto found = segments_.find(vertex.segment);
    return found == segments_.end() ? kNone : static_cast<uint16_t>(found->second);
  }

 private:
  static constexpr uint16_t kNone = UINT16_MAX;
  std::map<InstanceId, size_t> instances_;
  std::map<SegmentLabel, size_t> segments_;
};

}  // namespace

WebMesh CoarsenMesh(const Mesh& mesh, size_t max_vertices) {
  constexpr double kFinest = 1e-5;  // [m]; joins nothing but equal places
  WebMesh coarse{Joined(mesh, kFinest), 0};
  const Bounds bounds = BoundsOf(coarse.mesh);
  const double size = (bounds.high - bounds.low).maxCoeff();
  double cell_m = 0.01;
  // Vertices of different labels are never joined, so with very many labels the mesh stays larger.
  while (!Fits(coarse.mesh, max_vertices) && coarse.cell_m <= size) {
    coarse = {Joined(mesh, cell_m), cell_m};
    cell_m *= kGrowth;
  }
  return coarse;
}

std::string EncodeWebMesh(const Mesh& mesh, std::span<const ObjectSummary> objects) {
  const Bounds bounds = BoundsOf(mesh);
  const OwnerIndex owners(objects);
  std::vector<uint8_t> bytes;
  for (const MeshVertex& vertex : mesh.vertices) {
    const Eigen::Array3d share = (vertex.position_W.cast<double>() - bounds.low).array() /
                                 (bounds.high - bounds.low).array();
    for (const double part : share)
      Append(static_cast<uint16_t>(std::lround(std::clamp(part, 0.0, 1.0) * 65535)), &bytes);
  }
  for (const MeshVertex& vertex : mesh.vertices)
    bytes.insert(bytes.end(), {vertex.color.r, vertex.color.g, vertex.color.b});
  if (bytes.size() % 2 != 0) bytes.push_back(0);
  for (const MeshVertex& vertex : mesh.vertices) Append(owners.Of(vertex), &bytes);
  while (bytes.size() % 4 != 0) bytes.push_back(0);
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t corner : triangle) Append(corner, &bytes);
  return Base64(bytes);
}

std::string WebMeshHeader(const Mesh& mesh) {
  const Bounds bounds = BoundsOf(mesh);
  const nlohmann::ordered_json json{{"vertices", mesh.vertices.size()},
                                    {"triangles", mesh.triangles.size()},
                                    {"low", {bounds.low.x(), bounds.low.y(), bounds.low.z()}},
                                    {"high", {bounds.high.x(), bounds.high.y(), bounds.high.z()}}};
  return json.dump();
}

}  // namespace vismap
