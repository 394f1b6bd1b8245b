#include "map/surface_reader.h"

#include <algorithm>
#include <utility>

namespace vismap {

const SurfaceVoxels* SurfaceReader::ReadPacked(const Block& block) {
  const auto found = std::find_if(copies_.rbegin(), copies_.rend(),
                                  [&](const Copy& copy) { return copy.block == &block; });
  if (found != copies_.rend()) return found->voxels.get();
  if (spare_.empty()) spare_.push_back(std::make_unique<SurfaceVoxels>());
  copies_.push_back({&block, std::move(spare_.front())});
  spare_.pop_front();
  block.surface.CopyTo(copies_.back().voxels.get());
  return copies_.back().voxels.get();
}

void SurfaceReader::Trim(size_t keep) {
  while (copies_.size() > keep) {
    spare_.push_back(std::move(copies_.front().voxels));
    copies_.pop_front();
  }
}

}  // namespace vismap
