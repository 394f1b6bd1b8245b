#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>

#include <array>
#include <thread>
#include <vector>

#include "hub/running_hub.h"
#include "runtime/tcp_socket.h"

// What single clients, hostile or merely broken, can do to a hub: nothing that lasts.

namespace vismap {
namespace {

HubOptions Strict() {
  HubOptions options;
  options.queue_mb = 2;
  options.socket_buffer_bytes = 16384;
  options.patience_s = 0.5;
  options.greeting_s = 0.5;
  options.max_hold_s = 0.5;
  options.lossless = {"MAP_DELTA"};
  options.critical = {"map-server"};
  return options;
}

/// A client that speaks the protocol byte by byte.
class RawClient {
 public:
  explicit RawClient(const RunningHub& hub) {
    Result<Socket> socket = ConnectToHub({"127.0.0.1", hub.port()}, 5);
    EXPECT_TRUE(socket);
    if (socket) socket_ = std::move(*socket);
  }
  void Send(const std::vector<uint8_t>& bytes) {
    EXPECT_EQ(send(socket_.fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  /// Sends as much as the buffers of the system take.
  void SendWhatFits(const std::vector<uint8_t>& bytes) {
    EXPECT_GT(send(socket_.fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT), 100'000);
  }
  /// Reads 20 bytes every 10 ms for some seconds.
  void ReadSlowly(double seconds) {
    std::array<uint8_t, 20> bytes{};
    for (const double end = MonotonicSeconds() + seconds; MonotonicSeconds() < end;) {
      recv(socket_.fd(), bytes.data(), bytes.size(), MSG_DONTWAIT);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  /// Whether the hub closes the connection within the deadline; reads all that comes before.
  bool IsCutOff() {
    std::vector<uint8_t> bytes(65536);
    for (const double end = MonotonicSeconds() + kDeadline; MonotonicSeconds() < end;) {
      const ssize_t got = recv(socket_.fd(), bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (got == 0 || (got < 0 && errno == ECONNRESET)) return true;
      if (got < 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

 private:
  Socket socket_;
};

/// Publishes `count` messages of a megabyte and returns how long that took [s].
double SecondsToPublish(Bus* bus, int count) {
  const double start = MonotonicSeconds();
  for (int i = 0; i < count; ++i) EXPECT_TRUE(bus->Publish(kMapDeltaChannel, Delta(i, kMegabyte)));
  Settle(bus);
  return MonotonicSeconds() - start;
}

TEST(HostileClient, SubscriptionsThatTakeLongDoNotStopTheHub) {
  RunningHub hub(HubOptions{});
  auto sender = Join(hub, "sender"), reader = Join(hub, "reader");
  int received = 0;
  reader->Subscribe<map_delta_t>(kMapDeltaChannel, [&](const map_delta_t&) { ++received; });
  Settle(reader.get());
  RawClient flood(hub);
  flood.Send(TcpqHello(TcpqMagic::kClient));
  std::vector<uint8_t> records = TcpqSubscribe("(?:a?){300}b");
  std::vector<uint8_t> unsubscribe = records;
  unsubscribe[3] = static_cast<uint8_t>(TcpqRecord::Kind::kUnsubscribe);
  records.insert(records.end(), unsubscribe.begin(), unsubscribe.end());
  while (records.size() < 2 * kMegabyte)
    records.insert(records.end(), records.begin(), records.end());
  flood.SendWhatFits(records);
  const double start = MonotonicSeconds();
  EXPECT_TRUE(sender->Publish(kMapDeltaChannel, Delta(1, 100)));
  while (received == 0 && MonotonicSeconds() < start + kDeadline) reader->Spin(0.05);
  EXPECT_EQ(received, 1);
  EXPECT_LT(MonotonicSeconds() - start, 3);
}

TEST(HostileClient, AReaderThatIsNotCriticalMakesNoPublisherWait) {
  RunningHub hub(Strict());
  auto sender = Join(hub, "sender"), slow = Join(hub, "slow");
  slow->Subscribe<map_delta_t>(kMapDeltaChannel, [](const map_delta_t&) {});
  Introduce(slow.get());
  Settle(slow.get());
  SecondsToPublish(sender.get(), 50);
  hub.Stop();
  EXPECT_EQ(hub.counters().held_back, 0);
  EXPECT_GT(hub.counters().dropped, 30);
}

TEST(HostileClient, AReaderThatTakesAFewBytesIsJudgedByWhatWaitsForIt) {
  RunningHub hub(Strict());
  auto sender = Join(hub, "sender");
  RawClient drip(hub);
  drip.Send(TcpqSubscribe("MAP_DELTA"));
  Settle(sender.get());
  SecondsToPublish(sender.get(), 3);
  drip.ReadSlowly(3);  // 2 kB a second
  EXPECT_TRUE(drip.IsCutOff());
  hub.Stop();
  EXPECT_EQ(hub.counters().clients_cut_off, 1);
}

TEST(HostileClient, AHalfSentMessageIsNotWaitedForForEver) {
  RunningHub hub(Strict());
  RawClient half(hub);
  half.Send(TcpqPublishHead("MAP_DELTA", 1000));
  half.Send({1, 2, 3});
  EXPECT_TRUE(half.IsCutOff());
}

TEST(HostileClient, ASilentConnectionIsClosed) {
  RunningHub hub(Strict());
  Socket silent(socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(hub.port());
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(connect(silent.fd(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  char byte = 0;
  timeval timeout{static_cast<time_t>(kDeadline), 0};
  setsockopt(silent.fd(), SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof(timeout));
  ssize_t got = 1;
  while (got > 0) got = recv(silent.fd(), &byte, 1, 0);  // the hub's greeting, then the end
  EXPECT_EQ(got, 0);
}

TEST(HostileClient, IdleConnectionsMakeRoomForProcesses) {
  HubOptions options = Strict();
  options.max_clients = 4;
  RunningHub hub(options);
  std::vector<std::unique_ptr<RawClient>> idle;
  for (int i = 0; i < 4; ++i) idle.push_back(std::make_unique<RawClient>(hub));
  std::this_thread::sleep_for(std::chrono::milliseconds(600));  // beyond greeting_s
  auto process = Join(hub, "process");
  Settle(process.get());
  EXPECT_TRUE(idle[0]->IsCutOff());
}

TEST(HostileClient, AllQueuesTogetherAreBounded) {
  HubOptions options = Strict();
  options.total_mb = 5;
  options.patience_s = 20;
  RunningHub hub(options);
  auto sender = Join(hub, "sender");
  std::vector<std::unique_ptr<RawClient>> readers;
  for (int i = 0; i < 6; ++i) {
    readers.push_back(std::make_unique<RawClient>(hub));
    readers.back()->Send(TcpqSubscribe("MAP_DELTA"));
  }
  Settle(sender.get());
  SecondsToPublish(sender.get(), 10);
  hub.Stop();
  EXPECT_GE(hub.counters().clients_cut_off, 3);
}

TEST(HostileClient, EmptyMessagesAreCountedWithTheirOverhead) {
  const QueueLimits limits{kMegabyte};
  MessageQueue queue(limits);
  ChannelPolicies policies;
  const RoutedMessage empty = RouteMessage(TcpqPublish("ANY", {}), &policies);
  int queued = 0;
  while (queue.Add(empty, false) == MessageQueue::Added::kQueued && queued < 1'000'000) ++queued;
  EXPECT_LT(queued, 5000);
  EXPECT_LE(queue.bytes(), limits.max_bytes);
}

TEST(HostileClient, WithoutDescriptorsTheHubWaitsInsteadOfSpinning) {
  RunningHub hub(Strict());
  auto sender = Join(hub, "sender");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  Socket client(socket(AF_INET, SOCK_STREAM, 0));
  const rlimit none{static_cast<rlim_t>(client.fd()) + 1, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(hub.port());
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(connect(client.fd(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  timespec start{}, end{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &start);
  std::this_thread::sleep_for(std::chrono::milliseconds(800));
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
  setrlimit(RLIMIT_NOFILE, &before);
  const double cpu = static_cast<double>(end.tv_sec - start.tv_sec) +
                     static_cast<double>(end.tv_nsec - start.tv_nsec) * 1e-9;
  EXPECT_LT(cpu, 0.4);
  EXPECT_TRUE(sender->Publish(kMapDeltaChannel, Delta(1, 10)));
  Settle(sender.get());
}

}  // namespace
}  // namespace vismap
