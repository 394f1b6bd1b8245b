#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "process/process_harness.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

TEST(DoctorProgram, NamesTheCommandThatStartsAHub) {
  const TempFolder folder;
  ChildProcess doctor("doctor", {"--lcm-url", "tcpq://127.0.0.1:1", "--seconds", "1"},
                      folder.path());
  EXPECT_EQ(doctor.WaitForExit(), 1);
  EXPECT_THAT(doctor.StandardOutput(), HasSubstr("vismap-hub --listen 127.0.0.1:1"));
}

TEST(DoctorProgram, ReportsTheMissingDetectorAndLaterAHealthyBus) {
  ProcessBus processes;
  // A map that keeps up with the camera on a slow computer, too.
  const std::filesystem::path config = processes.folder() / "coarse.txtpb";
  std::ofstream(config) << "grid { voxel_size_m: 0.03 }\n";
  auto server = processes.Start("map-server", {"--config", config.string()});
  auto segmenter = processes.Start("depth-segmenter", {"--detections", "required"});
  ASSERT_TRUE(processes.WaitForReady({"map-server", "depth-segmenter"}));
  auto replay = processes.Start("sensor-replay",
                                {"--dataset", "synthetic:room?frames=40&width=160", "--loop"});
  ASSERT_TRUE(processes.SpinUntil([&] {
    const auto& all = processes.peers().all();
    return all.at("depth-segmenter").message.find("DETECTIONS") != std::string::npos;
  }));
  auto doctor = processes.Start("doctor", {"--seconds", "2"});
  EXPECT_EQ(doctor->WaitForExit(), 1);
  EXPECT_THAT(doctor->StandardOutput(), HasSubstr("depth-segmenter waits for DETECTIONS"));
  EXPECT_THAT(doctor->StandardOutput(), HasSubstr("start vismap-detector"));
  segmenter->Signal(SIGTERM);
  segmenter->WaitForExit();
  segmenter = processes.Start("depth-segmenter", {"--detections", "none", "--name", "second"});
  ASSERT_TRUE(processes.SpinUntil([&] {
    const auto& all = processes.peers().all();
    return all.contains("second") && all.at("second").state == "running";
  }));
  doctor = processes.Start("doctor", {"--seconds", "2", "--json"});
  EXPECT_EQ(doctor->WaitForExit(), 0) << doctor->StandardOutput();
  const auto report = nlohmann::json::parse(doctor->StandardOutput(), nullptr, false);
  ASSERT_TRUE(report.is_object());
  EXPECT_TRUE(report["healthy"].get<bool>());
}

}  // namespace
}  // namespace vismap
