#include "log_tool/cut.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "support/log_builder.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Ten frames 10 ms apart, each followed by its detections 10 ms later.
std::string TenFrames(LogBuilder* builder) {
  for (int64_t i = 0; i < 10; ++i) builder->Frame(i).Detections(i);
  return builder->Finish();
}

CutResult Cut(const std::string& from, const CutOptions& options, const std::filesystem::path& to) {
  Result<LogReader> reader = LogReader::Open(from);
  EXPECT_TRUE(reader) << reader.error().message;
  Result<CutResult> result = CutLog(*reader, options, to);
  EXPECT_TRUE(result) << result.error().message;
  return result.value_or(CutResult{});
}

std::vector<LogEvent> Events(const std::filesystem::path& path) {
  std::vector<LogEvent> events;
  Result<LogReader> reader = LogReader::Open(path);
  EXPECT_TRUE(ForEachEvent(
      *reader,
      [&](const LogEvent& event) -> Result<void> {
        events.push_back(event);
        return {};
      },
      [](const LogDamage&) { ADD_FAILURE(); }));
  return events;
}

TEST(CutLog, CutByTimeKeepsTheTimes) {
  LogBuilder builder;
  const std::string whole = TenFrames(&builder);
  CutOptions options;
  options.from = 0.05;
  options.to = 0.08;
  const CutResult result = Cut(whole, options, builder.folder() / "cut");
  EXPECT_EQ(result.kept, 3);
  EXPECT_EQ(result.left_out, 17);
  const std::vector<LogEvent> all = Events(whole), cut = Events(builder.folder() / "cut");
  ASSERT_EQ(cut.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(cut[i].timestamp, all[i + 5].timestamp);
    EXPECT_EQ(cut[i].number, static_cast<int64_t>(i));
    EXPECT_EQ(cut[i].channel, all[i + 5].channel);
    EXPECT_EQ(cut[i].data_size, all[i + 5].data_size);
  }
}

TEST(CutLog, CutByChannel) {
  LogBuilder builder;
  const std::string whole = TenFrames(&builder);
  CutOptions options;
  options.channels = {"DETECTIONS"};
  EXPECT_EQ(Cut(whole, options, builder.folder() / "cut").kept, 10);
  for (const LogEvent& event : Events(builder.folder() / "cut"))
    EXPECT_EQ(event.channel, "DETECTIONS");
}

TEST(CutLog, CutOfTheWholeLogIsTheSameFile) {
  LogBuilder builder;
  const std::string whole = TenFrames(&builder);
  const auto before = *ReadFileBytes(whole);
  EXPECT_EQ(Cut(whole, {}, whole).left_out, 0);
  EXPECT_EQ(*ReadFileBytes(whole), before);
}

TEST(CutLog, LeavesOutDamagedParts) {
  LogBuilder builder;
  std::vector<uint8_t> bytes = *ReadFileBytes(TenFrames(&builder));
  bytes[1] = 0;
  builder.folder().Write("bad", std::span<const uint8_t>(bytes));
  const std::string bad = (builder.folder() / "bad").string();
  const CutResult result = Cut(bad, {}, bad);
  EXPECT_EQ(result.kept, 19);
  EXPECT_GT(result.damaged_bytes, 100u);
  EXPECT_EQ(Events(bad).size(), 19u);
}

TEST(CutLog, FailsWhenNothingIsKept) {
  LogBuilder builder;
  Result<LogReader> reader = LogReader::Open(TenFrames(&builder));
  CutOptions options;
  options.channels = {"DETECTION"};
  EXPECT_THAT(CutLog(*reader, options, builder.folder() / "cut").error().message,
              HasSubstr("no message of the log is in this time range"));
  EXPECT_FALSE(std::filesystem::exists(builder.folder() / "cut"));
}

TEST(CutLog, ErrorNamesTheFile) {
  LogBuilder builder;
  Result<LogReader> reader = LogReader::Open(TenFrames(&builder));
  EXPECT_THAT(CutLog(*reader, {}, builder.folder() / "missing/cut").error().message,
              HasSubstr("missing/cut"));
}

}  // namespace
}  // namespace vismap
