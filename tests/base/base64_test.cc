#include "base/base64.h"

#include <gtest/gtest.h>

#include <string_view>

namespace vismap {
namespace {

TEST(Base64, AsInRfc4648) {
  const auto encode = [](std::string_view text) {
    return Base64(std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
  };
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encode("\xff\xfe\xfd"), "//79");
}

}  // namespace
}  // namespace vismap
