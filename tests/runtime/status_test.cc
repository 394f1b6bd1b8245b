#include "runtime/status.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>
#include <vismap/process_status_t.hpp>

#include "runtime/bus.h"

namespace vismap {
namespace {

TEST(StatusFindings, AreBoundedAndSayHowManyAreLeftOut) {
  auto bus = Bus::Open({"memq://", "tester", 1, nullptr});
  ASSERT_TRUE(bus) << bus.error().message;
  const auto publish = [&](Status* status) {
    status->Publish();
    while ((*bus)->Spin(0.01)) {
    }
  };
  Status status(bus->get(), "depth-segmenter");
  std::vector<std::string> found;
  (*bus)->Subscribe<process_status_t>(
      kStatusChannel, [&](const process_status_t& message) { found = message.findings; });
  for (int i = 0; i < 1000; ++i) {
    const std::string number = std::to_string(i);
    status.SetFinding("camera " + number, "camera " + number + " is shared");
    if (i == 15) {
      publish(&status);
      EXPECT_EQ(found.size(), 16u);
    }
  }
  EXPECT_EQ(status.findings().size(), 65u);
  publish(&status);
  ASSERT_EQ(found.size(), 16u);
  EXPECT_EQ(found.back(), "there are 50 more findings; the log of this process has them");
}

}  // namespace
}  // namespace vismap
