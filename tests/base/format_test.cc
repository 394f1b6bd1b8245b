#include "base/format.h"

#include <gtest/gtest.h>

#include <limits>

namespace vismap {
namespace {

TEST(Format, DurationsHaveAFittingUnit) {
  EXPECT_EQ(FormatDuration(0), "0 s");
  EXPECT_EQ(FormatDuration(25e-9), "25 ns");
  EXPECT_EQ(FormatDuration(4.14e-5), "41.4 µs");
  EXPECT_EQ(FormatDuration(0.117), "117 ms");
  EXPECT_EQ(FormatDuration(2.0449), "2.04 s");
  EXPECT_EQ(FormatDuration(30), "30 s");
  EXPECT_EQ(FormatDuration(-0.5), "-500 ms");
}

TEST(Format, LongDurationsHaveTwoUnits) {
  EXPECT_EQ(FormatDuration(99.9), "99.9 s");
  EXPECT_EQ(FormatDuration(120), "2 min");
  EXPECT_EQ(FormatDuration(200.4), "3 min 20 s");
  EXPECT_EQ(FormatDuration(3900), "1 h 5 min");
}

TEST(Format, WhatRoundsToTheNextUnitIsWrittenInIt) {
  EXPECT_EQ(FormatDuration(0.9996e-3), "1 ms");
  EXPECT_EQ(FormatDuration(0.9999), "1 s");
  EXPECT_EQ(FormatDuration(99.96), "1 min 40 s");
  EXPECT_EQ(FormatDuration(3599.6), "1 h");
  EXPECT_EQ(FormatBytes(999.6), "1 kB");
  EXPECT_EQ(FormatBytes(999'960), "1 MB");
}

TEST(Format, DurationsThatAreNoNumberHaveWords) {
  EXPECT_EQ(FormatDuration(std::numeric_limits<double>::infinity()), "unlimited time");
  EXPECT_EQ(FormatDuration(std::numeric_limits<double>::quiet_NaN()), "unknown time");
  EXPECT_EQ(FormatDuration(1e18), "1e+18 s");
}

TEST(Format, SizesHaveDecimalUnits) {
  EXPECT_EQ(FormatBytes(0), "0 bytes");
  EXPECT_EQ(FormatBytes(1), "1 byte");
  EXPECT_EQ(FormatBytes(512), "512 bytes");
  EXPECT_EQ(FormatBytes(1500), "1.5 kB");
  EXPECT_EQ(FormatBytes(31'750'723), "31.8 MB");
  EXPECT_EQ(FormatBytes(1.2e9), "1.2 GB");
  EXPECT_EQ(FormatBytes(2.5e15), "2.5e+03 TB");
}

TEST(Format, CountsHaveGroupsOfThreeDigits) {
  EXPECT_EQ(FormatCount(7), "7");
  EXPECT_EQ(FormatCount(999), "999");
  EXPECT_EQ(FormatCount(1000), "1,000");
  EXPECT_EQ(FormatCount(1'392'815), "1,392,815");
  EXPECT_EQ(FormatCount(-1000), "-1,000");
  EXPECT_EQ(FormatCount(-100), "-100");
}

TEST(Format, CountsOfThingsHaveSingularAndPlural) {
  EXPECT_EQ(FormatCount(1, "frame"), "1 frame");
  EXPECT_EQ(FormatCount(0, "frame"), "0 frames");
  EXPECT_EQ(FormatCount(2, "process", "processes"), "2 processes");
  EXPECT_EQ(FormatCount(1, "process", "processes"), "1 process");
}

TEST(Format, Percent) {
  EXPECT_EQ(FormatPercent(0.125), "12.5 %");
  EXPECT_EQ(FormatPercent(1), "100 %");
}

}  // namespace
}  // namespace vismap
