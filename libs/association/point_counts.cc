#include "association/point_counts.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/prefetch.h"
#include "map/surface_reader.h"

namespace vismap {
namespace {

constexpr int kBandRows = 16;  // sampled rows that one thread counts at a time

/// A sampled pixel with depth and segment, and the voxel that it lies in.
struct Sample {
  int32_t segment = -1;
  int32_t offset = 0;                     // in the block
  const SurfaceVoxels* voxels = nullptr;  // nullptr where the map has no surface
};

Choices VoxelChoices(const SurfaceVoxels& voxels, int offset, const LabelTable& labels) {
  std::array<std::pair<int, SegmentLabel>, kVoteSlots>
      sums{};  // (-votes, label): sorts strongest first, then lower label
  size_t count = 0;
  for (int slot = 0; slot < kVoteSlots; ++slot) {
    const LabelVote vote = voxels.Vote(offset, slot);
    if (vote.label == SegmentLabel::kNone || vote.votes == 0) continue;
    const SegmentLabel label = labels.Canonical(vote.label);
    size_t i = 0;
    while (i < count && sums[i].second != label) ++i;
    if (i == count) sums[count++] = {0, label};
    sums[i].first -= vote.votes;
  }
  for (size_t i = 1; i < count; ++i) {
    for (size_t j = i; j > 0 && sums[j] < sums[j - 1]; --j) std::swap(sums[j], sums[j - 1]);
  }
  Choices choices{};
  for (size_t i = 0; i < count; ++i) choices[i] = sums[i].second;
  return choices;
}

/// Sorts the counts and adds up those with the same key.
void SortAndSum(std::vector<ChoiceCount>* counts) {
  std::sort(counts->begin(), counts->end());
  size_t kept = 0;
  for (size_t i = 0; i < counts->size(); ++i) {
    if (kept > 0 && (*counts)[kept - 1].SameKey((*counts)[i])) {
      (*counts)[kept - 1].points += (*counts)[i].points;
    } else {
      (*counts)[kept++] = (*counts)[i];
    }
  }
  counts->resize(kept);
}

/// Looks up the sampled pixels of a frame, row by row.
class PointLookup {
 public:
  PointLookup(const SegmentedFrame& frame, const MapView& map, const AssociationOptions& options)
      : frame_(frame),
        map_(map),
        options_(options),
        max_distance_(static_cast<float>(options.max_distance_voxels * map.voxels.voxel_size() *
                                         kTruncationSteps / map.voxels.truncation())),
        R_(frame.frame.header.T_W_C.linear() / map.voxels.voxel_size()),
        t_(frame.frame.header.T_W_C.translation() / map.voxels.voxel_size()) {}

  void CountRows(int v_begin, int v_end, FrameCounts* counts) const {
    std::vector<Sample> samples;
    SurfaceReader reader;
    for (int v = v_begin; v < v_end; v += options_.pixel_stride) {
      samples.clear();
      reader.Trim();
      Locate(v, &reader, &samples);
      Evaluate(samples, counts);
    }
    SortAndSum(&counts->choices);
  }

 private:
  /// Finds the voxels of one row, and prefetches them for Evaluate.
  void Locate(int v, SurfaceReader* reader, std::vector<Sample>* samples) const {
    const PinholeCamera& camera = frame_.frame.header.camera;
    const SegmentIndex* segments = frame_.image.index.row(v);
    const float* depth = frame_.frame.depth.row(v);
    // A point is z * ray + t, in voxels.
    const Eigen::Vector3d step = R_.col(0) / camera.fx;
    const Eigen::Vector3d ray0 = R_ * camera.BackProject(0, v, 1);
    VoxelMap::Reader blocks = map_.voxels.reader();
    BlockIndex cached{INT32_MAX, 0, 0};
    const SurfaceVoxels* voxels = nullptr;
    for (int u = 0; u < camera.width; u += options_.pixel_stride) {
      const int32_t segment = Raw(segments[u]);
      const double z = depth[u];
      // No segment, no depth, or out of range.
      if (segment < 0 || !(z > options_.min_range_m && z < options_.max_range_m)) continue;
      const Eigen::Vector3d cell = (z * (ray0 + u * step) + t_).array().floor();
      const VoxelIndex voxel{static_cast<int32_t>(cell.x()), static_cast<int32_t>(cell.y()),
                             static_cast<int32_t>(cell.z())};
      if (const BlockIndex index = BlockOf(voxel); index != cached) {
        cached = index;
        const Block* block = blocks.Find(index);
        voxels = block != nullptr ? reader->Read(*block) : nullptr;
      }
      const int offset = OffsetInBlock(voxel);
      if (voxels != nullptr) {
        const auto i = static_cast<size_t>(offset);
        PrefetchLine(&voxels->distance[i]);
        PrefetchLine(&voxels->weight[i]);
        PrefetchLine(&voxels->slot_label[i]);
        PrefetchLine(&voxels->slot_votes[i]);
      }
      samples->push_back({segment, offset, voxels});
    }
  }

  void Evaluate(const std::vector<Sample>& samples, FrameCounts* counts) const {
    const Sample* last = nullptr;  // the sample before, whose voxel has `choices`
    Choices choices{};
    for (const Sample& sample : samples) {
      ++counts->points[static_cast<size_t>(sample.segment)];
      if (sample.voxels == nullptr) continue;
      const bool same_voxel =
          last != nullptr && last->voxels == sample.voxels && last->offset == sample.offset;
      if (!same_voxel) choices = Read(sample);
      last = &sample;
      if (choices[0] == SegmentLabel::kNone) continue;
      const ChoiceCount one{sample.segment, choices, 1};
      if (!counts->choices.empty() && counts->choices.back().SameKey(one)) {
        ++counts->choices.back().points;
      } else {
        counts->choices.push_back(one);
      }
    }
  }

  /// The choices of a voxel near the surface; none for other voxels.
  Choices Read(const Sample& sample) const {
    const SurfaceVoxels& voxels = *sample.voxels;
    const auto i = static_cast<size_t>(sample.offset);
    if (voxels.weight[i] == 0 ||
        std::abs(static_cast<float>(voxels.distance[i])) >= max_distance_) {
      return {};
    }
    return VoxelChoices(voxels, sample.offset, map_.labels);
  }

  const SegmentedFrame& frame_;
  const MapView& map_;
  const AssociationOptions& options_;
  const float max_distance_;
  const Eigen::Matrix3d R_;  // camera to world, in voxels
  const Eigen::Vector3d t_;
};

}  // namespace

FrameCounts CountPoints(const SegmentedFrame& frame, const MapView& map,
                        const AssociationOptions& options) {
  const PointLookup lookup(frame, map, options);
  const int rows_per_band = kBandRows * options.pixel_stride;
  const int height = frame.image.index.height();
  std::vector<FrameCounts> bands(static_cast<size_t>((height + rows_per_band - 1) / rows_per_band));
  ParallelFor(bands.size(), 1, [&](size_t band) {
    bands[band].points.assign(frame.segments.size(), 0);
    const int v_begin = static_cast<int>(band) * rows_per_band;
    lookup.CountRows(v_begin, std::min(height, v_begin + rows_per_band), &bands[band]);
  });
  FrameCounts total;
  total.points.assign(frame.segments.size(), 0);
  for (const FrameCounts& band : bands) {
    total.choices.insert(total.choices.end(), band.choices.begin(), band.choices.end());
    for (size_t s = 0; s < total.points.size(); ++s) total.points[s] += band.points[s];
  }
  SortAndSum(&total.choices);
  return total;
}

}  // namespace vismap
