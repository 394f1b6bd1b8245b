#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>

#include "base/result.h"
#include "freespace/occupancy_map.h"
#include "runtime/bus.h"

namespace vismap {

/// Asks the map server which blocks of its map differ when objects are left out (the request
/// "occupancy"), for the exporter, which knows no objects. Each question gets one answer.
class SpaceWithout {
 public:
  /// The blocks, or why there are none.
  using Receiver = std::function<void(const Result<OccupancyDelta>&)>;

  /// Subscribes to MAP_REPLY. `bus` must outlive it.
  explicit SpaceWithout(Bus* bus);

  /// `without`: as in map_request_t. The receiver is called later, at the latest after some
  /// seconds.
  void Ask(const std::string& map_id, const std::string& without, Receiver receiver);

 private:
  struct Question {
    map_request_t request;
    Receiver receiver;
    double repeat = 0, give_up = 0;  // MonotonicSeconds
  };

  void OnReply(const map_reply_t& reply);
  void RepeatOrGiveUp();
  void Finish(int64_t id, const Result<OccupancyDelta>& blocks);

  Bus* bus_;
  int64_t last_id_ = 0;
  std::map<int64_t, Question> open_;  // by request_id
};

}  // namespace vismap
