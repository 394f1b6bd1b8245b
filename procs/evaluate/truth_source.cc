#include "evaluate/truth_source.h"

#include "simulation/seen_surface.h"

namespace vismap {
namespace {

// As dense as the meshes of ScanNet, because its evaluation counts vertices [m].
constexpr double kSpacing = 0.02;

GroundTruth ToGroundTruth(const Scene& scene, const SeenSurface& seen) {
  GroundTruth truth;
  truth.name = scene.name;
  truth.format = "synthetic";
  const LabelledMesh mesh = seen.Triangles(scene, kSpacing);
  for (const Eigen::Vector3d& p_W : mesh.points_W) truth.points_W.push_back(p_W.cast<float>());
  truth.labels.assign(mesh.object_ids.begin(), mesh.object_ids.end());
  for (const auto& [a, b, c] : mesh.triangles) {
    truth.triangles.push_back(
        {static_cast<uint32_t>(a), static_cast<uint32_t>(b), static_cast<uint32_t>(c)});
  }
  for (const SceneObject& object : scene.objects) {
    const auto frames = seen.frames_of_object().find(object.id);
    truth.objects.push_back(
        {.label = object.id,
         .name = object.name,
         .class_id = object.class_id,
         .is_structure = object.kind == ObjectKind::kStructure,
         .frames = frames == seen.frames_of_object().end() ? 0 : frames->second});
  }
  return truth;
}

Result<TruthSource> ComputeTruth(const std::string& path) {
  Result<SyntheticOptions> options = ParseSyntheticPath(path);
  if (!options) return tl::unexpected(options.error());
  TruthSource source;
  options->pose_noise = 0;  // the ground truth has exact poses
  source.depth = MakeSyntheticDataset(*options, {});
  options->tours = 1;  // all tours see the same surface
  const auto scene = std::make_shared<const Scene>(MakeScene(*options));
  source.truth = ToGroundTruth(*scene, RenderSeenSurface(*options));
  source.distance = [scene](const Eigen::Vector3d& p_W) { return SignedDistance(*scene, p_W); };
  return source;
}

}  // namespace

Result<TruthSource> OpenTruth(const std::string& path) {
  if (IsSyntheticPath(path)) return ComputeTruth(path);
  Result<GroundTruth> truth = ReadGroundTruth(path);
  if (!truth) return tl::unexpected(truth.error());
  return TruthSource{.truth = std::move(*truth), .depth = OpenDataset(path, "")};
}

}  // namespace vismap
