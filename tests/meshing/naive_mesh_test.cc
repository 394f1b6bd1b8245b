// The fast mesh has the naive one's triangles.
#include <gtest/gtest.h>

#include <algorithm>

#include "mapping/integrate.h"
#include "segmentation/segment_frame.h"
#include "support/naive/mesh_block.h"
#include "support/random_scenes.h"

namespace vismap {
namespace {

using testing_support::RandomNumbers;

/// Calls each(map, delta) after every random frame of a map.
template <typename Each>
SemanticMap MapRandomFrames(uint64_t seed, const Each& each) {
  RandomNumbers random(seed);
  const PinholeCamera camera = testing_support::RandomCamera(97, 73, &random);
  SemanticMap map({random.Real(0.03, 0.06), 4});
  for (int i = 0; i < 3; ++i) {
    const SegmentedFrame frame =
        SegmentFrame(testing_support::RandomFrame(camera, &random), nullptr, {});
    const FrameAssociation association = Associate(frame, {map.voxels, map.labels}, {});
    each(map, IntegrateFrame(frame, association, {}, &map));
  }
  return map;
}

MeshingOptions RandomOptions(uint64_t seed) {
  RandomNumbers random(seed);
  MeshingOptions options;
  options.min_weight = random.Real(0, 0.5);
  options.min_observations = random.Whole(1, 3);
  options.jump_fraction = random.Real(0.3, 1.1);
  options.min_component_triangles = 0;
  return options;
}

TEST(MeshBlocks, EqualsTheNaiveOneAfterEveryFrame) {
  size_t triangles = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const MeshingOptions options = RandomOptions(seed);
    MapRandomFrames(seed, [&](const SemanticMap& map, const MapDelta& delta) {
      for (const BlockMesh& block : MeshBlocks(map, delta.changed_blocks, options).blocks) {
        const auto naive = naive::MeshBlock(map, block.block, options);
        EXPECT_EQ(naive::SortedTriangles(block.mesh), naive) << "seed " << seed;
        triangles += naive.size();
      }
    });
  }
  EXPECT_GT(triangles, 1000u);
}

TEST(ExtractMesh, EqualsTheNaiveOne) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const MeshingOptions options = RandomOptions(seed);
    const SemanticMap map = MapRandomFrames(seed, [](const SemanticMap&, const MapDelta&) {});
    const std::vector<BlockIndex> held = map.voxels.SortedIndices();
    std::vector<BlockIndex> blocks;  // with all whose cells reach into those
    for (const BlockIndex& block : held) {
      for (int i = 0; i < 8; ++i)
        blocks.push_back({block.x - (i & 1), block.y - (i >> 1 & 1), block.z - (i >> 2)});
    }
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    std::vector<naive::Triangle> all;
    for (const BlockIndex& block : blocks) {
      const auto part = naive::MeshBlock(map, block, options);
      all.insert(all.end(), part.begin(), part.end());
    }
    std::sort(all.begin(), all.end());
    EXPECT_EQ(naive::SortedTriangles(ExtractMesh(map, options)), all) << "seed " << seed;
  }
}

}  // namespace
}  // namespace vismap
