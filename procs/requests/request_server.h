#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>

#include "base/result.h"
#include "freespace/octree.h"
#include "runtime/bus.h"
#include "runtime/pacer.h"
#include "runtime/status.h"
#include "wire/update_sequence.h"

namespace vismap {

/// What a reply says of the octree in it.
struct OctreeFacts {
  int64_t utime = 0;  ///< of the newest frame in it [us]
  Eigen::AlignedBox3d bounds_W;
  double resolution = 0;  ///< edge of a leaf [m]
  UnknownPolicy unknown = UnknownPolicy::kOccupied;
  double shell = 0;        ///< see OctreeBytes [m]
  double inflated_by = 0;  ///< see octree_t [m]
};

/// What carrying out a request gave.
struct Answer {
  std::string message;     ///< one sentence for people, or the value that was asked for
  std::string encoding{};  ///< of the payload: "json", "ply", "bt"; empty = no payload
  std::vector<uint8_t> payload{};
  std::optional<OctreeFacts> octree{};  ///< when the payload is an octree
};

/// The answer to a request that was begun, or why there is none.
struct LateAnswer {
  LateAnswer(Answer made) : answer(std::move(made)) {}               // NOLINT: it is one
  LateAnswer(Result<Answer> made) : answer(std::move(made)) {}       // NOLINT: it is one
  LateAnswer(tl::unexpected<Error> why) : answer(std::move(why)) {}  // NOLINT: it is one

  Result<Answer> answer;
  /// Of the map that it was made from; nullopt = of the present one.
  std::optional<FollowerPosition> position{};
  double worked_s = 0;  ///< time of another thread that it took [s]
};

/// The programs that answer on MAP_REQUEST. The octomap exporter answers verbs that begin with
/// "octomap" and those of navigation: grid, distances, distances-delta, clearance, frontiers. All
/// others are the map server's.
enum class RequestReceiver { kMapServer, kOctomapExporter };
RequestReceiver ReceiverOf(const std::string& verb);

/// The requests that wait to be carried out. Those of one source wait in the order of their
/// arrival; the sources take turns, so that one with many requests does not keep the others
/// waiting.
class WaitingRequests {
 public:
  static constexpr size_t kMostOfSource = 8, kMost = 64;

  /// Returns false when there is no room for the request. One that waits already is not added
  /// again.
  bool Add(map_request_t request);
  /// Removes and returns the request whose turn it is; nullopt = none waits.
  std::optional<map_request_t> Next();
  /// Removes and returns the requests of its source with the same verb and argument.
  std::vector<map_request_t> TakeEqual(const map_request_t& request);
  size_t size() const { return size_; }

 private:
  // The source whose turn it is comes first. No source is without requests.
  std::deque<std::deque<map_request_t>> by_source_;
  size_t size_ = 0;
};

/// Answers every MAP_REQUEST to one program with one MAP_REPLY. A request that comes again (same
/// source and id) is not carried out twice but gets the same reply. Requests for another map are
/// left to the server of that map.
///
/// Requests do not wait for the messages of other channels. While those come, requests take at most
/// a share of the time: with a fifth, after one that took a second, the next is carried out four
/// seconds later. Time of other threads counts, too (LateAnswer::worked_s).
/// One for which there is no room (see WaitingRequests) is counted and not answered; its sender
/// repeats it.
class RequestServer {
 public:
  /// Carries out a request. An Error is the reason why it cannot be carried out.
  using Handler = std::function<Result<Answer>(const map_request_t&)>;
  /// Gives the map that the program has, and the revision of it.
  using Position = std::function<FollowerPosition()>;

  /// Subscribes to MAP_REQUEST. `bus` and `status` must outlive it.
  RequestServer(RequestReceiver receiver, Position position, Bus* bus, Status* status);
  RequestServer(const RequestServer&) = delete;
  RequestServer& operator=(const RequestServer&) = delete;

  /// Sends the answer to a request that was begun, now or later; once.
  using Reply = std::function<void(LateAnswer)>;
  /// Begins to carry out a request, which may wait for other programs or threads. It must call the
  /// Reply in the end; the server must outlive it.
  using LateHandler = std::function<void(const map_request_t&, Reply)>;

  /// Requests with this verb go to `handler`. Others are refused with the list of the known verbs.
  void Handle(const std::string& verb, Handler handler);
  /// The same for answers that may take longer than the handler. Until the answer is there, other
  /// requests are carried out, and a repetition of this one begins nothing.
  void HandleLate(const std::string& verb, LateHandler handler);
  /// Requests for which this holds are joined: what waits of the same source, verb and argument
  /// when one begins, or comes until it is answered, gets the same answer. For followers, which ask
  /// again after some time for what they still lack.
  void JoinEqual(std::function<bool(const map_request_t&)> is_joined) {
    is_joined_ = std::move(is_joined);
  }
  /// While so many have begun and have no answer, all others wait; kUsuallyBegun at the start.
  void SetMostBegun(size_t most) { most_begun_ = most; }
  /// The share of the time that requests may take, see PauseAfter; kUsualShare at the start.
  void SetShare(double share) { share_ = share; }

 private:
  static constexpr size_t kUsuallyBegun = 8;

  Result<void> OnRequest(const map_request_t& request);
  void ServeNextIfDue();
  void Serve(const map_request_t& request);
  bool RepeatReply(const map_request_t& request);
  bool IsForUs(const map_request_t& request) const;
  bool Join(const map_request_t& request);
  void Begin(const map_request_t& request, const LateHandler& handler);
  void Finish(const map_request_t& request, LateAnswer late);
  Result<Answer> CarryOut(const map_request_t& request) const;
  map_reply_t MakeReply(const map_request_t& request, LateAnswer late) const;
  void Remember(map_reply_t reply);
  std::string KnownVerbs() const;

  RequestReceiver receiver_;
  Position position_;
  Bus* bus_;
  Status* status_;
  std::map<std::string, Handler> handlers_;  // by verb
  std::map<std::string, LateHandler> late_handlers_;
  // Without an answer, by source and request_id; the first of each is the one that was begun.
  std::map<std::pair<std::string, int64_t>, std::vector<map_request_t>> begun_;
  std::function<bool(const map_request_t&)> is_joined_;  // see JoinEqual; may be empty
  size_t most_begun_ = kUsuallyBegun;
  WaitingRequests waiting_;
  double share_ = kUsualShare;
  double next_due_ = 0;                 // of a request, while other messages come, MonotonicSeconds
  std::deque<map_reply_t> remembered_;  // the newest replies, without very large ones
  size_t remembered_bytes_ = 0;
};

}  // namespace vismap
