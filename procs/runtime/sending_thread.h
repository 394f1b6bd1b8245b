#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "base/raw_bytes.h"
#include "wire/channels.h"

namespace vismap {

/// A thread that encodes and sends messages one after the other, in the order in which they were
/// added, so that a thread that has megabytes to say does not wait until they are sent. All
/// functions may be called by any thread.
class SendingThread {
 public:
  /// Encodes a message. Called once, by this thread.
  using Encode = std::function<RawBytes()>;
  /// Sends an encoded message, by this thread. Returns false when it could not be sent.
  using Send = std::function<bool(const Channel&, const RawBytes&)>;
  /// What became of the messages of a channel.
  struct Totals {
    int64_t sent = 0, sent_bytes = 0, unsent = 0;
  };

  /// `most_bytes`: see WaitForRoom.
  SendingThread(Send send, size_t most_bytes);
  /// Sends what waits; drops what would begin later than 5 s from now.
  ~SendingThread();
  SendingThread(const SendingThread&) = delete;
  SendingThread& operator=(const SendingThread&) = delete;

  /// Adds a message of about so many bytes. Does not wait, see WaitForRoom.
  void Add(const Channel& channel, size_t bytes, Encode encode);
  /// Waits until less than `most_bytes` wait to be sent, at most `seconds`. Returns whether that is
  /// so.
  bool WaitForRoom(double seconds);
  /// Waits until all messages were sent, at most `seconds`. Returns whether that is so.
  bool WaitUntilSent(double seconds);
  /// The totals since the last call, by channel.
  std::map<std::string, Totals> TakeTotals();

 private:
  struct Message {
    Channel channel{};
    size_t bytes = 0;
    Encode encode;
  };

  void Run();
  bool SendOne(Message* message, Totals* totals);

  Send send_;
  size_t most_bytes_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Message> waiting_;
  size_t waiting_bytes_ = 0;  // with those of the message that is being sent
  std::map<std::string, Totals> totals_;
  bool ends_ = false;
  double send_until_ = 0;  // once ends_ is set, MonotonicSeconds
  std::thread thread_;
};

}  // namespace vismap
