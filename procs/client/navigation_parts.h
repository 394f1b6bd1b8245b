#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vismap/distance_field_t.hpp>
#include <vismap/process_status_t.hpp>

#include "client/client.h"
#include "client/exporter_news.h"
#include "client/navigation.h"
#include "wire/distance_follower.h"

namespace vismap {

/// What a NavigationClient consists of: one thread at a time handles messages, and any threads
/// read.
struct NavigationClient::Parts {
  /// The newest value of a channel, which is never changed.
  template <typename Value>
  struct Kept {
    std::shared_ptr<const Value> value;
    OutputState state;
  };
  struct Pending {
    map_request_t request;
    double send_at = 0;
    std::optional<map_reply_t> reply;
  };
  /// How far a value can be trusted at present.
  struct Trust {
    double age_s = 0;
    std::string why;         // "" = it is the newest state of the map
    bool handed_out = true;  // false = it is older than is wanted
  };

  explicit Parts(const NavigationClientOptions& given);

  void Subscribe();
  void OnTree(TreeKind kind, const octree_t& message);
  void OnGrid(const occupancy_grid_t& message);
  void OnDistances(const distance_field_t& message);
  void OnStatus(const navigation_status_t& message);
  void OnReply(const map_reply_t& message);
  void OnProcess(const process_status_t& message);
  bool Turn(double timeout);
  /// No messages are handled from now on, for this reason; "" = none.
  void Fail(const std::string& why);

  /// Copies a kept value and the news that its age depends on.
  template <typename Value>
  std::pair<Kept<Value>, ExporterNews> Copy(const Kept<Value>& kept) const {
    const std::lock_guard lock(mutex);
    return {kept, news};
  }
  ExporterNews CopyNews() const;
  Kept<octree_t>& KeptTree(TreeKind kind) { return trees.at(kind); }
  Trust TrustIn(const OutputName& name, const OutputState& state, const ExporterNews& heard,
                double max_age_s) const;

  /// Waits until a condition holds, at most `timeout` [s]; without the thread it handles messages.
  void WaitUntil(double timeout, const std::function<bool()>& condition);
  /// A request that the next turns send until its reply is there. Returns its id.
  int64_t Begin(map_request_t* request);
  /// The reply, if it is there.
  std::optional<map_reply_t> TakeReply(int64_t id);
  void Forget(int64_t id);

  const NavigationClientOptions options;
  std::thread thread;
  std::atomic<bool> stopping{false};

  mutable std::mutex mutex;  // of what follows; held while pointers and numbers are copied
  std::map<TreeKind, Kept<octree_t>> trees;
  Kept<occupancy_grid_t> grid;
  Kept<LeafDistances> distances;

 private:
  template <typename Value>
  void Replace(Kept<Value>* kept, std::shared_ptr<const Value> value, std::string map_id,
               int64_t revision, std::string problem);
  void Notify();
  void SendRequests();
  void AskForDistances();
  void TellState();
  int64_t CountChanges() const;

  ExporterNews news;
  std::condition_variable changed;
  int64_t changes = 0;
  std::map<int64_t, Pending> requests;  // by request_id
  int64_t next_id;

  // For the thread that handles messages.
  Client client;
  DistanceFollower follower;
  double next_state = 0, next_question = 0;
  int64_t question = 0;  // request_id of the question for distances that are missing
};

/// Calls `turn` until `stopping`. Returns one sentence if an exception ended it before; else "".
std::string TurnUntil(const std::atomic<bool>& stopping, const std::function<void()>& turn);

/// What the channels carry.
OutputName NameOf(TreeKind kind);
OutputName GridName();
OutputName DistancesName();

}  // namespace vismap
