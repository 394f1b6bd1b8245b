#include "navigation/distance_codec.h"

#include <array>
#include <bit>
#include <cstring>

#include "base/require.h"
#include "codecs/zstd_codec.h"

namespace vismap {
namespace {

static_assert(std::endian::native == std::endian::little);
using Values = std::array<uint16_t, kBlockVoxels>;
constexpr size_t kCountBytes = 4, kIndexBytes = 13, kValueBytes = 2 * sizeof(Values);
constexpr int32_t kMostIndex = 1 << 27;  // so that indices of leaves fit 31 bits

template <typename T>
void Append(const T& value, std::vector<uint8_t>* out) {
  const auto* bytes = reinterpret_cast<const uint8_t*>(&value);
  out->insert(out->end(), bytes, bytes + sizeof(T));
}

// High bytes are mostly equal, so that they compress best beside each other.
void AppendValues(const Values& values, std::vector<uint8_t>* out) {
  for (const uint16_t value : values) out->push_back(static_cast<uint8_t>(value));
  for (const uint16_t value : values) out->push_back(static_cast<uint8_t>(value >> 8));
}

bool ReadValues(const uint8_t* bytes, Values* values) {
  bool valid = true;
  for (size_t i = 0; i < values->size(); ++i) {
    (*values)[i] = static_cast<uint16_t>(bytes[i] | bytes[values->size() + i] << 8);
    valid = valid && (*values)[i] <= kBeyond;
  }
  return valid;
}

bool FitsRange(const BlockIndex& index) {
  const auto fits = [](int32_t i) { return i > -kMostIndex && i < kMostIndex; };
  return fits(index.x) && fits(index.y) && fits(index.z);
}

Result<std::vector<BlockIndex>> ReadBlockIndices(const uint8_t* bytes, size_t count) {
  std::vector<BlockIndex> indices(count);
  for (size_t i = 0; i < count; ++i) {
    std::memcpy(&indices[i], bytes + i * sizeof(BlockIndex), sizeof(BlockIndex));
    if (!FitsRange(indices[i])) return Fail("distances: the index of a block is out of range");
    if (i > 0 && !(indices[i - 1] < indices[i]))
      return Fail("distances: blocks are not in ascending order");
  }
  return indices;
}

}  // namespace

std::vector<uint8_t> EncodeDistances(const DistanceBlocks& blocks) {
  static_assert(sizeof(BlockIndex) == 12);
  std::vector<uint8_t> raw;
  raw.reserve(MaxDistanceBytes(blocks.size()));
  Append(static_cast<uint32_t>(blocks.size()), &raw);
  for (const auto& entry : blocks) Append(entry.first, &raw);
  for (const auto& entry : blocks) raw.push_back(entry.second ? 1 : 0);
  for (const auto& entry : blocks) {
    if (!entry.second) continue;
    AppendValues(entry.second->obstacle, &raw);
    AppendValues(entry.second->unknown, &raw);
  }
  return CompressBytes(raw);
}

size_t MaxDistanceBytes(size_t blocks) {
  return kCountBytes + blocks * (kIndexBytes + kValueBytes);
}

Result<DistanceBlocks> DecodeDistances(std::span<const uint8_t> bytes, size_t max_decoded_bytes) {
  const auto raw = DecompressBytes(bytes, kCountBytes, max_decoded_bytes);
  if (!raw) return Fail("distances: " + raw.error().message);
  uint32_t count = 0;
  std::memcpy(&count, raw->data(), kCountBytes);
  if ((raw->size() - kCountBytes) / kIndexBytes < count)
    return Fail("distances: blocks are missing");
  const auto indices = ReadBlockIndices(raw->data() + kCountBytes, count);
  if (!indices) return tl::unexpected(indices.error());
  const uint8_t* kinds = raw->data() + kCountBytes + count * sizeof(BlockIndex);
  const uint8_t* at = kinds + count;
  const uint8_t* end = raw->data() + raw->size();
  DistanceBlocks blocks;
  blocks.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    if (kinds[i] > 1) return Fail("distances: a block is of unknown kind");
    blocks.emplace_back((*indices)[i], std::nullopt);
    if (kinds[i] == 0) continue;
    if (end - at < static_cast<ptrdiff_t>(kValueBytes))
      return Fail("distances: values are missing");
    BlockDistances& values = blocks.back().second.emplace();
    if (!ReadValues(at, &values.obstacle) || !ReadValues(at + sizeof(Values), &values.unknown))
      return Fail("distances: a distance is above 32767");
    at += kValueBytes;
  }
  if (at != end) return Fail("distances: bytes are left at the end");
  return blocks;
}

}  // namespace vismap
