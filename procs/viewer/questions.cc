#include "viewer/questions.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/printable.h"
#include "runtime/clock.h"
#include "wire/channels.h"

namespace vismap {

namespace {
constexpr double kRepeatQuestion = 2;  // [s]
}  // namespace

Questions::Questions(Bus* bus) : bus_(bus) {
  bus_->Subscribe<map_reply_t>(
      kMapReplyChannel, [this](const map_reply_t& reply) { OnReply(reply); }, Delivery::kUrgent);
  bus_->Every(0.5, [this] { RepeatOrGiveUp(); });
}

void Questions::Ask(const std::string& verb, const std::string& argument, Receiver receiver) {
  for (auto& [id, open] : open_) {
    if (open.request.verb == verb && open.request.argument == argument)
      return open.receivers.push_back(std::move(receiver));
  }
  const double now = MonotonicSeconds();
  if (now - second_ >= 1) {
    second_ = now;
    asked_ = 0;
  }
  if (++asked_ > kMostPerSecond)
    return receiver(tl::unexpected(
        Failure{Refusal::kTooMany, "more than " + std::to_string(kMostPerSecond) +
                                       " questions to the map server per second; try again"}));
  if (open_.size() >= kMost)
    return receiver(tl::unexpected(
        Failure{Refusal::kTooMany,
                std::to_string(kMost) + " questions wait for the map server already; try again"}));
  last_id_ = std::max(last_id_ + 1, WallUtime());
  Question question{};  // also sets the numbers in the request to 0
  question.request.utime = question.request.request_id = last_id_;
  question.request.verb = verb;
  question.request.argument = argument;
  question.request.unknown = map_request_t::UNKNOWN_DEFAULT;
  question.receivers.push_back(std::move(receiver));
  question.repeat = MonotonicSeconds() + kRepeatQuestion;
  question.give_up = MonotonicSeconds() + kLongestWait;
  bus_->Publish(kMapRequestChannel, question.request);
  open_.emplace(last_id_, std::move(question));
}

void Questions::OnReply(const map_reply_t& reply) {
  if (reply.requester != bus_->source() || !open_.contains(reply.request_id)) return;
  if (reply.ok) return Finish(reply.request_id, reply);
  Finish(reply.request_id,
         tl::unexpected(Failure{Refusal::kRefused, PrintableText(reply.message)}));
}

void Questions::RepeatOrGiveUp() {
  const double now = MonotonicSeconds();
  std::vector<int64_t> given_up;
  for (auto& [id, question] : open_) {
    if (now >= question.give_up) {
      given_up.push_back(id);
    } else if (now >= question.repeat) {
      bus_->Publish(kMapRequestChannel, question.request);
      question.repeat = now + kRepeatQuestion;
    }
  }
  for (const int64_t id : given_up)
    Finish(id, tl::unexpected(Failure{Refusal::kNoAnswer,
                                      "the map server has not answered within 10 s; check that "
                                      "vismap-map-server is running"}));
}

void Questions::Finish(int64_t id, const Answered& answer) {
  const std::vector<Receiver> receivers = std::move(open_.at(id).receivers);
  open_.erase(id);
  for (const Receiver& receiver : receivers) receiver(answer);
}

}  // namespace vismap
