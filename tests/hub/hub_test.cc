#include "hub/hub.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>
#include <thread>
#include <vector>
#include <vismap/map_delta_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/process_status_t.hpp>

#include "hub/running_hub.h"
#include "runtime/clock.h"
#include "runtime/tcp_socket.h"

// LCM's own client, which uses GLib, leaks the name of a subscription.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libglib"; }

namespace vismap {
namespace {

TEST(Hub, DeliversInOrderToAllSubscribers) {
  RunningHub hub;
  auto sender = Join(hub, "sender");
  auto reader_a = Join(hub, "a"), reader_b = Join(hub, "b");
  std::vector<int64_t> a, b;
  reader_a->Subscribe<map_delta_t>(kMapDeltaChannel,
                                   [&](const map_delta_t& d) { a.push_back(d.revision); });
  reader_b->Subscribe<map_delta_t>(kMapDeltaChannel,
                                   [&](const map_delta_t& d) { b.push_back(d.revision); });
  Settle(reader_a.get());
  Settle(reader_b.get());
  std::vector<int64_t> sent;
  for (int64_t i = 0; i < 200; ++i) {
    ASSERT_TRUE(sender->Publish(kMapDeltaChannel, Delta(i, 100)));
    sent.push_back(i);
  }
  EXPECT_TRUE(SpinUntil(reader_a.get(), [&] { return a.size() == sent.size(); }));
  EXPECT_TRUE(SpinUntil(reader_b.get(), [&] { return b.size() == sent.size(); }));
  EXPECT_EQ(a, sent);
  EXPECT_EQ(b, sent);
  EXPECT_EQ(reader_a->counters().at("MAP_DELTA").lost, 0);
}

void ForwardsLargeMessages(int socket_buffer_bytes) {
  HubOptions options;
  options.socket_buffer_bytes = socket_buffer_bytes;
  RunningHub hub(options);
  auto sender = Join(hub, "sender"), reader = Join(hub, "reader");
  int received = 0;
  reader->Subscribe<map_delta_t>(kMapDeltaChannel, [&](const map_delta_t& d) {
    EXPECT_EQ(d.payload.size(), 5 * kMegabyte);
    ++received;
  });
  Settle(reader.get());
  std::thread sending([&] {
    for (int i = 0; i < 12; ++i)
      EXPECT_TRUE(sender->Publish(kMapDeltaChannel, Delta(i, 5 * kMegabyte)));
  });
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return received == 12; }));
  sending.join();
  EXPECT_EQ(reader->counters().at("MAP_DELTA").rejected, 0);
}

TEST(Hub, ForwardsLargeMessages) { ForwardsLargeMessages(0); }
TEST(Hub, ForwardsLargeMessagesThroughTheSmallestSocketBuffers) { ForwardsLargeMessages(4096); }

TEST(Hub, LateSubscriberReceivesWhatItHasMissedAfterTheStart) {
  HubOptions options;
  options.rejoin_s = 30;
  RunningHub hub(options);
  auto sender = Join(hub, "sender"), reader = Join(hub, "reader");
  for (int64_t i = 0; i < 20; ++i) ASSERT_TRUE(sender->Publish(kMapDeltaChannel, Delta(i, 1000)));
  Settle(sender.get());
  std::vector<int64_t> got;
  reader->Subscribe<map_delta_t>(kMapDeltaChannel,
                                 [&](const map_delta_t& d) { got.push_back(d.revision); });
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return got.size() == 20; }));
  ASSERT_TRUE(sender->Publish(kMapDeltaChannel, Delta(20, 1000)));
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return got.size() == 21; }));
  EXPECT_THAT(got, ::testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16,
                                          17, 18, 19, 20));
  EXPECT_EQ(reader->counters().at("MAP_DELTA").lost, 0);
}

TEST(Hub, LateSubscriberReceivesNothingOldWhenTheTimeIsOver) {
  HubOptions options;
  options.rejoin_s = 0;
  RunningHub hub(options);
  auto sender = Join(hub, "sender"), reader = Join(hub, "reader");
  ASSERT_TRUE(sender->Publish(kMapDeltaChannel, Delta(0, 1000)));
  Settle(sender.get());
  std::vector<int64_t> got;
  reader->Subscribe<map_delta_t>(kMapDeltaChannel,
                                 [&](const map_delta_t& d) { got.push_back(d.revision); });
  Settle(reader.get());
  ASSERT_TRUE(sender->Publish(kMapDeltaChannel, Delta(1, 1000)));
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return !got.empty(); }));
  EXPECT_THAT(got, ::testing::ElementsAre(1));
}

TEST(RejoinBacklog, IsBoundedInBytesAndKeepsTheNewestOfLatestChannels) {
  RejoinBacklog backlog(0, 10, 3 * (1000 + MessageQueue::kEntryBytes));
  const auto message = [](const std::string& channel, QueuePolicy policy, uint8_t value) {
    RawBytes bytes;
    bytes.append(std::vector<uint8_t>(1000, value));
    return RoutedMessage{channel, std::make_shared<const RawBytes>(std::move(bytes)), policy, "a"};
  };
  const auto values = [&] {
    std::vector<int> all;
    backlog.Replay(
        nullptr, [](const std::string&) { return true; },
        [&](const RoutedMessage& m) { all.push_back(m.record->data()[0]); });
    return all;
  };
  const auto sender = std::make_shared<HubClient>(Socket(), "sender", 1000, QueueLimits{1000});
  backlog.Keep(message("OBJECTS", QueuePolicy::kLatest, 1), sender, 1);
  backlog.Keep(message("OBJECTS", QueuePolicy::kLatest, 2), sender, 1);
  EXPECT_THAT(values(), ::testing::ElementsAre(2));
  for (uint8_t i = 3; i < 7; ++i)
    backlog.Keep(message("RGBD_FRAME", QueuePolicy::kLossless, i), sender, 2);
  EXPECT_THAT(values(), ::testing::ElementsAre(4, 5, 6));
  EXPECT_EQ(backlog.dropped(), 2);
  backlog.Keep(message("RGBD_FRAME", QueuePolicy::kLossless, 7), sender, 10);
  EXPECT_THAT(values(), ::testing::ElementsAre(4, 5, 6)) << "the time is over";
  backlog.Expire(10);
  EXPECT_THAT(values(), ::testing::IsEmpty());
  EXPECT_EQ(backlog.bytes(), 0U);
}

TEST(Hub, SlowReaderLosesTheNewestMessages) {
  HubOptions options;
  options.queue_mb = 4;
  options.socket_buffer_bytes = 16384;
  RunningHub hub(options);
  auto sender = Join(hub, "sender"), slow = Join(hub, "slow"), quick = Join(hub, "quick");
  std::vector<int64_t> slow_got;
  int quick_got = 0;
  slow->Subscribe<map_delta_t>(kMapDeltaChannel,
                               [&](const map_delta_t& d) { slow_got.push_back(d.revision); });
  quick->Subscribe<map_delta_t>(kMapDeltaChannel, [&](const map_delta_t&) { ++quick_got; });
  Settle(slow.get());
  Settle(quick.get());
  for (int i = 0; i < 60; ++i) {  // 60 MB, while `slow` does not read at all
    ASSERT_TRUE(sender->Publish(kMapDeltaChannel, Delta(i, kMegabyte)));
    ASSERT_TRUE(SpinUntil(quick.get(), [&] { return quick_got == i + 1; }))
        << "no publisher waits for the slow reader";
  }
  ASSERT_TRUE(SpinUntil(slow.get(), [&] { return !slow_got.empty(); }));
  Settle(slow.get());  // all queued messages arrive before this answer
  ASSERT_TRUE(sender->Publish(kMapDeltaChannel, Delta(60, kMegabyte)));
  ASSERT_TRUE(SpinUntil(slow.get(), [&] { return slow_got.back() == 60; }));
  EXPECT_EQ(slow_got.front(), 0);
  EXPECT_LT(slow_got.size(), 40U);
  EXPECT_TRUE(std::is_sorted(slow_got.begin(), slow_got.end()));
  EXPECT_EQ(slow->counters().at("MAP_DELTA").lost, 61 - static_cast<int64_t>(slow_got.size()));
  hub.Stop();
  EXPECT_EQ(hub.counters().dropped, 61 - static_cast<int64_t>(slow_got.size()));
}

TEST(Hub, ClientsReconnectAfterARestart) {
  auto hub = std::make_unique<RunningHub>();
  const uint16_t port = hub->port();
  auto sender = Join(*hub, "sender"), reader = Join(*hub, "reader");
  int received = 0;
  reader->Subscribe<map_delta_t>(kMapDeltaChannel, [&](const map_delta_t&) { ++received; });
  Settle(reader.get());
  sender->Publish(kMapDeltaChannel, Delta(1, 10));
  ASSERT_TRUE(SpinUntil(reader.get(), [&] { return received == 1; }));
  hub.reset();
  ASSERT_TRUE(SpinUntil(reader.get(), [&] { return !reader->connected(); }));
  ASSERT_TRUE(SpinUntil(sender.get(), [&] { return !sender->connected(); }));
  EXPECT_FALSE(sender->Publish(kMapDeltaChannel, Delta(2, 10)));
  EXPECT_EQ(sender->counters().at("MAP_DELTA").unsent, 1);
  hub = std::make_unique<RunningHub>(HubOptions{}, port);
  ASSERT_TRUE(SpinUntil(reader.get(), [&] { return reader->connected(); }));
  ASSERT_TRUE(SpinUntil(sender.get(), [&] { return sender->connected(); }));
  Settle(reader.get());
  sender->Publish(kMapDeltaChannel, Delta(3, 10));
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return received == 2; }));
  EXPECT_EQ(reader->reconnects(), 1);
  EXPECT_EQ(reader->counters().at("MAP_DELTA").lost, 1)
      << "the message that could not be sent is missing";
}

TEST(Hub, PublishesItsStatus) {
  RunningHub hub;
  auto reader = Join(hub, "reader");
  std::string process;
  reader->Subscribe<process_status_t>(kStatusChannel,
                                      [&](const process_status_t& s) { process = s.process; });
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return process == "hub"; }));
}

/// Numbers of the messages that a hub with these faults forwards, of 200 sent ones.
std::vector<int64_t> ThroughALossyHub(const FaultOptions& faults) {
  RunningHub hub({}, 0, faults);
  auto sender = Join(hub, "sender"), reader = Join(hub, "reader");
  std::vector<int64_t> got;
  reader->Subscribe<map_delta_t>(kMapDeltaChannel,
                                 [&](const map_delta_t& d) { got.push_back(d.revision); });
  Settle(reader.get());
  for (int64_t i = 0; i < 200; ++i) sender->Publish(kMapDeltaChannel, Delta(i, 10));
  Settle(sender.get());  // the hub has handled all of them
  Settle(reader.get());
  hub.Stop();
  EXPECT_EQ(hub.counters().dropped_on_purpose, 200 - static_cast<int64_t>(got.size()));
  return got;
}

TEST(HubWithFaults, LosesTheRequestedShareReproducibly) {
  FaultOptions faults;
  faults.drop_fraction = 0.2;
  faults.channels = {"MAP_DELTA"};
  const std::vector<int64_t> first = ThroughALossyHub(faults);
  EXPECT_NEAR(static_cast<double>(first.size()), 160, 20);
  EXPECT_EQ(ThroughALossyHub(faults), first);
  faults.seed = 1;
  EXPECT_NE(ThroughALossyHub(faults), first);
  faults.channels = {"OBJECTS"};
  EXPECT_EQ(ThroughALossyHub(faults).size(), 200U);
}

TEST(Hub, AddressInUseIsAnError) {
  RunningHub hub;
  HubOptions options;
  options.listen = "127.0.0.1:" + std::to_string(hub.port());
  const auto second = Hub::Open(options);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, ::testing::HasSubstr(std::to_string(hub.port())));
}

// ---- LCM's own client
// --------------------------------------------------------------------------------------------------

struct Collected {
  int count = 0;
  size_t bytes = 0;
  static void Take(const lcm::ReceiveBuffer* buffer, const std::string&, Collected* self) {
    ++self->count;
    self->bytes += buffer->data_size;
  }
};

bool HandleUntil(lcm::LCM* lcm, const Collected& collected, int count) {
  const double deadline = MonotonicSeconds() + kDeadline;
  while (collected.count < count && MonotonicSeconds() < deadline) {
    if (lcm->getFileno() < 0 || lcm->handleTimeout(50) < 0) return false;
  }
  return collected.count >= count;
}

TEST(HubWithStockClient, AnswersAThousandRequestsFast) {
  RunningHub hub;
  std::atomic<bool> done{false};
  std::atomic<bool> subscribed{false};
  std::thread answering([&] {
    lcm::LCM lcm(hub.url());
    struct Answer {
      lcm::LCM* lcm;
      static void Give(const lcm::ReceiveBuffer* buffer, const std::string&, Answer* self) {
        self->lcm->publish("ANSWER", buffer->data, buffer->data_size);
      }
    } answer{&lcm};
    lcm.subscribeFunction("QUESTION", &Answer::Give, &answer);
    subscribed = true;
    while (!done) lcm.handleTimeout(20);
  });
  lcm::LCM lcm(hub.url());
  Collected collected;
  lcm.subscribeFunction("ANSWER", &Collected::Take, &collected);
  while (!subscribed) std::this_thread::yield();
  const char word[] = "word";
  const double deadline = MonotonicSeconds() + kDeadline;
  while (collected.count == 0 &&
         MonotonicSeconds() < deadline) {  // until the subscription of the other client has arrived
    lcm.publish("QUESTION", word, sizeof(word));
    lcm.handleTimeout(100);
  }
  const int before = collected.count;
  const double start = MonotonicSeconds();
  for (int i = 1; i <= 1000; ++i) {
    lcm.publish("QUESTION", word, sizeof(word));
    ASSERT_TRUE(HandleUntil(&lcm, collected, before + i));
  }
  RecordProperty("milliseconds_per_question", std::to_string(MonotonicSeconds() - start));
  EXPECT_LT(MonotonicSeconds() - start, 20)
      << "40 ms per message would mean delayed acknowledgements";
  done = true;
  answering.join();
}

TEST(HubWithStockClient, ForwardsLargeMessagesInBothDirections) {
  RunningHub hub;
  auto bus = Join(hub, "ours");
  lcm::LCM stock(hub.url());
  Collected collected;
  stock.subscribeFunction("MAP_D.*A", &Collected::Take, &collected);  // a real regular expression
  int received = 0;
  bus->Subscribe<map_delta_t>(kMapDeltaChannel, [&](const map_delta_t&) { ++received; });
  map_delta_t delta = Delta(1, 3 * kMegabyte);
  delta.source = "stock";
  const std::vector<uint8_t> bytes = Pack(delta);
  Settle(bus.get());
  std::thread sending([&] {
    for (int i = 0; i < 5; ++i)
      stock.publish("MAP_DELTA", bytes.data(), static_cast<unsigned>(bytes.size()));
  });
  EXPECT_TRUE(SpinUntil(bus.get(), [&] { return received == 5; }));
  sending.join();
  collected = {};
  ASSERT_TRUE(HandleUntil(&stock, collected, 5))
      << "a client receives its own messages, as with udpm";
  ASSERT_TRUE(bus->Publish(kMapDeltaChannel, Delta(2, 3 * kMegabyte)));
  EXPECT_TRUE(HandleUntil(&stock, collected, 6));
  EXPECT_GT(collected.bytes, 6 * 3 * kMegabyte);
}

TEST(HubWithStockClient, SubscriptionsMatchWholeNames) {
  RunningHub hub;
  lcm::LCM stock(hub.url());
  Collected exact, all;
  stock.subscribeFunction("AB", &Collected::Take, &exact);
  for (const char* channel : {"AB", "ABC", "XAB", "AB"}) stock.publish(channel, "x", 1);
  ASSERT_TRUE(HandleUntil(&stock, exact, 2));
  stock.subscribeFunction(".*", &Collected::Take, &all);
  stock.publish("LAST", "x", 1);
  ASSERT_TRUE(HandleUntil(&stock, all, 1));
  EXPECT_EQ(exact.count, 2);
}

// ---- Clients that violate the protocol
// ---------------------------------------------------------------------------

/// Sends `bytes` over a raw connection; returns whether the hub then closes it.
bool IsDisconnected(const RunningHub& hub, const std::vector<uint8_t>& bytes) {
  const Socket socket(::socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(hub.port());
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(connect(socket.fd(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  send(socket.fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  const double deadline = MonotonicSeconds() + kDeadline;
  while (MonotonicSeconds() < deadline) {
    pollfd waiting{socket.fd(), POLLIN, 0};
    if (poll(&waiting, 1, 200) == 0) return false;
    char buffer[4096];
    if (recv(socket.fd(), buffer, sizeof(buffer), 0) <= 0) return true;
  }
  return false;
}

std::vector<uint8_t> operator+(std::vector<uint8_t> a, const std::vector<uint8_t>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(HubWithHostileClient, IsDisconnectedWhileOthersContinue) {
  RunningHub hub;
  auto bus = Join(hub, "honest");
  const std::vector<uint8_t> hello = TcpqHello(TcpqMagic::kClient);
  EXPECT_TRUE(IsDisconnected(hub, {'G', 'E', 'T', ' ', '/', ' ', 'H', 'T'}));
  EXPECT_TRUE(IsDisconnected(hub, hello + std::vector<uint8_t>{0, 0, 0, 9, 0, 0, 0, 1}));
  EXPECT_TRUE(
      IsDisconnected(hub, hello + std::vector<uint8_t>{0, 0, 0, 1, 0xff, 0xff, 0xff, 0xff}));
  EXPECT_TRUE(IsDisconnected(hub, hello + TcpqPublishHead("A", 0xfffffff0)));
  EXPECT_TRUE(IsDisconnected(hub, hello + TcpqSubscribe("(unclosed")));
  EXPECT_FALSE(IsDisconnected(hub, hello + TcpqPublishHead("A", 100 * kMegabyte)))
      << "announced, but never sent";
  EXPECT_FALSE(IsDisconnected(hub, hello + TcpqPublishHead("A", 0)));
  Settle(bus.get());
}

TEST(HubWithHostileClient, ExpensivePatternsDoNotBlockTheHub) {
  RunningHub hub;
  auto bus = Join(hub, "honest");
  const std::vector<uint8_t> hello = TcpqHello(TcpqMagic::kClient);
  const std::string channel(60, 'a');
  EXPECT_FALSE(IsDisconnected(hub, hello + TcpqSubscribe("(a*)*b") + TcpqPublishHead(channel, 0)));
  Settle(bus.get());
}

TEST(HubWithHostileClient, ClientsAboveTheLimitAreRejected) {
  HubOptions options;
  options.max_clients = 1;
  RunningHub hub(options);
  auto bus = Join(hub, "first");
  EXPECT_TRUE(IsDisconnected(hub, TcpqHello(TcpqMagic::kClient)));
  Settle(bus.get());
}

TEST(Hub, UrgentMessagesDoNotWaitBehindOthers) {
  RunningHub hub;
  auto sender = Join(hub, "sender"), reader = Join(hub, "reader");
  int others = 0, others_before_urgent = -1;
  reader->Subscribe<map_delta_t>(kMapDeltaChannel, [&](const map_delta_t&) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ++others;
  });
  reader->Subscribe<map_request_t>(
      kMapRequestChannel, [&](const map_request_t&) { others_before_urgent = others; },
      Delivery::kUrgent);
  EXPECT_EQ(reader->connections(), 2);
  EXPECT_EQ(sender->connections(), 1);
  Introduce(reader.get());
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // the hub has both subscriptions
  for (int i = 0; i < 200; ++i) sender->Publish(kMapDeltaChannel, Delta(i, 1000));
  map_request_t request{};
  sender->Publish(kMapRequestChannel, request);
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return others == 200; }));
  EXPECT_GE(others_before_urgent, 0);
  EXPECT_LT(others_before_urgent, 100);
  sender->Publish(kMapRequestChannel, request);
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return others_before_urgent == 200; }));
}

TEST(Hub, AThreadSendsInOrderOnAConnectionOfItsOwn) {
  RunningHub hub;
  auto sender = Join(hub, "sender"), reader = Join(hub, "reader");
  std::vector<int64_t> got;
  reader->Subscribe<map_delta_t>(kMapDeltaChannel,
                                 [&](const map_delta_t& d) { got.push_back(d.revision); });
  Settle(reader.get());
  sender->SendByThread();
  EXPECT_EQ(sender->connections(), 2);
  std::vector<int64_t> sent;
  for (int64_t i = 0; i < 60; ++i) {
    EXPECT_TRUE(sender->Publish(kMapDeltaChannel, Delta(i, i % 3 == 0 ? 5'000'000 : 100)));
    sent.push_back(i);
  }
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return got.size() >= 30; }));
  sender.reset();  // what waits is sent first
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return got.size() == sent.size(); }));
  EXPECT_EQ(got, sent);
  EXPECT_EQ(reader->counters().at("MAP_DELTA").lost, 0);
}

TEST(Hub, ASendingThreadConnectsAgainAfterARestartAndLosesNothingAfterIt) {
  auto hub = std::make_unique<RunningHub>();
  const uint16_t port = hub->port();
  auto sender = Join(*hub, "sender");
  sender->SendByThread();
  sender->Publish(kMapDeltaChannel, Delta(0, 100));
  EXPECT_TRUE(sender->WaitUntilSent(kDeadline));
  hub.reset();
  SpinUntil(sender.get(), [&] { return !sender->connected(); });
  sender->Publish(kMapDeltaChannel, Delta(1, 100));
  EXPECT_TRUE(sender->WaitUntilSent(kDeadline));
  sender->Spin(0);
  EXPECT_EQ(sender->counters().at("MAP_DELTA").unsent, 1);
  hub = std::make_unique<RunningHub>(HubOptions{}, port);
  auto reader = Join(*hub, "reader");
  std::vector<int64_t> got;
  reader->Subscribe<map_delta_t>(kMapDeltaChannel,
                                 [&](const map_delta_t& d) { got.push_back(d.revision); });
  Settle(reader.get());
  ASSERT_TRUE(SpinUntil(sender.get(), [&] { return sender->connected(); }));
  for (int64_t i = 2; i < 5; ++i) sender->Publish(kMapDeltaChannel, Delta(i, 100));
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return got.size() == 3; }));
  EXPECT_EQ(got, (std::vector<int64_t>{2, 3, 4}));
}

TEST(Hub, UrgentChannelsAreReadAgainAfterARestart) {
  auto hub = std::make_unique<RunningHub>();
  const uint16_t port = hub->port();
  auto reader = Join(*hub, "reader");
  int urgent = 0;
  reader->Subscribe<map_request_t>(
      kMapRequestChannel, [&](const map_request_t&) { ++urgent; }, Delivery::kUrgent);
  hub.reset();
  SpinUntil(reader.get(), [&] { return !reader->connected(); });
  hub = std::make_unique<RunningHub>(HubOptions{}, port);
  ASSERT_TRUE(SpinUntil(reader.get(), [&] { return reader->connected(); }));
  auto sender = Join(*hub, "sender");
  EXPECT_TRUE(SpinUntil(reader.get(), [&] {
    sender->Publish(kMapRequestChannel, map_request_t{});
    return urgent > 0;
  }));
}

}  // namespace
}  // namespace vismap
