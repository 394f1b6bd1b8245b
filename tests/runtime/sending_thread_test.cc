#include "runtime/sending_thread.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace vismap {
namespace {

constexpr Channel kA{"A", 1000}, kB{"B", 1000};

/// What a SendingThread has sent; sending waits while `held`.
struct Recorder {
  bool Send(const Channel& channel, const RawBytes& bytes) {
    while (held) std::this_thread::yield();
    const std::lock_guard lock(mutex);
    sender = std::this_thread::get_id();
    sent.push_back(channel.name + std::to_string(bytes.size()));
    return bytes.size() != 13;
  }
  std::vector<std::string> Sent() {
    const std::lock_guard lock(mutex);
    return sent;
  }

  std::atomic<bool> held = false;
  std::mutex mutex;
  std::thread::id sender;
  std::vector<std::string> sent;
};

class Sending : public ::testing::Test {
 protected:
  void Add(const Channel& channel, size_t bytes) {
    thread_->Add(channel, bytes, [bytes] { return RawBytes(bytes); });
  }

  Recorder recorder_;
  std::unique_ptr<SendingThread> thread_ = std::make_unique<SendingThread>(
      [this](const Channel& channel, const RawBytes& bytes) {
        return recorder_.Send(channel, bytes);
      },
      100);
};

TEST_F(Sending, SendsInOrderInAnotherThreadAndCounts) {
  Add(kA, 1);
  Add(kB, 13);
  Add(kA, 3);
  thread_->Add(kB, 5, []() -> RawBytes { throw std::runtime_error("a bug"); });
  Add(kB, 2);
  EXPECT_TRUE(thread_->WaitUntilSent(10));
  EXPECT_EQ(recorder_.Sent(), (std::vector<std::string>{"A1", "B13", "A3", "B2"}));
  EXPECT_NE(recorder_.sender, std::this_thread::get_id());
  const auto totals = thread_->TakeTotals();
  EXPECT_EQ(totals.at("A").sent, 2);
  EXPECT_EQ(totals.at("A").sent_bytes, 4);
  EXPECT_EQ(totals.at("B").sent, 1);
  EXPECT_EQ(totals.at("B").unsent, 2);
  EXPECT_TRUE(thread_->TakeTotals().empty()) << "the totals since the last call";
}

TEST_F(Sending, HasNoRoomWhileManyBytesWait) {
  recorder_.held = true;
  Add(kA, 60);
  EXPECT_TRUE(thread_->WaitForRoom(0));
  Add(kA, 60);
  EXPECT_FALSE(thread_->WaitForRoom(0.05)) << "what is being sent counts, too";
  EXPECT_FALSE(thread_->WaitUntilSent(0));
  recorder_.held = false;
  EXPECT_TRUE(thread_->WaitForRoom(10));
}

TEST_F(Sending, TheDestructorSendsWhatWaits) {
  recorder_.held = true;
  for (size_t i = 1; i <= 5; ++i) Add(kA, i);
  std::thread later([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    recorder_.held = false;
  });
  thread_.reset();
  later.join();
  EXPECT_EQ(recorder_.Sent(), (std::vector<std::string>{"A1", "A2", "A3", "A4", "A5"}));
}

}  // namespace
}  // namespace vismap
