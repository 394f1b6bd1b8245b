#include "runtime/tcp_socket.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <array>
#include <string>

#include "runtime/tcpq_records.h"

namespace vismap {
namespace {

/// Two ends of a connection within this computer.
struct Connection {
  Connection() {
    const Socket listening(socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* const at = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(bind(listening.fd(), at, size), 0);
    EXPECT_EQ(listen(listening.fd(), 1), 0);
    getsockname(listening.fd(), at, &size);
    client = Socket(socket(AF_INET, SOCK_STREAM, 0));
    EXPECT_EQ(connect(client.fd(), at, size), 0);
    server = Socket(accept(listening.fd(), nullptr, nullptr));
  }
  Socket client, server;
};

std::string CongestionControl(int fd) {
  std::array<char, 32> name{};
  socklen_t size = name.size() - 1;
  getsockopt(fd, IPPROTO_TCP, TCP_CONGESTION, name.data(), &size);
  return name.data();
}

TEST(TuneTcp, SpacesNoPacketsWithinAComputer) {
  Connection connection;
  const std::string bbr = "bbr";
  setsockopt(connection.client.fd(), IPPROTO_TCP, TCP_CONGESTION, bbr.data(),
             static_cast<socklen_t>(bbr.size()));
  TuneTcp(connection.client.fd());
  EXPECT_NE(CongestionControl(connection.client.fd()), "bbr");
}

// A message larger than one step of reading, and small ones around it.
TEST(RecordReader, ReadsRecordsOfAllSizesFromOneStream) {
  Connection connection;
  RecordReader reader(TcpqMagic::kClient, size_t{1} << 24);
  reader.SkipHello();
  std::vector<size_t> sizes;
  for (const size_t size : {3, 300'000, 0, 300'000, 1000, 70'000, 1}) {
    const TcpqRecord sent =
        TcpqPublish("CHANNEL", std::vector<uint8_t>(size, static_cast<uint8_t>(size & 0xff)));
    for (size_t at = 0; at < sent.bytes->size();) {
      const size_t part = std::min<size_t>(50'000, sent.bytes->size() - at);
      ASSERT_EQ(send(connection.client.fd(), sent.bytes->data() + at, part, 0),
                static_cast<ssize_t>(part));
      at += part;
      const auto take = [&](const TcpqRecord& record) {
        sizes.push_back(record.data().size());
        for (const uint8_t byte : record.data())
          ASSERT_EQ(byte, static_cast<uint8_t>(record.data().size()));
      };
      ASSERT_TRUE(reader.ReadFrom(connection.server.fd(), 1 << 20, take));
    }
  }
  const std::vector<size_t> expected = {3, 300'000, 0, 300'000, 1000, 70'000, 1};
  while (sizes.size() < expected.size()) {
    ASSERT_TRUE(reader.ReadFrom(connection.server.fd(), 1 << 20,
                                [&](const TcpqRecord& r) { sizes.push_back(r.data().size()); }));
  }
  EXPECT_EQ(sizes, expected);
  connection.client.Close();
  const auto none = [](const TcpqRecord&) {};
  const Result<void> closed = reader.ReadFrom(connection.server.fd(), 1 << 20, none);
  ASSERT_FALSE(closed);
  EXPECT_EQ(closed.error().message, "");
}

}  // namespace
}  // namespace vismap
