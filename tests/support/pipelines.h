#pragma once

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "codecs/frame_codec.h"
#include "geometry/compute_surface.h"
#include "mapping/integrate.h"
#include "segmentation/refine.h"
#include "segmentation/segment_depth.h"
#include "simulation/sequence.h"
#include "simulation/synthetic_dataset.h"
#include "support/naive/associate.h"
#include "support/naive/integrate.h"
#include "support/naive/segment_depth.h"

namespace vismap::testing_support {

/// A sequence of the folder that VISMAP_DATA names; nullopt when there is none.
inline std::optional<std::string> RecordedSequence(const std::string& name) {
  const char* root = std::getenv("VISMAP_DATA");
  if (root == nullptr) return std::nullopt;
  const std::filesystem::path path = std::filesystem::path(root) / name;
  if (!std::filesystem::is_directory(path)) return std::nullopt;
  return path.string();
}

/// What a frame's mapping starts from.
struct InputFrame {
  RgbdFrame frame;
  std::optional<DetectionSet> detections;  ///< nullopt = no detector looked

  const DetectionSet* Detections() const { return detections ? &*detections : nullptr; }
};

/// A sequence with its detections, read frame by frame. Throws what the files are wrong with.
class InputSequence {
 public:
  explicit InputSequence(const std::string& path, const DatasetOptions& options = {})
      : dataset_(Unwrap(OpenSequence(path, "", options))) {
    const std::optional<std::string> inside =
        IsSyntheticPath(path) ? path : dataset_->default_detections_path();
    if (inside) detections_ = Unwrap(OpenDetections(*inside));
  }

  size_t size() const { return dataset_->size(); }
  InputFrame Read(size_t i) const {
    InputFrame input{Unwrap(DecodeFrame(Unwrap(dataset_->Read(i)))), std::nullopt};
    if (detections_ && detections_->DetectorRanOn(input.frame.header))
      input.detections = Unwrap(detections_->ForFrame(input.frame.header));
    return input;
  }
  std::vector<InputFrame> ReadAll() const {
    std::vector<InputFrame> frames;
    for (size_t i = 0; i < size(); ++i) frames.push_back(Read(i));
    return frames;
  }

 private:
  template <typename T>
  static T Unwrap(Result<T> result) {
    if (!result) throw std::runtime_error(result.error().message);
    return std::move(*result);
  }

  std::unique_ptr<Dataset> dataset_;
  std::unique_ptr<DetectionSource> detections_;
};

/// The map of some frames, by the fast stages.
inline SemanticMap MapFast(const std::vector<InputFrame>& inputs, const VoxelGridOptions& grid) {
  SemanticMap map(grid);
  for (const InputFrame& input : inputs) {
    const PinholeCamera& camera = input.frame.header.camera;
    const SurfaceMap surface = ComputeSurface(input.frame.depth, camera, {});
    const SegmentedFrame frame = RefineWithDetections(
        input.frame, SegmentDepth(surface, camera, {}), input.Detections(), {});
    const FrameAssociation association = Associate(frame, {map.voxels, map.labels}, {});
    IntegrateFrame(frame, association, {}, &map);
  }
  return map;
}

/// The same by the naive stages, but for the surface: the naive one's normals have other last
/// digits, which move a pixel of a segment's border in some frames. They are compared by
/// themselves.
inline SemanticMap MapNaively(const std::vector<InputFrame>& inputs, const VoxelGridOptions& grid) {
  SemanticMap map(grid);
  for (const InputFrame& input : inputs) {
    const PinholeCamera& camera = input.frame.header.camera;
    const SurfaceMap surface = ComputeSurface(input.frame.depth, camera, {});
    const SegmentedFrame frame = RefineWithDetections(
        input.frame, naive::SegmentDepth(surface, camera, {}), input.Detections(), {});
    const FrameAssociation association = naive::Associate(frame, {map.voxels, map.labels}, {});
    naive::IntegrateFrame(frame, association, {}, &map);
  }
  return map;
}

}  // namespace vismap::testing_support
