#include "runtime/sending_thread.h"

#include <chrono>
#include <exception>
#include <utility>

#include "runtime/clock.h"
#include "runtime/log.h"

namespace vismap {

namespace {
constexpr double kSendAtEnd = 5;  // [s]
}  // namespace

SendingThread::SendingThread(Send send, size_t most_bytes)
    : send_(std::move(send)), most_bytes_(most_bytes), thread_([this] { Run(); }) {}

SendingThread::~SendingThread() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    send_until_ = MonotonicSeconds() + kSendAtEnd;
  }
  changed_.notify_all();
  thread_.join();
}

void SendingThread::Add(const Channel& channel, size_t bytes, Encode encode) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({channel, bytes, std::move(encode)});
    waiting_bytes_ += bytes;
  }
  changed_.notify_all();
}

bool SendingThread::WaitForRoom(double seconds) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                           [this] { return waiting_bytes_ < most_bytes_; });
}

bool SendingThread::WaitUntilSent(double seconds) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                           [this] { return waiting_bytes_ == 0; });
}

std::map<std::string, SendingThread::Totals> SendingThread::TakeTotals() {
  const std::lock_guard lock(mutex_);
  return std::exchange(totals_, {});
}

void SendingThread::Run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    Message message = std::move(waiting_.front());
    waiting_.pop_front();
    const bool late = ends_ && MonotonicSeconds() > send_until_;
    lock.unlock();
    Totals sent;
    if (late || !SendOne(&message, &sent)) sent.unsent = 1;
    message.encode = nullptr;  // what it holds may be large
    lock.lock();
    waiting_bytes_ -= message.bytes;
    Totals& totals = totals_[message.channel.name];
    totals.sent += sent.sent;
    totals.sent_bytes += sent.sent_bytes;
    totals.unsent += sent.unsent;
    changed_.notify_all();
  }
}

bool SendingThread::SendOne(Message* message, Totals* totals) {
  try {
    const RawBytes bytes = message->encode();
    if (!send_(message->channel, bytes)) return false;
    totals->sent = 1;
    totals->sent_bytes = static_cast<int64_t>(bytes.size());
    return true;
  } catch (const std::exception& error) {
    LogWarningRateLimited(
        std::string("sending ") + message->channel.name,
        std::string(message->channel.name) + ": a message was not sent: " + error.what());
    return false;
  }
}

}  // namespace vismap
