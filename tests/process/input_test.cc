#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "process/process_harness.h"
#include "process/room_pipeline.h"
#include "support/log_builder.h"

// Input as it comes from real recorders: damaged, cut off, without times, or of no use at all.

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

constexpr char kTinyRoom[] = "synthetic:room?frames=12&width=96";

struct Ended {
  int exit_code = -1;
  std::string out, log;
};

Ended RunProgram(const std::string& name, const std::vector<std::string>& arguments,
                 const TempFolder& folder) {
  ChildProcess child(name, arguments, folder.path());
  const int exit_code = child.WaitForExit().value_or(-1);
  return {exit_code, child.StandardOutput(), child.StandardError()};
}

Ended Map(const fs::path& dataset, const TempFolder& folder) {
  return RunProgram("offline-mapper",
                    {"--dataset", dataset.string(), "--out", (folder / "out").string()}, folder);
}

std::string ReportedHash(const TempFolder& folder) {
  std::ifstream report(folder / "out/report.json");
  return nlohmann::json::parse(report)["map"]["hash"].get<std::string>();
}

/// Writes a computed room as a folder of images.
void WriteRoom(const std::string& name, const std::string& room, const TempFolder& folder) {
  const Ended log = RunProgram("log",
                               {"from-dataset", room, "--detections", "none", "--out",
                                (folder / (name + ".lcmlog")).string()},
                               folder);
  ASSERT_EQ(log.exit_code, 0) << log.log;
  const Ended written = RunProgram(
      "log",
      {"to-dataset", (folder / (name + ".lcmlog")).string(), "--out", (folder / name).string()},
      folder);
  ASSERT_EQ(written.exit_code, 0) << written.log;
}

/// A log of which one frame is damaged, and another one has a pose that is no pose.
std::string DamagedLog(LogBuilder* builder) {
  rgbd_frame_t message = Encode(SmallSensorFrame(1000));
  std::vector<uint8_t> damaged = Pack(message);
  damaged[damaged.size() - 50] ^= 1;
  rgbd_frame_t lost = Encode(SmallSensorFrame(2000));
  lost.T_W_C[3] = std::nan("");
  builder->AddBytes("RGBD_FRAME", damaged).Add(kRgbdFrameChannel, lost);
  return builder->Frame(33'000).Frame(66'000).Frame(99'000).Finish();
}

TEST(Input, DamagedFramesOfALogCostOnlyThemselves) {
  LogBuilder builder;
  const std::string log = DamagedLog(&builder);
  const TempFolder folder;
  const Ended mapped = Map(log, folder);
  EXPECT_EQ(mapped.exit_code, 0) << mapped.log;
  EXPECT_THAT(mapped.log, AllOf(HasSubstr("2 of 5 frames were left out"), HasSubstr("checksum"),
                                HasSubstr("NaN")));
  EXPECT_THAT(mapped.out, HasSubstr("3 frames, median"));
  const Ended verified = RunProgram("log", {"verify", log}, folder);
  EXPECT_EQ(verified.exit_code, 1);
  EXPECT_THAT(verified.out, AllOf(HasSubstr("1 damaged message"), HasSubstr("NaN")));
}

/// A log of frames that cannot be used.
std::string UselessLog(LogBuilder* builder) {
  for (int i = 0; i < 6; ++i) {
    rgbd_frame_t message = Encode(SmallSensorFrame(33'333 * (i + 1)));
    message.T_W_C[15] = 2;
    builder->Add(kRgbdFrameChannel, message);
  }
  return builder->Finish();
}

TEST(Input, WithoutAUsableFrameAllProgramsSayTheSameAndTheFolderStays) {
  LogBuilder builder;
  const std::string log = UselessLog(&builder);
  const TempFolder folder;
  folder.Write("out/mine.txt", "mine");
  const auto why = AllOf(HasSubstr("no usable frames (6 of 6: "), HasSubstr("last row"));
  const Ended mapped = Map(log, folder);
  EXPECT_EQ(mapped.exit_code, 3);
  EXPECT_THAT(mapped.log, why);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "out"), {}), 1);
  const Ended replayed = RunProgram("sensor-replay", {"--dataset", log}, folder);
  EXPECT_EQ(replayed.exit_code, 3);
  EXPECT_THAT(replayed.log, why);
  const Ended converted =
      RunProgram("log", {"to-dataset", log, "--out", (folder / "x").string()}, folder);
  EXPECT_EQ(converted.exit_code, 3);
  EXPECT_THAT(converted.log, why);
  const Ended verified = RunProgram("log", {"verify", log}, folder);
  EXPECT_EQ(verified.exit_code, 1);
  EXPECT_THAT(verified.out, HasSubstr("last row"));
}

TEST(Input, ColourThatCannotBeDecodedIsToldByVerifyToo) {
  LogBuilder builder;
  for (int i = 1; i <= 4; ++i) {
    rgbd_frame_t message = Encode(SmallSensorFrame(33'333 * i));
    message.color = {0x89, 'P', 'N', 'G'};
    message.color_size = 4;
    builder.Add(kRgbdFrameChannel, message);
  }
  const std::string log = builder.Finish();
  const TempFolder folder;
  const Ended mapped = Map(log, folder);
  EXPECT_EQ(mapped.exit_code, 0) << mapped.log;
  EXPECT_THAT(mapped.log, HasSubstr("4 of 4 frames are mapped without their colour"));
  EXPECT_THAT(RunProgram("log", {"verify", log}, folder).out,
              HasSubstr("the colour of 4 RGBD_FRAMEs cannot be decoded"));
}

TEST(Input, DetectionsThatNameNoObjectAreTold) {
  const TempFolder folder;
  std::string weak = "[";
  for (int i = 1; i <= 12; ++i) {
    weak +=
        std::string(i > 1 ? "," : "") + R"({"image_id":)" + std::to_string(i) +
        R"(,"category_id":62,"score":0.02,"segmentation":{"size":[72,96],"counts":[0,3000,3912]}})";
  }
  folder.Write("weak.json", weak + "]");
  const Ended mapped =
      RunProgram("offline-mapper",
                 {"--dataset", "synthetic:room?frames=12&width=96", "--detections",
                  (folder / "weak.json").string(), "--out", (folder / "out").string()},
                 folder);
  EXPECT_EQ(mapped.exit_code, 0) << mapped.log;
  EXPECT_THAT(mapped.log, HasSubstr("12 of 12 detections name no object"));
}

TEST(Input, ALogOfOtherThingsIsTold) {
  LogBuilder builder;
  const std::string log = builder.AddBytes("OTHER", {1, 2, 3}).Finish();
  const TempFolder folder;
  const Ended mapped = Map(log, folder);
  EXPECT_EQ(mapped.exit_code, 3);
  EXPECT_THAT(mapped.log,
              AllOf(HasSubstr("the log has no RGBD_FRAME"), Not(HasSubstr("frames=all"))));
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(Input, AnUnusableOutputFolderIsToldBeforeTheMapping) {
  const TempFolder folder;
  folder.Write("file", "x");
  for (const char* out : {"file", "file/below", "/proc/vismap"}) {
    const Ended mapped = RunProgram(
        "offline-mapper", {"--dataset", kTinyRoom, "--out", (folder / out).string()}, folder);
    EXPECT_EQ(mapped.exit_code, 1) << out;
    EXPECT_THAT(mapped.log, AllOf(HasSubstr("error"), Not(HasSubstr("mapping")))) << out;
  }
}

TEST(Input, TheSameImagesAreDamagedInEveryProgram) {
  const TempFolder folder;
  WriteRoom("room", kTinyRoom, folder);
  const auto cut = [&](const std::string& name) {
    const fs::path path = folder / "room" / name;
    ASSERT_TRUE(fs::exists(path)) << name;
    fs::resize_file(path, fs::file_size(path) / 2);
  };
  cut("depth/depth00003.png");
  cut("image/image00005.jpg");
  const Ended mapped = Map(folder / "room", folder);
  ASSERT_EQ(mapped.exit_code, 0) << mapped.log;
  EXPECT_THAT(mapped.log, AllOf(HasSubstr("1 of 12 frames were left out"),
                                HasSubstr("1 of 11 frames are mapped without their colour")));

  ProcessBus processes;
  const auto server = processes.Start("map-server");
  const auto segmenter = processes.Start("depth-segmenter", {"--detections", "none"});
  const auto replay =
      processes.Start("sensor-replay", {"--dataset", (folder / "room").string(), "--mode",
                                        "lockstep", "--wait-for", "map-server,depth-segmenter"});
  EXPECT_TRUE(processes.SpinUntil([&] { return !replay->Running(); }));
  EXPECT_EQ(replay->WaitForExit(), 0) << replay->StandardError();
  EXPECT_THAT(replay->StandardError(), HasSubstr("1 of 12 frames were left out"));
  EXPECT_EQ(ServerStatistic(&processes, "hash"), ReportedHash(folder));
}

TEST(Input, ASecondSequenceWithoutAClockGoesOnAfterTheFirst) {
  const TempFolder folder;
  WriteRoom("a", kTinyRoom, folder);
  WriteRoom("b", std::string(kTinyRoom) + "&pose_noise=0.002", folder);
  for (const char* name : {"a", "b"}) fs::remove(folder / name / "timestamp.txt");
  ProcessBus processes;
  const auto server = processes.Start("map-server");
  const auto segmenter = processes.Start("depth-segmenter", {"--detections", "none"});
  const auto play = [&](const std::string& name) {
    const auto replay =
        processes.Start("sensor-replay", {"--dataset", (folder / name).string(), "--mode",
                                          "lockstep", "--wait-for", "map-server,depth-segmenter"});
    EXPECT_TRUE(processes.SpinUntil([&] { return !replay->Running(); }));
    EXPECT_EQ(replay->WaitForExit(), 0) << replay->StandardError();
    return replay->StandardError();
  };
  EXPECT_THAT(play("a"), HasSubstr("integrated 12, skipped 0 and had 0 before"));
  EXPECT_THAT(play("b"), AllOf(HasSubstr("its utimes are moved by"),
                               HasSubstr("integrated 12, skipped 0 and had 0 before")));
  EXPECT_THAT(play("a"), HasSubstr("integrated 0, skipped 0 and had 12 before"));
  EXPECT_THAT(play("b"), HasSubstr("integrated 0, skipped 0 and had 12 before"));
  EXPECT_EQ(Ask(&processes, "statistics").revision, 24);
}

}  // namespace
}  // namespace vismap
