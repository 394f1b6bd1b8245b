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

/// The low bytes of all weights, then the high ones: they compress in half the time, to less. Other
/// fields do not gain by this.
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

/// Calls `field(member)` for every member of fixed size of surface voxels except the weights, in
/// the order of the file.
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
  std::vector<uint8_t> Finish() { return std::move(bytes_); }

 private:
  std::vector<uint8_t> bytes_;
};

/// Reads values one after the other. After a read beyond the end, is_short() is true.
class Reader {
 public:
  explicit Reader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  template <typename T>
  void Read(T* value) {
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
  if (highest > voxels.palette.size())
    return Fail("a vote has an entry that is not in the palette");
  for (const SegmentLabel label : voxels.palette) {
    if (label == SegmentLabel::kNone || Raw(label) > labels) {
      return Fail("a vote is for segment label " + std::to_string(Raw(label)) + " of " +
                  std::to_string(labels));
    }
  }
  return {};
}

Result<void> ReadPalettes(const std::vector<SurfaceVoxels*>& surfaces, size_t labels,
                          Reader* reader) {
  for (SurfaceVoxels* voxels : surfaces) {
    uint8_t size = 0;
    reader->Read(&size);
    voxels->palette.resize(size);
    for (SegmentLabel& label : voxels->palette) reader->Read(&label);
    if (reader->is_short()) return Fail("palettes are missing");
    if (Result<void> checked = CheckVotes(*voxels, labels); !checked) return checked;
  }
  return {};
}

Result<void> ReadIndices(Reader* reader, std::vector<IndexedBlock>* blocks) {
  for (size_t i = 0; i < blocks->size(); ++i) {
    BlockIndex& index = (*blocks)[i].first;
    reader->Read(&index);
    if (!InRange(index)) return Fail("the index of a block is out of range");
    if (i > 0 && !((*blocks)[i - 1].first < index))
      return Fail("blocks are not in ascending order");
  }
  return {};
}

Result<void> ReadKinds(Reader* reader, std::vector<IndexedBlock>* blocks,
                       std::vector<SurfaceVoxels*>* surfaces, std::vector<FreeVoxels*>* frees) {
  for (auto& [index, block] : *blocks) {
    BlockKind kind = BlockKind::kUnseen;
    reader->Read(&kind);
    if (kind > BlockKind::kAllFree) return Fail("a block is of unknown kind");
    block.all_free = kind == BlockKind::kAllFree;
    if (kind == BlockKind::kSurface) {
      block.surface = Shared<SurfaceVoxels>::Make();
      surfaces->push_back(&*block.surface);
    } else if (kind == BlockKind::kFree) {
      block.free = Shared<FreeVoxels>::Make();
      frees->push_back(&block.free.Own());
    }
    // Checked per block, so that voxels are never allocated without bytes to fill them.
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
  return writer.Finish();
}

Result<std::vector<IndexedBlock>> DecodeBlocks(std::span<const uint8_t> bytes, size_t blocks,
                                               size_t labels) {
  if (blocks > bytes.size() / (sizeof(BlockIndex) + 1)) return Fail("blocks are missing");
  Reader reader(bytes);
  std::vector<IndexedBlock> decoded(blocks);
  if (Result<void> read = ReadIndices(&reader, &decoded); !read) {
    return tl::unexpected(read.error());
  }
  std::vector<SurfaceVoxels*> surfaces;
  std::vector<FreeVoxels*> frees;
  if (Result<void> read = ReadKinds(&reader, &decoded, &surfaces, &frees); !read) {
    return tl::unexpected(read.error());
  }
  for (SurfaceVoxels* voxels : surfaces) {
    SplitWeights split{};
    reader.Read(&split);
    voxels->weight = Join(split);
  }
  ForEachField([&](auto member) {
    for (SurfaceVoxels* voxels : surfaces) reader.Read(&(voxels->*member));
  });
  if (reader.is_short()) return Fail("voxels are missing");
  if (Result<void> read = ReadPalettes(surfaces, labels, &reader); !read) {
    return tl::unexpected(read.error());
  }
  for (FreeVoxels* voxels : frees) reader.Read(voxels);
  if (reader.is_short()) return Fail("free voxels are missing");
  if (reader.left() != 0) return Fail("bytes are left after the blocks");
  return decoded;
}

std::string EncodeThin(const VoxelMap& map, std::span<const BlockIndex> indices) {
  Writer writer;
  for (size_t number = 0; number < indices.size(); ++number) {
    const Block& block = *map.Find(indices[number]);
    if (!block.thin) continue;
    const auto& hits = block.thin->hits;
    writer.Put(static_cast<uint32_t>(number));
    writer.Put(static_cast<uint16_t>(
        std::count_if(hits.begin(), hits.end(), [](uint8_t count) { return count > 0; })));
    for (size_t voxel = 0; voxel < hits.size(); ++voxel) {
      if (hits[voxel] == 0) continue;
      writer.Put(static_cast<uint16_t>(voxel));
      writer.Put(hits[voxel]);
    }
  }
  const std::vector<uint8_t> bytes = writer.Finish();
  return {bytes.begin(), bytes.end()};
}

Result<void> DecodeThin(std::span<const uint8_t> bytes, std::vector<IndexedBlock>* blocks) {
  Reader reader(bytes);
  int64_t last_block = -1;
  while (reader.left() > 0) {
    uint32_t number = 0;
    uint16_t count = 0;
    reader.Read(&number);
    reader.Read(&count);
    if (reader.is_short() || number >= blocks->size() || int64_t{number} <= last_block ||
        count == 0)
      return Fail("hits of thin things belong to no block of the chunk");
    last_block = number;
    auto thin = Shared<ThinVoxels>::Make();
    for (int i = 0, last_voxel = -1; i < count; ++i) {
      uint16_t voxel = 0;
      uint8_t hits = 0;
      reader.Read(&voxel);
      reader.Read(&hits);
      if (reader.is_short() || voxel >= kBlockVoxels || voxel <= last_voxel || hits == 0 ||
          hits > ThinVoxels::kMost) {
        return Fail("hits of thin things cannot be read");
      }
      last_voxel = voxel;
      thin->hits[voxel] = hits;
    }
    (*blocks)[number].second.thin = std::move(thin);
  }
  return {};
}

}  // namespace vismap::mapfile
