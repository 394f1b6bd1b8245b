#include "map_tool/map_diff.h"

#include <algorithm>
#include <map>
#include <set>

#include "map/surface_reader.h"

namespace vismap {
namespace {

std::string Text(BlockIndex index) {
  return "(" + std::to_string(index.x) + ", " + std::to_string(index.y) + ", " +
         std::to_string(index.z) + ")";
}

// What differs between two blocks; "" = nothing.
std::string DiffBlocks(const Block& a, const Block& b) {
  if (static_cast<bool>(a.surface) != static_cast<bool>(b.surface))
    return "a surface in one map only";
  if ((a.thin != nullptr) != (b.thin != nullptr) || (a.thin != nullptr && *a.thin != *b.thin))
    return "different hits of thin things";
  if (!a.surface) {
    const bool equal = a.all_free == b.all_free && (a.free != nullptr) == (b.free != nullptr) &&
                       (a.free == nullptr || *a.free == *b.free);
    return equal ? "" : "different free space";
  }
  SurfaceReader reader;
  const SurfaceVoxels& x = *reader.Read(a);
  const SurfaceVoxels& y = *reader.Read(b);
  if (x.distance != y.distance) return "different distances";
  if (x.weight != y.weight) return "different weights";
  if (x.observations != y.observations) return "different observations";
  if (x.color != y.color) return "different colours";
  for (int voxel = 0; voxel < kBlockVoxels; ++voxel) {
    for (int slot = 0; slot < kVoteSlots; ++slot) {
      const LabelVote v = x.Vote(voxel, slot), w = y.Vote(voxel, slot);
      if (v.label != w.label || v.votes != w.votes) return "different label votes";
    }
  }
  return "";
}

struct Difference {
  size_t blocks = 0;
  BlockIndex first;
};

void DiffVoxels(const VoxelMap& a, const VoxelMap& b, std::vector<std::string>& sentences) {
  std::map<std::string, Difference> differences;
  const auto count = [&](const std::string& what, BlockIndex index) {
    Difference& difference = differences[what];
    if (difference.blocks++ == 0) difference.first = index;
  };
  for (const BlockIndex index : a.SortedIndices()) {
    const Block* other = b.Find(index);
    if (other == nullptr) {
      count("exist only in the first map", index);
    } else if (const std::string what = DiffBlocks(*a.Find(index), *other); !what.empty()) {
      count("have " + what, index);
    }
  }
  for (const BlockIndex index : b.SortedIndices()) {
    if (a.Find(index) == nullptr) count("exist only in the second map", index);
  }
  for (const auto& [what, difference] : differences) {
    sentences.push_back(std::to_string(difference.blocks) + " blocks " + what + "; the first is " +
                        Text(difference.first));
  }
}

void DiffLabels(const LabelTable& a, const LabelTable& b, std::vector<std::string>& sentences) {
  const size_t common = std::min(a.records().size(), b.records().size());
  size_t count = 0, first = 0;
  for (size_t i = 0; i < common; ++i) {
    if (a.records()[i] == b.records()[i]) continue;
    if (count++ == 0) first = i + 1;
  }
  if (a.records().size() != b.records().size()) {
    sentences.push_back("number of segment labels: " + std::to_string(a.records().size()) +
                        " and " + std::to_string(b.records().size()));
  }
  if (count > 0) {
    sentences.push_back(std::to_string(count) +
                        " segment labels have different records; the first is " +
                        std::to_string(first));
  }
  if (a.pairs() != b.pairs()) sentences.push_back("the evidence for merging labels differs");
  if (a.next_instance() != b.next_instance()) {
    sentences.push_back("number of instances: " + std::to_string(Raw(a.next_instance()) - 1) +
                        " and " + std::to_string(Raw(b.next_instance()) - 1));
  }
}

}  // namespace

std::vector<std::string> DiffMaps(const LoadedMap& a, const LoadedMap& b) {
  std::vector<std::string> sentences;
  if (a.map_hash == b.map_hash) return sentences;
  const auto compare = [&](const char* what, auto x, auto y) {
    if (x != y)
      sentences.push_back(std::string(what) + ": " + std::to_string(x) + " and " +
                          std::to_string(y));
  };
  compare("voxel size [m]", a.map.voxels.voxel_size(), b.map.voxels.voxel_size());
  compare("truncation [m]", a.map.voxels.truncation(), b.map.voxels.truncation());
  compare("frames", a.map.revision, b.map.revision);
  compare("utime of the last frame [us]", a.map.last_utime, b.map.last_utime);
  DiffVoxels(a.map.voxels, b.map.voxels, sentences);
  DiffLabels(a.map.labels, b.map.labels, sentences);
  if (sentences.empty())
    sentences.push_back("the hashes differ: " + a.map_hash + " and " + b.map_hash);
  return sentences;
}

}  // namespace vismap
