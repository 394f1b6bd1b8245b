#include "freespace/occupancy_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "base/require.h"
#include "codecs/zstd_codec.h"

namespace vismap {
namespace {

// Content before compression, little endian: version u8, complete u8, voxel size f64, number of
// blocks u32; the index of each block (three i32, as differences to the block before); the kind of
// each block (u8); the planes of each mixed block. This order compresses best.
static_assert(std::endian::native == std::endian::little);
constexpr uint8_t kVersion = 1;
constexpr uint8_t kMixed = 3;
constexpr size_t kHeaderBytes = 14;
constexpr size_t kBytesPerBlock = 13;
constexpr int32_t kMaxIndex = 1 << 27;  // so that voxel indices fit 31 bits

template <typename T>
void Put(const T& value, std::vector<uint8_t>* out) {
  const auto* bytes = reinterpret_cast<const uint8_t*>(&value);
  out->insert(out->end(), bytes, bytes + sizeof(T));
}

/// Reads values one after the other. The caller has checked that there are enough bytes.
class Cursor {
 public:
  explicit Cursor(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  size_t left() const { return bytes_.size() - at_; }
  template <typename T>
  T Read() {
    Require(left() >= sizeof(T), "the size was checked before reading");
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }

 private:
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
};

bool InRange(BlockIndex index) {
  const auto fits = [](int32_t i) { return i > -kMaxIndex && i < kMaxIndex; };
  return fits(index.x) && fits(index.y) && fits(index.z);
}

/// a + b, which wraps around instead of overflowing, since the bytes may hold any numbers.
int32_t Sum(int32_t a, int32_t b) {
  return static_cast<int32_t>(static_cast<uint32_t>(a) + static_cast<uint32_t>(b));
}

Result<std::vector<BlockIndex>> ReadIndices(size_t count, Cursor* cursor) {
  std::vector<BlockIndex> indices;
  indices.reserve(count);
  BlockIndex last{};
  for (size_t i = 0; i < count; ++i) {
    const auto step = cursor->Read<BlockIndex>();
    const BlockIndex index{Sum(last.x, step.x), Sum(last.y, step.y), Sum(last.z, step.z)};
    if (!InRange(index)) return Fail("occupancy delta: the index of a block is out of range");
    if (i > 0 && !(last < index)) return Fail("occupancy delta: blocks are not in ascending order");
    indices.push_back(index);
    last = index;
  }
  return indices;
}

Result<BlockOccupancy> ReadOccupancy(uint8_t kind, Cursor* planes_cursor) {
  if (kind < kMixed) return BlockOccupancy(static_cast<CellState>(kind));
  if (kind > kMixed) return Fail("occupancy delta: a block is of unknown kind");
  if (planes_cursor->left() < sizeof(OccupancyPlanes)) {
    return Fail("occupancy delta: planes are missing");
  }
  const auto planes = planes_cursor->Read<OccupancyPlanes>();
  for (size_t i = 0; i < planes.free.size(); ++i) {
    if ((planes.free[i] & planes.occupied[i]) != 0) {
      return Fail("occupancy delta: a voxel is both free and occupied");
    }
  }
  BlockOccupancy occupancy(planes);
  if (occupancy.is_uniform()) return Fail("occupancy delta: a uniform block has planes");
  return occupancy;
}

}  // namespace

std::vector<uint8_t> EncodeOccupancyDelta(const OccupancyDelta& delta) {
  std::vector<uint8_t> raw;
  raw.reserve(kHeaderBytes + delta.blocks.size() * (kBytesPerBlock + sizeof(OccupancyPlanes)));
  Put(kVersion, &raw);
  Put(static_cast<uint8_t>(delta.complete), &raw);
  Put(delta.voxel_size, &raw);
  Put(static_cast<uint32_t>(delta.blocks.size()), &raw);
  BlockIndex last{};
  for (const auto& [index, occupancy] : delta.blocks) {
    Put(BlockIndex{index.x - last.x, index.y - last.y, index.z - last.z}, &raw);
    last = index;
  }
  for (const auto& [index, occupancy] : delta.blocks) {
    Put(occupancy.is_uniform() ? static_cast<uint8_t>(occupancy.uniform_state()) : kMixed, &raw);
  }
  for (const auto& [index, occupancy] : delta.blocks) {
    if (occupancy.mixed() != nullptr) Put(*occupancy.mixed(), &raw);
  }
  return CompressBytes(raw);
}

size_t MaxOccupancyDeltaBytes(size_t blocks) {
  return kHeaderBytes + blocks * (kBytesPerBlock + sizeof(OccupancyPlanes));
}

Result<OccupancyDelta> DecodeOccupancyDelta(std::span<const uint8_t> bytes,
                                            size_t max_decoded_bytes) {
  const Result<std::vector<uint8_t>> raw = DecompressBytes(bytes, kHeaderBytes, max_decoded_bytes);
  if (!raw) return Fail("occupancy delta: " + raw.error().message);
  Cursor cursor(*raw);
  const auto version = cursor.Read<uint8_t>();
  if (version != kVersion) {
    return Fail("occupancy delta: expected version " + std::to_string(kVersion) + ", found " +
                std::to_string(version));
  }
  const auto complete = cursor.Read<uint8_t>();
  if (complete > 1) return Fail("occupancy delta: 'complete' is neither 0 nor 1");
  OccupancyDelta delta{cursor.Read<double>(), complete == 1, {}};
  if (!(delta.voxel_size > 1e-4 && delta.voxel_size < 1e3)) {
    return Fail("occupancy delta: the voxel size is not a plausible length");
  }
  const size_t count = cursor.Read<uint32_t>();
  if (cursor.left() / kBytesPerBlock < count) return Fail("occupancy delta: blocks are missing");
  const Result<std::vector<BlockIndex>> indices = ReadIndices(count, &cursor);
  if (!indices) return tl::unexpected(indices.error());
  const std::span<const uint8_t> all(*raw);
  Cursor planes_cursor(all.subspan(kHeaderBytes + count * kBytesPerBlock));
  delta.blocks.reserve(count);
  for (const BlockIndex& index : *indices) {
    Result<BlockOccupancy> occupancy = ReadOccupancy(cursor.Read<uint8_t>(), &planes_cursor);
    if (!occupancy) return tl::unexpected(occupancy.error());
    delta.blocks.emplace_back(index, std::move(*occupancy));
  }
  if (planes_cursor.left() != 0) return Fail("occupancy delta: bytes are left at the end");
  return delta;
}

}  // namespace vismap
