#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "process/process_harness.h"

// vismap-map report: of a map, of a folder of the offline mapper, and of what it maps first.

namespace vismap {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

constexpr char kReportedRoom[] = "synthetic:room?frames=12&width=160";
constexpr char kReportedVoxels[] = "grid { voxel_size_m: 0.02 }\n";

/// Mapped once for all tests below.
class ReportedRoom {
 public:
  static const ReportedRoom& Get() {
    static const ReportedRoom room;
    return room;
  }
  std::string File(const std::string& name) const { return (folder_ / name).string(); }

 private:
  ReportedRoom() {
    folder_.Write("coarse.txtpb", kReportedVoxels);
    ChildProcess mapper(
        "offline-mapper",
        {"--dataset", kReportedRoom, "--config", File("coarse.txtpb"), "--out", File("out")},
        folder_.path());
    EXPECT_EQ(mapper.WaitForExit(), 0) << mapper.StandardError();
  }
  TempFolder folder_;
};

struct Reported {
  int exit_code = -1;
  std::string html, error;
};

Reported Report(const std::string& subject, std::vector<std::string> options = {}) {
  const TempFolder folder;
  const fs::path file = folder / "report.html";
  options.insert(options.begin(), {"report", subject, "--out", file.string(), "--page",
                                   (folder / "nothing").string()});
  ChildProcess tool("map", options, folder.path());
  const int code = tool.WaitForExit().value_or(-1);
  std::ifstream stream(file, std::ios::binary);
  return {code, {std::istreambuf_iterator<char>(stream), {}}, tool.StandardError()};
}

TEST(ReportCommand, FolderHasStageTimesAndAMapAloneHasThemWhenTheyAreOfIt) {
  const ReportedRoom& room = ReportedRoom::Get();
  const Reported of_folder = Report(room.File("out"));
  ASSERT_EQ(of_folder.exit_code, 0) << of_folder.error;
  EXPECT_THAT(of_folder.html, HasSubstr("<td>segmentation</td>"));
  EXPECT_THAT(of_folder.html, HasSubstr("chair"));
  EXPECT_THAT(of_folder.html, HasSubstr("12 of 1 camera"));
  EXPECT_THAT(of_folder.html, HasSubstr("No ground truth was named"));
  EXPECT_THAT(of_folder.html, HasSubstr("not of a log"));
  EXPECT_THAT(of_folder.html, Not(HasSubstr("://")));

  fs::create_directories(room.File("other"));
  fs::copy_file(room.File("out/map.vismap"), room.File("other/map.vismap"));
  std::ofstream(room.File("other/report.json"))
      << R"({"map":{"hash":"00"},"stages_ms":{"foreign":{"median":1}}})";
  const Reported other = Report(room.File("other/map.vismap"));
  EXPECT_EQ(other.exit_code, 0) << other.error;
  EXPECT_THAT(other.error, HasSubstr("is of another map"));
  EXPECT_THAT(other.html, Not(HasSubstr("foreign")));
}

TEST(ReportCommand, LogIsMappedFirstAndItsChannelsAreListed) {
  const ReportedRoom& room = ReportedRoom::Get();
  ChildProcess log("log", {"from-dataset", kReportedRoom, "--out", room.File("run.lcmlog")},
                   room.File("out"));
  ASSERT_EQ(log.WaitForExit(), 0) << log.StandardError();
  const Reported reported =
      Report(room.File("run.lcmlog"), {"--config", room.File("coarse.txtpb")});
  ASSERT_EQ(reported.exit_code, 0) << reported.error;
  EXPECT_THAT(reported.html, HasSubstr("<td>RGBD_FRAME</td><td>12</td>"));
  EXPECT_THAT(reported.html, HasSubstr("no STATUS messages"));
  EXPECT_THAT(reported.html, HasSubstr("<td>segmentation</td>"));
}

TEST(ReportCommand, ScoresWhenThereIsTruth) {
  const ReportedRoom& room = ReportedRoom::Get();
  const Reported reported = Report(room.File("out"), {"--truth", kReportedRoom});
  ASSERT_EQ(reported.exit_code, 0) << reported.error;
  EXPECT_THAT(reported.html, HasSubstr("<td>mAP50</td>"));
  const Reported wrong = Report(room.File("out"), {"--truth", room.File("no-truth")});
  EXPECT_EQ(wrong.exit_code, 3);
  EXPECT_THAT(wrong.error, HasSubstr("--truth"));
  EXPECT_THAT(wrong.error, HasSubstr("no-truth"));
}

TEST(ReportCommand, ErrorsNameWhatIsMissing) {
  const ReportedRoom& room = ReportedRoom::Get();
  for (const char* name : {"none.vismap", "none.lcmlog", "nothing", "coarse.txtpb"}) {
    const Reported reported = Report(room.File(name));
    EXPECT_EQ(reported.exit_code, 3) << name << reported.error;
    EXPECT_THAT(reported.error, HasSubstr(name));
    EXPECT_EQ(reported.html, "");
  }
}

}  // namespace
}  // namespace vismap
