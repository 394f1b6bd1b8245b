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
#include "geometry/fill_holes.h"
#include "mapping/integrate.h"
#include "segmentation/refine.h"
#include "segmentation/segment_depth.h"
#include "session/derived_options.h"
#include "simulation/sequence.h"
#include "simulation/synthetic_dataset.h"
#include "support/naive/associate.h"
#include "support/naive/fill_holes.h"
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

/// The input of the pipeline for one frame.
struct InputFrame {
  RgbdFrame frame;
  std::optional<DetectionSet> detections;  ///< nullopt = no detector looked

  const DetectionSet* Detections() const { return detections ? &*detections : nullptr; }
};

/// A sequence with its detections, read frame by frame. Throws when the files are faulty.
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
    if (detections_ && detections_->DetectorRan(input.frame.header))
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

/// A frame as SegmentFrame begins with it when there is nothing to leave out.
inline RgbdFrame WithFilledHoles(RgbdFrame frame) {
  PrepareDepth({}, &frame.depth);
  return frame;
}

/// The options that a map is made with by default.
inline MapSessionOptions DefaultOptions(const VoxelGridOptions& grid) {
  MapSessionOptions options{grid, {}, {}};
  DeriveOptions(SurfaceOptions{}, &options);
  return options;
}

/// The map of some frames, by the fast stages.
inline SemanticMap MapFast(const std::vector<InputFrame>& inputs, const VoxelGridOptions& grid) {
  const MapSessionOptions options = DefaultOptions(grid);
  SemanticMap map(grid);
  for (const InputFrame& input : inputs) {
    const PinholeCamera& camera = input.frame.header.camera;
    RgbdFrame filled = WithFilledHoles(input.frame);
    const SurfaceMap surface = ComputeSurface(filled.depth, camera, {});
    const SegmentedFrame frame = RefineWithDetections(
        std::move(filled), SegmentDepth(surface, camera, {}), input.Detections(), {});
    const FrameAssociation association =
        Associate(frame, {map.voxels, map.labels}, options.association);
    IntegrateFrame(frame, association, options.integration, &map);
  }
  return map;
}

/// The same by the naive stages, except the surface: the normals of the naive surface differ in the
/// last digits, which moves a pixel at the border of a segment in some frames. A test of its own
/// compares them.
inline SemanticMap MapNaively(const std::vector<InputFrame>& inputs, const VoxelGridOptions& grid) {
  const MapSessionOptions options = DefaultOptions(grid);
  SemanticMap map(grid);
  for (const InputFrame& input : inputs) {
    const PinholeCamera& camera = input.frame.header.camera;
    RgbdFrame filled = input.frame;
    PrepareDepthOptions only_limits;
    only_limits.holes.max_px = 0;
    PrepareDepth(only_limits, &filled.depth);
    filled.depth = naive::FillHoles(filled.depth, {});
    const SurfaceMap surface = ComputeSurface(filled.depth, camera, {});
    const SegmentedFrame frame = RefineWithDetections(
        std::move(filled), naive::SegmentDepth(surface, camera, {}), input.Detections(), {});
    const FrameAssociation association =
        naive::Associate(frame, {map.voxels, map.labels}, options.association);
    naive::IntegrateFrame(frame, association, options.integration, &map);
  }
  return map;
}

}  // namespace vismap::testing_support
