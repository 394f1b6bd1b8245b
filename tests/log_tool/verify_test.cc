#include "log_tool/verify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <vismap/process_status_t.hpp>

#include "base/file.h"
#include "support/log_builder.h"
#include "support/mutations.h"

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

LogReport Verify(const std::filesystem::path& path) {
  Result<LogReader> reader = LogReader::Open(path);
  EXPECT_TRUE(reader) << reader.error().message;
  Result<LogReport> report = VerifyLog(*reader);
  EXPECT_TRUE(report) << report.error().message;
  return report ? std::move(*report) : LogReport{};
}

TEST(VerifyLog, ACleanRunHasNoProblems) {
  LogBuilder builder;
  for (int64_t i = 1; i <= 3; ++i) builder.Frame(1000 * i).Detections(1000 * i).Commit(1000 * i, i);
  const LogReport report = Verify(builder.Skip(9000, "no depth").Frame(9500).Finish());
  EXPECT_THAT(report.Problems(), IsEmpty());
  EXPECT_EQ(report.events, 11);
  EXPECT_EQ(report.frames_sent, 4);
  EXPECT_EQ(report.frames_integrated, 3);
  EXPECT_EQ(report.frames_skipped, 1);
  EXPECT_EQ(report.frames_without_commit, 1);
  const ChannelReport& frames = report.channels.at("RGBD_FRAME");
  EXPECT_EQ(frames.messages, 4);
  EXPECT_GT(frames.bytes, 4000);
  EXPECT_EQ(frames.last_time - frames.first_time, 100000);  // ten events of 10 ms
  EXPECT_NEAR(frames.rate(), 30, 1e-9);
}

TEST(VerifyLog, LostMessagesAreCountedPerSource) {
  LogBuilder builder;
  const auto add = [&](const std::string& source, int64_t seq) {
    frame_commit_t commit{};
    commit.source = source;
    commit.seq = seq;
    builder.AddBytes("MAP_COMMIT", Pack(commit));
  };
  add("a", 5);  // the recording starts here
  add("b", 0);
  add("a", 6);
  add("b", 3);  // 1 and 2 are missing
  add("a", 8);  // 7 is missing
  add("a", 0);  // restarted
  const LogReport report = Verify(builder.Finish());
  EXPECT_EQ(report.channels.at("MAP_COMMIT").lost, 3);
  EXPECT_EQ(report.channels.at("MAP_COMMIT").repeated, 1);
  EXPECT_THAT(report.Problems(), ::testing::Contains(HasSubstr("MAP_COMMIT: 3 lost messages")));
}

TEST(VerifyLog, ReportsMessagesThatCannotBeDecoded) {
  LogBuilder builder;
  rgbd_frame_t message = Encode(SmallSensorFrame(1000));
  std::vector<uint8_t> damaged = Pack(message);
  damaged.back() ^= 1;
  frame_commit_t other{};
  builder.AddBytes("RGBD_FRAME", damaged).AddBytes("DETECTIONS", Pack(other));
  builder.AddBytes("OTHER_PROGRAM", {1, 2, 3});
  const LogReport report = Verify(builder.Finish());
  EXPECT_EQ(report.channels.at("RGBD_FRAME").undecodable, 1);
  EXPECT_EQ(report.channels.at("DETECTIONS").other_type, 1);
  EXPECT_EQ(report.channels.at("OTHER_PROGRAM").messages, 1);
  EXPECT_THAT(report.Problems(),
              ElementsAre(AllOf(HasSubstr("DETECTIONS"), HasSubstr("1 message of a wrong type"),
                                HasSubstr("fingerprint"), HasSubstr("detections_t")),
                          AllOf(HasSubstr("RGBD_FRAME"), HasSubstr("1 damaged message"),
                                HasSubstr("at byte 0"), HasSubstr("checksum"))));
}

TEST(VerifyLog, ReadsStatusOfBothVersions) {
  process_status_t status{};
  status.source = "map-server";
  std::vector<uint8_t> old = Pack(status);
  old.resize(old.size() - 4);  // the older version had no findings
  const std::array<uint8_t, 8> fingerprint = {0xdf, 0xd3, 0x01, 0x2f, 0xf7, 0x31, 0x1f, 0x8a};
  std::copy(fingerprint.begin(), fingerprint.end(), old.begin());
  status.seq = 1;
  LogBuilder builder;
  builder.Frame(1000).Frame(2000).AddBytes("STATUS", old).AddBytes("STATUS", Pack(status));
  const LogReport report = Verify(builder.Finish());
  EXPECT_EQ(report.channels.at("STATUS").messages, 2);
  EXPECT_EQ(report.channels.at("STATUS").other_type, 0);
  EXPECT_EQ(report.channels.at("STATUS").undecodable, 0);
}

TEST(VerifyLog, DistinguishesTruncationFromDamage) {
  LogBuilder builder;
  const std::string path = builder.Frame(1000).Frame(2000).Frame(3000).Finish();
  std::vector<uint8_t> bytes = *ReadFileBytes(path);
  const TempFolder folder;
  bytes.resize(bytes.size() - 10);
  folder.Write("cut", std::span<const uint8_t>(bytes));
  EXPECT_THAT(Verify(folder / "cut").Problems(), ElementsAre(HasSubstr("the log is truncated")));
  bytes[bytes.size() / 3 + 100] ^= 0xff;  // within the second frame's data
  bytes[0] = 0;                           // the first one's sync word
  folder.Write("damaged", std::span<const uint8_t>(bytes));
  EXPECT_THAT(Verify(folder / "damaged").Problems(),
              ElementsAre(HasSubstr("are damaged"), HasSubstr("the log is truncated"),
                          HasSubstr("RGBD_FRAME: 1 damaged message")));
}

TEST(VerifyLog, ReportsMissingInputOfTheMap) {
  LogBuilder builder;
  const LogReport report = Verify(builder.Frame(1000).Commit(1000, 1).Commit(2000, 2).Finish());
  EXPECT_THAT(report.Problems(), ElementsAre(HasSubstr("the DETECTIONS of camera 3, utime 1000"),
                                             HasSubstr("the RGBD_FRAME of camera 3, utime 2000")));
}

TEST(VerifyLog, ReportIsAvailableAsTextAndJson) {
  LogBuilder builder;
  const std::string path = builder.Frame(1000).Commit(2000, 1).Finish();
  const LogReport report = Verify(path);
  EXPECT_THAT(ReportText(path, report),
              AllOf(HasSubstr("RGBD_FRAME"), HasSubstr("rgbd_frame_t"),
                    HasSubstr("1 sent, 1 integrated, 0 skipped, 1 without a commit")));
  const auto json = nlohmann::json::parse(ReportJson(path, report));
  EXPECT_EQ(json.at("channels").at("RGBD_FRAME").at("messages").get<int>(), 1);
  EXPECT_EQ(json.at("frames").at("integrated").get<int>(), 1);
  EXPECT_EQ(json.at("problems").size(), report.Problems().size());
}

TEST(VerifyLog, NoMutatedLogCrashesIt) {
  LogBuilder builder;
  builder.Frame(1000).Detections(1000).Commit(1000, 1).Frame(2000).Detections(2000).Commit(2000, 2);
  const std::vector<uint8_t> good = *ReadFileBytes(builder.Finish());
  const TempFolder folder;
  int clean = 0;
  ForEachMutation(good, 1000, [&](const std::vector<uint8_t>& bad) {
    std::filesystem::remove(folder / "bad");
    folder.Write("bad", std::span<const uint8_t>(bad));
    Result<LogReader> reader = LogReader::Open(folder / "bad");
    const Result<LogReport> report = VerifyLog(*reader);
    clean += report && report->Problems().empty() ? 1 : 0;
  });
  EXPECT_LT(clean, 150);  // only changes of event numbers, times and messages without a checksum
                          // cannot be detected
}

}  // namespace
}  // namespace vismap
