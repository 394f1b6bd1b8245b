// Malformed messages, decoded as in a process. There must be no crash, no exception, no undefined
// behaviour (checked with the san preset), and no more memory than the limit of the target.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <iostream>

#include "allocation_meter.h"
#include "codecs/zstd_codec.h"
#include "hostile_messages.h"
#include "support/messages.h"
#include "wire/channels.h"
#include "wire/envelope.h"
#include "wire/map_update.h"
#include "wire/rgbd_frame.h"
#include "wire/segmented_frame.h"

namespace vismap {
namespace {

int64_t FromEnvironment(const char* name, int64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr || *text == '\0' ? otherwise : std::atoll(text);
}

struct Tally {
  int64_t messages = 0, accepted = 0;
  AllocationFigures worst;
};

/// Decodes one message; fails when it throws or exceeds the memory limits.
::testing::AssertionResult Decodes(const FuzzTarget& target, std::span<const uint8_t> bytes,
                                   Tally* tally) {
  AllocationMeter::Begin();
  std::string thrown;
  try {
    tally->accepted += target.decode(bytes).has_value();
  } catch (const std::exception& error) {
    thrown = error.what();
  }
  const AllocationFigures figures = AllocationMeter::End();
  ++tally->messages;
  tally->worst.largest = std::max(tally->worst.largest, figures.largest);
  tally->worst.peak = std::max(tally->worst.peak, figures.peak);
  if (!thrown.empty()) return ::testing::AssertionFailure() << target.type << " threw: " << thrown;
  if (figures.largest > target.AllowedAllocation(bytes.size()) ||
      figures.peak > target.AllowedPeak(bytes.size())) {
    return ::testing::AssertionFailure()
           << target.type << " of " << bytes.size() << " bytes: one allocation of "
           << figures.largest << ", at most " << target.AllowedAllocation(bytes.size())
           << " are allowed; together " << figures.peak << ", at most "
           << target.AllowedPeak(bytes.size()) << " are allowed";
  }
  return ::testing::AssertionSuccess();
}

TEST(AllocationMeter, MeasuresLargestAndTotalAllocations) {
  AllocationMeter::Begin();
  for (int i = 0; i < 3; ++i) {
    std::vector<char> one(1000), two(5000);
    one[0] = two[0] = 1;
    EXPECT_EQ(one[0], two[0]);
  }
  std::free(std::realloc(std::malloc(100), 300));
  const AllocationFigures figures = AllocationMeter::End();
  EXPECT_GE(figures.largest, 5000U);
  EXPECT_LT(figures.largest, 5100U);
  EXPECT_GE(figures.peak, 6000U);
  EXPECT_LT(figures.peak, 6500U);
}

TEST(Fuzz, ValidMessagesAreAccepted) {
  for (const FuzzTarget& target : AllFuzzTargets()) {
    Tally tally;
    EXPECT_TRUE(Decodes(target, target.good, &tally));
    EXPECT_EQ(tally.accepted, 1) << target.type;
  }
}

TEST(Fuzz, MutatedAndTruncatedMessages) {
  const std::vector<FuzzTarget> targets = AllFuzzTargets();
  const int64_t count = FromEnvironment("VISMAP_FUZZ_MESSAGES", 200'000);
  const auto seed = static_cast<uint64_t>(FromEnvironment("VISMAP_FUZZ_SEED", 1));
  std::vector<Tally> tallies(targets.size());
  for (int64_t i = 0; i < count; ++i) {
    const size_t which = static_cast<size_t>(i) % targets.size();
    TestRandom random(seed * 1'000'003 + static_cast<uint64_t>(i));
    const std::vector<uint8_t> bytes = Mutate(targets[which], &random);
    ASSERT_TRUE(Decodes(targets[which], bytes, &tallies[which]))
        << "message " << i << " of VISMAP_FUZZ_SEED=" << seed;
  }
  for (size_t i = 0; i < targets.size(); ++i) {
    const Tally& tally = tallies[i];
    std::cout << targets[i].type << ": " << tally.messages << " messages, " << tally.accepted
              << " accepted, largest allocation " << tally.worst.largest << ", most at once "
              << tally.worst.peak << " bytes\n";
    EXPECT_GT(tally.accepted, 0) << targets[i].type << ": some mutated messages must be accepted";
    EXPECT_LT(tally.accepted, tally.messages) << targets[i].type;
  }
}

TEST(Fuzz, EveryTruncationOfEveryType) {
  for (const FuzzTarget& target : AllFuzzTargets()) {
    std::vector<uint8_t> good = target.good;
    DropChecksum(target, &good);
    Tally tally;
    for (size_t size = 0; size < good.size(); ++size) {
      const std::vector<uint8_t> cut(good.begin(),
                                     good.begin() + static_cast<std::ptrdiff_t>(size));
      ASSERT_TRUE(Decodes(target, cut, &tally)) << size;
    }
    EXPECT_EQ(tally.accepted, 0) << target.type;
  }
}

// Every length in a message (of an array, of an array in an element, of a string, or of a string in
// an array) occupies four of its bytes, so all groups of four bytes are replaced.
TEST(Fuzz, EveryLengthOfEveryTypeMayBeWrong) {
  int64_t attacks = 0;
  for (const FuzzTarget& target : AllFuzzTargets()) {
    Tally tally;
    for (size_t at = 8; at + 4 <= target.good.size(); ++at) {
      for (const int64_t length : kHostileLengths) {
        std::vector<uint8_t> bytes = target.good;
        WriteLength(length, at, &bytes);
        DropChecksum(target, &bytes);
        ASSERT_TRUE(Decodes(target, bytes, &tally)) << length << " at byte " << at;
      }
    }
    attacks += tally.messages;
  }
  std::cout << attacks << " lengths\n";
}

/// A valid message whose compressed parts expand to the largest possible size.
struct Bomb {
  const char* what;
  std::vector<uint8_t> bytes;
};

rgbd_frame_t BlackFrame(int width, int height) {
  SensorFrame frame = SmallSensorFrame();
  frame.header.camera.width = width;
  frame.header.camera.height = height;
  frame.header.camera.fx = frame.header.camera.fy = width;
  frame.header.camera.cx = width / 2.0;
  frame.header.camera.cy = height / 2.0;
  frame.color.clear();
  frame.depth = Image<uint16_t>(width, height);
  rgbd_frame_t message = Encode(frame);
  message.source = "bomb";
  return message;
}

FuzzTarget TargetOf(const std::string& type) {
  for (FuzzTarget& target : AllFuzzTargets()) {
    if (target.type == type) return std::move(target);
  }
  ADD_FAILURE() << type;
  return {};
}

TEST(Bombs, LargestDepthImageIsAcceptedAndALargerOneNeedsNoMemory) {
  const FuzzTarget target = TargetOf("rgbd_frame_t");
  rgbd_frame_t frame = BlackFrame(4096, 4096);
  std::vector<uint8_t> bytes = Pack(frame);
  EXPECT_LT(bytes.size(), 8192U) << "compressed by a factor above ten thousand";
  Tally tally;
  EXPECT_TRUE(Decodes(target, bytes, &tally));
  EXPECT_EQ(tally.accepted, 1);
  frame.depth_camera.width = 4097;
  bytes = Pack(frame);
  Tally refused;
  EXPECT_TRUE(Decodes(target, bytes, &refused));
  EXPECT_EQ(refused.accepted, 0);
  EXPECT_LT(refused.worst.peak, 64U * 1024);
}

TEST(Bombs, LabelRunsBeyondTheImageNeedNoMemory) {
  const FuzzTarget target = TargetOf("segmented_frame_t");
  segmented_frame_t message{};
  message.frame = Encode(SmallSensorFrame());
  message.utime = message.frame.utime;
  message.label_encoding = segmented_frame_t::LABELS_RLE_ZSTD;
  message.labels = CompressBytes(std::vector<uint8_t>(size_t{1} << 28, 1));
  message.label_size = static_cast<int32_t>(message.labels.size());
  const std::vector<uint8_t> bytes = Pack(message);
  Tally tally;
  EXPECT_TRUE(Decodes(target, bytes, &tally));
  EXPECT_EQ(tally.accepted, 0);
  EXPECT_LT(tally.worst.largest, size_t{1} << 20);
}

TEST(Bombs, MapDeltaWithAGigabyteOfBlocksIsRejectedWithinAMegabyte) {
  const FuzzTarget target = TargetOf("map_delta_t");
  OccupancyDelta delta{0.01, true, {}};
  for (int32_t i = 0; i <= kMaxBlocksPerUpdate; ++i)
    delta.blocks.emplace_back(BlockIndex{0, 0, i}, BlockOccupancy(CellState::kFree));
  map_delta_t message = Encode(MapUpdate{1, "map", 1, -1, 0, 1, delta});
  std::vector<uint8_t> bytes = Pack(message);
  Tally tally;
  EXPECT_TRUE(Decodes(target, bytes, &tally));
  EXPECT_EQ(tally.accepted, 0) << "one block too many";
  message.n_blocks = 10;  // wrong: the payload is as large as before
  bytes = Pack(message);
  EXPECT_TRUE(Decodes(target, bytes, &tally));
  EXPECT_EQ(tally.accepted, 0);
  EXPECT_LT(tally.worst.peak, size_t{1} << 20);
  delta.blocks.pop_back();
  message = Encode(MapUpdate{1, "map", 1, -1, 0, 1, delta});
  bytes = Pack(message);
  EXPECT_TRUE(Decodes(target, bytes, &tally));
  EXPECT_EQ(tally.accepted, 1);
}

TEST(Bombs, MessagesAboveTheLimitOfTheirChannelAreNotDecoded) {
  for (const FuzzTarget& target : AllFuzzTargets()) {
    std::vector<uint8_t> bytes = target.good;
    bytes.resize(target.channel_bytes + 1);
    Tally tally;
    EXPECT_TRUE(Decodes(target, bytes, &tally));
    EXPECT_EQ(tally.accepted, 0) << target.type;
    EXPECT_LT(tally.worst.peak, 4096U) << target.type;
  }
}

}  // namespace
}  // namespace vismap
