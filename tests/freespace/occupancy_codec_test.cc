#include "freespace/occupancy_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include "freespace/random_occupancy.h"
#include "support/occupancy_snapshot.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
using testing_support::Random;
using testing_support::RandomOccupancy;
using testing_support::SnapshotOf;

std::vector<uint8_t> Squeeze(const std::vector<uint8_t>& raw) {
  std::vector<uint8_t> packed(ZSTD_compressBound(raw.size()));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), 1));
  return packed;
}

std::vector<uint8_t> Unsqueeze(const std::vector<uint8_t>& packed) {
  std::vector<uint8_t> raw(ZSTD_getFrameContentSize(packed.data(), packed.size()));
  ZSTD_decompress(raw.data(), raw.size(), packed.data(), packed.size());
  return raw;
}

TEST(OccupancyCodec, RoundTripIsIdentity) {
  for (const int blocks : {0, 1, 30, 400}) {
    OccupancyDelta delta = SnapshotOf(RandomOccupancy(static_cast<uint64_t>(blocks), blocks, 0.02));
    delta.blocks.emplace_back(BlockIndex{50, -7, 3}, BlockOccupancy(CellState::kUnknown));
    for (const bool complete : {true, false}) {
      delta.complete = complete;
      const Result<OccupancyDelta> decoded = DecodeOccupancyDelta(EncodeOccupancyDelta(delta));
      ASSERT_TRUE(decoded) << decoded.error().message;
      EXPECT_EQ(*decoded, delta);
    }
  }
}

TEST(OccupancyCodec, UniformBlocksCostNextToNothing) {
  OccupancyMap map(0.02);
  for (int i = 0; i < 100000; ++i) {
    map.Set({i / 1000, i / 10 % 100, i % 10}, BlockOccupancy(CellState::kFree));
  }
  EXPECT_LT(EncodeOccupancyDelta(SnapshotOf(map)).size(), 20000u);
}

TEST(OccupancyCodec, EveryCutIsAnError) {
  const std::vector<uint8_t> bytes = EncodeOccupancyDelta(SnapshotOf(RandomOccupancy(1, 12)));
  for (size_t size = 0; size < bytes.size(); ++size) {
    ASSERT_FALSE(DecodeOccupancyDelta(std::span(bytes.data(), size))) << size;
  }
  std::vector<uint8_t> longer = bytes;
  longer.push_back(7);
  EXPECT_FALSE(DecodeOccupancyDelta(longer));
}

TEST(OccupancyCodec, EveryCutOfTheContentIsAnError) {
  const std::vector<uint8_t> raw =
      Unsqueeze(EncodeOccupancyDelta(SnapshotOf(RandomOccupancy(1, 12))));
  for (size_t size = 0; size < raw.size(); ++size) {
    const std::vector<uint8_t> cut(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_FALSE(DecodeOccupancyDelta(Squeeze(cut))) << size;
  }
}

TEST(OccupancyCodec, FlippedBytesGiveAValidDeltaOrAnError) {
  const std::vector<uint8_t> packed = EncodeOccupancyDelta(SnapshotOf(RandomOccupancy(2, 40)));
  const std::vector<uint8_t> raw = Unsqueeze(packed);
  Random random(3);
  int decoded = 0;
  for (int i = 0; i < 6000; ++i) {
    std::vector<uint8_t> bytes = i % 2 == 0 ? packed : raw;
    const size_t range = i % 3 == 0 ? 30 : bytes.size();
    for (int flips = 1 + random.Below(3); flips > 0; --flips) {
      bytes[random.Next() % range] ^= static_cast<uint8_t>(1 << random.Below(8));
    }
    const auto delta = DecodeOccupancyDelta(i % 2 == 0 ? bytes : Squeeze(bytes));
    if (!delta) continue;
    ++decoded;
    OccupancyMap map(delta->voxel_size);
    EXPECT_TRUE(map.Apply(*delta));
    const auto again = DecodeOccupancyDelta(EncodeOccupancyDelta(*delta));
    ASSERT_TRUE(again);
    EXPECT_EQ(*again, *delta);
  }
  EXPECT_GT(decoded, 0);
}

TEST(OccupancyCodec, BombsAreStoppedAtTheLimit) {
  const std::vector<uint8_t> bomb = Squeeze(std::vector<uint8_t>(size_t{1} << 24, 0));
  EXPECT_LT(bomb.size(), 10000u);
  const auto decoded = DecodeOccupancyDelta(bomb, size_t{1} << 20);
  ASSERT_FALSE(decoded);
  EXPECT_THAT(decoded.error().message, HasSubstr("expected 14..1048576"));
}

TEST(OccupancyCodec, NewerVersionIsNamed) {
  std::vector<uint8_t> raw = Unsqueeze(EncodeOccupancyDelta(SnapshotOf(RandomOccupancy(1, 2))));
  raw[0] = 9;
  const auto decoded = DecodeOccupancyDelta(Squeeze(raw));
  ASSERT_FALSE(decoded);
  EXPECT_THAT(decoded.error().message, HasSubstr("expected version 1, found 9"));
}

}  // namespace
}  // namespace vismap
