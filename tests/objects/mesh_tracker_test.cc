#include "objects/mesh_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "objects/read_out.h"
#include "support/analytic_room.h"

namespace vismap {
namespace {

using testing_support::AnalyticRoom;
using testing_support::kBall;
using testing_support::kBoxLeft;

/// A follower that misses nothing: the newest mesh of every block that has a surface.
class Follower {
 public:
  MeshTracker::Receiver Receive() {
    return [this](MeshPart part) {
      if (part.part == 0 && part.base_revision < 0) meshes_.clear();
      EXPECT_TRUE(part.base_revision < 0 || part.base_revision == revision_);
      if (part.part + 1 == part.parts) revision_ = part.revision;
      last_blocks_ = 0;
      for (BlockMesh& block : part.blocks) Set(std::move(block));
    };
  }
  int64_t revision() const { return revision_; }
  size_t last_blocks() const { return last_blocks_; }  ///< blocks of the last part

  void ExpectSurfaceOf(const SemanticMap& map) const {
    const auto all = MeshEachBlock(map, map.voxels.SortedIndices(), ShowLabels(map.labels));
    size_t with_surface = 0;
    for (const BlockMesh& block : all) {
      if (block.mesh.triangles.empty()) continue;
      ++with_surface;
      ASSERT_TRUE(meshes_.contains(block.block));
      EXPECT_EQ(meshes_.at(block.block).triangles, block.mesh.triangles);
      ExpectSameVertices(meshes_.at(block.block).vertices, block.mesh.vertices);
    }
    EXPECT_EQ(meshes_.size(), with_surface);
  }

 private:
  static void ExpectSameVertices(const std::vector<MeshVertex>& a,
                                 const std::vector<MeshVertex>& b) {
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end(),
                           [](const MeshVertex& x, const MeshVertex& y) {
                             return x.position_W == y.position_W && x.segment == y.segment &&
                                    x.instance == y.instance && x.class_id == y.class_id;
                           }));
  }
  void Set(BlockMesh block) {
    ++last_blocks_;
    if (block.mesh.triangles.empty()) {
      meshes_.erase(block.block);
    } else {
      meshes_[block.block] = std::move(block.mesh);
    }
  }

  std::map<BlockIndex, Mesh> meshes_;
  int64_t revision_ = -1;
  size_t last_blocks_ = 0;
};

/// Takes the surface out of the blocks that lie above z = 0.3 m; returns them.
std::vector<BlockIndex> RemoveWhatIsHigh(SemanticMap* map) {
  std::vector<BlockIndex> changed;
  for (const BlockIndex& index : map->voxels.SortedIndices()) {
    Block& block = *map->voxels.FindMutable(index);
    if (index.z * map->voxels.block_size() < 0.3 || !block.surface) continue;
    block.surface = nullptr;
    block.all_free = true;
    changed.push_back(index);
  }
  ++map->revision;
  return changed;
}

TEST(MeshTracker, UpdatesGiveTheSurfaceOfTheMap) {
  SemanticMap map = AnalyticRoom();
  MeshTracker tracker({});
  Follower follower;
  tracker.Start(map);
  EXPECT_EQ(tracker.revision(), -1);
  EXPECT_TRUE(tracker.has_changes());
  tracker.MeshChanges(map, follower.Receive());
  EXPECT_FALSE(tracker.has_changes());
  EXPECT_EQ(follower.revision(), map.revision);
  follower.ExpectSurfaceOf(map);
  const size_t whole = follower.last_blocks();

  const std::vector<BlockIndex> changed = RemoveWhatIsHigh(&map);
  ASSERT_FALSE(changed.empty());
  tracker.AddChanges(map, changed, {});
  tracker.MeshChanges(map, follower.Receive());
  follower.ExpectSurfaceOf(map);
  EXPECT_GT(follower.last_blocks(), 0u);
  EXPECT_LT(follower.last_blocks(), whole);
  ++map.revision;
  tracker.MeshChanges(map, follower.Receive());
  EXPECT_EQ(follower.last_blocks(), 0u) << "nothing has changed since";
  EXPECT_EQ(follower.revision(), map.revision);
}

TEST(MeshTracker, BlocksWhoseLabelsShowSomethingElseAreMeshedAgain) {
  SemanticMap map = AnalyticRoom();
  MeshTracker tracker({});
  Follower follower;
  tracker.Start(map);
  tracker.MeshChanges(map, follower.Receive());
  ++map.revision;
  testing_support::AddEvidence(&map, kBall, InstanceId{6}, ClassId{37}, 40, 40);
  tracker.MeshChanges(map, follower.Receive());
  EXPECT_GT(follower.last_blocks(), 0u);
  follower.ExpectSurfaceOf(map);
  ++map.revision;
  const std::pair<SegmentLabel, SegmentLabel> merged(kBall, kBoxLeft);
  map.labels.Merge(kBall, kBoxLeft);
  tracker.AddChanges(map, std::span<const BlockIndex>(), std::span(&merged, 1));
  tracker.MeshChanges(map, follower.Receive());
  EXPECT_GT(follower.last_blocks(), 0u);
  follower.ExpectSurfaceOf(map);
}

TEST(MeshTracker, ALateFollowerGetsWhatItLacks) {
  SemanticMap map = AnalyticRoom();
  MeshTracker tracker({});
  Follower early, late;
  tracker.Start(map);
  tracker.MeshChanges(map, early.Receive());
  tracker.MeshSince(map, early.revision(), early.Receive());
  EXPECT_EQ(early.last_blocks(), 0u);
  const int64_t before = map.revision;
  tracker.AddChanges(map, RemoveWhatIsHigh(&map), {});
  const auto ignore = [](MeshPart) {};
  tracker.MeshChanges(map, ignore);
  ASSERT_EQ(early.revision(), before) << "has missed the last update";
  tracker.MeshSince(map, -1, late.Receive());
  late.ExpectSurfaceOf(map);
  std::vector<MeshPart> parts;
  tracker.MeshSince(map, before, [&](MeshPart part) { parts.push_back(std::move(part)); });
  ASSERT_EQ(parts.size(), 2u) << "an update of nothing, then what is lacking";
  EXPECT_EQ(parts[0].base_revision, map.revision);
  EXPECT_TRUE(parts[0].blocks.empty());
  EXPECT_EQ(parts[1].base_revision, before);
  early.Receive()(std::move(parts[1]));
  early.ExpectSurfaceOf(map);
  tracker.MeshSince(map, map.revision + 1, late.Receive());
  EXPECT_GT(late.last_blocks(), 0u) << "a revision that is not known: everything";
  late.ExpectSurfaceOf(map);
}

TEST(MeshTracker, ALargeSurfaceComesInParts) {
  testing_support::AnalyticScene floor;
  floor.distance = [](const Eigen::Vector3d& p) { return p.z(); };
  const SemanticMap map = testing_support::MakeAnalyticMap(
      floor, {.min_W = {-2, -2, -0.1}, .max_W = {2, 2, 0.1}}, {0.02, 4});
  MeshTracker tracker({});
  Follower follower;
  tracker.Start(map);
  size_t parts = 0, blocks = 0;
  tracker.MeshAll(map, [&](MeshPart part) {
    EXPECT_EQ(part.part, parts++);
    blocks += part.blocks.size();
    follower.Receive()(std::move(part));
  });
  EXPECT_GT(parts, 1u);
  EXPECT_GT(blocks, 512u);
  follower.ExpectSurfaceOf(map);
  size_t of_whole_map = 0;
  MeshWholeMap(map, {}, [&](std::vector<BlockMesh> meshes) {
    for (const BlockMesh& block : meshes) of_whole_map += !block.mesh.triangles.empty();
  });
  EXPECT_EQ(of_whole_map, blocks);
}

TEST(MeshTracker, KeepsTheSurfaceAndTheBlocksOfEachLabel) {
  const SemanticMap map = AnalyticRoom();
  MeshTracker tracker({});
  tracker.Start(map);
  EXPECT_EQ(tracker.surfaces().AmountOf(kBall).vertices, 0) << "not meshed yet";
  EXPECT_FALSE(tracker.places().BlocksOf(kBall).empty());
  tracker.MeshChanges(map, [](MeshPart) {});
  EXPECT_GT(tracker.surfaces().AmountOf(kBall).vertices, 100);
}

}  // namespace
}  // namespace vismap
