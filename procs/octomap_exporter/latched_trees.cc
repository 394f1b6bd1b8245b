#include "octomap_exporter/latched_trees.h"

#include <algorithm>
#include <utility>

namespace vismap {

void LatchedTrees::Publish(const Channel& channel, octree_t tree) {
  auto found = std::find_if(sent_.begin(), sent_.end(), [&](const Sent& sent) {
    return std::string(sent.channel.name) == channel.name;
  });
  if (found == sent_.end()) found = sent_.insert(sent_.end(), Sent{channel, {}, 0});
  found->tree = std::move(tree);
  Send(&*found);
}

void LatchedTrees::Repeat() {
  if (budget_ <= 0) return;
  const double period = RepeatPeriod();
  for (Sent& sent : sent_) {
    if (now_() >= sent.at + period) Send(&sent);
  }
}

void LatchedTrees::Clear() { sent_.clear(); }

double LatchedTrees::RepeatPeriod() const {
  double bytes = 0;
  for (const Sent& sent : sent_) bytes += static_cast<double>(sent.tree.data.size());
  return std::max(kPeriod, bytes / budget_);
}

void LatchedTrees::Send(Sent* sent) {
  sent->tree.published_utime = WallUtime();
  sent->at = now_();
  bus_->Publish(sent->channel, sent->tree);
}

}  // namespace vismap
