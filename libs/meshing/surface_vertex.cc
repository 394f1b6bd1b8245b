#include "meshing/surface_vertex.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "base/prefetch.h"

namespace vismap {
namespace {

// The three bytes of a voxel in the array at offset `member`, and the byte behind them.
uint32_t FourBytes(const CellGrid::Place& place, size_t member) {
  static_assert(std::is_standard_layout_v<SurfaceVoxels>);
  uint32_t bytes;
  const auto* voxels = reinterpret_cast<const std::byte*>(place.voxels);
  std::memcpy(&bytes, voxels + member + 3 * static_cast<size_t>(place.offset), sizeof(bytes));
  return bytes;
}

// The colour, and another byte above it.
uint32_t ColorOf(const CellGrid::Place& place) {
  return FourBytes(place, offsetof(SurfaceVoxels, color));
}

// The palette entries of the votes, one per byte, the first one lowest.
uint32_t EntriesOf(const CellGrid::Place& place) {
  static_assert(kVoteSlots == 3);
  return FourBytes(place, offsetof(SurfaceVoxels, slot_label)) & 0xFFFFFF;
}

// Counts, colours and votes lie all over a block, so that reading them without prefetching would
// stall.
void PrefetchVoxel(const CellGrid::Place& place) {
  if (place.voxels == nullptr) return;
  PrefetchLine(&place.voxels->observations[static_cast<size_t>(place.offset)]);
  PrefetchLine(&place.voxels->color[static_cast<size_t>(place.offset)]);
  PrefetchLine(&place.voxels->slot_label[static_cast<size_t>(place.offset)]);
  PrefetchLine(&place.voxels->slot_votes[static_cast<size_t>(place.offset)]);
}

// Which of four voxels have votes, by their twelve entries: bits 0 to 3.
unsigned VotedOfFour(const uint8_t* entries) {
  uint64_t low, high;
  std::memcpy(&low, entries, sizeof(low));
  std::memcpy(&high, entries + 4, sizeof(high));
  constexpr uint64_t kVoxel = 0xFFFFFF;
  return static_cast<unsigned>((low & kVoxel) != 0) |
         static_cast<unsigned>((low >> 24 & kVoxel) != 0) << 1 |
         static_cast<unsigned>((high >> 16 & kVoxel) != 0) << 2 |
         static_cast<unsigned>((high >> 40) != 0) << 3;
}

// The most frequent label; ties to the lower one.
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

// The voxels around an edge are those that share a corner with one of its ends: a box that begins
// one voxel below the lower end, three voxels wide, and four along the edge. As a set, voxel (x, y,
// z) of the box is bit x + 4 y + 16 z.
using Around = uint64_t;
constexpr int kAroundBits = 2;

// The ends of an edge and the voxels that share a face with an end, by the axis of the edge.
constexpr std::array<Around, 3> ListFaceNeighbours() {
  std::array<Around, 3> neighbours{};
  for (int axis = 0; axis < 3; ++axis) {
    for (int bit = 0; bit < 64; ++bit) {
      int outside = 0, faces = 0;
      for (int i = 0; i < 3; ++i) {
        const int at = bit >> (kAroundBits * i) & 3, last = i == axis ? 3 : 2;
        outside += at > last;
        faces += at == 0 || at == last;
      }
      if (outside == 0 && faces <= 1) neighbours[static_cast<size_t>(axis)] |= Around{1} << bit;
    }
  }
  return neighbours;
}
constexpr std::array<Around, 3> kFaceNeighbours = ListFaceNeighbours();

}  // namespace

void VertexMaker::Make(BlockIndex block, const CrossedEdges& edges,
                       std::vector<MeshVertex>* vertices) {
  const auto first = [](int32_t index) { return static_cast<double>(index) * kBlockSide + 0.5; };
  const VoxelCenters centers{{first(block.x), first(block.y), first(block.z)}, voxel_size_};
  const std::span<const uint16_t> slots = edges.slots();
  vertices->reserve(slots.size());
  for (size_t from = 0; from < slots.size(); from += kVertexLanes) {
    const size_t count = std::min(slots.size() - from, kVertexLanes);
    const size_t groups = (count + kVertexGroup - 1) / kVertexGroup;
    std::copy_n(slots.begin() + static_cast<std::ptrdiff_t>(from), count, lanes_.slot.begin());
    LocateEnds(groups, lanes_);
    LoadStars(edges, from, from + count);
    PlaceVertices(groups, centers, lanes_);
    for (size_t i = 0; i < count; ++i) LoadColors(i);
    BlendColors(groups, lanes_);
    for (size_t i = 0; i < count; ++i) vertices->push_back(VertexAt(i));
  }
}

inline void VertexMaker::LoadStars(const CrossedEdges& edges, size_t from, size_t to) {
  size_t lane = 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    const size_t step = AxisStep(axis), end = std::min(edges.FirstAlong(axis + 1), to);
    for (; from < end; ++from, ++lane) {
      const int16_t* lower = grid_.Lower(edges.slots()[from]);
      const int16_t* upper = lower + step;
      for (size_t i = 0; i < kStar.size(); ++i) {
        lanes_.lower[i][lane] = lower[kStar[i]];
        lanes_.upper[i][lane] = upper[kStar[i]];
      }
      PrefetchEnds(lane);
    }
  }
}

inline void VertexMaker::PrefetchEnds(size_t lane) const {
  PrefetchVoxel(grid_.PlaceOfEnd(lanes_.lower_end[lane]));
  PrefetchVoxel(grid_.PlaceOfEnd(lanes_.upper_end[lane]));
}

inline void VertexMaker::LoadColors(size_t lane) {
  CellGrid::Place a = grid_.PlaceOfEnd(lanes_.lower_end[lane]);
  CellGrid::Place b = grid_.PlaceOfEnd(lanes_.upper_end[lane]);
  // Free blocks have no colours. The end behind the surface is never in a free block.
  if (a.voxels == nullptr) a = b;
  if (b.voxels == nullptr) b = a;
  lanes_.lower_color[lane] = ColorOf(a);
  lanes_.upper_color[lane] = ColorOf(b);
}

inline MeshVertex VertexMaker::VertexAt(size_t lane) const {
  const auto& [x, y, z] = lanes_.position;
  const auto& [nx, ny, nz] = lanes_.normal;
  const uint32_t color = lanes_.color[lane];
  const ShownLabel label = LabelOf(lane);
  return {{x[lane], y[lane], z[lane]},
          {nx[lane], ny[lane], nz[lane]},
          {static_cast<uint8_t>(color), static_cast<uint8_t>(color >> 8),
           static_cast<uint8_t>(color >> 16)},
          label.segment,
          label.instance,
          label.class_id,
          SeenOf(lane)};
}

inline uint8_t VertexMaker::SeenOf(size_t lane) const {
  const uint32_t nearer = lanes_.nearer_end[lane];
  CellGrid::Place place = grid_.PlaceOfEnd(nearer);
  if (place.voxels == nullptr)
    place = grid_.PlaceOfEnd(lanes_.lower_end[lane] ^ lanes_.upper_end[lane] ^ nearer);
  return place.voxels->observations[static_cast<size_t>(place.offset)];
}

inline ShownLabel VertexMaker::LabelOf(size_t lane) const {
  const uint32_t nearer = lanes_.nearer_end[lane];
  SegmentLabel label = LabelAt(grid_.PlaceOfEnd(nearer));
  if (label == SegmentLabel::kNone) {
    const uint32_t farther = lanes_.lower_end[lane] ^ lanes_.upper_end[lane] ^ nearer;
    label = LabelAt(grid_.PlaceOfEnd(farther));
  }
  if (label == SegmentLabel::kNone) label = LabelAround(EdgeOfSlot(lanes_.slot[lane]));
  return Raw(label) < shown_.size() ? shown_[Raw(label)] : ShownLabel{.segment = label};
}

inline SegmentLabel VertexMaker::LabelAt(const CellGrid::Place& place) const {
  if (place.voxels == nullptr) return SegmentLabel::kNone;
  const uint32_t entries = EntriesOf(place);
  return entries == 0 ? SegmentLabel::kNone : LabelOfVotes(place, entries);
}

inline SegmentLabel VertexMaker::LabelOfVotes(const CellGrid::Place& place,
                                              uint32_t entries) const {
  const std::vector<SegmentLabel>& palette = place.voxels->palette;
  if (entries <= 0xFF) return palette[entries - 1];  // most voxels have one label
  // Without branches, since the processor cannot predict how many slots are used.
  const auto& counts = place.voxels->slot_votes[static_cast<size_t>(place.offset)];
  std::array<LabelVote, kVoteSlots> votes;
  for (size_t slot = 0; slot < kVoteSlots; ++slot) {
    const uint32_t entry = entries >> (8 * slot) & 0xFF;
    const SegmentLabel label = Canonical(palette[entry != 0 ? entry - 1 : 0]);
    votes[slot] = {entry != 0 ? label : SegmentLabel::kNone, counts[slot]};
  }
  return StrongestLabel(votes);
}

SegmentLabel VertexMaker::LabelAround(const LatticeEdge& edge) const {
  const Around voted = VotedAround(edge);
  const Around beside = voted & kFaceNeighbours[static_cast<size_t>(edge.axis)];
  std::array<SegmentLabel, kMostAround> labels;
  size_t count = 0;
  bool same = true;
  for (Around left = beside != 0 ? beside : voted; left != 0; left &= left - 1) {
    const int bit = std::countr_zero(left);
    const auto at = [bit](int axis) { return (bit >> (kAroundBits * axis) & 3) - 1; };
    const CellGrid::Place place = grid_.PlaceOf(edge.x + at(0), edge.y + at(1), edge.z + at(2));
    labels[count] = Canonical(LabelOfVotes(place, EntriesOf(place)));
    same = same && labels[count] == labels[0];
    ++count;
  }
  if (same) return count == 0 ? SegmentLabel::kNone : labels[0];  // the usual case
  return MostFrequent(std::span(labels).first(count));
}

inline uint64_t VertexMaker::VotedAround(const LatticeEdge& edge) const {
  constexpr int kRead = 4;  // voxels read at once
  const int first = edge.x - 1, at = first & (kBlockSide - 1), from = std::min(at, kRead);
  const int count = 3 + (edge.axis == 0);
  const int high_y = edge.y + 1 + (edge.axis == 1), high_z = edge.z + 1 + (edge.axis == 2);
  const auto read = [&](int x, int y, int z) -> unsigned {
    const CellGrid::Place place = grid_.PlaceOf(x, y, z);
    if (place.voxels == nullptr) return 0;
    return VotedOfFour(place.voxels->slot_label[static_cast<size_t>(place.offset)].data());
  };
  Around voted = 0;
  for (int z = edge.z - 1, layer = 0; z <= high_z; ++z, layer += 1 << (2 * kAroundBits)) {
    for (int y = edge.y - 1, shift = layer; y <= high_y; ++y, shift += 1 << kAroundBits) {
      unsigned row = read(first - at + from, y, z) >> (at - from);
      if (at + count > kBlockSide) row |= read(first - at + kBlockSide, y, z) << (kBlockSide - at);
      voted |= Around{row & ((1U << count) - 1)} << shift;
    }
  }
  return voted;
}

}  // namespace vismap
