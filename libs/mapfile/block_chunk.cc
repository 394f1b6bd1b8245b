#include "mapfile/block_chunk.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "base/require.h"
#include "map/surface_reader.h"

namespace vismap::mapfile {
namespace {

enum class BlockKind : uint8_t { kUnseen = 0, kSurface = 1, kFree = 2, kAllFree = 3 };

constexpr size_t kChunkBytes = size_t{1} << 19;
constexpr int32_t kMaxIndex = 1 << 27;  // so that voxel indices fit 31 bits

BlockKind KindOf(const Block& block) {
  Require(static_cast<bool>(block.surface) + (block.free != nullptr) + block.all_free <= 1,
          "a block is one of surface, free and all free");
  if (block.surface) return BlockKind::kSurface;
  if (block.free) return BlockKind::kFree;
  return block.all_free ? BlockKind::kAllFree : BlockKind::kUnseen;
}

/// The low bytes of all weights, then the high ones: that takes half as long to compress, and less
/// space. The other fields do not gain by it.
using SplitWeights = std::array<uint8_t, 2 * kBlockVoxels>;

SplitWeights Split(const std::array<uint16_t, kBlockVoxels>& weights) {
  SplitWeights split;
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    split[i] = static_cast<uint8_t>(weights[i] & 0xff);
    split[kBlockVoxels + i] = static_cast<uint8_t>(weights[i] >> 8);
  }
  return split;
}

std::array<uint16_t, kBlockVoxels> Join(const SplitWeights& split) {
  std::array<uint16_t, kBlockVoxels> weights;
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    weights[i] = static_cast<uint16_t>(split[i] | split[kBlockVoxels + i] << 8);
  }
  return weights;
}

/// Calls `field(member)` for every other fixed-size member of surface voxels, in the order of the
/// file.
template <typename Field>
void ForEachField(const Field& field) {
  field(&SurfaceVoxels::distance);
  field(&SurfaceVoxels::observations);
  field(&SurfaceVoxels::color);
  field(&SurfaceVoxels::slot_label);
  field(&SurfaceVoxels::slot_votes);
}

constexpr size_t kSurfaceBytes = sizeof(SurfaceVoxels::distance) + sizeof(SurfaceVoxels::weight) +
                                 sizeof(SurfaceVoxels::observations) +
                                 sizeof(SurfaceVoxels::color) + sizeof(SurfaceVoxels::slot_label) +
                                 sizeof(SurfaceVoxels::slot_votes) + 1;

class Writer {
 public:
  template <typename T>
  void Put(const T& value) {
    const auto* bytes = reinterpret_cast<const uint8_t*>(&value);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof(T));
  }
  void Reserve(size_t size) { bytes_.reserve(size); }
  std::vector<uint8_t> Take() { return std::move(bytes_); }

 private:
  std::vector<uint8_t> bytes_;
};

/// Reads values one after another; remembers whether there was enough.
class Reader {
 public:
  explicit Reader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  template <typename T>
  void Take(T* value) {
    if (bytes_.size() < sizeof(T)) {
      short_ = true;
      return;
    }
    std::memcpy(static_cast<void*>(value), bytes_.data(), sizeof(T));
    bytes_ = bytes_.subspan(sizeof(T));
  }
  bool is_short() const { return short_; }
  size_t left() const { return bytes_.size(); }

 private:
  std::span<const uint8_t> bytes_;
  bool short_ = false;
};

bool InRange(BlockIndex index) {
  const auto fits = [](int32_t i) { return i > -kMaxIndex && i < kMaxIndex; };
  return fits(index.x) && fits(index.y) && fits(index.z);
}

Result<void> CheckVotes(const SurfaceVoxels& voxels, size_t labels) {
  uint8_t highest = 0;
  for (const auto& slots : voxels.slot_label) {
    for (const uint8_t entry : slots) highest = std::max(highest, entry);
  }
  if (highest > voxels.palette.size()) return Fail("a vote has no palette entry");
  for (const SegmentLabel label : voxels.palette) {
    if (label == SegmentLabel::kNone || Raw(label) > labels) {
      return Fail("a vote is for segment label " + std::to_string(Raw(label)) + " of " +
                  std::to_string(labels));
    }
  }
  return {};
}

Result<void> TakePalettes(const std::vector<SurfaceVoxels*>& surfaces, size_t labels,
                          Reader* reader) {
  for (SurfaceVoxels* voxels : surfaces) {
    uint8_t size = 0;
    reader->Take(&size);
    voxels->palette.resize(size);
    for (SegmentLabel& label : voxels->palette) reader->Take(&label);
    if (reader->is_short()) return Fail("palettes are missing");
    if (Result<void> checked = CheckVotes(*voxels, labels); !checked) return checked;
  }
  return {};
}

Result<void> TakeIndices(Reader* reader, std::vector<IndexedBlock>* blocks) {
  for (size_t i = 0; i < blocks->size(); ++i) {
    BlockIndex& index = (*blocks)[i].first;
    reader->Take(&index);
    if (!InRange(index)) return Fail("a block lies outside the grid");
    if (i > 0 && !((*blocks)[i - 1].first < index)) return Fail("blocks are not in order");
  }
  return {};
}

Result<void> TakeKinds(Reader* reader, std::vector<IndexedBlock>* blocks,
                       std::vector<SurfaceVoxels*>* surfaces, std::vector<FreeVoxels*>* frees) {
  for (auto& [index, block] : *blocks) {
    BlockKind kind = BlockKind::kUnseen;
    reader->Take(&kind);
    if (kind > BlockKind::kAllFree) return Fail("unknown kind of block");
    block.all_free = kind == BlockKind::kAllFree;
    if (kind == BlockKind::kSurface) {
      auto voxels = std::make_unique<SurfaceVoxels>();
      surfaces->push_back(voxels.get());
      block.surface = std::move(voxels);
    } else if (kind == BlockKind::kFree) {
      block.free = std::make_unique<FreeVoxels>();
      frees->push_back(block.free.get());
    }
    // Voxels are created only as far as there are bytes to fill them.
    if (reader->left() < surfaces->size() * kSurfaceBytes + frees->size() * sizeof(FreeVoxels)) {
      return Fail("voxels are missing");
    }
  }
  return {};
}

}  // namespace

size_t ChunkLength(const VoxelMap& map, std::span<const BlockIndex> indices) {
  size_t bytes = 0;
  size_t length = 0;
  while (length < indices.size() && bytes < kChunkBytes) {
    const Block& block = *map.Find(indices[length++]);
    bytes += sizeof(BlockIndex) + 1;
    if (block.surface) bytes += sizeof(SurfaceVoxels);
    if (block.free) bytes += sizeof(FreeVoxels);
  }
  return length;
}

std::vector<uint8_t> EncodeBlocks(const VoxelMap& map, std::span<const BlockIndex> indices) {
  Writer writer;
  writer.Reserve(kChunkBytes + 2 * sizeof(SurfaceVoxels));
  std::vector<const Block*> blocks;
  std::vector<const SurfaceVoxels*> surfaces;
  SurfaceReader reader;
  for (const BlockIndex& index : indices) {
    blocks.push_back(map.Find(index));
    if (const SurfaceVoxels* voxels = reader.Read(*blocks.back())) surfaces.push_back(voxels);
  }
  for (const BlockIndex& index : indices) writer.Put(index);
  for (const Block* block : blocks) writer.Put(KindOf(*block));
  for (const SurfaceVoxels* voxels : surfaces) writer.Put(Split(voxels->weight));
  ForEachField([&](auto member) {
    for (const SurfaceVoxels* voxels : surfaces) writer.Put(voxels->*member);
  });
  for (const SurfaceVoxels* voxels : surfaces) {
    Require(voxels->palette.size() <= 255, "a palette has at most 255 labels");
    writer.Put(static_cast<uint8_t>(voxels->palette.size()));
    for (const SegmentLabel label : voxels->palette) writer.Put(label);
  }
  for (const Block* block : blocks) {
    if (block->free) writer.Put(*block->free);
  }
  return writer.Take();
}

Result<std::vector<IndexedBlock>> DecodeBlocks(std::span<const uint8_t> bytes, size_t blocks,
                                               size_t labels) {
  if (blocks > bytes.size() / (sizeof(BlockIndex) + 1)) return Fail("blocks are missing");
  Reader reader(bytes);
  std::vector<IndexedBlock> decoded(blocks);
  if (Result<void> taken = TakeIndices(&reader, &decoded); !taken) {
    return tl::unexpected(taken.error());
  }
  std::vector<SurfaceVoxels*> surfaces;
  std::vector<FreeVoxels*> frees;
  if (Result<void> taken = TakeKinds(&reader, &decoded, &surfaces, &frees); !taken) {
    return tl::unexpected(taken.error());
  }
  for (SurfaceVoxels* voxels : surfaces) {
    SplitWeights split{};
    reader.Take(&split);
    voxels->weight = Join(split);
  }
  ForEachField([&](auto member) {
    for (SurfaceVoxels* voxels : surfaces) reader.Take(&(voxels->*member));
  });
  if (reader.is_short()) return Fail("voxels are missing");
  if (Result<void> taken = TakePalettes(surfaces, labels, &reader); !taken) {
    return tl::unexpected(taken.error());
  }
  for (FreeVoxels* voxels : frees) reader.Take(voxels);
  if (reader.is_short()) return Fail("free voxels are missing");
  if (reader.left() != 0) return Fail("bytes are left after the blocks");
  return decoded;
}

}  // namespace vismap::mapfile
