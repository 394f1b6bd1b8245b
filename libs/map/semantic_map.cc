#include "map/semantic_map.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "base/digest.h"
#include "base/parallel.h"
#include "map/map_bytes.h"
#include "map/surface_reader.h"

namespace vismap {
namespace {

void AppendBytes(const void* data, size_t size, std::vector<uint8_t>& bytes) {
  const auto* first = static_cast<const uint8_t*>(data);
  bytes.insert(bytes.end(), first, first + size);
}

// Votes are written as labels, not as palette entries, so that blocks with the same content have
// the same bytes.
void AppendSurface(const SurfaceVoxels& voxels, std::vector<uint8_t>& bytes) {
  AppendBytes(voxels.distance.data(), sizeof(voxels.distance), bytes);
  AppendBytes(voxels.weight.data(), sizeof(voxels.weight), bytes);
  AppendBytes(voxels.observations.data(), sizeof(voxels.observations), bytes);
  AppendBytes(voxels.color.data(), sizeof(voxels.color), bytes);
  for (int voxel = 0; voxel < kBlockVoxels; ++voxel) {
    for (int slot = 0; slot < kVoteSlots; ++slot) {
      const LabelVote vote = voxels.Vote(voxel, slot);
      if (vote.label == SegmentLabel::kNone) continue;
      const std::array<uint32_t, 4> record{
          static_cast<uint32_t>(voxel), static_cast<uint32_t>(slot), Raw(vote.label), vote.votes};
      AppendBytes(record.data(), sizeof(record), bytes);
    }
  }
}

uint64_t BlockChecksum(BlockIndex index, const Block& block) {
  std::vector<uint8_t> bytes;
  bytes.reserve(sizeof(SurfaceVoxels));
  AppendBytes(&index, sizeof(index), bytes);
  if (block.surface) {
    bytes.push_back('S');
    SurfaceReader reader;
    AppendSurface(*reader.Read(block), bytes);
  } else if (block.free) {
    bytes.push_back('F');
    AppendBytes(block.free->once.data(), sizeof(block.free->once), bytes);
    AppendBytes(block.free->twice.data(), sizeof(block.free->twice), bytes);
  } else {
    bytes.push_back(block.all_free ? 'A' : 'U');
  }
  return Checksum64(bytes);
}

void AddRecord(const LabelRecord& record, Digest& digest) {
  digest.Add(record.merged_into);
  digest.Add(record.frames);
  digest.Add(record.frames_with_detector);
  digest.Add(record.pixels);
  digest.Add(record.first_utime);
  digest.Add(record.last_utime);
  if (record.cleared_voxels > 0) {  // so that maps made without carving keep their hash
    digest.Add(record.cleared_voxels);
    digest.Add(record.cleared_utime);
  }
  digest.Add(record.instance_evidence.size());
  for (const auto& [instance, evidence] : record.instance_evidence) {
    digest.Add(instance);
    digest.Add(evidence);
  }
  digest.Add(record.class_evidence.size());
  for (const auto& [class_id, evidence] : record.class_evidence) {
    digest.Add(class_id);
    digest.Add(evidence);
  }
}

}  // namespace

size_t BytesOf(const SemanticMap& map) {
  return map.voxels.bytes() + BytesOf(map.labels) + TrajectoryBytes(map.revision);
}

size_t BytesOf(const LabelTable& labels) {
  constexpr size_t kLabel = sizeof(LabelRecord) + 192, kPair = 96;  // a label has some evidence
  return labels.records().size() * kLabel +
         (labels.pairs().size() + labels.bonds().pairs().size()) * kPair;
}

size_t TrajectoryBytes(int64_t frames) {
  constexpr size_t kFrame = 256;  // its pose and its time
  return static_cast<size_t>(std::max<int64_t>(frames, 0)) * kFrame;
}

SegmentLabel StrongestLabel(const std::array<LabelVote, kVoteSlots>& votes) {
  // Without branches, since the processor cannot predict which label leads. A label that is there
  // twice has its sum both times. More votes rank first, then the lower label.
  uint64_t best = 0;
  for (const LabelVote& vote : votes) {
    uint64_t sum = 0;
    for (const LabelVote& other : votes) sum += other.label == vote.label ? other.votes : 0;
    const uint64_t rank = (sum + 1) << 32 | (~Raw(vote.label) & 0xFFFFFFFFu);
    best = std::max(best, vote.label == SegmentLabel::kNone ? 0 : rank);
  }
  return best == 0 ? SegmentLabel::kNone : static_cast<SegmentLabel>(~static_cast<uint32_t>(best));
}

std::string HashMap(const SemanticMap& map) {
  Digest digest;
  digest.Add(map.voxels.voxel_size());
  digest.Add(map.voxels.truncation());
  digest.Add(map.revision);
  digest.Add(map.last_utime);

  const std::vector<BlockIndex> indices = map.voxels.SortedIndices();
  std::vector<uint64_t> checksums(indices.size());
  ParallelFor(indices.size(), 64, [&](size_t i) {
    checksums[i] = BlockChecksum(indices[i], *map.voxels.Find(indices[i]));
  });
  digest.AddBytes(checksums.data(), checksums.size() * sizeof(uint64_t));

  digest.Add(map.labels.next_instance());
  digest.Add(map.labels.records().size());
  for (const LabelRecord& record : map.labels.records()) AddRecord(record, digest);
  for (const auto& [pair, evidence] : map.labels.pairs()) {
    digest.Add(pair.first);
    digest.Add(pair.second);
    digest.Add(evidence.together);
    digest.Add(evidence.apart);
  }
  for (const auto& [pair, bond] : map.labels.bonds().pairs()) {
    digest.Add(pair.first);
    digest.Add(pair.second);
    digest.Add(bond);
  }
  return digest.Hex();
}

}  // namespace vismap
