#include "viewer/slice_distances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "navigation/distance_kernels.h"
#include "wire/channels.h"
#include "wire/envelope.h"

namespace vismap {
namespace {

constexpr float kNoDistance = std::numeric_limits<float>::quiet_NaN();

/// The two axes that a slice across `axis` has.
std::array<size_t, 2> PlaneAxes(int axis) {
  return {axis == 0 ? size_t{1} : size_t{0}, axis == 2 ? size_t{1} : size_t{2}};
}

/// Distances at the centres of leaves of an update.
class UpdateDistances {
 public:
  explicit UpdateDistances(const DistanceUpdate& update) : update_(update) {}

  float At(const std::array<int32_t, 3>& leaf) {
    const VoxelIndex index{leaf[0], leaf[1], leaf[2]};
    if (!block_ || *block_ != BlockOf(index)) Find(BlockOf(index));
    if (found_ == nullptr) return kNoDistance;
    const auto offset = static_cast<size_t>(OffsetInBlock(index));
    if (found_->unknown[offset] == 0) return kNoDistance;  // the leaf itself is unknown
    const uint16_t squared = found_->obstacle[offset];
    if (squared == kBeyond) return static_cast<float>(update_.limit_m);
    return static_cast<float>(std::sqrt(static_cast<double>(squared)) * update_.leaf_m / 2);
  }

 private:
  void Find(BlockIndex block) {
    block_ = block;
    const auto found =
        std::lower_bound(update_.blocks.begin(), update_.blocks.end(), block,
                         [](const auto& entry, const BlockIndex& b) { return entry.first < b; });
    const bool there = found != update_.blocks.end() && found->first == block && found->second;
    found_ = there ? &*found->second : nullptr;
  }

  const DistanceUpdate& update_;
  std::optional<BlockIndex> block_;  // the last one
  const BlockDistances* found_ = nullptr;
};

/// Between the centres of the four leaves around a point of the plane, linear; where one of them is
/// unknown, that of the leaf with the point.
class PlaneDistances {
 public:
  PlaneDistances(const DistanceUpdate& update, const SliceQuestion& question)
      : leaves_(update), leaf_m_(update.leaf_m), others_(PlaneAxes(question.axis)) {
    index_[static_cast<size_t>(question.axis)] =
        static_cast<int32_t>(std::floor(question.at_m / leaf_m_));
  }

  float At(double u_m, double v_m) {
    const double u = u_m / leaf_m_ - 0.5, v = v_m / leaf_m_ - 0.5;
    const double left = std::floor(u), low = std::floor(v);
    const auto a = static_cast<float>(u - left), b = static_cast<float>(v - low);
    const float sum = (1 - b) * ((1 - a) * Leaf(left, low) + a * Leaf(left + 1, low)) +
                      b * ((1 - a) * Leaf(left, low + 1) + a * Leaf(left + 1, low + 1));
    const float own = Leaf(std::floor(u_m / leaf_m_), std::floor(v_m / leaf_m_));
    return std::isnan(sum) || std::isnan(own) ? own : sum;
  }

 private:
  float Leaf(double u, double v) {
    index_[others_[0]] = static_cast<int32_t>(u);
    index_[others_[1]] = static_cast<int32_t>(v);
    return leaves_.At(index_);
  }

  UpdateDistances leaves_;
  double leaf_m_;
  std::array<size_t, 2> others_;
  std::array<int32_t, 3> index_{};
};

}  // namespace

map_request_t DistanceRequest(const Slice& slice, const SliceQuestion& question) {
  constexpr double kThin = 1e-3;   // of the box across the slice [m]
  constexpr double kAround = 0.5;  // more than a leaf, so that the rim has neighbours [m]
  map_request_t request{};         // also sets its numbers to 0
  request.verb = "distances";
  request.unknown = map_request_t::UNKNOWN_DEFAULT;
  request.has_bbx = true;
  request.bbx_min_W[question.axis] = question.at_m - kThin / 2;
  request.bbx_max_W[question.axis] = question.at_m + kThin / 2;
  const std::array<size_t, 2> others = PlaneAxes(question.axis);
  const std::array<int, 2> cells = {slice.width, slice.height};
  for (size_t i = 0; i < 2; ++i) {
    request.bbx_min_W[others[i]] = slice.origin_m[i] - kAround;
    request.bbx_max_W[others[i]] = slice.origin_m[i] + cells[i] * slice.cell_m + kAround;
  }
  return request;
}

Result<SliceDistances> ReadDistances(const std::vector<uint8_t>& payload, const Slice& slice,
                                     const SliceQuestion& question) {
  const auto message = Unpack<distance_field_t>(payload, kDistancesChannel.max_bytes);
  if (!message) return tl::unexpected(message.error());
  const Result<DistanceUpdate> update = Decode(*message);
  if (!update) return tl::unexpected(update.error());
  return DistancesOf(slice, question, *update);
}

SliceDistances DistancesOf(const Slice& slice, const SliceQuestion& question,
                           const DistanceUpdate& update) {
  SliceDistances distances{update.leaf_m, update.limit_m, {}};
  distances.metres.reserve(slice.states.size());
  PlaneDistances plane(update, question);
  for (int row = 0; row < slice.height; ++row) {
    for (int column = 0; column < slice.width; ++column) {
      distances.metres.push_back(plane.At(slice.origin_m[0] + (column + 0.5) * slice.cell_m,
                                          slice.origin_m[1] + (row + 0.5) * slice.cell_m));
    }
  }
  return distances;
}

}  // namespace vismap
