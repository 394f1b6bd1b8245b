#include "meshing/surface_vertex.h"

#include <algorithm>

namespace vismap {
namespace {

Rgb8 Blend(Rgb8 a, Rgb8 b, float t) {
  constexpr uint32_t kOne = 256;
  const auto share = static_cast<uint32_t>(static_cast<int>(t * float{kOne} + 0.5F));
  const auto mix = [share](uint32_t low, uint32_t high) {
    return static_cast<uint8_t>((low * (kOne - share) + high * share + kOne / 2) / kOne);
  };
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

Rgb8 ColorOf(const CellGrid::Place& a, const CellGrid::Place& b, float t) {
  const auto color = [](const CellGrid::Place& place) {
    return place.voxels->color[static_cast<size_t>(place.offset)];
  };
  if (a.voxels != nullptr && b.voxels != nullptr) return Blend(color(a), color(b), t);
  if (a.voxels != nullptr) return color(a);
  return b.voxels != nullptr ? color(b) : Rgb8{};
}

// Colours and votes come from all over a block: without this every one of them is waited for.
void PrefetchVoxel(const CellGrid::Place& place) {
  if (place.voxels == nullptr) return;
  __builtin_prefetch(&place.voxels->color[static_cast<size_t>(place.offset)]);
  __builtin_prefetch(&place.voxels->slot_label[static_cast<size_t>(place.offset)]);
}

bool HasVotes(const CellGrid::Place& place) {
  if (place.voxels == nullptr) return false;
  const auto& entries = place.voxels->slot_label[static_cast<size_t>(place.offset)];
  return (entries[0] | entries[1] | entries[2]) != 0;
}

// The most frequent one; ties to the lower.
SegmentLabel MostFrequent(std::span<SegmentLabel> labels) {
  std::sort(labels.begin(), labels.end());
  SegmentLabel best = SegmentLabel::kNone;
  size_t most = 0;
  for (size_t i = 0, end = 0; i < labels.size(); i = end) {
    while (end < labels.size() && labels[end] == labels[i]) ++end;
    if (end - i > most) best = labels[i];
    most = std::max(most, end - i);
  }
  return best;
}

}  // namespace

void VertexMaker::Prefetch(const SurfaceVoxels& voxels) {
  constexpr size_t kPerLine = 64 / 3;  // colours and votes have three bytes a voxel
  for (size_t i = 0; i < kBlockVoxels; i += kPerLine) {
    __builtin_prefetch(&voxels.color[i]);
    __builtin_prefetch(&voxels.slot_label[i]);
  }
  __builtin_prefetch(&voxels.palette);
}

void VertexMaker::Make(BlockIndex block, std::span<const uint16_t> edges,
                       std::vector<MeshVertex>* vertices) {
  StartBlock(block);
  vertices->reserve(edges.size());
  while (!edges.empty()) {
    const auto some = edges.first(std::min<size_t>(edges.size(), kVertexLanes));
    for (size_t i = 0; i < some.size(); ++i) LoadLane(some[i], i);
    PlaceVertices(lanes_);
    for (size_t i = 0; i < some.size(); ++i) FinishVertex(i, &vertices->emplace_back());
    edges = edges.subspan(some.size());
  }
}

void VertexMaker::StartBlock(BlockIndex block) {
  const std::array<int32_t, 3> index{block.x, block.y, block.z};
  for (size_t axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < kSlotSide; ++i) {
      const double first = static_cast<double>(index[axis]) * kBlockSide;
      centers_[axis][i] = first + static_cast<double>(i) + 0.5;
      centers_W_[axis][i] = static_cast<float>(centers_[axis][i] * voxel_size_);
    }
  }
}

inline void VertexMaker::LoadLane(uint16_t slot, size_t lane) {
  const int16_t* lower = grid_.Lower(slot);
  const int16_t* upper = grid_.Upper(slot);
  for (size_t i = 0; i < kStar.size(); ++i) {
    lanes_.lower[i][lane] = lower[kStar[i]];
    lanes_.upper[i][lane] = upper[kStar[i]];
  }
  lanes_.axis[lane] = static_cast<int16_t>(slot / kAxisSlots);
  Origin& origin = origins_[lane];
  origin = {slot, {grid_.LowerPlace(slot), grid_.UpperPlace(slot)}};
  for (const CellGrid::Place& end : origin.ends) PrefetchVoxel(end);
}

inline void VertexMaker::FinishVertex(size_t lane, MeshVertex* vertex) const {
  const auto& [slot, ends] = origins_[lane];
  const float t = lanes_.t[lane];
  const LatticeEdge edge = EdgeOfSlot(slot);
  const auto center = [this](int axis, int at) {
    return centers_W_[static_cast<size_t>(axis)][static_cast<size_t>(at)];
  };
  vertex->position_W = {center(0, edge.x), center(1, edge.y), center(2, edge.z)};
  const int along = slot >> (kSlotBits * edge.axis) & (kSlotStride - 1);
  const double lower = centers_[static_cast<size_t>(edge.axis)][static_cast<size_t>(along)];
  vertex->position_W[edge.axis] =
      static_cast<float>((lower + static_cast<double>(t)) * voxel_size_);
  vertex->normal_W = {lanes_.normal[0][lane], lanes_.normal[1][lane], lanes_.normal[2][lane]};
  vertex->color = ColorOf(ends[0], ends[1], t);
  const ShownLabel label = LabelOf(lane);
  vertex->segment = label.segment;
  vertex->instance = label.instance;
  vertex->class_id = label.class_id;
}

ShownLabel VertexMaker::LabelOf(size_t lane) const {
  const auto& [slot, ends] = origins_[lane];
  const size_t nearer = lanes_.t[lane] <= 0.5F ? 0 : 1;
  SegmentLabel label = LabelAt(ends[nearer]);
  if (label == SegmentLabel::kNone) label = LabelAt(ends[1 - nearer]);
  if (label == SegmentLabel::kNone) label = LabelAround(EdgeOfSlot(slot));
  return Raw(label) < shown_.size() ? shown_[Raw(label)] : ShownLabel{.segment = label};
}

inline SegmentLabel VertexMaker::LabelAt(const CellGrid::Place& place) const {
  return HasVotes(place) ? LabelOfVotes(*place.voxels, place.offset) : SegmentLabel::kNone;
}

inline SegmentLabel VertexMaker::LabelOfVotes(const SurfaceVoxels& voxels, int offset) const {
  const auto& entries = voxels.slot_label[static_cast<size_t>(offset)];
  if ((entries[1] | entries[2]) == 0) return Canonical(voxels.palette[entries[0] - 1u]);  // mostly
  std::array<LabelVote, kVoteSlots> votes;
  for (int slot = 0; slot < kVoteSlots; ++slot) {
    LabelVote& vote = votes[static_cast<size_t>(slot)];
    vote = voxels.Vote(offset, slot);
    vote.label = Canonical(vote.label);
  }
  return StrongestLabel(votes);
}

SegmentLabel VertexMaker::LabelAround(const LatticeEdge& edge) const {
  VoxelsAround voted;
  size_t count = ListBeside(edge, &voted);
  if (count == 0) count = ListAround(edge, &voted);
  std::array<SegmentLabel, kMostAround> labels;
  bool same = true;
  for (size_t i = 0; i < count; ++i) {
    labels[i] = LabelOfVotes(*voted[i].voxels, voted[i].offset);
    same = same && labels[i] == labels[0];
  }
  if (same) return count == 0 ? SegmentLabel::kNone : labels[0];  // mostly
  return MostFrequent(std::span(labels).first(count));
}

// Both without branches: which voxels have votes cannot be foreseen.

size_t VertexMaker::ListBeside(const LatticeEdge& edge, VoxelsAround* voted) const {
  size_t count = 0;
  const auto add = [&](const Eigen::Vector3i& at) {
    (*voted)[count] = grid_.PlaceOf(at.x(), at.y(), at.z());
    count += HasVotes((*voted)[count]) ? 1 : 0;
  };
  const Eigen::Vector3i lower(edge.x, edge.y, edge.z), along = Eigen::Vector3i::Unit(edge.axis);
  const Eigen::Vector3i upper = lower + along;
  add(lower - along);
  add(upper + along);
  for (const int turn : {1, 2}) {
    const Eigen::Vector3i aside = Eigen::Vector3i::Unit((edge.axis + turn) % 3);
    for (const Eigen::Vector3i& end : {lower, upper}) {
      add(end - aside);
      add(end + aside);
    }
  }
  return count;
}

size_t VertexMaker::ListAround(const LatticeEdge& edge, VoxelsAround* voted) const {
  const int high_x = edge.x + 1 + (edge.axis == 0);
  const int high_y = edge.y + 1 + (edge.axis == 1);
  const int high_z = edge.z + 1 + (edge.axis == 2);
  size_t count = 0;
  for (int z = edge.z - 1; z <= high_z; ++z) {
    for (int y = edge.y - 1; y <= high_y; ++y) {
      for (int x = edge.x - 1; x <= high_x; ++x) {
        (*voted)[count] = grid_.PlaceOf(x, y, z);
        count += HasVotes((*voted)[count]) ? 1 : 0;
      }
    }
  }
  return count;
}

}  // namespace vismap
