#include "requests/request_server.h"

#include <algorithm>
#include <utility>

#include "runtime/clock.h"
#include "runtime/log.h"

namespace vismap {
namespace {

constexpr size_t kRememberedReplies = 64;
constexpr size_t kLargestRemembered = kMegabyte;  // of a payload [bytes]

}  // namespace

RequestReceiver ReceiverOf(const std::string& verb) {
  return verb.starts_with("octomap") ? RequestReceiver::kOctomapExporter
                                     : RequestReceiver::kMapServer;
}

RequestServer::RequestServer(RequestReceiver receiver, Position position, Bus* bus, Status* status)
    : receiver_(receiver), position_(std::move(position)), bus_(bus), status_(status) {
  bus_->Subscribe<map_request_t>(kMapRequestChannel,
                                 [this](const map_request_t& request) { OnRequest(request); });
}

void RequestServer::Handle(const std::string& verb, Handler handler) {
  handlers_[verb] = std::move(handler);
}

void RequestServer::OnRequest(const map_request_t& request) {
  if (RepeatReply(request) || !IsForUs(request)) return;
  map_reply_t reply = MakeReply(request, CarryOut(request));
  status_->Count(reply.ok ? "requests_done" : "requests_refused");
  if (!reply.ok)
    LogWarning("request '" + request.verb + "' of " + request.source + ": " + reply.message);
  bus_->Publish(kMapReplyChannel, reply);
  Remember(std::move(reply));
}

bool RequestServer::RepeatReply(const map_request_t& request) {
  const auto known =
      std::find_if(remembered_.begin(), remembered_.end(), [&](const map_reply_t& reply) {
        return reply.requester == request.source && reply.request_id == request.request_id;
      });
  if (known == remembered_.end()) return false;
  bus_->Publish(kMapReplyChannel, *known);
  return true;
}

bool RequestServer::IsForUs(const map_request_t& request) const {
  return ReceiverOf(request.verb) == receiver_ &&
         (request.map_id.empty() || request.map_id == position_().map_id);
}

Result<Answer> RequestServer::CarryOut(const map_request_t& request) const {
  const auto handler = handlers_.find(request.verb);
  if (handler == handlers_.end())
    return Fail("unknown request '" + request.verb + "'; known are " + KnownVerbs());
  return handler->second(request);
}

std::string RequestServer::KnownVerbs() const {
  std::string verbs;
  for (const auto& entry : handlers_) verbs += (verbs.empty() ? "" : ", ") + entry.first;
  return verbs;
}

// The position is that after the request, which may have changed the map.
map_reply_t RequestServer::MakeReply(const map_request_t& request, Result<Answer> answer) const {
  const FollowerPosition position = position_();
  map_reply_t reply{};
  reply.utime = WallUtime();
  reply.requester = request.source;
  reply.request_id = request.request_id;
  reply.ok = answer.has_value();
  reply.map_id = position.map_id;
  reply.revision = position.revision;
  if (!answer) {
    reply.message = answer.error().message;
    return reply;
  }
  reply.message = std::move(answer->message);
  reply.encoding = std::move(answer->encoding);
  reply.payload = std::move(answer->payload);
  reply.payload_size = static_cast<int32_t>(reply.payload.size());
  return reply;
}

void RequestServer::Remember(map_reply_t reply) {
  if (reply.payload.size() < kLargestRemembered) remembered_.push_back(std::move(reply));
  if (remembered_.size() > kRememberedReplies) remembered_.pop_front();
}

}  // namespace vismap
