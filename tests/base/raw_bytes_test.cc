#include "base/raw_bytes.h"

#include <gmock/gmock.h>

#include <vector>

namespace vismap {
namespace {

using ::testing::ElementsAre;

TEST(RawBytes, KeepsItsContentWhenItGrows) {
  RawBytes bytes;
  std::vector<uint8_t> expected;
  for (int i = 0; i < 2000; ++i) {
    const std::vector<uint8_t> more(static_cast<size_t>(i % 7), static_cast<uint8_t>(i));
    bytes.append(more);
    expected.insert(expected.end(), more.begin(), more.end());
  }
  EXPECT_EQ(std::vector<uint8_t>(bytes.begin(), bytes.end()), expected);
}

TEST(RawBytes, ShrinksWithoutLosingWhatStays) {
  RawBytes bytes;
  bytes.append(std::vector<uint8_t>{1, 2, 3});
  bytes.resize(2);
  EXPECT_THAT(std::vector<uint8_t>(bytes.begin(), bytes.end()), ElementsAre(1, 2));
  bytes.append(std::vector<uint8_t>{4});
  EXPECT_THAT(std::vector<uint8_t>(bytes.begin(), bytes.end()), ElementsAre(1, 2, 4));
}

TEST(RawBytes, IsEmptyAfterAMove) {
  RawBytes bytes(3);
  bytes.data()[2] = 9;
  const RawBytes moved = std::move(bytes);
  EXPECT_EQ(moved.size(), 3u);
  EXPECT_EQ(moved.data()[2], 9);
  EXPECT_EQ(bytes.size(), 0u);  // NOLINT(bugprone-use-after-move): that is what is tested
}

}  // namespace
}  // namespace vismap
