#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "map/semantic_map.h"
#include "support/voxel_reading.h"

namespace vismap::testing_support {

/// A scene given by functions of the point p_W [m]. Empty functions mean "no labels" and "black".
struct AnalyticScene {
  std::function<double(const Eigen::Vector3d&)>
      distance{};  ///< to the surface [m], + in free space
  std::function<SegmentLabel(const Eigen::Vector3d&)> label{};  ///< of the nearest surface
  std::function<Rgb8(const Eigen::Vector3d&)> color{};
};

/// The part of the world that was seen, and how often.
struct AnalyticRegion {
  Eigen::Vector3d min_W = Eigen::Vector3d::Constant(-1);  ///< [m]
  Eigen::Vector3d max_W = Eigen::Vector3d::Constant(1);   ///< voxels with their centre inside
  int observations = 5;  ///< frames that saw every voxel, also its label votes; 1..255
};

/// Signed distances of simple solids, + outside [m].
inline double SphereDistance(const Eigen::Vector3d& p, const Eigen::Vector3d& center, double r) {
  return (p - center).norm() - r;
}
inline double BoxDistance(const Eigen::Vector3d& p, const Eigen::Vector3d& center,
                          const Eigen::Vector3d& half_size) {
  const Eigen::Vector3d q = (p - center).cwiseAbs() - half_size;
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
}

namespace analytic_detail {

inline void SetVote(SurfaceVoxels* voxels, int offset, SegmentLabel label, int votes) {
  auto& palette = voxels->palette;
  auto entry = std::find(palette.begin(), palette.end(), label);
  if (entry == palette.end()) entry = palette.insert(palette.end(), label);
  const auto i = static_cast<size_t>(offset);
  voxels->slot_label[i][0] = static_cast<uint8_t>(entry - palette.begin() + 1);
  voxels->slot_votes[i][0] = static_cast<uint8_t>(votes);
}

// Builds one block of the map.
struct BlockBuilder {
  std::unique_ptr<SurfaceVoxels> surface = std::make_unique<SurfaceVoxels>();
  std::unique_ptr<FreeVoxels> free = std::make_unique<FreeVoxels>();
  int near = 0;
  int seen_free = 0;

  void Add(const AnalyticScene& scene, const Eigen::Vector3d& p_W, int offset, int observations,
           const VoxelMap& map) {
    const double d = scene.distance(p_W);
    if (d <= -map.truncation()) return;  // inside a solid: no camera sees it
    const auto i = static_cast<size_t>(offset);
    const double clamped = std::min(d, map.truncation());
    surface->distance[i] =
        static_cast<int16_t>(std::lround(clamped / map.truncation() * kTruncationSteps));
    surface->weight[i] =
        static_cast<uint16_t>(std::min(65535.0F, static_cast<float>(observations) * kWeightScale));
    surface->observations[i] = static_cast<uint8_t>(observations);
    if (d >= map.truncation()) {
      ++seen_free;
      free->once[i / 64] |= uint64_t{1} << (i % 64);
      if (observations > 1) free->twice[i / 64] |= uint64_t{1} << (i % 64);
      return;
    }
    ++near;
    if (scene.color) surface->color[i] = scene.color(p_W);
    if (!scene.label || std::abs(d) > map.voxel_size()) return;
    const SegmentLabel label = scene.label(p_W);
    if (label != SegmentLabel::kNone) SetVote(surface.get(), offset, label, observations);
  }

  void Store(BlockIndex index, int observations, VoxelMap* map) {
    if (near == 0 && seen_free == 0) return;
    Block& block = map->FindOrCreate(index);
    if (near > 0) {
      block.surface = std::move(surface);
    } else if (seen_free == kBlockVoxels && observations > 1) {
      block.all_free = true;
    } else {
      block.free = std::move(free);
    }
  }
};

}  // namespace analytic_detail

/// The map that a perfect sensor would leave of `scene` in `region`: voxels nearer than the
/// truncation distance in surface blocks, the rest of the free side as free blocks, the inside of
/// solids unseen. Voxels within one voxel of the surface carry `observations` votes for their
/// label. All labels up to the highest are in the label table, with no evidence yet.
inline SemanticMap MakeAnalyticMap(const AnalyticScene& scene, const AnalyticRegion& region,
                                   const VoxelGridOptions& grid = {}) {
  SemanticMap map(grid);
  const BlockIndex low = BlockOf(VoxelAt(map.voxels, region.min_W));
  const BlockIndex high = BlockOf(VoxelAt(map.voxels, region.max_W));
  for (BlockIndex b{low.x, 0, 0}; b.x <= high.x; ++b.x) {
    for (b.y = low.y; b.y <= high.y; ++b.y) {
      for (b.z = low.z; b.z <= high.z; ++b.z) {
        analytic_detail::BlockBuilder builder;
        for (int offset = 0; offset < kBlockVoxels; ++offset) {
          const VoxelIndex voxel{b.x * kBlockSide + offset % 8, b.y * kBlockSide + offset / 8 % 8,
                                 b.z * kBlockSide + offset / 64};
          const Eigen::Vector3d p_W = VoxelCenter(map.voxels, voxel);
          if ((p_W.array() < region.min_W.array()).any()) continue;
          if ((p_W.array() >= region.max_W.array()).any()) continue;
          builder.Add(scene, p_W, offset, region.observations, map.voxels);
        }
        builder.Store(b, region.observations, &map.voxels);
      }
    }
  }
  SegmentLabel highest = SegmentLabel::kNone;
  map.voxels.blocks().ForEach([&](BlockIndex, const Block& block) {
    if (!block.surface) return;
    for (const SegmentLabel label : block.surface->palette) highest = std::max(highest, label);
  });
  map.labels.GrowLabels(static_cast<SegmentLabel>(Raw(highest) + 1));
  map.revision = region.observations;
  map.last_utime = 1'000'000;
  return map;
}

/// Records that `label` was seen in `frames` frames, all with a detector, and that in
/// `frames_with_instance` of them a detection of `class_id` made it part of `instance`.
inline void AddEvidence(SemanticMap* map, SegmentLabel label, InstanceId instance, ClassId class_id,
                        int frames, int frames_with_instance) {
  if (map->labels.next_label() <= label) {
    map->labels.GrowLabels(static_cast<SegmentLabel>(Raw(label) + 1));
  }
  if (map->labels.next_instance() <= instance) {
    map->labels.GrowInstances(static_cast<InstanceId>(Raw(instance) + 1));
  }
  LabelRecord& record = map->labels.MutableRecord(label);
  record.frames += static_cast<uint32_t>(frames);
  record.frames_with_detector += static_cast<uint32_t>(frames);
  record.first_utime = 1'000;
  record.last_utime = 1'000'000;
  if (instance == InstanceId::kNone) return;
  record.instance_evidence[instance] += static_cast<float>(frames_with_instance);
  record.class_evidence[class_id] += static_cast<float>(frames_with_instance);
}

}  // namespace vismap::testing_support
