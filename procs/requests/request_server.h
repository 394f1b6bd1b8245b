#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>

#include "base/result.h"
#include "runtime/bus.h"
#include "runtime/status.h"
#include "wire/update_sequence.h"

namespace vismap {

/// What carrying out a request gave.
struct Answer {
  std::string message;     ///< one sentence for people, or the value that was asked for
  std::string encoding{};  ///< of the payload: "json", "ply", "bt"; empty = no payload
  std::vector<uint8_t> payload{};
};

/// The programs that answer on MAP_REQUEST. Verbs that begin with "octomap" are the exporter's, all
/// others the map server's.
enum class RequestReceiver { kMapServer, kOctomapExporter };
RequestReceiver ReceiverOf(const std::string& verb);

/// Answers every MAP_REQUEST to one program with one MAP_REPLY. A request that comes again (same
/// source and id) is not carried out twice but gets the same reply. Requests for another map are
/// left to the server of that map.
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

  /// Requests with this verb go to `handler`. Others are refused with the list of the known verbs.
  void Handle(const std::string& verb, Handler handler);

 private:
  void OnRequest(const map_request_t& request);
  bool RepeatReply(const map_request_t& request);
  bool IsForUs(const map_request_t& request) const;
  Result<Answer> CarryOut(const map_request_t& request) const;
  map_reply_t MakeReply(const map_request_t& request, Result<Answer> answer) const;
  void Remember(map_reply_t reply);
  std::string KnownVerbs() const;

  RequestReceiver receiver_;
  Position position_;
  Bus* bus_;
  Status* status_;
  std::map<std::string, Handler> handlers_;  // by verb
  std::deque<map_reply_t> remembered_;       // the newest replies, without very large ones
};

}  // namespace vismap
