#include "exports/explain_cell.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "map/surface_reader.h"
#include "objects/read_out.h"

namespace vismap {
namespace {

using CellJson = nlohmann::ordered_json;

/// What a voxel holds.
struct Cell {
  const Block* block = nullptr;  ///< nullptr = unseen
  int offset = 0;                ///< of the voxel in it
  const SurfaceVoxels* voxels = nullptr;
  CellState state = CellState::kUnknown;
  double distance_m = 0, weight = 0;  ///< of `voxels`
  int observations = 0;
  int thin_hits = 0;
};

const char* NameOf(CellState state) {
  switch (state) {
    case CellState::kFree:
      return "free";
    case CellState::kOccupied:
      return "occupied";
    case CellState::kUnknown:
      break;
  }
  return "unknown";
}

const char* KindOf(const Block* block) {
  if (block == nullptr) return "unseen";
  if (block->surface) return "surface";
  if (block->all_free) return "all_free";
  return block->free ? "partly_free" : "unseen";
}

Cell CellAt(const SemanticMap& map, const OccupancyOptions& options, VoxelIndex index,
            SurfaceReader* reader) {
  Cell cell;
  cell.block = map.voxels.Find(BlockOf(index));
  cell.offset = OffsetInBlock(index);
  if (cell.block == nullptr) return cell;
  const Block& block = *cell.block;
  const auto offset = static_cast<size_t>(cell.offset);
  cell.state = ClassifyBlock(block, map.voxels.options(), options).At(cell.offset);
  cell.voxels = reader->Read(block);
  if (block.thin) cell.thin_hits = block.thin->hits[offset];
  if (cell.voxels != nullptr) {
    cell.distance_m = static_cast<double>(cell.voxels->distance[offset]) / kTruncationSteps *
                      map.voxels.truncation();
    cell.weight = static_cast<double>(cell.voxels->weight[offset]) / kWeightScale;
    cell.observations = cell.voxels->observations[offset];
  } else if (block.all_free) {
    cell.observations = 2;
  } else if (block.free) {
    cell.observations = block.free->SeenOnce(cell.offset) + block.free->SeenTwice(cell.offset);
  }
  return cell;
}

std::string Metres(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4f m", value);
  return text;
}

std::string WhySurface(const Cell& cell, const OccupancyOptions& options, double voxel_size) {
  const std::string distance = "its signed distance is " + Metres(cell.distance_m);
  if (cell.weight <= 0 || cell.observations < options.min_observations)
    return "frames that have seen it: " + std::to_string(cell.observations) +
           ", needed: " + std::to_string(options.min_observations);
  if (cell.state == CellState::kOccupied)
    return distance + ", at most " + Metres(options.occupied_max_voxels * voxel_size);
  if (cell.state == CellState::kFree)
    return distance + ", at least " + Metres(options.free_min_voxels * voxel_size) +
           " before the surface";
  return distance + ", between the limits of occupied and free space, " +
         Metres(options.occupied_max_voxels * voxel_size) + " and " +
         Metres(options.free_min_voxels * voxel_size);
}

std::string Why(const Cell& cell, const OccupancyOptions& options, double voxel_size) {
  if (options.thin_hits > 0 && cell.thin_hits >= options.thin_hits)
    return "the depth of something thin ended in it in " + std::to_string(cell.thin_hits) +
           " frames";
  if (cell.voxels != nullptr) return WhySurface(cell, options, voxel_size);
  if (cell.observations == 0) return "no frame has seen it";
  if (cell.state == CellState::kFree)
    return "rays passed it, and it is farther from all surfaces than the truncation distance";
  return "rays of one frame passed it, and " + std::to_string(options.min_observations) +
         " frames are needed";
}

CellJson LabelsOf(const Cell& cell, const LabelTable& labels, std::span<const ShownLabel> shown,
                  const ClassNamer& class_name) {
  CellJson list = CellJson::array();
  if (cell.voxels == nullptr) return list;
  for (int slot = 0; slot < kVoteSlots; ++slot) {
    const LabelVote vote = cell.voxels->Vote(cell.offset, slot);
    if (vote.label == SegmentLabel::kNone) continue;
    const ShownLabel& as = shown[Raw(vote.label)];
    list.push_back({{"label", Raw(vote.label)},
                    {"shown_as", Raw(labels.Canonical(vote.label))},
                    {"votes", vote.votes},
                    {"instance", Raw(as.instance)},
                    {"class", Raw(as.class_id)},
                    {"class_name", class_name(as.class_id)}});
  }
  return list;
}

ShownLabel ShownAt(const Cell& cell, const LabelTable& labels, std::span<const ShownLabel> shown) {
  if (cell.voxels == nullptr) return {};
  std::array<LabelVote, kVoteSlots> votes;
  for (int slot = 0; slot < kVoteSlots; ++slot) {
    LabelVote& vote = votes[static_cast<size_t>(slot)];
    vote = cell.voxels->Vote(cell.offset, slot);
    if (vote.label != SegmentLabel::kNone) vote.label = labels.Canonical(vote.label);
  }
  const SegmentLabel strongest = StrongestLabel(votes);
  return strongest == SegmentLabel::kNone ? ShownLabel{} : shown[Raw(strongest)];
}

CellJson LastFrame(const Cell& cell, const MapMetadata& metadata) {
  if (cell.block == nullptr || cell.block->last_used == 0) return nullptr;
  const uint32_t revision = cell.block->last_used;
  CellJson json{{"revision", revision}};
  if (revision > metadata.trajectory.size()) return json;
  const CameraPose& pose = metadata.trajectory[revision - 1];
  json["camera_id"] = Raw(pose.camera_id);
  json["utime"] = pose.utime;
  return json;
}

CellJson Triple(double x, double y, double z) { return {x, y, z}; }

}  // namespace

Result<std::string> ExplainCell(const SemanticMap& map, const MapMetadata& metadata,
                                const OccupancyOptions& options, const Eigen::Vector3d& p_W,
                                const ClassNamer& class_name) {
  constexpr double kFarthest = 1e5;  // [m]
  if (!p_W.allFinite() || p_W.cwiseAbs().maxCoeff() > kFarthest)
    return Fail("a point must have three finite numbers of at most 100000 m");
  const double v = map.voxels.voxel_size();
  const Eigen::Vector3d floor = (p_W / v).array().floor();
  const VoxelIndex index{static_cast<int32_t>(floor.x()), static_cast<int32_t>(floor.y()),
                         static_cast<int32_t>(floor.z())};
  SurfaceReader reader;
  const Cell cell = CellAt(map, options, index, &reader);
  const std::vector<ShownLabel> shown = ShowLabels(map.labels);
  CellJson json{{"map_id", metadata.map_id}, {"revision", map.revision}};
  json["at"] = Triple(p_W.x(), p_W.y(), p_W.z());
  json["voxel"] = {index.x, index.y, index.z};
  json["center"] = Triple((index.x + 0.5) * v, (index.y + 0.5) * v, (index.z + 0.5) * v);
  json["state"] = NameOf(cell.state);
  json["why"] = Why(cell, options, v);
  json["block"] = KindOf(cell.block);
  const bool near = cell.voxels != nullptr && cell.weight > 0;
  json["distance_m"] = near ? CellJson(cell.distance_m) : CellJson(nullptr);
  json["weight"] = near ? CellJson(cell.weight) : CellJson(nullptr);
  json["observations"] = cell.observations;
  json["thin_hits"] = cell.thin_hits;
  json["color"] = nullptr;
  if (near) {
    const Rgb8 color = cell.voxels->color[static_cast<size_t>(cell.offset)];
    json["color"] = {color.r, color.g, color.b};
  }
  json["labels"] = LabelsOf(cell, map.labels, shown, class_name);
  const ShownLabel as = ShownAt(cell, map.labels, shown);
  json["shown"] = {{"segment", Raw(as.segment)},
                   {"instance", Raw(as.instance)},
                   {"class", Raw(as.class_id)},
                   {"class_name", class_name(as.class_id)}};
  json["last_frame"] = LastFrame(cell, metadata);
  return json.dump(-1, ' ', false, CellJson::error_handler_t::replace);
}

}  // namespace vismap
