#include "octomap_exporter/space_without.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/printable.h"
#include "requests/object_edits.h"
#include "runtime/clock.h"

namespace vismap {

namespace {
constexpr double kAskAgainPeriod = 0.5, kLongestWait = 5;  // [s]
}  // namespace

SpaceWithout::SpaceWithout(Bus* bus) : bus_(bus) {
  bus_->Subscribe<map_reply_t>(
      kMapReplyChannel, [this](const map_reply_t& reply) { OnReply(reply); }, Delivery::kUrgent);
  bus_->Every(kAskAgainPeriod / 2, [this] { RepeatOrGiveUp(); });
}

void SpaceWithout::Ask(const std::string& map_id, const std::string& without, Receiver receiver) {
  last_id_ = std::max(last_id_ + 1, WallUtime());
  Question question;
  question.request.utime = question.request.request_id = last_id_;
  question.request.map_id = map_id;
  question.request.verb = "occupancy";
  question.request.without = without;
  question.receiver = std::move(receiver);
  question.repeat = MonotonicSeconds() + kAskAgainPeriod;
  question.give_up = MonotonicSeconds() + kLongestWait;
  bus_->Publish(kMapRequestChannel, question.request);
  open_.emplace(last_id_, std::move(question));
}

void SpaceWithout::OnReply(const map_reply_t& reply) {
  if (reply.requester != bus_->source() || !open_.contains(reply.request_id)) return;
  if (!reply.ok) return Finish(reply.request_id, Fail(PrintableText(reply.message)));
  Finish(reply.request_id, ReadOccupancy(reply.payload));
}

void SpaceWithout::RepeatOrGiveUp() {
  const double now = MonotonicSeconds();
  std::vector<int64_t> given_up;
  for (auto& [id, question] : open_) {
    if (now >= question.give_up) given_up.push_back(id);
    if (now < question.repeat || now >= question.give_up) continue;
    bus_->Publish(kMapRequestChannel, question.request);
    question.repeat = now + kAskAgainPeriod;
  }
  for (const int64_t id : given_up) {
    Finish(id, Fail("without: the map server, which knows the objects, has not answered within " +
                    std::to_string(static_cast<int>(kLongestWait)) + " s"));
  }
}

void SpaceWithout::Finish(int64_t id, const Result<OccupancyDelta>& blocks) {
  const Receiver receiver = std::move(open_.at(id).receiver);
  open_.erase(id);
  receiver(blocks);
}

}  // namespace vismap
