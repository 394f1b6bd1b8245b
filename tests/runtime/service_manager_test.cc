#include "runtime/service_manager.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/fake_service_manager.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;

TEST(ServiceManager, DoesNothingWithoutAServiceManager) {
  ServiceManager service;
  EXPECT_EQ(service.alive_period(), 0);
  service.SetReady();
  service.SetStatus("anything");
  service.KeepAlive();
  service.SetStopping();
}

TEST(ServiceManager, SentencesCannotContainOtherAssignments) {
  FakeServiceManager manager(1'000'000);
  ServiceManager service;
  service.SetStatus("frame of 'x\nMAINPID=1\nREADY=1' refused");
  EXPECT_THAT(manager.Heard(), ElementsAre("STATUS=frame of 'x MAINPID=1 READY=1' refused"));
}

TEST(ServiceManager, KeepAliveSendsAtMostOneMessagePerPeriod) {
  FakeServiceManager manager(int64_t{3600} * 1000 * 1000);
  ServiceManager service;
  EXPECT_EQ(service.alive_period(), 1800);
  for (int i = 0; i < 100; ++i) service.KeepAlive();
  service.SetReady();
  service.SetReady();
  EXPECT_THAT(manager.Heard(), ElementsAre("WATCHDOG=1", "READY=1"));
}

}  // namespace
}  // namespace vismap
