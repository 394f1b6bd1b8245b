#include "log_tool/map_to_mcap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "logs/recording.h"
#include "support/log_builder.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct SequenceOfLog {
  Recording recording;
  std::unique_ptr<DetectionSource> detections;
};

SequenceOfLog OpenSequenceOf(const std::string& log) {
  auto recording = OpenRecording(log, "");
  EXPECT_TRUE(recording) << recording.error().message;
  SequenceOfLog sequence{std::move(*recording), nullptr};
  if (const auto inside = sequence.recording.dataset->default_detections_path())
    sequence.detections = std::move(*OpenRecordedDetections(*inside));
  return sequence;
}

McapExport WriteFrames(LogBuilder* builder, bool with_map) {
  for (int64_t i = 1; i <= 4; ++i) builder->Frame(1'000'000 * i).Detections(1'000'000 * i);
  const SequenceOfLog input = OpenSequenceOf(builder->Finish());
  VismapConfig config;
  DeriveOptions(&config);
  const auto written = WriteMcap({*input.recording.dataset, input.detections.get(), with_map},
                                 config, {}, builder->folder() / "run.mcap");
  EXPECT_TRUE(written) << written.error().message;
  return written.value_or(McapExport{});
}

TEST(WriteSequenceAsMcap, HasTheMapAsItGrows) {
  LogBuilder builder;
  McapExport result = WriteFrames(&builder, true);
  EXPECT_EQ(result.unusable.total(), 0) << result.unusable.Text();
  EXPECT_EQ(result.topics["/camera3/color/image"], 4);
  EXPECT_EQ(result.topics["/camera3/detections"], 4);
  EXPECT_EQ(result.topics["/camera3/segments/image"], 4);
  EXPECT_EQ(result.topics["/map/objects"], 4);  // one per second
  EXPECT_EQ(result.topics["/map/surface"], 4);
  EXPECT_EQ(result.topics["/map/surface_points"], 2);  // every five seconds, and at the end
  EXPECT_EQ(result.topics["/map/free"], 2);
}

TEST(WriteSequenceAsMcap, HasNoMapUnlessItIsAskedFor) {
  LogBuilder builder;
  const McapExport result = WriteFrames(&builder, false);
  EXPECT_EQ(result.topics.at("/camera3/depth/image"), 4);
  for (const auto& [topic, count] : result.topics) EXPECT_FALSE(topic.starts_with("/map")) << topic;
}

TEST(WriteSequenceAsMcap, ErrorNamesTheFile) {
  LogBuilder builder;
  const SequenceOfLog input = OpenSequenceOf(builder.Frame(1000).Finish());
  const auto written = WriteMcap({*input.recording.dataset, nullptr, false}, VismapConfig{}, {},
                                 builder.folder() / "missing/run.mcap");
  EXPECT_THAT(written.error().message, HasSubstr("missing/run.mcap"));
}

TEST(WriteSequenceAsMcap, LeavesNoFileWhenItIsStopped) {
  LogBuilder builder;
  const SequenceOfLog input = OpenSequenceOf(builder.Frame(1000).Frame(2000).Finish());
  const auto out = builder.folder() / "run.mcap";
  StopSignal stop;
  stop.Request();
  const auto written =
      WriteMcap({*input.recording.dataset, nullptr, false}, VismapConfig{}, {}, out, &stop);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().message, kMcapStopped);
  for (const auto& entry : std::filesystem::directory_iterator(builder.folder().path()))
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("mcap")));
}

}  // namespace
}  // namespace vismap
