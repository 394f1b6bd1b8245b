#include "requests/request_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <vismap/process_status_t.hpp>

#include "runtime/clock.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

/// A server of two verbs on a bus of its own, and the replies that it sends.
class Requests : public ::testing::Test {
 protected:
  Requests() {
    bus_->Subscribe<map_reply_t>(kMapReplyChannel,
                                 [this](const map_reply_t& reply) { replies_.push_back(reply); });
    server_.Handle("count", [this](const map_request_t& request) -> Result<Answer> {
      position_.revision = ++carried_out_;
      return Answer{"counted " + request.argument, "json", std::vector<uint8_t>(payload_, 7)};
    });
    server_.HandleLate("wait", [this](const map_request_t&, const RequestServer::Reply& reply) {
      waiting_.push_back(reply);
    });
    server_.Handle("break", [](const map_request_t&) -> Result<Answer> {
      return Fail("it cannot be broken");
    });
  }

  static std::unique_ptr<Bus> MemoryBus() { return std::move(*Bus::Open({"memq://", "test"})); }

  static map_request_t Request(int64_t id, const std::string& verb) {
    map_request_t request{};
    request.request_id = id;
    request.verb = verb;
    return request;
  }

  void Send(const map_request_t& request) {
    bus_->Publish(kMapRequestChannel, request);
    Settle();
  }
  /// Handles all messages and lets the requests that wait have their turns.
  void Settle() {
    const double deadline = MonotonicSeconds() + 10;
    do {
      while (bus_->Spin(0.001)) {
      }
    } while (status_.counter("requests_waiting") > 0 && MonotonicSeconds() < deadline);
    while (bus_->Spin(0.001)) {
    }
  }

  std::unique_ptr<Bus> bus_ = MemoryBus();
  Status status_{bus_.get(), "server"};
  FollowerPosition position_{"map", 0};
  RequestServer server_{RequestReceiver::kMapServer, [this] { return position_; }, bus_.get(),
                        &status_};
  std::vector<RequestServer::Reply> waiting_;
  size_t payload_ = 3;
  int64_t carried_out_ = 0;
  std::vector<map_reply_t> replies_;
};

TEST_F(Requests, ALateAnswerDoesNotKeepOthersWaitingAndComesOnce) {
  Send(Request(1, "wait"));
  Send(Request(1, "wait"));
  ASSERT_EQ(waiting_.size(), 1u) << "the repetition begins nothing";
  Send(Request(2, "count"));
  ASSERT_EQ(replies_.size(), 1u);
  EXPECT_EQ(replies_.back().request_id, 2);
  waiting_[0](Answer{"at last"});
  waiting_[0](Answer{"again"});
  Settle();
  ASSERT_EQ(replies_.size(), 2u);
  EXPECT_EQ(replies_.back().request_id, 1);
  EXPECT_EQ(replies_.back().message, "at last");
  Send(Request(1, "wait"));
  EXPECT_EQ(waiting_.size(), 1u);
  EXPECT_EQ(replies_.back().message, "at last") << "a repetition gets the same answer";
}

TEST_F(Requests, LateAnswersStateTheMapThatWasLookedAtAlsoWhenTheyFail) {
  Send(Request(1, "wait"));
  Send(Request(2, "wait"));
  const FollowerPosition looked_at = position_;
  position_ = {"map", 100};
  for (size_t i = 0; i < 2; ++i) {
    LateAnswer late = i == 0 ? Result<Answer>(Answer{"seen"}) : Fail("nothing there");
    late.position = looked_at;
    waiting_[i](late);
  }
  Settle();
  ASSERT_EQ(replies_.size(), 2u);
  EXPECT_TRUE(replies_[0].ok);
  EXPECT_FALSE(replies_[1].ok);
  for (const map_reply_t& reply : replies_) EXPECT_EQ(reply.revision, looked_at.revision);
}

TEST_F(Requests, EqualOnesThatAreJoinedAreCarriedOutOnce) {
  server_.SetMostBegun(1);
  server_.JoinEqual([](const map_request_t& request) { return request.argument == "gap"; });
  const auto send = [&](int64_t id, const std::string& argument, const std::string& source) {
    map_request_t request = Request(id, "wait");
    request.argument = argument;
    request.source = source;
    bus_->PublishAsIs(kMapRequestChannel, request);
    for (int i = 0; i < 20; ++i) bus_->Spin(0.002);
  };
  send(1, "gap", "a");
  send(2, "gap", "a");
  send(2, "gap", "a");
  send(3, "gap", "b");
  send(4, "other", "a");
  send(5, "gap", "b");
  EXPECT_EQ(status_.counter("requests_waiting"), 3);
  ASSERT_EQ(waiting_.size(), 1u);
  waiting_[0](Answer{"sent"});
  for (int i = 0; i < 50; ++i) bus_->Spin(0.002);
  ASSERT_EQ(replies_.size(), 2u);
  EXPECT_EQ(replies_[0].request_id + replies_[1].request_id, 3) << "1 and 2, each once";
  for (size_t next = 1; next < 3; ++next) {
    ASSERT_EQ(waiting_.size(), next + 1);
    waiting_[next](Answer{"sent"});
    for (int i = 0; i < 300 && waiting_.size() == next + 1; ++i) bus_->Spin(0.002);
  }
  ASSERT_EQ(replies_.size(), 5u);
  EXPECT_EQ(waiting_.size(), 3u) << "3 and 5 together, and 4";
  send(6, "gap", "a");
  EXPECT_EQ(waiting_.size(), 4u) << "after the answer it is a new question";
}

TEST_F(Requests, WaitWhileAsManyHaveBegunAsMay) {
  server_.SetMostBegun(1);
  Send(Request(1, "wait"));
  const auto send = [&](const map_request_t& request) {
    bus_->Publish(kMapRequestChannel, request);
    for (int i = 0; i < 50; ++i) bus_->Spin(0.002);
  };
  send(Request(1, "wait"));
  EXPECT_EQ(status_.counter("requests_waiting"), 0) << "a repetition of what has begun";
  send(Request(2, "count"));
  send(Request(3, "wait"));
  EXPECT_EQ(status_.counter("requests_waiting"), 2);
  EXPECT_EQ(replies_.size(), 0u);
  waiting_[0](Answer{"at last"});
  Settle();
  ASSERT_EQ(replies_.size(), 2u);
  EXPECT_EQ(replies_[1].request_id, 2);
  EXPECT_EQ(waiting_.size(), 2u);
}

TEST_F(Requests, AreCarriedOutAndAnswered) {
  map_request_t request = Request(17, "count");
  request.argument = "sheep";
  Send(request);
  ASSERT_EQ(replies_.size(), 1u);
  const map_reply_t& reply = replies_[0];
  EXPECT_TRUE(reply.ok);
  EXPECT_EQ(reply.requester, "test");
  EXPECT_EQ(reply.request_id, 17);
  EXPECT_EQ(reply.message, "counted sheep");
  EXPECT_EQ(reply.encoding, "json");
  EXPECT_EQ(reply.payload, std::vector<uint8_t>(3, 7));
  EXPECT_EQ(reply.map_id, "map");
  EXPECT_EQ(reply.revision, 1) << "the revision after the request";
  EXPECT_EQ(status_.counter("requests_done"), 1);
}

TEST_F(Requests, ThatCannotBeCarriedOutAreRefusedWithTheReason) {
  Send(Request(1, "break"));
  Send(Request(2, "fly"));
  ASSERT_EQ(replies_.size(), 2u);
  EXPECT_FALSE(replies_[0].ok);
  EXPECT_EQ(replies_[0].message, "it cannot be broken");
  EXPECT_EQ(replies_[0].payload_size, 0);
  EXPECT_FALSE(replies_[1].ok);
  EXPECT_EQ(replies_[1].message, "unknown request 'fly'; known are break, count, wait");
  EXPECT_EQ(status_.counter("requests_refused"), 2);
}

TEST_F(Requests, ThatComeAgainGetTheirFirstReplyAgain) {
  Send(Request(1, "count"));
  Send(Request(1, "count"));
  ASSERT_EQ(replies_.size(), 2u);
  EXPECT_EQ(carried_out_, 1);
  EXPECT_EQ(replies_[1].revision, replies_[0].revision);
  EXPECT_EQ(replies_[1].payload, replies_[0].payload);
  Send(Request(2, "count"));
  EXPECT_EQ(carried_out_, 2);
  for (int64_t id = 3; id < 1020; ++id) Send(Request(id, "count"));
  Send(Request(1019, "count"));
  EXPECT_EQ(carried_out_, 1019);
  Send(Request(1, "count"));
  EXPECT_EQ(carried_out_, 1020) << "only so many replies are remembered";
}

TEST_F(Requests, OfOtherSourcesMayHaveTheSameId) {
  for (const char* source : {"viewer", "planner"}) {
    map_request_t request = Request(1, "count");
    request.source = source;
    bus_->PublishAsIs(kMapRequestChannel, request);
  }
  Settle();
  EXPECT_EQ(carried_out_, 2);
}

TEST_F(Requests, WithAVeryLargeReplyAreCarriedOutAgain) {
  payload_ = 2 * kMegabyte;
  Send(Request(1, "count"));
  Send(Request(1, "count"));
  EXPECT_EQ(carried_out_, 2);
}

TEST_F(Requests, AreAnsweredInPrintableTextOfBoundedLength) {
  Send(Request(1, std::string(60000, '\n') + "fly"));
  ASSERT_EQ(replies_.size(), 1u);
  EXPECT_LT(replies_[0].message.size(), 200u);
  EXPECT_EQ(replies_[0].message.find('\n'), std::string::npos);
  map_request_t request = Request(2, "fly");
  request.source = std::string(60000, 'x');
  bus_->PublishAsIs(kMapRequestChannel, request);
  Settle();
  EXPECT_EQ(replies_.size(), 1u) << "and only to sources with a name of usual length";
  EXPECT_EQ(bus_->counters().at("MAP_REQUEST").rejected, 1);
}

TEST_F(Requests, TakeAFifthOfTheTimeWhileOtherMessagesCome) {
  double busy = 0;
  server_.Handle("slow", [&](const map_request_t&) -> Result<Answer> {
    const double start = MonotonicSeconds();
    while (MonotonicSeconds() < start + 0.05) {
    }
    busy += MonotonicSeconds() - start;
    return Answer{"done"};
  });
  bus_->Subscribe<process_status_t>(kStatusChannel, [](const process_status_t&) {});
  const double start = MonotonicSeconds();
  for (int64_t id = 1; MonotonicSeconds() < start + 2; ++id) {
    bus_->Publish(kMapRequestChannel, Request(id, "slow"));
    status_.Publish();
    bus_->Spin(0.001);
  }
  EXPECT_GT(busy, 0.2);
  EXPECT_LT(busy, 0.6);
  EXPECT_GT(status_.counter("requests_not_taken"), 0);
  EXPECT_LE(status_.counter("requests_waiting"), 64);
}

TEST(WaitingRequestsTest, SourcesTakeTurns) {
  WaitingRequests waiting;
  const auto add = [&](const std::string& source, int64_t id) {
    map_request_t request{};
    request.source = source;
    request.request_id = id;
    return waiting.Add(request);
  };
  for (int64_t id = 0; id < 8; ++id) EXPECT_TRUE(add("flood", id));
  EXPECT_FALSE(add("flood", 8)) << "there is no room for more of one source";
  EXPECT_TRUE(add("flood", 3)) << "it waits already";
  EXPECT_TRUE(add("viewer", 1));
  EXPECT_EQ(waiting.size(), 9u);
  EXPECT_EQ(waiting.Next()->source, "flood");
  EXPECT_EQ(waiting.Next()->source, "viewer");
  EXPECT_EQ(waiting.Next()->request_id, 1);
  while (waiting.Next()) {
  }
  EXPECT_EQ(waiting.size(), 0u);
  for (int i = 0; i < 64; ++i) EXPECT_TRUE(add("source " + std::to_string(i), 1));
  EXPECT_FALSE(add("one more", 1));
}

TEST_F(Requests, WithAnAnswerThatIsTooLargeToSendAreRefused) {
  payload_ = kMapReplyChannel.max_bytes;
  Send(Request(1, "count"));
  ASSERT_EQ(replies_.size(), 1u);
  EXPECT_FALSE(replies_[0].ok);
  EXPECT_THAT(replies_[0].message, HasSubstr("at most"));
}

TEST_F(Requests, ForOtherMapsAndOtherProgramsAreLeftToThem) {
  map_request_t request = Request(1, "count");
  request.map_id = "another map";
  Send(request);
  Send(Request(2, "octomap"));
  Send(Request(3, "octomap-fly"));
  EXPECT_TRUE(replies_.empty());
  request.map_id = "map";
  Send(request);
  EXPECT_EQ(replies_.size(), 1u);
}

TEST_F(Requests, OneServerPerProgramAnswers) {
  RequestServer exporter(
      RequestReceiver::kOctomapExporter, [] { return FollowerPosition{}; }, bus_.get(), &status_);
  exporter.Handle("octomap", [](const map_request_t&) { return Answer{"exported"}; });
  Send(Request(1, "octomap"));
  Send(Request(2, "octomap-fly"));
  Send(Request(3, "fly"));
  ASSERT_EQ(replies_.size(), 3u);
  EXPECT_EQ(replies_[0].message, "exported");
  EXPECT_THAT(replies_[1].message, HasSubstr("known are octomap"));
  EXPECT_THAT(replies_[2].message, HasSubstr("known are break, count, wait"));
}

}  // namespace
}  // namespace vismap
