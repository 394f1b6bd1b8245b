// The messages that systemd receives from our processes when it starts them with Type=notify.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include "process/process_harness.h"
#include "support/fake_service_manager.h"

namespace vismap {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr int kWatchdogUs = 200'000;

TEST(Service, HubReportsReadyAliveAndStopping) {
  const TempFolder folder;
  FakeServiceManager manager(kWatchdogUs);
  ChildProcess hub("hub", {"--listen", "127.0.0.1:0"}, folder.path());
  ASSERT_TRUE(manager.WaitFor("READY=1")) << hub.StandardError();
  EXPECT_THAT(hub.StandardOutput(), HasSubstr("tcpq://127.0.0.1:"));
  EXPECT_THAT(manager.Heard(), Contains(StartsWith("STATUS=running: tcpq://127.0.0.1:")));
  EXPECT_TRUE(manager.WaitFor("WATCHDOG=1", 3));
  hub.Signal(SIGSTOP);  // simulates a process that hangs
  ASSERT_EQ(waitpid(hub.pid(), nullptr, WUNTRACED), hub.pid());
  manager.Heard();
  manager.Forget();
  EXPECT_TRUE(manager.Heard(5 * kWatchdogUs * 1e-6).empty());
  hub.Signal(SIGCONT);
  EXPECT_TRUE(manager.WaitFor("WATCHDOG=1"));
  hub.Signal(SIGTERM);
  EXPECT_TRUE(manager.WaitFor("STOPPING=1"));
  EXPECT_EQ(hub.WaitForExit(), 0);
  EXPECT_EQ(manager.Count("READY=1"), 0) << "it is sent only once";
}

TEST(Service, ProcessReportsItsStatus) {
  ProcessBus processes;
  FakeServiceManager manager(kWatchdogUs);
  auto segmenter = processes.Start("depth-segmenter", {"--detections", "none"});
  ASSERT_TRUE(manager.WaitFor("READY=1")) << segmenter->StandardError();
  ASSERT_TRUE(processes.WaitForReady({"depth-segmenter"}));
  EXPECT_EQ(manager.Heard()[0], "STATUS=starting: connecting to the bus at " + processes.url());
  EXPECT_TRUE(manager.WaitFor("STATUS=ready"));
  EXPECT_TRUE(manager.WaitFor("WATCHDOG=1", 3)) << "without any message on the bus";
  segmenter->Signal(SIGTERM);
  EXPECT_TRUE(manager.WaitFor("STOPPING=1"));
  EXPECT_EQ(segmenter->WaitForExit(), 0);
  EXPECT_EQ(manager.Count("READY=1"), 1);
}

TEST(Service, ProcessWithoutAHubIsNeverReady) {
  const TempFolder folder;
  FakeServiceManager manager(kWatchdogUs);
  ChildProcess segmenter("depth-segmenter",
                         {"--lcm-url", "tcpq://127.0.0.1:1", "--connect-timeout", "0.5"},
                         folder.path());
  EXPECT_EQ(segmenter.WaitForExit(), 1);
  EXPECT_THAT(manager.Heard(),
              Contains("STATUS=starting: connecting to the bus at tcpq://127.0.0.1:1"));
  EXPECT_THAT(manager.Heard(), Not(Contains("READY=1")));
}

}  // namespace
}  // namespace vismap
