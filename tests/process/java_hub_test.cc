#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <filesystem>
#include <string>
#include <thread>
#include <vismap/map_delta_t.hpp>

#include "process/process_harness.h"
#include "runtime/clock.h"
#include "runtime/tcp_socket.h"

// Our client with LCM's own hub, which is written in Java (Debian package liblcm-java).

namespace vismap {
namespace {

constexpr char kJava[] = "/usr/bin/java";
constexpr char kLcmJar[] = "/usr/share/java/lcm.jar";

/// A port of this computer that was free a moment ago.
int FreePort() {
  const Socket probe(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  EXPECT_EQ(bind(probe.fd(), reinterpret_cast<sockaddr*>(&address), size), 0);
  getsockname(probe.fd(), reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

TEST(JavaHub, ForwardsOurMessages) {
  if (!std::filesystem::exists(kJava) || !std::filesystem::exists(kLcmJar)) {
    GTEST_SKIP() << "needs the packages liblcm-java and default-jre-headless";
  }
  const TempFolder folder;
  const std::string port = std::to_string(FreePort());
  ChildProcess java(kJava, {"-cp", kLcmJar, "lcm.lcm.TCPService", port}, folder.path());
  const std::string url = "tcpq://127.0.0.1:" + port;
  const auto reader = Bus::Open({url, "reader", kProcessDeadline, nullptr});
  ASSERT_TRUE(reader) << reader.error().message << java.StandardError();
  const auto sender = Bus::Open({url, "sender", 10, nullptr});
  ASSERT_TRUE(sender) << sender.error().message;
  size_t received = 0, bytes = 0;
  (*reader)->Subscribe<map_delta_t>(kMapDeltaChannel, [&](const map_delta_t& delta) {
    ++received;
    bytes += delta.payload.size();
  });
  const auto send = [&](size_t size) {
    map_delta_t delta{};
    delta.payload.assign(size, 7);
    delta.payload_size = static_cast<int32_t>(size);
    EXPECT_TRUE((*sender)->Publish(kMapDeltaChannel, delta));
  };
  const auto wait_for = [&](size_t count, double timeout) {
    const double deadline = MonotonicSeconds() + timeout;
    while (received < count && MonotonicSeconds() < deadline) (*reader)->Spin(0.02);
    return received >= count;
  };
  // Repeat until the subscription has arrived at the hub; there is no acknowledgement.
  for (int i = 0; i < 1000 && !wait_for(1, 0.1); ++i) send(1);
  ASSERT_TRUE(wait_for(1, 0)) << java.StandardError();
  while (wait_for(received + 1, 0.3)) {
  }
  const size_t before = received, bytes_before = bytes;
  std::thread sending([&] {  // this hub makes the sender wait for the reader
    for (int i = 0; i < 10; ++i) send(kMegabyte);
  });
  EXPECT_TRUE(wait_for(before + 10, kProcessDeadline));
  sending.join();
  EXPECT_EQ(bytes - bytes_before, 10 * kMegabyte);
  EXPECT_EQ((*reader)->counters().at("MAP_DELTA").lost, 0);
}

}  // namespace
}  // namespace vismap
