#include "base/digest.h"

#include <gtest/gtest.h>

#include <array>

namespace vismap {
namespace {

TEST(Digest, DependsOnContentNotOnChunking) {
  Digest whole, parts, other;
  const std::array<uint8_t, 4> bytes{1, 2, 3, 4};
  whole.AddBytes(bytes.data(), 4);
  parts.AddBytes(bytes.data(), 1);
  parts.AddBytes(bytes.data() + 1, 3);
  other.AddBytes(bytes.data(), 3);
  EXPECT_EQ(whole.Hex(), parts.Hex());
  EXPECT_NE(whole.Hex(), other.Hex());
  EXPECT_EQ(whole.Hex().size(), 32u);
}

}  // namespace
}  // namespace vismap
