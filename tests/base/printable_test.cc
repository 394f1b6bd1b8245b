#include "base/printable.h"

#include <gtest/gtest.h>

#include <random>

namespace vismap {
namespace {

TEST(PrintableText, OrdinaryTextStaysAsItIs) {
  for (const char* text : {"", "map-server: 12 frames", "41.4 µs, Größe, 地図, 😀, C:\\maps"})
    EXPECT_EQ(PrintableText(text), text);
}

TEST(PrintableText, WhatControlsALogOrATerminalIsEscaped) {
  EXPECT_EQ(PrintableText("a\nb\r\tc"), "a\\nb\\r\\tc");
  EXPECT_EQ(PrintableText("\x1b[2J\x07"), "\\x1b[2J\\x07");
  EXPECT_EQ(PrintableText(std::string("a\0b\x7f", 4)), "a\\x00b\\x7f");
  EXPECT_EQ(PrintableText("\xc2\x9b"), "\\u009b") << "an escape sequence begins with it, too";
  EXPECT_EQ(PrintableText("\xe2\x80\xae"), "\\u202e") << "turns the direction of writing around";
  EXPECT_EQ(PrintableText("\xe2\x80\x8b\xef\xbb\xbf"), "\\u200b\\ufeff") << "cannot be seen";
  EXPECT_EQ(PrintableText("\xf3\xa0\x81\x81"), "\\U000e0041");
}

TEST(PrintableText, BytesThatAreNoUtf8AreEscaped) {
  EXPECT_EQ(PrintableText("\xff\xc3(\xe4"), "\\xff\\xc3(\\xe4");
  EXPECT_EQ(PrintableText("\xc0\xaf"), "\\xc0\\xaf") << "an overlong slash";
  EXPECT_EQ(PrintableText("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half of a surrogate pair";
  EXPECT_EQ(PrintableText("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond Unicode";
  EXPECT_EQ(PrintableText("\xe2\x80"), "\\xe2\\x80") << "cut short";
}

TEST(PrintableText, LongTextIsCutBetweenCharacters) {
  EXPECT_EQ(PrintableText("0123456789", 10), "0123456789");
  EXPECT_EQ(PrintableText("0123456789a", 10), "0123456...");
  EXPECT_EQ(PrintableText("01234µµµµµ", 10), "01234µ...");
  EXPECT_EQ(PrintableText("01234\n\n\n\n", 10), "01234\\n...");
  EXPECT_EQ(PrintableText("abc", 2), "..");
  EXPECT_EQ(PrintableText(std::string(1'000'000, '\n'), 100).size(), 99u);
}

TEST(PrintableText, AnyBytesBecomeOneShortLineAndStayTheSameWhenEscapedAgain) {
  std::mt19937 random(7);
  for (int i = 0; i < 20000; ++i) {
    std::string text(random() % 40, '\0');
    for (char& c : text) c = static_cast<char>(random() % 3 == 0 ? random() : 0xE0 + random() % 32);
    const std::string shown = PrintableText(text, 64);
    EXPECT_LE(shown.size(), 64u);
    EXPECT_EQ(shown.find_first_of("\n\r\x1b\x7f"), std::string::npos);
    EXPECT_EQ(PrintableText(shown, 64), shown);
  }
}

}  // namespace
}  // namespace vismap
