#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "viewer/web_server.h"

namespace vismap {

/// A thread that works out answers which take long, one after the other. Poll hands them over, so
/// that replies are called by the thread that asked.
class AnswerThread {
 public:
  static constexpr size_t kMostWaiting = 16;  ///< questions; further ones are refused with 429
  using Work = std::function<HttpAnswer()>;

  AnswerThread();
  /// Waits for the answer that is being worked out; the others are dropped.
  ~AnswerThread();
  AnswerThread(const AnswerThread&) = delete;
  AnswerThread& operator=(const AnswerThread&) = delete;

  /// `work` is called by the thread, and must not touch what others change. `reply` is called once,
  /// now or by Poll. See AnswerInTurn for questions whose turn comes late, and for exceptions.
  void Ask(Work work, const WebHandler::Reply& reply);
  /// Calls the replies whose answers are there.
  void Poll();

 private:
  struct Question {
    Work work;
    WebHandler::Reply reply;
    double asked = 0;  // MonotonicSeconds
  };
  void Run();

  std::mutex mutex_;
  std::condition_variable changed_;
  bool ends_ = false;
  std::deque<Question> waiting_;
  std::vector<std::pair<WebHandler::Reply, HttpAnswer>> done_;
  std::thread thread_;  // last, since it uses the others
};

}  // namespace vismap
