#include "viewer/questions.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/printable.h"
#include "runtime/clock.h"
#include "wire/channels.h"

namespace vismap {

namespace {
constexpr double kRepeatQuestion = 2;  // [s]

// Whether two requests ask for the same.
bool SameQuestion(const map_request_t& a, const map_request_t& b) {
  const auto box = [](const map_request_t& request) {
    std::array<double, 6> corners{};
    std::copy_n(request.bbx_min_W, 3, corners.begin());
    std::copy_n(request.bbx_max_W, 3, corners.begin() + 3);
    return corners;
  };
  return a.verb == b.verb && a.argument == b.argument && a.unknown == b.unknown &&
         a.inflate_m == b.inflate_m && a.has_bbx == b.has_bbx && box(a) == box(b);
}

std::string NoAnswerText(const map_request_t& request) {
  const bool exporter = request.verb == "octomap" || request.verb == "distances";
  return exporter ? "the octomap exporter has not answered within 10 s; check that "
                    "vismap-octomap-exporter is running"
                  : "the map server has not answered within 10 s; check that vismap-map-server is "
                    "running";
}
}  // namespace

Questions::Questions(Bus* bus) : bus_(bus) {
  bus_->Subscribe<map_reply_t>(
      kMapReplyChannel, [this](const map_reply_t& reply) { OnReply(reply); }, Delivery::kUrgent);
  bus_->Every(0.5, [this] { RepeatOrGiveUp(); });
}

void Questions::Ask(const std::string& verb, const std::string& argument, Receiver receiver) {
  map_request_t request{};  // also sets its numbers to 0
  request.verb = verb;
  request.argument = argument;
  request.unknown = map_request_t::UNKNOWN_DEFAULT;
  Ask(std::move(request), std::move(receiver));
}

void Questions::Ask(map_request_t request, Receiver receiver) {
  for (auto& [id, open] : open_) {
    if (SameQuestion(open.request, request)) return open.receivers.push_back(std::move(receiver));
  }
  const double now = MonotonicSeconds();
  if (now - second_ >= 1) {
    second_ = now;
    asked_ = 0;
  }
  if (++asked_ > kMostPerSecond)
    return receiver(tl::unexpected(
        Failure{Refusal::kTooMany, "more than " + std::to_string(kMostPerSecond) +
                                       " questions to other processes per second; try again"}));
  if (open_.size() >= kMost)
    return receiver(tl::unexpected(
        Failure{Refusal::kTooMany,
                std::to_string(kMost) + " questions wait for an answer already; try again"}));
  last_id_ = std::max(last_id_ + 1, WallUtime());
  Question question{std::move(request), {}, 0, 0};
  question.request.utime = question.request.request_id = last_id_;
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
    Finish(id, tl::unexpected(Failure{Refusal::kNoAnswer, NoAnswerText(open_.at(id).request)}));
}

void Questions::Finish(int64_t id, const Answered& answer) {
  const std::vector<Receiver> receivers = std::move(open_.at(id).receivers);
  open_.erase(id);
  for (const Receiver& receiver : receivers) receiver(answer);
}

}  // namespace vismap
