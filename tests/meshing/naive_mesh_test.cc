// The fast mesh has the same triangles, colours and labels as the naive one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <memory>

#include "mapping/integrate.h"
#include "segmentation/segment_frame.h"
#include "support/followed_mesh.h"
#include "support/mesh_blocks.h"
#include "support/naive/mesh_block.h"
#include "support/naive/vertex_look.h"
#include "support/random_scenes.h"

namespace vismap {
namespace {

using testing_support::MeshBlocks;
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
      for (const BlockMesh& block :
           MeshBlocks(map, delta.changes(), ShowSegments(map.labels), options)) {
        const auto naive = naive::MeshBlock(map, block.block, options);
        EXPECT_EQ(naive::SortedTriangles(block.mesh), naive) << "seed " << seed;
        triangles += naive.size();
      }
    });
  }
  EXPECT_GT(triangles, 1000u);
}

// Changes a voxel at random.
void Change(size_t voxel, RandomNumbers* random, SurfaceVoxels& voxels) {
  voxels.distance[voxel] = static_cast<int16_t>(random->Whole(-20000, 20000));
  voxels.weight[voxel] = static_cast<uint16_t>(random->Whole(0, 500));
  voxels.observations[voxel] = 9;
  voxels.color[voxel] = {static_cast<uint8_t>(random->Whole(0, 255)), 1, 2};
  voxels.slot_label[voxel] = {};
  if (!random->Chance(0.1)) return;  // so that vertices look for votes beside their edge
  voxels.slot_label[voxel][0] = static_cast<uint8_t>(random->Whole(1, 9));
  voxels.slot_votes[voxel][0] = 200;
}

TEST(AffectedBy, CoversTheSurfacesThatAVoxelChanges) {
  // All voxels are seen and near the surface, so that each affects the mesh.
  RandomNumbers random(8);
  SemanticMap map({0.05, 4});
  std::vector<BlockIndex> blocks;
  for (int i = 0; i < 27; ++i) {
    blocks.push_back({i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1});
    SurfaceVoxels& voxels =
        *(map.voxels.FindOrCreate(blocks.back()).surface = std::make_unique<SurfaceVoxels>());
    for (int label = 1; label <= 9; ++label)
      voxels.palette.push_back(static_cast<SegmentLabel>(label));
    for (size_t voxel = 0; voxel < kBlockVoxels; ++voxel) Change(voxel, &random, voxels);
  }
  const auto mesh_all = [&] { return MeshEachBlock(map, blocks, {}); };
  std::vector<BlockMesh> before = mesh_all();
  NeighbourBits affected_once = 0;
  const auto at = [&] { return std::array{0, 1, 4, 7}[static_cast<size_t>(random.Whole(0, 3))]; };
  for (int round = 0; round < 1000; ++round) {
    const auto voxel = static_cast<size_t>(LinearIndex(at(), at(), at()));
    VoxelBits changed{};
    changed[voxel / 64] = uint64_t{1} << (voxel % 64);
    Change(voxel, &random, *map.voxels.FindMutable({0, 0, 0})->surface);
    std::vector<BlockMesh> after = mesh_all();
    NeighbourBits differ = 0;
    for (size_t i = 0; i < blocks.size(); ++i) {
      const Mesh &a = before[i].mesh, &b = after[i].mesh;
      const bool same = a.triangles == b.triangles &&
                        std::ranges::equal(a.vertices, b.vertices, testing_support::SameVertex);
      const auto& [x, y, z] = blocks[i];
      if (!same) differ |= NeighbourBits{1} << NeighbourSlot(x, y, z);
    }
    EXPECT_EQ(differ & ~AffectedBy(changed), 0u) << "voxel " << voxel;
    affected_once |= differ;
    before = std::move(after);
  }
  // Some neighbours use only votes of this block, and seldom.
  EXPECT_GE(std::popcount(affected_once), 22);
}

TEST(BlocksToMesh, HasEveryBlockWhoseSurfaceDiffersAfterAFrame) {
  size_t surfaces = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    testing_support::FollowedMesh followed(RandomOptions(seed));
    MapRandomFrames(seed, [&](const SemanticMap& map, const MapDelta& delta) {
      followed.Follow(map, delta);
      followed.ExpectUpToDate(map);
    });
    surfaces += followed.surfaces();
  }
  EXPECT_GT(surfaces, 100u);
}

TEST(ExtractSurface, EqualsTheNaiveOne) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const MeshingOptions options = RandomOptions(seed);
    const SemanticMap map = MapRandomFrames(seed, [](const SemanticMap&, const MapDelta&) {});
    const std::vector<BlockIndex> held = map.voxels.SortedIndices();
    std::vector<BlockIndex> blocks;  // and all blocks whose cells reach into these
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
    EXPECT_EQ(naive::SortedTriangles(ExtractSurface(map, options)), all) << "seed " << seed;
  }
}

/// A voxel with votes for up to three of six labels; how many depends on the region.
void VoteAtRandom(double chance, int voxel, SurfaceVoxels* voxels, RandomNumbers* random) {
  const auto i = static_cast<size_t>(voxel);
  if (!random->Chance(chance)) return;
  const int labels = random->Chance(0.6) ? 1 : random->Whole(2, 3);
  for (size_t slot = 0; slot < static_cast<size_t>(labels); ++slot) {
    voxels->slot_label[i][slot] = static_cast<uint8_t>(random->Whole(1, 6));
    voxels->slot_votes[i][slot] = static_cast<uint8_t>(random->Whole(1, 4));
  }
}

std::unique_ptr<SurfaceVoxels> RandomVoxels(RandomNumbers* random) {
  auto voxels = std::make_unique<SurfaceVoxels>();
  voxels->weight.fill(128);
  for (uint32_t label = 1; label <= 6; ++label) voxels->palette.push_back(SegmentLabel{label});
  const double chance = random->Chance(0.3) ? 0 : random->Real(0, 0.3);
  for (int i = 0; i < kBlockVoxels; ++i) {
    const auto at = static_cast<size_t>(i);
    // Mostly before the surface: a cell's edges then seldom share a voxel.
    voxels->distance[at] = static_cast<int16_t>(random->Whole(-12000, 30000));
    voxels->observations[at] = static_cast<uint8_t>(1 + i * 37 % 255);
    const auto byte = [&] { return static_cast<uint8_t>(random->Whole(0, 255)); };
    voxels->color[at] = {byte(), byte(), byte()};
    VoteAtRandom(chance, i, voxels.get(), random);
  }
  return voxels;
}

/// Blocks with random voxels, and between them some that are free, packed or unseen.
SemanticMap RandomVotes(uint64_t seed) {
  RandomNumbers random(seed);
  SemanticMap map({0.01, 4});
  map.labels.GrowLabels(SegmentLabel{7});
  map.labels.Merge(SegmentLabel{2}, SegmentLabel{5});
  for (int i = 0; i < 27; ++i) {
    if (random.Chance(0.1)) continue;
    Block& block = map.voxels.FindOrCreate({i % 3 - 2, i / 3 % 3 - 2, i / 9 - 2});
    if (random.Chance(0.15)) {
      block.all_free = true;
    } else {
      block.surface = RandomVoxels(&random);
      if (random.Chance(0.2)) block.surface.Pack();
    }
  }
  return map;
}

TEST(MeshBlocks, NormalsEqualTheNaiveOnes) {
  const auto compare = [](const SemanticMap& map, const MeshingOptions& options) {
    size_t vertices = 0;
    for (const BlockMesh& block :
         MeshBlocks(map, map.voxels.SortedIndices(), ShowSegments(map.labels), options)) {
      for (const MeshVertex& vertex : block.mesh.vertices) {
        const naive::VertexEdge edge = naive::EdgeOf(vertex, map);
        EXPECT_EQ(vertex.normal_W, naive::NormalAt(edge, map, options))
            << vertex.position_W.transpose();
        ++vertices;
      }
    }
    return vertices;
  };
  MeshingOptions options;
  options.jump_fraction = 2;
  EXPECT_GT(compare(RandomVotes(3), options), 5000u);
  size_t vertices = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const SemanticMap map = MapRandomFrames(seed, [](const SemanticMap&, const MapDelta&) {});
    vertices += compare(map, RandomOptions(seed));
  }
  EXPECT_GT(vertices, 1000u);
}

TEST(MeshBlocks, ColoursLabelsAndCountsEqualTheNaiveOnes) {
  size_t unlabelled = 0, beyond_the_ends = 0;
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    const SemanticMap map = RandomVotes(seed);
    MeshingOptions options;
    options.jump_fraction = 2;
    for (const BlockMesh& block :
         MeshBlocks(map, map.voxels.SortedIndices(), ShowSegments(map.labels), options)) {
      for (const MeshVertex& vertex : block.mesh.vertices) {
        const naive::VertexEdge edge = naive::EdgeOf(vertex, map);
        ASSERT_EQ(vertex.color, naive::ColorAt(edge, map)) << vertex.position_W.transpose();
        ASSERT_EQ(vertex.seen, naive::SeenAt(edge, map)) << vertex.position_W.transpose();
        ASSERT_GT(vertex.seen, 0);
        const SegmentLabel label = naive::LabelAt(edge, map);
        ASSERT_EQ(vertex.segment, label) << vertex.position_W.transpose();
        unlabelled += label == SegmentLabel::kNone ? 1 : 0;
        beyond_the_ends += naive::LabelAtEnds(edge, map) != label ? 1 : 0;
      }
    }
  }
  EXPECT_GT(unlabelled, 500u);
  EXPECT_GT(beyond_the_ends, 5000u);
}

}  // namespace
}  // namespace vismap
