#include "wire/mesh_follower.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "support/random_scenes.h"

namespace vismap {
namespace {

BlockMesh RandomBlock(BlockIndex index, testing_support::RandomNumbers* random) {
  constexpr double kEdge = 0.16;
  BlockMesh block{index, {}};
  const auto count = random->Whole(0, 3) == 0 ? 0 : random->Whole(3, 200);
  const auto coordinate = [&](int32_t corner) {
    return static_cast<float>((corner + random->Whole(0, 1000) / 1000.0) * kEdge);
  };
  for (int i = 0; i < count; ++i) {
    block.mesh.vertices.push_back({{coordinate(index.x), coordinate(index.y), coordinate(index.z)},
                                   Eigen::Vector3f::UnitZ(),
                                   {static_cast<uint8_t>(i), 2, 3},
                                   static_cast<SegmentLabel>(random->Whole(0, 9)),
                                   static_cast<InstanceId>(random->Whole(0, 9)),
                                   static_cast<ClassId>(random->Whole(0, 9)),
                                   static_cast<uint8_t>(random->Whole(0, 255))});
  }
  const auto corner = [&] { return static_cast<uint32_t>(random->Whole(0, count - 1)); };
  for (int i = count == 0 ? 0 : random->Whole(1, 300); i > 0; --i)
    block.mesh.triangles.push_back({corner(), corner(), corner()});
  return block;
}

mesh_delta_t RandomUpdate(int64_t revision, testing_support::RandomNumbers* random) {
  MeshUpdate update;
  update.map_id = "map";
  update.full = revision % 7 == 0;
  update.base_revision = revision - 1;
  update.block_size = 0.16;
  update.mesh.revision = revision;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      if (random->Whole(0, 2) != 0)
        update.mesh.blocks.push_back(RandomBlock({x, y, random->Whole(-1, 1)}, random));
    }
  }
  return Encode(update);
}

bool Same(const MeshVertex& a, const MeshVertex& b) {
  return a.position_W == b.position_W && a.normal_W == b.normal_W && a.color.r == b.color.r &&
         a.color.g == b.color.g && a.color.b == b.color.b && a.segment == b.segment &&
         a.instance == b.instance && a.class_id == b.class_id && a.seen == b.seen;
}

// The naive reference: the state that a follower must have.
struct Expected {
  std::map<BlockIndex, Mesh> blocks;
  MeshDigest digest;

  void Apply(const mesh_delta_t& message) {
    if (message.full) *this = {};
    for (const mesh_block_t& block : message.blocks) {
      BlockMesh decoded = *Decode(block);
      digest.Set(decoded.block, MeshDigest::HashOf(block));
      blocks.erase(decoded.block);
      if (!decoded.mesh.vertices.empty()) blocks[decoded.block] = std::move(decoded.mesh);
    }
  }
  void Compare(const MeshFollower& follower) const {
    EXPECT_EQ(follower.Digest(), digest.Hex());
    EXPECT_EQ(follower.block_count(), blocks.size());
    const Mesh joined = follower.Joined();
    EXPECT_EQ(follower.triangle_count(), joined.triangles.size());
    size_t vertices = 0, triangles = 0;
    for (const auto& [index, mesh] : blocks) {
      ASSERT_LE(vertices + mesh.vertices.size(), joined.vertices.size());
      ASSERT_LE(triangles + mesh.triangles.size(), joined.triangles.size());
      for (const auto& [a, b, c] : mesh.triangles) {
        const auto first = static_cast<uint32_t>(vertices);
        EXPECT_EQ(joined.triangles[triangles++],
                  (std::array<uint32_t, 3>{first + a, first + b, first + c}));
      }
      for (const MeshVertex& vertex : mesh.vertices)
        EXPECT_TRUE(Same(joined.vertices[vertices++], vertex));
    }
    EXPECT_EQ(vertices, joined.vertices.size());
    EXPECT_EQ(triangles, joined.triangles.size());
  }
};

TEST(MeshFollower, EqualsTheUpdatesAppliedNaively) {
  testing_support::RandomNumbers random(12);
  MeshFollower follower;
  Expected expected;
  for (int64_t revision = 0; revision < 30; ++revision) {
    const mesh_delta_t update = RandomUpdate(revision, &random);
    ASSERT_EQ(follower.Apply(update), FollowOutcome::kApplied);
    expected.Apply(update);
    expected.Compare(follower);
  }
  EXPECT_GT(expected.blocks.size(), 10u);
}

TEST(MeshFollower, HowOftenASurfaceWasSeenReachesTheCopyButNotTheDigest) {
  testing_support::RandomNumbers random(4);
  MeshFollower follower;
  mesh_delta_t update = RandomUpdate(7, &random);  // the whole surface
  ASSERT_EQ(follower.Apply(update), FollowOutcome::kApplied);
  const std::string digest = follower.Digest();
  const auto block = std::find_if(update.blocks.begin(), update.blocks.end(),
                                  [](const mesh_block_t& one) { return one.n_vertices > 0; });
  ASSERT_NE(block, update.blocks.end());
  for (uint8_t& seen : block->seen) seen = 77;
  update.full = false;
  update.base_revision = 7;
  update.revision = 8;
  ASSERT_EQ(follower.Apply(update), FollowOutcome::kApplied);
  EXPECT_EQ(follower.Digest(), digest);
  const Mesh joined = follower.Joined();
  EXPECT_GE(std::count_if(joined.vertices.begin(), joined.vertices.end(),
                          [](const MeshVertex& vertex) { return vertex.seen == 77; }),
            block->n_vertices);
  block->red[0] ^= 1;
  update.base_revision = 8;
  update.revision = 9;
  ASSERT_EQ(follower.Apply(update), FollowOutcome::kApplied);
  EXPECT_NE(follower.Digest(), digest);
}

TEST(MeshFollower, InconsistentUpdateChangesNothing) {
  testing_support::RandomNumbers random(13);
  MeshFollower follower;
  Expected expected;
  const mesh_delta_t first = RandomUpdate(0, &random);
  ASSERT_EQ(follower.Apply(first), FollowOutcome::kApplied);
  expected.Apply(first);
  const mesh_delta_t good = RandomUpdate(1, &random);
  ASSERT_GT(good.n_blocks, 2);
  const auto expect_broken = [&](const mesh_delta_t& bad) {
    EXPECT_EQ(follower.Apply(bad), FollowOutcome::kBroken);
    EXPECT_FALSE(Decode(bad));
    expected.Compare(follower);
  };
  for (const auto& corner : {&mesh_block_t::a, &mesh_block_t::b, &mesh_block_t::c}) {
    for (const int beyond : {-1, 0}) {
      mesh_delta_t bad = good;
      for (mesh_block_t& block : bad.blocks) {
        if (block.n_triangles > 0) (block.*corner).back() = beyond < 0 ? -1 : block.n_vertices;
      }
      expect_broken(bad);
    }
  }
  mesh_delta_t swapped = good;
  std::swap(swapped.blocks[0], swapped.blocks[1]);
  expect_broken(swapped);
  mesh_delta_t flat = good;
  flat.blocks[1].edge_m = 0;
  expect_broken(flat);
  mesh_delta_t part = good;
  part.part = part.parts;
  expect_broken(part);
  EXPECT_EQ(follower.Apply(good), FollowOutcome::kApplied);
}

}  // namespace
}  // namespace vismap
