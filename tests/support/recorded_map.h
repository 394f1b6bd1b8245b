#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "codecs/frame_codec.h"
#include "mapping/integrate.h"
#include "segmentation/segment_frame.h"
#include "simulation/sequence.h"

namespace vismap::testing_support {

/// The sequence that benchmarks run on: 7-Scenes when VISMAP_DATA has it, else the built-in room.
inline std::string BenchSequence() {
  const char* data = std::getenv("VISMAP_DATA");
  if (data != nullptr && std::filesystem::is_directory(std::filesystem::path(data) / "7scenes")) {
    return (std::filesystem::path(data) / "7scenes").string();
  }
  return "synthetic:room?frames=80";
}

/// Integrates up to `frames` frames of a sequence without detections; calls
/// `each(map, delta)` after every one. Throws when the sequence cannot be read.
template <typename Each>
SemanticMap MakeRecordedMap(const std::string& path, int frames, const VoxelGridOptions& grid,
                            const Each& each) {
  DatasetOptions selection;
  selection.max_frames = frames;
  const auto dataset = OpenSequence(path, "", selection);
  if (!dataset) throw std::runtime_error(dataset.error().message);
  SemanticMap map(grid);
  for (size_t i = 0; i < (*dataset)->size(); ++i) {
    const auto sensor_frame = (*dataset)->Read(i);
    if (!sensor_frame) throw std::runtime_error(sensor_frame.error().message);
    const auto frame = DecodeFrame(*sensor_frame);
    if (!frame) throw std::runtime_error(frame.error().message);
    const SegmentedFrame segmented = SegmentFrame(*frame, nullptr, {});
    const FrameAssociation association = Associate(segmented, {map.voxels, map.labels}, {});
    const MapDelta delta = IntegrateFrame(segmented, association, {}, &map);
    each(map, delta);
  }
  return map;
}

}  // namespace vismap::testing_support
