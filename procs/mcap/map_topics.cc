#include "mcap/map_topics.h"

#include <algorithm>
#include <utility>

#include "freespace/coarsen.h"

namespace vismap {
namespace {

constexpr size_t kVerticesPerUpdate = 100000;  // a larger SurfaceMessage is split
constexpr int kLargestFactor = 64;             // of Coarsen
constexpr double kFinestCell = 0.05;           // to show [m]

size_t BytesOf(const Mesh& mesh) {
  return mesh.vertices.size() * sizeof(MeshVertex) + mesh.triangles.size() * 12 + sizeof(BlockMesh);
}

size_t BytesOf(const std::vector<BlockMesh>& blocks) {
  size_t bytes = 0;
  for (const BlockMesh& block : blocks) bytes += BytesOf(block.mesh);
  return bytes;
}

std::vector<CloudPoint> PointsOf(const Mesh& mesh) {
  std::vector<CloudPoint> points;
  points.reserve(mesh.vertices.size());
  for (const MeshVertex& vertex : mesh.vertices)
    points.push_back({vertex.position_W, vertex.color, vertex.segment, vertex.instance,
                      vertex.class_id, vertex.seen});
  return points;
}

// The number of free cells, or of occupied ones, whichever is larger.
size_t CellsToShow(const OccupancyMap& map) {
  const CellCounts cells = CountCells(map);
  return static_cast<size_t>(std::max(cells.free, cells.occupied));
}

// The map in cells that are small enough to see and few enough to draw.
OccupancyMap CellsForPeople(const OccupancyMap& map, size_t most_cells) {
  int factor = static_cast<int>(
      std::clamp(kFinestCell / map.cell_size() + 0.5, 1.0, static_cast<double>(kLargestFactor)));
  OccupancyMap coarse = Coarsen(map, {factor, 1.0});
  while (CellsToShow(coarse) > most_cells && factor < kLargestFactor) {
    factor = std::min(2 * factor, kLargestFactor);
    coarse = Coarsen(map, {factor, 1.0});
  }
  return coarse;
}

}  // namespace

FollowOutcome SurfaceTopics::Apply(const mesh_delta_t& message, int64_t log_us) {
  Result<MeshUpdate> update = Decode(message);
  if (!update) return FollowOutcome::kBroken;
  const double now = static_cast<double>(log_us) * 1e-6;
  sequence_.GiveUpStaleParts(now);
  const UpdateHead head{update->map_id, update->mesh.revision, update->base_revision,
                        update->full,   update->part,          update->parts};
  const size_t size = BytesOf(update->mesh.blocks);
  const FollowOutcome outcome = sequence_.AddPart(head, std::move(update->mesh.blocks), size, now);
  if (outcome != FollowOutcome::kApplied) return outcome;
  if (update->full || update->map_id != map_id_) Reset();
  map_id_ = update->map_id;
  for (std::vector<BlockMesh>& part : sequence_.ReleaseParts())
    for (BlockMesh& block : part) Set(std::move(block), update->utime);
  if (bytes() <= options_.limits.max_bytes) return outcome;
  Reset();
  sequence_.RequireSnapshot();
  return FollowOutcome::kTooLarge;
}

void SurfaceTopics::Reset() {
  points_.clear();
  pending_.clear();
  point_count_ = pending_bytes_ = 0;
  reset_ = true;
  changes_.MarkChanged();
  cloud_.MarkChanged();
}

void SurfaceTopics::Set(BlockMesh block, int64_t utime) {
  utime_ = utime;
  std::vector<CloudPoint>& points = points_[block.block];
  point_count_ -= points.size();
  points = PointsOf(block.mesh);
  point_count_ += points.size();
  if (points.empty()) points_.erase(block.block);

  const auto [waiting, is_new] = pending_.try_emplace(block.block);
  if (!is_new) pending_bytes_ -= BytesOf(waiting->second.mesh);
  pending_bytes_ += BytesOf(block.mesh);
  waiting->second = std::move(block);
  changes_.MarkChanged();
  cloud_.MarkChanged();
}

void SurfaceTopics::WriteDue(int64_t log_us) {
  if (changes_.IsDue(log_us)) WriteChanges(log_us);
  if (cloud_.IsDue(log_us)) WriteCloud(log_us);
}

void SurfaceTopics::Finish(int64_t log_us) {
  if (changes_.changed()) WriteChanges(log_us);
  if (cloud_.changed()) WriteCloud(log_us);
}

void SurfaceTopics::WriteChanges(int64_t log_us) {
  std::vector<BlockMesh> blocks;
  size_t vertices = 0;
  const auto write = [&] {
    if (blocks.empty() && !reset_) return;
    file_.Write("/map/surface", {log_us, utime_},
                SurfaceMessage(blocks, std::exchange(reset_, false), options_.coloring, log_us));
    blocks.clear();
    vertices = 0;
  };
  for (auto& [index, block] : pending_) {
    vertices += block.mesh.vertices.size();
    blocks.push_back(std::move(block));
    if (vertices >= kVerticesPerUpdate) write();
  }
  write();
  pending_.clear();
  pending_bytes_ = 0;
  changes_.MarkWritten(log_us);
}

void SurfaceTopics::WriteCloud(int64_t log_us) {
  const size_t step =
      std::max<size_t>(1, (point_count_ + options_.most_points - 1) / options_.most_points);
  std::vector<CloudPoint> chosen;
  size_t number = 0;
  for (const auto& [index, points] : points_)
    for (const CloudPoint& point : points)
      if (number++ % step == 0) chosen.push_back(point);
  file_.Write("/map/surface_points", {log_us, utime_}, SurfaceCloudMessage(chosen, utime_));
  cloud_.MarkWritten(log_us);
}

FollowOutcome SpaceTopics::Apply(MapUpdate update, int64_t log_us) {
  const double now = static_cast<double>(log_us) * 1e-6;
  follower_.GiveUpStaleParts(now);
  const FollowOutcome outcome = follower_.Apply(std::move(update), now);
  if (outcome == FollowOutcome::kApplied) {
    utime_ = follower_.utime();
    timer_.MarkChanged();
  }
  return outcome;
}

void SpaceTopics::Set(OccupancyMap map, int64_t utime) {
  whole_ = std::move(map);
  utime_ = utime;
  timer_.MarkChanged();
}

const OccupancyMap* SpaceTopics::Newest() const {
  if (follower_.occupancy()) return &*follower_.occupancy();
  return whole_ ? &*whole_ : nullptr;
}

void SpaceTopics::WriteDue(int64_t log_us) {
  if (timer_.IsDue(log_us)) WriteAll(log_us);
}

void SpaceTopics::Finish(int64_t log_us) {
  if (timer_.changed()) WriteAll(log_us);
}

void SpaceTopics::WriteAll(int64_t log_us) {
  timer_.MarkWritten(log_us);
  if (Newest() == nullptr) return;
  const OccupancyMap cells = CellsForPeople(*Newest(), options_.most_points);
  file_.Write("/map/occupied", {log_us, utime_}, CellsMessage(cells, CellState::kOccupied, utime_));
  file_.Write("/map/free", {log_us, utime_}, CellsMessage(cells, CellState::kFree, utime_));
}

}  // namespace vismap
