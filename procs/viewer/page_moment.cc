#include "viewer/page_moment.h"

#include <algorithm>

#include "base/digest.h"

namespace vismap {

std::vector<BlockIndex> PageMoment::Show(const Moment& moment) {
  moment_ = moment;
  const auto surface = recording_->SurfaceAt(moment.frames);
  shown_ = Hashes(surface.begin(), surface.end(), 2 * surface.size());
  std::vector<BlockIndex> lacking;
  for (const auto& [index, hash] : surface) {
    const auto sent = sent_.find(index);
    if (sent == sent_.end() || sent->second != hash) lacking.push_back(index);
  }
  for (const auto& entry : sent_) {
    if (!shown_.contains(entry.first)) lacking.push_back(entry.first);
  }
  std::sort(lacking.begin(), lacking.end());
  return lacking;
}

FrameBytes PageMoment::BytesOf(BlockIndex index) {
  const Result<BlockAtMoment> block = recording_->BlockAt(index, moment_.frames);
  if (!block) problem_ = block.error().message;
  if (!block || block->bytes == nullptr) {
    sent_.erase(index);
    return nullptr;
  }
  sent_[index] = block->hash;
  return block->bytes;
}

std::vector<BlockIndex> PageMoment::SortedIndices() const {
  std::vector<BlockIndex> indices;
  indices.reserve(shown_.size());
  for (const auto& entry : shown_) indices.push_back(entry.first);
  std::sort(indices.begin(), indices.end());
  return indices;
}

MapSummary SummaryOf(const LogRecording& recording, const Moment& moment) {
  MapSummary summary;
  if (moment.frames == 0) return summary;
  summary.map_id = recording.map_id();
  summary.revision = moment.frames;
  summary.utime = moment.utime;
  summary.blocks = moment.blocks;
  summary.triangles = moment.triangles;
  summary.digest = moment.digest;
  Digest digest;  // as MeshDigest::Hex
  digest.Add(static_cast<uint64_t>(moment.blocks));
  digest.Add(moment.digest);
  summary.mesh_digest = digest.Hex();
  summary.voxel_size_m = recording.voxel_size_m();
  summary.block_edge_m = recording.block_edge_m();
  summary.in_sync = true;
  return summary;
}

}  // namespace vismap
