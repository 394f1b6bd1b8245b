#include "requests/request_server.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "base/format.h"
#include "base/printable.h"
#include "runtime/clock.h"
#include "runtime/log.h"

namespace vismap {
namespace {

constexpr std::array<std::string_view, 5> kNavigationVerbs = {
    "grid", "distances", "distances-delta", "clearance", "frontiers"};
constexpr size_t kRememberedReplies = 1000, kRememberedBytes = 32 * kMegabyte;
constexpr size_t kLargestRemembered = kMegabyte;                            // of a reply [bytes]
constexpr size_t kLargestPayload = kMapReplyChannel.max_bytes - kMegabyte;  // [bytes]
constexpr size_t kMaxSource = 200, kMaxVerb = 50;  // of texts that are repeated in replies [bytes]
// Without other messages for so long, requests are carried out without a pause [s].
constexpr double kIdle = 0.5;
constexpr double kServePeriod = 0.02;  // between two looks at the waiting requests [s]

size_t SizeOf(const map_reply_t& reply) {
  return reply.payload.size() + reply.message.size() + reply.requester.size() + 200;
}

// Whether one answer serves both, for requests that consist of verb and argument.
bool AreEqual(const map_request_t& a, const map_request_t& b) {
  return a.source == b.source && a.verb == b.verb && a.argument == b.argument;
}

void SetFacts(const OctreeFacts& facts, map_reply_t* reply) {
  reply->has_octree = true;
  reply->data_utime = facts.utime;
  for (int axis = 0; axis < 3; ++axis) {
    reply->bbx_min_W[axis] = facts.bounds_W.min()[axis];
    reply->bbx_max_W[axis] = facts.bounds_W.max()[axis];
  }
  reply->resolution_m = facts.resolution;
  reply->unknown = facts.unknown == UnknownPolicy::kOccupied ? map_request_t::UNKNOWN_OCCUPIED
                                                             : map_request_t::UNKNOWN_ABSENT;
  reply->shell_m = facts.shell;
  reply->inflated_by_m = facts.inflated_by;
}

}  // namespace

bool WaitingRequests::Add(map_request_t request) {
  auto of_source = std::find_if(by_source_.begin(), by_source_.end(), [&](const auto& requests) {
    return requests.front().source == request.source;
  });
  if (of_source != by_source_.end()) {
    const bool known = std::any_of(of_source->begin(), of_source->end(), [&](const auto& other) {
      return other.request_id == request.request_id;
    });
    if (known) return true;
    if (of_source->size() >= kMostOfSource) return false;
  }
  if (size_ >= kMost) return false;
  if (of_source == by_source_.end()) of_source = by_source_.emplace(by_source_.end());
  of_source->push_back(std::move(request));
  ++size_;
  return true;
}

std::optional<map_request_t> WaitingRequests::Next() {
  if (by_source_.empty()) return std::nullopt;
  std::deque<map_request_t> requests = std::move(by_source_.front());
  by_source_.pop_front();
  map_request_t next = std::move(requests.front());
  requests.pop_front();
  if (!requests.empty()) by_source_.push_back(std::move(requests));
  --size_;
  return next;
}

std::vector<map_request_t> WaitingRequests::TakeEqual(const map_request_t& request) {
  std::vector<map_request_t> equal;
  for (auto of_source = by_source_.begin(); of_source != by_source_.end(); ++of_source) {
    if (of_source->front().source != request.source) continue;
    std::erase_if(*of_source, [&](const map_request_t& other) {
      if (!AreEqual(other, request)) return false;
      equal.push_back(other);
      return true;
    });
    if (of_source->empty()) by_source_.erase(of_source);
    break;
  }
  size_ -= equal.size();
  return equal;
}

RequestReceiver ReceiverOf(const std::string& verb) {
  const auto& navigation = kNavigationVerbs;
  const bool exporter = verb.starts_with("octomap") ||
                        std::find(navigation.begin(), navigation.end(), verb) != navigation.end();
  return exporter ? RequestReceiver::kOctomapExporter : RequestReceiver::kMapServer;
}

RequestServer::RequestServer(RequestReceiver receiver, Position position, Bus* bus, Status* status)
    : receiver_(receiver), position_(std::move(position)), bus_(bus), status_(status) {
  bus_->Subscribe<map_request_t>(
      kMapRequestChannel, [this](const map_request_t& request) { return OnRequest(request); },
      Delivery::kUrgent);
  bus_->Every(kServePeriod, [this] { ServeNextIfDue(); });
}

void RequestServer::Handle(const std::string& verb, Handler handler) {
  handlers_[verb] = std::move(handler);
}

void RequestServer::HandleLate(const std::string& verb, LateHandler handler) {
  late_handlers_[verb] = std::move(handler);
}

Result<void> RequestServer::OnRequest(const map_request_t& request) {
  if (request.source.size() > kMaxSource) {
    return Fail("the source of a request has " + std::to_string(request.source.size()) +
                " characters; expected at most " + std::to_string(kMaxSource));
  }
  if (!IsForUs(request) || Join(request)) return {};
  if (!waiting_.Add(request)) {
    status_->Count("requests_not_taken");
    LogWarningRateLimited("requests",
                          "too many requests wait; one of " + request.source + " was not taken");
  }
  ServeNextIfDue();
  return {};
}

void RequestServer::ServeNextIfDue() {
  const double start = MonotonicSeconds();
  if (waiting_.size() > 0 && begun_.size() < most_begun_ &&
      (start >= next_due_ || bus_->SecondsWithoutWork() > kIdle)) {
    const StageTimer timer(status_, "requests");
    Serve(*waiting_.Next());
    const double end = MonotonicSeconds();
    next_due_ = end + PauseAfter(end - start, share_);
  }
  status_->SetCounter("requests_waiting", static_cast<int64_t>(waiting_.size()));
}

void RequestServer::Serve(const map_request_t& request) {
  if (RepeatReply(request)) return;
  const auto late = late_handlers_.find(request.verb);
  if (late != late_handlers_.end()) return Begin(request, late->second);
  Finish(request, CarryOut(request));
}

// Returns whether the request gets the answer of one that has begun: it is the same one again, or
// an equal one of those that are joined.
bool RequestServer::Join(const map_request_t& request) {
  for (auto& [id, requests] : begun_) {
    const bool equal = is_joined_ && is_joined_(request) && AreEqual(requests.front(), request);
    const bool known = std::any_of(requests.begin(), requests.end(), [&](const auto& other) {
      return other.source == request.source && other.request_id == request.request_id;
    });
    if (equal && !known && requests.size() < WaitingRequests::kMostOfSource)
      requests.push_back(request);
    if (equal || known) return true;
  }
  return false;
}

void RequestServer::Begin(const map_request_t& request, const LateHandler& handler) {
  const std::pair<std::string, int64_t> id(request.source, request.request_id);
  if (begun_.contains(id)) return;
  std::vector<map_request_t> requests = {request};
  if (is_joined_ && is_joined_(request)) {
    for (map_request_t& equal : waiting_.TakeEqual(request)) requests.push_back(std::move(equal));
  }
  begun_[id] = std::move(requests);
  handler(request, [this, id](LateAnswer late) {
    const auto begun = begun_.extract(id);
    if (begun.empty()) return;
    const std::vector<map_request_t>& all = begun.mapped();
    for (size_t i = 1; i < all.size(); ++i) Finish(all[i], late);
    Finish(all.front(), std::move(late));
  });
}

void RequestServer::Finish(const map_request_t& request, LateAnswer late) {
  if (late.worked_s > 0)
    next_due_ = std::max(next_due_, MonotonicSeconds() + PauseAfter(late.worked_s, share_));
  Result<Answer>& answer = late.answer;
  if (answer && answer->payload.size() > kLargestPayload) {
    answer = Fail("the answer has " + FormatBytes(answer->payload.size()) + ", and at most " +
                  FormatBytes(kLargestPayload) + " can be sent; save the map instead");
  }
  map_reply_t reply = MakeReply(request, std::move(late));
  status_->Count(reply.ok ? "requests_done" : "requests_refused");
  if (!reply.ok) {
    LogWarningRateLimited("refused", "request '" + PrintableText(request.verb, kMaxVerb) + "' of " +
                                         request.source + ": " + reply.message);
  }
  if (SizeOf(reply) > kLargestRemembered) {
    bus_->Publish(kMapReplyChannel, std::move(reply));
    return;
  }
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
    return Fail("unknown request '" + PrintableText(request.verb, kMaxVerb) + "'; known are " +
                KnownVerbs());
  return handler->second(request);
}

std::string RequestServer::KnownVerbs() const {
  std::string verbs;
  std::set<std::string> names;
  for (const auto& entry : handlers_) names.insert(entry.first);
  for (const auto& entry : late_handlers_) names.insert(entry.first);
  for (const std::string& name : names) verbs += (verbs.empty() ? "" : ", ") + name;
  return verbs;
}

// Unless the answer says it, the position is that after the request, which may have changed the
// map.
map_reply_t RequestServer::MakeReply(const map_request_t& request, LateAnswer late) const {
  const FollowerPosition position = late.position ? *late.position : position_();
  Result<Answer>& answer = late.answer;
  map_reply_t reply{};
  reply.utime = WallUtime();
  reply.requester = request.source;
  reply.request_id = request.request_id;
  reply.ok = answer.has_value();
  reply.map_id = position.map_id;
  reply.revision = position.revision;
  if (!answer) {
    reply.message = PrintableText(answer.error().message);
    return reply;
  }
  reply.message = PrintableText(answer->message);
  reply.encoding = std::move(answer->encoding);
  reply.payload = std::move(answer->payload);
  reply.payload_size = static_cast<int32_t>(reply.payload.size());
  if (answer->octree) SetFacts(*answer->octree, &reply);
  return reply;
}

void RequestServer::Remember(map_reply_t reply) {
  remembered_bytes_ += SizeOf(reply);
  remembered_.push_back(std::move(reply));
  while (remembered_.size() > kRememberedReplies || remembered_bytes_ > kRememberedBytes) {
    remembered_bytes_ -= SizeOf(remembered_.front());
    remembered_.pop_front();
  }
}

}  // namespace vismap
