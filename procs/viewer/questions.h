#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>

#include "base/result.h"
#include "runtime/bus.h"

namespace vismap {

/// Questions to the map server or the octomap exporter that are not answered yet. Each is asked
/// again every two seconds, which the server notices, and given up after ten.
class Questions {
 public:
  /// Fewer than the map server takes of one source, which asks also for what the viewer itself
  /// has missed.
  static constexpr size_t kMost = 4;
  static constexpr int kMostPerSecond = 10;
  static constexpr double kLongestWait = 10;  // [s]
  /// Why there is no answer.
  enum class Refusal { kTooMany, kNoAnswer, kRefused };
  struct Failure {
    Refusal reason;
    std::string sentence;
  };
  using Answered = tl::expected<map_reply_t, Failure>;
  using Receiver = std::function<void(const Answered&)>;

  /// `bus` must outlive it.
  explicit Questions(Bus* bus);
  /// Calls `receiver` once, now or later. Joins an open question that is equal.
  void Ask(const std::string& verb, const std::string& argument, Receiver receiver);
  /// The same for a request with more than that.
  void Ask(map_request_t request, Receiver receiver);
  size_t size() const { return open_.size(); }

 private:
  struct Question {
    map_request_t request;
    std::vector<Receiver> receivers;
    double repeat = 0, give_up = 0;  // MonotonicSeconds
  };
  void OnReply(const map_reply_t& reply);
  void RepeatOrGiveUp();
  void Finish(int64_t id, const Answered& answer);

  Bus* bus_;
  std::map<int64_t, Question> open_;  // by request_id
  int64_t last_id_ = 0;
  double second_ = 0;  // when the counted questions began, MonotonicSeconds
  int asked_ = 0;
};

}  // namespace vismap
