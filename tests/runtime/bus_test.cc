#include "runtime/bus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <vector>
#include <vismap/map_delta_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/process_status_t.hpp>

#include "runtime/clock.h"
#include "runtime/peers.h"
#include "runtime/status.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

std::unique_ptr<Bus> MemoryBus(const StopSignal* stop = nullptr) {
  auto bus = Bus::Open({"memq://", "tester", 1, stop});
  EXPECT_TRUE(bus) << bus.error().message;
  return std::move(*bus);
}

map_request_t Request(int64_t id) {
  map_request_t request{};
  request.request_id = id;
  return request;
}

/// Handles all waiting messages.
void Drain(Bus* bus) {
  while (bus->Spin(0.01)) {
  }
}

TEST(Bus, DeliversPublishedMessages) {
  auto bus = MemoryBus();
  std::vector<int64_t> ids, seqs;
  bus->Subscribe<map_request_t>(kMapRequestChannel, [&](const map_request_t& request) {
    ids.push_back(request.request_id);
    seqs.push_back(request.seq);
    EXPECT_EQ(request.source, "tester");
  });
  for (const int64_t id : {5, 6, 7}) EXPECT_TRUE(bus->Publish(kMapRequestChannel, Request(id)));
  Drain(bus.get());
  EXPECT_EQ(ids, (std::vector<int64_t>{5, 6, 7}));
  EXPECT_EQ(seqs, (std::vector<int64_t>{0, 1, 2}));
  EXPECT_EQ(bus->counters().at("MAP_REQUEST").received, 3);
  EXPECT_EQ(bus->counters().at("MAP_REQUEST").published, 3);
}

TEST(Bus, AllSubscribersOfAChannelReceiveAMessage) {
  auto bus = MemoryBus();
  int a = 0, b = 0;
  bus->Subscribe<map_request_t>(kMapRequestChannel, [&](const map_request_t&) { ++a; });
  bus->Subscribe<map_request_t>(kMapRequestChannel, [&](const map_request_t&) { ++b; });
  bus->Publish(kMapRequestChannel, Request(1));
  Drain(bus.get());
  EXPECT_EQ(a, 1);
  EXPECT_EQ(b, 1);
  EXPECT_EQ(bus->counters().at("MAP_REQUEST").received, 1);
}

TEST(Bus, RejectedAndForeignMessagesAreCounted) {
  auto bus = MemoryBus();
  int good = 0;
  bus->Subscribe<map_request_t>(kMapRequestChannel,
                                [&](const map_request_t& request) -> Result<void> {
                                  if (request.request_id < 0) return Fail("a negative request_id");
                                  ++good;
                                  return {};
                                });
  bus->Publish(kMapRequestChannel, Request(-1));
  bus->Publish(kMapRequestChannel, process_status_t{});  // another type on this channel
  bus->Publish(kMapRequestChannel, Request(1));
  Drain(bus.get());
  EXPECT_EQ(good, 1);
  EXPECT_EQ(bus->counters().at("MAP_REQUEST").rejected, 2);
}

TEST(Bus, TooLargeMessagesAreNotSent) {
  auto bus = MemoryBus();
  map_request_t request = Request(1);
  request.argument.assign(kMapRequestChannel.max_bytes, 'x');
  EXPECT_FALSE(bus->Publish(kMapRequestChannel, request));
  EXPECT_EQ(bus->counters().at("MAP_REQUEST").unsent, 1);
}

TEST(Bus, AThreadOfItsOwnSendsInOrderAndItsMessagesAreCounted) {
  auto bus = MemoryBus();
  std::vector<int64_t> ids, seqs;
  bus->Subscribe<map_request_t>(kMapRequestChannel, [&](const map_request_t& request) {
    ids.push_back(request.request_id);
    seqs.push_back(request.seq);
  });
  EXPECT_TRUE(bus->Publish(kMapRequestChannel, Request(5)));
  bus->SendByThread();
  for (const int64_t id : {6, 7}) EXPECT_TRUE(bus->Publish(kMapRequestChannel, Request(id)));
  map_request_t large = Request(8);
  large.argument.assign(kMapRequestChannel.max_bytes, 'x');
  bus->Publish(kMapRequestChannel, large);
  EXPECT_TRUE(bus->Publish(kMapRequestChannel, Request(9)));
  EXPECT_TRUE(bus->WaitUntilSent(10));
  Drain(bus.get());
  EXPECT_EQ(ids, (std::vector<int64_t>{5, 6, 7, 9}));
  EXPECT_EQ(seqs, (std::vector<int64_t>{0, 1, 2, 4}));
  EXPECT_EQ(bus->counters().at("MAP_REQUEST").published, 4);
  EXPECT_EQ(bus->counters().at("MAP_REQUEST").unsent, 1);
  EXPECT_EQ(bus->connections(), 1) << "without a hub it needs no other connection";
}

TEST(Bus, MissingSequenceNumbersAreCountedPerSource) {
  auto bus = MemoryBus();
  const Channel raw{"STATUS", 1 << 16};
  bus->Subscribe<map_request_t>(raw, [](const map_request_t&) {});
  const auto numbers_lost = [&](const std::vector<int64_t>& seqs, const std::string& source) {
    const int64_t before = bus->counters().at("STATUS").lost;
    for (const int64_t seq : seqs) {
      map_request_t request = Request(seq);
      request.seq = seq;
      request.source = source;
      bus->PublishAsIs(raw, request);
    }
    Drain(bus.get());
    return bus->counters().at("STATUS").lost - before;
  };
  EXPECT_EQ(numbers_lost({0, 1, 2, 3}, "a"), 0);
  EXPECT_EQ(numbers_lost({7}, "a"), 3);
  EXPECT_EQ(numbers_lost({100, 101}, "b"), 0) << "the first number of a source is no loss";
  EXPECT_EQ(numbers_lost({0, 1}, "a"), 0) << "a was restarted";
  EXPECT_EQ(numbers_lost({3, 103}, "a"), 1 + 99);
  EXPECT_EQ(numbers_lost({-5, INT64_MAX, INT64_MIN}, "c"), 0) << "impossible numbers";
}

TEST(Bus, LatestDeliveryHandlesOnlyTheNewestMessage) {
  auto bus = MemoryBus();
  std::vector<int64_t> seen;
  bus->Subscribe<map_request_t>(
      kMapRequestChannel, [&](const map_request_t& request) { seen.push_back(request.request_id); },
      Delivery::kLatest);
  for (int64_t id = 0; id < 10; ++id) bus->Publish(kMapRequestChannel, Request(id));
  Drain(bus.get());
  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(seen.back(), 9);
  EXPECT_LT(seen.size(), 10U);
  EXPECT_EQ(bus->counters().at("MAP_REQUEST").superseded, 10 - static_cast<int64_t>(seen.size()));
  EXPECT_EQ(bus->counters().at("MAP_REQUEST").lost, 0);
}

TEST(Bus, ExceptionOfAHandlerLeavesSpinAndTheBusStillWorks) {
  auto bus = MemoryBus();
  int handled = 0;
  bus->Subscribe<map_request_t>(kMapRequestChannel, [&](const map_request_t& request) {
    if (request.request_id == 1) throw std::logic_error("a bug");
    ++handled;
  });
  bus->Publish(kMapRequestChannel, Request(1));
  bus->Publish(kMapRequestChannel, Request(2));
  EXPECT_THROW(Drain(bus.get()), std::logic_error);
  Drain(bus.get());
  EXPECT_EQ(handled, 1);
}

TEST(Bus, MessageAboveTheLimitOfItsChannelIsNotRead) {
  auto bus = MemoryBus();
  const Channel narrow{"MAP_REQUEST", 1000};
  int handled = 0;
  bus->Subscribe<map_request_t>(narrow, [&](const map_request_t&) { ++handled; });
  map_request_t request = Request(1);
  request.source = "other";
  bus->PublishAsIs(narrow, request);
  request.seq = 500;  // would count as lost messages
  request.path = std::string(2000, 'x');
  bus->PublishAsIs({"MAP_REQUEST", kMegabyte}, request);
  Drain(bus.get());
  EXPECT_EQ(handled, 1);
  EXPECT_EQ(bus->counters().at("MAP_REQUEST").rejected, 1);
  EXPECT_EQ(bus->counters().at("MAP_REQUEST").lost, 0);
}

TEST(Bus, HandlersMayPublishAndSubscribe) {
  auto bus = MemoryBus();
  int answers = 0;
  bus->Subscribe<map_request_t>(kMapRequestChannel, [&](const map_request_t&) {
    bus->Subscribe<map_delta_t>(kMapDeltaChannel, [&](const map_delta_t&) { ++answers; });
    bus->Publish(kMapDeltaChannel, map_delta_t{});
  });
  bus->Publish(kMapRequestChannel, Request(1));
  Drain(bus.get());
  EXPECT_EQ(answers, 1);
}

TEST(Bus, TimersRunAndStopEndsRun) {
  StopSignal stop;
  auto bus = MemoryBus(&stop);
  int ticks = 0;
  bus->Every(0.01, [&] {
    if (++ticks == 3) stop.Request();
  });
  EXPECT_FALSE(bus->Run());
  EXPECT_EQ(ticks, 3);
}

TEST(Bus, RunEndsWhenFinished) {
  auto bus = MemoryBus();
  EXPECT_TRUE(bus->Run([] { return true; }));
}

TEST(Bus, ErrorWithoutAHubNamesTheCommand) {
  const double start = MonotonicSeconds();
  const auto bus = Bus::Open({"tcpq://127.0.0.1:1", "tester", 0.3, nullptr});
  ASSERT_FALSE(bus);
  EXPECT_THAT(bus.error().message, HasSubstr("vismap-hub --listen 127.0.0.1:1"));
  EXPECT_GE(MonotonicSeconds() - start, 0.3);
}

TEST(Bus, StopEndsTheWaitForAHub) {
  StopSignal stop;
  stop.Request();
  const double start = MonotonicSeconds();
  EXPECT_FALSE(Bus::Open({"tcpq://127.0.0.1:1", "tester", 60, &stop}));
  EXPECT_LT(MonotonicSeconds() - start, 30);
}

TEST(Status, PublishesStateCountersAndTimings) {
  auto bus = MemoryBus();
  std::vector<process_status_t> heard;
  bus->Subscribe<process_status_t>(kStatusChannel,
                                   [&](const process_status_t& s) { heard.push_back(s); });
  Status status(bus.get(), "depth-segmenter");
  status.Count("frames", 3);
  for (const double ms : {1.0, 9.0, 2.0}) status.AddTiming("work", ms);
  status.Set(ProcessState::kWaiting, "waiting for DETECTIONS");
  Drain(bus.get());
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0].process, "depth-segmenter");
  EXPECT_EQ(heard[0].state, "waiting");
  EXPECT_EQ(heard[0].message, "waiting for DETECTIONS");
  const auto& names = heard[0].counter_names;
  const auto frames = std::find(names.begin(), names.end(), "frames");
  ASSERT_NE(frames, names.end());
  EXPECT_EQ(heard[0].counter_values[static_cast<size_t>(frames - names.begin())], 3);
  ASSERT_EQ(heard[0].n_timings, 1);
  EXPECT_EQ(heard[0].median_ms[0], 2.0);
  EXPECT_EQ(heard[0].max_ms[0], 9.0);
}

TEST(Peers, ReadyNeedsAStatusAndAStateAfterStarting) {
  auto bus = MemoryBus();
  Peers peers(bus.get());
  EXPECT_FALSE(peers.IsAlive("map-server"));
  EXPECT_EQ(peers.NotReady({"map-server", "detector"}).size(), 2U);
  Status status(bus.get(), "map-server");
  status.Publish();
  Drain(bus.get());
  EXPECT_TRUE(peers.IsAlive("map-server"));
  EXPECT_FALSE(peers.IsReady("map-server")) << "still starting";
  status.Set(ProcessState::kReady);
  Drain(bus.get());
  EXPECT_TRUE(peers.IsReady("map-server"));
  status.Set(ProcessState::kStopping);
  Drain(bus.get());
  EXPECT_FALSE(peers.IsAlive("map-server"));
}

}  // namespace
}  // namespace vismap
