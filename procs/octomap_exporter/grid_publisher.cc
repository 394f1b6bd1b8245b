#include "octomap_exporter/grid_publisher.h"

#include <algorithm>
#include <utility>

#include "wire/channels.h"
#include "wire/grid_message.h"

namespace vismap {

GridPublisher::GridPublisher(const VismapConfig& config, Bus* bus)
    : options_(config.ground_grid),
      period_(config.octomap_exporter.grid_period_s),
      budget_(config.octomap_exporter.repeat_mb_s * kMegabyte),
      bus_(bus),
      pacer_(period_) {}

bool GridPublisher::IsDue(const FollowerPosition& position) const {
  return period_ > 0 && position != made_ && pacer_.due();
}

Result<void> GridPublisher::Publish(const OccupancyMap& map, const FollowerPosition& position,
                                    int64_t utime, std::span<const Eigen::Vector3d> path_W) {
  Result<void> published;
  pacer_.RunIfDue([&] {
    made_ = position;
    published = Make(map, utime, path_W);
  });
  return published;
}

Result<void> GridPublisher::Make(const OccupancyMap& map, int64_t utime,
                                 std::span<const Eigen::Vector3d> path_W) {
  Result<GroundGrid> grid = MakeGroundGrid(map, options_, path_W);
  sent_.reset();
  if (!grid) return tl::unexpected(grid.error());
  if (grid->states.empty()) return {};
  sent_ = Encode(GridMessage{utime, 0, made_.map_id, made_.revision, options_, std::move(*grid)});
  Send();
  return {};
}

void GridPublisher::Repeat() {
  if (!sent_ || budget_ <= 0) return;
  const double bytes = static_cast<double>(sent_->getEncodedSize());
  if (MonotonicSeconds() >= sent_at_ + std::max(kPeriod, bytes / budget_)) Send();
}

void GridPublisher::Clear() {
  sent_.reset();
  made_ = {};
}

void GridPublisher::Send() {
  sent_->published_utime = WallUtime();
  sent_at_ = MonotonicSeconds();
  bus_->Publish(kGridChannel, *sent_);
}

}  // namespace vismap
