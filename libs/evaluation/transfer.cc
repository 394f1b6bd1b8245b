#include "evaluation/transfer.h"

#include "base/parallel.h"
#include "evaluation/nearest.h"

namespace vismap {

TransferredLabels TransferLabels(const GroundTruth& truth, const Mesh& mesh, double radius) {
  std::vector<size_t> vertex_of;
  std::vector<Eigen::Vector3d> points;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!mesh.vertices[i].position_W.allFinite()) continue;
    points.push_back(mesh.vertices[i].position_W.cast<double>());
    vertex_of.push_back(i);
  }
  const NearestPoints tree(std::move(points));
  const size_t count = truth.points_W.size();
  TransferredLabels labels;
  labels.distance.assign(count, std::numeric_limits<double>::infinity());
  labels.segment.resize(count);
  labels.instance.resize(count);
  labels.class_id.resize(count);
  ParallelFor(count, 256, [&](size_t i) {
    const auto nearest = tree.Nearest(truth.points_W[i].cast<double>());
    if (!nearest) return;
    labels.distance[i] = nearest->distance;
    if (nearest->distance >= radius) return;
    const MeshVertex& vertex = mesh.vertices[vertex_of[nearest->index]];
    labels.segment[i] = vertex.segment;
    labels.instance[i] = vertex.instance;
    labels.class_id[i] = vertex.class_id;
  });
  return labels;
}

}  // namespace vismap
