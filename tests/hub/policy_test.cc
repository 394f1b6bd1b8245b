#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>
#include <vismap/object_list_t.hpp>
#include <vismap/octree_t.hpp>
#include <vismap/process_status_t.hpp>

#include "hub/running_hub.h"

// What happens to messages for a slow reader, by the policy of the channel.

namespace vismap {
namespace {

constexpr int kSmallQueueMb = 2;
constexpr size_t kSmallQueue = kSmallQueueMb * kMegabyte;

HubOptions SmallQueues(const PolicyLists& lists = {}) {
  HubOptions options;
  options.queue_mb = kSmallQueueMb;
  options.socket_buffer_bytes = 16384;
  options.lossless = lists.lossless;
  options.latest = lists.latest;
  options.drop_newest = lists.drop_newest;
  options.critical = {".*"};
  return options;
}

/// Revisions of the deltas that a bus has received, in order.
std::shared_ptr<std::vector<int64_t>> Collect(Bus* bus) {
  auto got = std::make_shared<std::vector<int64_t>>();
  bus->Subscribe<map_delta_t>(kMapDeltaChannel,
                              [got](const map_delta_t& d) { got->push_back(d.revision); });
  return got;
}

TEST(LosslessChannel, PublisherWaitsForASlowReaderAndNothingIsLost) {
  RunningHub hub(SmallQueues({{"MAP_DELTA"}, {}, {}}));
  auto sender = Join(hub, "sender"), slow = Join(hub, "slow");
  const auto got = Collect(slow.get());
  Introduce(slow.get());
  Settle(slow.get());
  std::atomic<int> sent{0};
  std::thread sending([&] {
    for (int i = 0; i < 100; ++i) {
      EXPECT_TRUE(sender->Publish(kMapDeltaChannel, Delta(i, kMegabyte)));
      ++sent;
    }
  });
  // No client reads: the hub accepts what its queue holds, and what it reads in one round.
  double still_since = MonotonicSeconds();
  for (int seen = -1; MonotonicSeconds() - still_since < 0.3;) {
    if (seen != sent) still_since = MonotonicSeconds();
    seen = sent;
    std::this_thread::yield();
  }
  EXPECT_LT(sent, 20);
  EXPECT_TRUE(SpinUntil(slow.get(), [&] { return got->size() == 100U; }));
  sending.join();
  EXPECT_TRUE(std::is_sorted(got->begin(), got->end()));
  hub.Stop();
  EXPECT_EQ(hub.counters().dropped, 0);
  EXPECT_GT(hub.counters().held_back, 0);
}

TEST(LosslessChannel, StalledReaderIsDisconnectedWhileOthersContinue) {
  HubOptions options = SmallQueues({{"MAP_DELTA"}, {}, {}});
  options.patience_s = 2;  // longer than a busy computer keeps the other reader waiting
  RunningHub hub(options);
  auto sender = Join(hub, "sender"), hung = Join(hub, "hung"), reader = Join(hub, "reader");
  const auto got = Collect(reader.get()), never = Collect(hung.get());
  Introduce(hung.get());
  Introduce(reader.get());
  Settle(reader.get());
  Settle(hung.get());
  std::thread sending([&] {
    for (int i = 0; i < 40; ++i) {
      EXPECT_TRUE(sender->Publish(kMapDeltaChannel, Delta(i, kMegabyte)));
    }
  });
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return got->size() == 40U; }));
  sending.join();
  hub.Stop();
  EXPECT_EQ(hub.counters().clients_cut_off, 1);
  EXPECT_EQ(hub.counters().dropped, 0);
}

TEST(LosslessChannel, ClientDoesNotWaitForItself) {
  RunningHub hub(SmallQueues({{"MAP_DELTA"}, {}, {}}));
  auto alone = Join(hub, "alone");
  const auto got = Collect(alone.get());
  Settle(alone.get());
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(alone->Publish(kMapDeltaChannel, Delta(i, kMegabyte)));
  }
  EXPECT_TRUE(SpinUntil(alone.get(), [&] { return !got->empty(); }));
  Settle(alone.get());
  hub.Stop();
  EXPECT_EQ(hub.counters().held_back, 0);
}

/// Two clients send each other more than the queues hold before either reads. No policy may block
/// both forever.
TEST(LosslessChannel, TwoClientsThatFloodEachOtherBothFinish) {
  RunningHub hub(SmallQueues({{"MAP_DELTA", "OBJECTS"}, {}, {}}));
  auto a = Join(hub, "a"), b = Join(hub, "b");
  const auto by_b = Collect(b.get());
  int by_a = 0;
  a->Subscribe<object_list_t>(kObjectsChannel, [&](const object_list_t&) { ++by_a; });
  Introduce(a.get());
  Introduce(b.get());
  Settle(a.get());
  Settle(b.get());
  constexpr int kMessages = 40;
  std::thread other([&] {
    object_list_t objects{};
    objects.map_id = std::string(kMegabyte, 'x');
    for (int i = 0; i < kMessages; ++i) EXPECT_TRUE(b->Publish(kObjectsChannel, objects));
    EXPECT_TRUE(SpinUntil(b.get(), [&] { return by_b->size() == size_t{kMessages}; }));
  });
  for (int i = 0; i < kMessages; ++i) {
    EXPECT_TRUE(a->Publish(kMapDeltaChannel, Delta(i, kMegabyte)));
  }
  EXPECT_TRUE(SpinUntil(a.get(), [&] { return by_a == kMessages; }));
  other.join();
  hub.Stop();
  EXPECT_EQ(hub.counters().dropped, 0);
}

TEST(LatestChannel, SlowReaderReceivesTheNewestMessageOfEverySource) {
  RunningHub hub(SmallQueues());
  auto a = Join(hub, "a"), b = Join(hub, "b"), slow = Join(hub, "slow");
  std::map<std::string, std::vector<int64_t>> got;
  slow->Subscribe<octree_t>(kOctomapChannel,
                            [&](const octree_t& m) { got[m.source].push_back(m.revision); });
  Settle(slow.get());
  const auto send = [](Bus* bus, int64_t revision) {
    octree_t message{};
    message.revision = revision;
    message.data.assign(kMegabyte / 4, 1);
    message.data_size = static_cast<int32_t>(message.data.size());
    EXPECT_TRUE(bus->Publish(kOctomapChannel, message));
  };
  for (int i = 0; i < 100; ++i) {
    send(a.get(), i);
    if (i < 50) send(b.get(), i);
  }
  Settle(a.get());  // the hub has handled all messages of both
  Settle(b.get());
  EXPECT_TRUE(SpinUntil(slow.get(), [&] {
    return !got["a"].empty() && got["a"].back() == 99 && !got["b"].empty() && got["b"].back() == 49;
  }));
  EXPECT_LT(got["a"].size(), 20U);
  EXPECT_TRUE(std::is_sorted(got["a"].begin(), got["a"].end()));
  hub.Stop();
  EXPECT_GT(hub.counters().replaced, 100);
  EXPECT_EQ(hub.counters().replaced_by_channel.of("OCTOMAP"), hub.counters().replaced);
  EXPECT_EQ(hub.counters().dropped, 0);
}

TEST(DropNewestChannel, StatusCountsDroppedMessagesByChannelAndClient) {
  RunningHub hub(SmallQueues());
  auto sender = Join(hub, "sender"), slow = Join(hub, "slow"), reader = Join(hub, "reader");
  const auto got = Collect(slow.get());
  Introduce(slow.get());
  Settle(slow.get());
  std::map<std::string, int64_t> counters;
  reader->Subscribe<process_status_t>(kStatusChannel, [&](const process_status_t& status) {
    if (status.process != "hub") return;
    for (size_t i = 0; i < status.counter_names.size(); ++i) {
      const std::string& name = status.counter_names[i];
      counters[name.substr(0, name.find(" ("))] = status.counter_values[i];
    }
  });
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(sender->Publish(kMapDeltaChannel, Delta(i, kMegabyte)));
  }
  EXPECT_TRUE(SpinUntil(reader.get(), [&] { return counters["MAP_DELTA.dropped"] > 10; }));
  EXPECT_EQ(counters["slow"], counters["MAP_DELTA.dropped"]);
  EXPECT_EQ(counters["held_back"], 0);
}

TEST(FewPerSenderChannel, ManyRequestsOfOneClientDoNotDelayThoseOfAnother) {
  RunningHub hub(SmallQueues());
  auto flood = Join(hub, "flood"), other = Join(hub, "other"), slow = Join(hub, "slow");
  std::map<std::string, std::vector<int64_t>> got;
  slow->Subscribe<map_request_t>(kMapRequestChannel, [&](const map_request_t& request) {
    got[request.source].push_back(request.request_id);
  });
  Introduce(slow.get());
  Settle(slow.get());
  const auto send = [](Bus* bus, int64_t id) {
    map_request_t request{};
    request.request_id = id;
    request.verb = std::string(1000, 'v');
    EXPECT_TRUE(bus->Publish(kMapRequestChannel, request));
  };
  for (int i = 0; i < 20'000; ++i) send(flood.get(), i);
  Settle(flood.get());
  send(other.get(), 7);
  Settle(other.get());
  EXPECT_TRUE(SpinUntil(slow.get(), [&] { return !got["other"].empty(); }));
  hub.Stop();
  // Besides those in the queue of the hub, some wait in the buffers of the connection.
  EXPECT_LT(got["flood"].size(), 2000U);
  EXPECT_GE(got["flood"].size(), static_cast<size_t>(MessageQueue::kMostOfSender));
  EXPECT_TRUE(std::is_sorted(got["flood"].begin(), got["flood"].end()));
  EXPECT_EQ(got["other"].front(), 7);
  EXPECT_EQ(hub.counters().held_back, 0) << "the client that sends too many need not wait";
  EXPECT_GT(hub.counters().dropped_by_channel.of("MAP_REQUEST"), 10'000);
}

TEST(ChannelPolicies, ConfiguredListsOverrideTheDefaults) {
  auto policies = ChannelPolicies::Make({{"MY_.*"}, {"RGBD_FRAME"}, {"STATUS", "MY_LOG"}});
  ASSERT_TRUE(policies);
  EXPECT_EQ(policies->Of("MY_LOG"), QueuePolicy::kLossless);
  EXPECT_EQ(policies->Of("RGBD_FRAME"), QueuePolicy::kLatest);
  EXPECT_EQ(policies->Of("STATUS"), QueuePolicy::kDropNewest);
  EXPECT_EQ(policies->Of("DETECTIONS"), QueuePolicy::kLossless);
  EXPECT_EQ(policies->Of("OBJECTS"), QueuePolicy::kLatest);
  EXPECT_EQ(policies->Of("MAP_REQUEST"), QueuePolicy::kFewPerSender);
  EXPECT_EQ(policies->Of("MAP_REPLY"), QueuePolicy::kLossless);
  EXPECT_EQ(policies->Of("MAP_DELTA"), QueuePolicy::kDropNewest);
  EXPECT_EQ(policies->Of("vismap/DETECTIONS"), QueuePolicy::kLossless);
  EXPECT_EQ(policies->Of("vismap/RGBD_FRAME"), QueuePolicy::kLatest);
  EXPECT_EQ(policies->Of("ROBOT_DETECTIONS"), QueuePolicy::kDropNewest) << "of other programs";
  auto prefixed = ChannelPolicies::Make({{}, {}, {}, "ROBOT_"});
  ASSERT_TRUE(prefixed);
  EXPECT_EQ(prefixed->Of("ROBOT_DETECTIONS"), QueuePolicy::kLossless);
  EXPECT_EQ(prefixed->Of("DETECTIONS"), QueuePolicy::kLossless);
  const auto broken = ChannelPolicies::Make({{"("}, {}, {}});
  ASSERT_FALSE(broken);
  EXPECT_THAT(broken.error().message, ::testing::HasSubstr("("));
}

}  // namespace
}  // namespace vismap
