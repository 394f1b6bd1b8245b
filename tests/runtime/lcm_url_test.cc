#include "runtime/lcm_url.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismap {
namespace {

using ::testing::HasSubstr;

TEST(ParseLcmUrl, ReadsAddressAndPortOfTheHub) {
  const auto url = ParseLcmUrl("tcpq://10.1.2.3:7701");
  ASSERT_TRUE(url);
  EXPECT_EQ(url->provider, "tcpq");
  EXPECT_EQ(url->hub.host, "10.1.2.3");
  EXPECT_EQ(url->hub.port, 7701);
  EXPECT_EQ(ParseLcmUrl("tcpq://10.1.2.3")->hub.port, 7700);
  EXPECT_EQ(ParseLcmUrl("tcpq://")->hub.host, "127.0.0.1");
}

TEST(ParseLcmUrl, RejectsNamesAndInvalidUrls) {
  for (const char* bad :
       {"tcpq://localhost:7700", "tcpq://robot", "tcpq://1.2.3", "tcpq://1.2.3.4:99999",
        "tcpq://1.2.3.4:77x", "tcpq://1.2.3.4:", "127.0.0.1:7700", ""}) {
    const auto url = ParseLcmUrl(bad);
    ASSERT_FALSE(url) << bad;
    EXPECT_THAT(url.error().message, HasSubstr("--lcm-url"));
  }
}

TEST(ParseLcmUrl, UdpmGetsALargeReceiveBuffer) {
  EXPECT_EQ(ParseLcmUrl("udpm://239.255.76.67:7667")->text,
            "udpm://239.255.76.67:7667?recv_buf_size=4194304");
  EXPECT_EQ(ParseLcmUrl("udpm://239.255.76.67:7667?ttl=0")->text,
            "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304");
  const auto own = ParseLcmUrl("udpm://239.255.76.67:7667?recv_buf_size=100000&ttl=0");
  EXPECT_EQ(own->receive_buffer, 100000);
  EXPECT_EQ(own->text, "udpm://239.255.76.67:7667?recv_buf_size=100000&ttl=0");
  EXPECT_FALSE(ParseLcmUrl("udpm://?recv_buf_size=big"));
}

TEST(ProbeHub, FailsWhenNoProgramListens) {
  const auto probed = ProbeHub({"127.0.0.1", 1}, 1.0);
  ASSERT_FALSE(probed);
  EXPECT_THAT(probed.error().message, HasSubstr("127.0.0.1:1"));
}

TEST(ProbeReceiveBuffer, ErrorNamesTheCommand) {
  EXPECT_TRUE(ProbeReceiveBuffer(4096));
  const auto too_much = ProbeReceiveBuffer(1 << 30);
  if (too_much) GTEST_SKIP() << "this kernel grants 1 GB";
  EXPECT_THAT(too_much.error().message, HasSubstr("sysctl -w net.core.rmem_max"));
}

}  // namespace
}  // namespace vismap
