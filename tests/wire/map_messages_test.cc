#include <gtest/gtest.h>

#include <set>
#include <string>

#include "wire/map_follower.h"
#include "wire/map_update.h"
#include "wire/mesh_update.h"
#include "wire/object_list.h"
#include "wire/octree_message.h"

namespace vismap {
namespace {

using Outcome = FollowOutcome;

BlockOccupancy FreeBlock() { return BlockOccupancy(CellState::kFree); }

// Updates of a map that gains one free block per revision.
MapUpdate UpdateTo(int64_t revision) {
  MapUpdate update{revision * 100, "map", revision, revision - 1, 0, 1, {0.01, false, {}}};
  update.delta.blocks.emplace_back(BlockIndex{static_cast<int32_t>(revision), 0, 0}, FreeBlock());
  return update;
}

MapUpdate SnapshotAt(int64_t revision) {
  MapUpdate update{revision * 100, "map", revision, -1, 0, 1, {0.01, true, {}}};
  for (int32_t i = 1; i <= revision; ++i)
    update.delta.blocks.emplace_back(BlockIndex{i, 0, 0}, FreeBlock());
  return update;
}

std::string DigestAt(int64_t revision) {
  OccupancyMap map(0.01);
  EXPECT_TRUE(map.Apply(SnapshotAt(revision).delta));
  return map.Digest();
}

TEST(MapUpdate, DecodeInvertsEncode) {
  const MapUpdate update = SnapshotAt(5);
  const Result<MapUpdate> decoded = Decode(Encode(update));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->delta, update.delta);
  EXPECT_EQ(decoded->revision, 5);
  EXPECT_EQ(decoded->map_id, "map");
}

TEST(MapUpdate, DamagedPayloadIsAnError) {
  const map_delta_t good = Encode(SnapshotAt(5));
  for (size_t i = 0; i < good.payload.size(); ++i) {
    map_delta_t bad = good;
    bad.payload[i] ^= 0x41;
    const Result<MapUpdate> decoded = Decode(bad);
    if (decoded) {
      EXPECT_EQ(decoded->delta.blocks.size(), 5u);
    }
    bad = good;
    bad.payload.resize(i);
    bad.payload_size = static_cast<int32_t>(i);
    EXPECT_FALSE(Decode(bad));
  }
  map_delta_t bad = good;
  bad.n_blocks = 4;
  EXPECT_FALSE(Decode(bad));
  bad = good;
  bad.part = 1;
  EXPECT_FALSE(Decode(bad));
}

TEST(MapFollower, AppliesConsecutiveUpdates) {
  MapFollower follower;
  EXPECT_EQ(follower.Apply(SnapshotAt(2)), Outcome::kApplied);
  EXPECT_EQ(follower.Apply(UpdateTo(3)), Outcome::kApplied);
  EXPECT_EQ(follower.Apply(UpdateTo(3)), Outcome::kIgnored);
  EXPECT_EQ(follower.position().revision, 3);
  EXPECT_EQ(follower.occupancy()->Digest(), DigestAt(3));
}

TEST(MapFollower, KeepsItsStateAndNeedsASnapshotWhenAnUpdateIsMissing) {
  MapFollower follower;
  EXPECT_EQ(follower.Apply(UpdateTo(1)), Outcome::kNeedsSnapshot);
  follower.Apply(SnapshotAt(2));
  EXPECT_EQ(follower.Apply(UpdateTo(4)), Outcome::kNeedsSnapshot);
  EXPECT_FALSE(follower.in_sync());
  EXPECT_EQ(follower.occupancy()->Digest(), DigestAt(2));
  EXPECT_EQ(follower.Apply(UpdateTo(5)), Outcome::kNeedsSnapshot);
  EXPECT_EQ(follower.gaps(), 1);
  EXPECT_EQ(follower.Apply(SnapshotAt(5)), Outcome::kApplied);
  EXPECT_EQ(follower.Apply(UpdateTo(6)), Outcome::kApplied);
  EXPECT_EQ(follower.occupancy()->Digest(), DigestAt(6));
}

TEST(MapFollower, AppliesAnUpdateWhenAllItsPartsHaveArrived) {
  MapFollower follower;
  const std::vector<MapUpdate> parts = SplitUpdate(SnapshotAt(7), 3);
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_EQ(follower.Apply(parts[0]), Outcome::kWaiting);
  EXPECT_EQ(follower.Apply(parts[2]), Outcome::kWaiting);  // the middle is missing
  EXPECT_FALSE(follower.occupancy());
  EXPECT_EQ(follower.Apply(UpdateTo(8)), Outcome::kNeedsSnapshot);
  EXPECT_EQ(follower.Apply(parts[1]), Outcome::kApplied)
      << "the last part is the first to complete";
  EXPECT_TRUE(follower.in_sync());
  EXPECT_EQ(follower.occupancy()->Digest(), DigestAt(7));
}

TEST(MapFollower, NewMapNeedsItsOwnSnapshot) {
  MapFollower follower;
  follower.Apply(SnapshotAt(2));
  MapUpdate other = UpdateTo(3);
  other.map_id = "another";
  EXPECT_EQ(follower.Apply(other), Outcome::kNeedsSnapshot);
  MapUpdate snapshot = SnapshotAt(1);
  snapshot.map_id = "another";
  EXPECT_EQ(follower.Apply(snapshot), Outcome::kApplied);
  EXPECT_EQ(follower.position().map_id, "another");
  EXPECT_EQ(follower.occupancy()->Digest(), DigestAt(1));
}

TEST(MapFollower, ReportsChangedBlocksAndEverythingAfterASnapshot) {
  MapFollower follower;
  EXPECT_TRUE(follower.ConsumeChanges().everywhere);
  EXPECT_TRUE(follower.ConsumeChanges().everywhere) << "there is no map yet";
  follower.Apply(SnapshotAt(2));
  const OccupancyChanges first = follower.ConsumeChanges();
  EXPECT_TRUE(first.everywhere);
  EXPECT_TRUE(first.blocks.empty());
  EXPECT_TRUE(follower.ConsumeChanges().blocks.empty());

  std::set<BlockIndex> changed;
  for (int64_t revision = 3; revision < 9; ++revision) {
    follower.Apply(UpdateTo(revision));
    for (const auto& entry : UpdateTo(revision).delta.blocks) changed.insert(entry.first);
  }
  const OccupancyChanges after = follower.ConsumeChanges();
  EXPECT_FALSE(after.everywhere);
  EXPECT_EQ(after.blocks, std::vector<BlockIndex>(changed.begin(), changed.end()));
  EXPECT_FALSE(after.blocks.empty());
  follower.Apply(UpdateTo(20));
  EXPECT_TRUE(follower.ConsumeChanges().blocks.empty()) << "it was not applied";
  follower.Apply(SnapshotAt(20));
  follower.Apply(UpdateTo(21));
  EXPECT_TRUE(follower.ConsumeChanges().everywhere);
}

TEST(MeshUpdate, PositionsAreExactToAHundredthOfAVoxelAndIdsExactly) {
  MeshUpdate update{7, "map", 3, false, 0, 1, 0.08, {4, {}}};
  BlockMesh block{{-2, 0, 5}, {}};
  for (int i = 0; i < 3; ++i) {
    MeshVertex vertex;
    vertex.position_W = {-0.16F + 0.03F * static_cast<float>(i), 0.079F, 0.41F};
    vertex.normal_W = Eigen::Vector3f(1, 2, static_cast<float>(i)).normalized();
    vertex.color = {1, 2, 250};
    vertex.segment = SegmentLabel{123456};
    vertex.instance = InstanceId{70000};
    vertex.class_id = ClassId{62};
    vertex.seen = static_cast<uint8_t>(253 + i);
    block.mesh.vertices.push_back(vertex);
  }
  block.mesh.triangles.push_back({0, 1, 2});
  update.mesh.blocks.push_back(block);
  const mesh_delta_t message = Encode(update);
  const Result<MeshUpdate> decoded = Decode(message);
  ASSERT_TRUE(decoded) << decoded.error().message;
  for (size_t i = 0; i < 3; ++i) {
    const MeshVertex& a = block.mesh.vertices[i];
    const MeshVertex& b = decoded->mesh.blocks[0].mesh.vertices[i];
    EXPECT_LT((a.position_W - b.position_W).norm(), 1e-5);
    EXPECT_LT((a.normal_W - b.normal_W).norm(), 0.01);
    EXPECT_EQ(a.segment, b.segment);
    EXPECT_EQ(a.instance, b.instance);
    EXPECT_EQ(a.class_id, b.class_id);
    EXPECT_EQ(a.seen, b.seen);
  }
  mesh_delta_t bad = message;
  bad.blocks[0].c[0] = 3;
  EXPECT_FALSE(Decode(bad));
  bad = message;
  bad.blocks.push_back(bad.blocks[0]);
  bad.n_blocks = 2;
  EXPECT_FALSE(Decode(bad));
}

TEST(ObjectList, DecodeInvertsEncodeButLeavesOutStructure) {
  ObjectList list{5, "map", 9, {}};
  ObjectSummary chair;
  chair.instance = InstanceId{3};
  chair.class_id = ClassId{62};
  chair.score = 0.75;
  chair.segments = {SegmentLabel{1}, SegmentLabel{8}};
  chair.points = 100;
  chair.area = 0.5;
  chair.class_probability = {{ClassId{62}, 0.75}, {ClassId{63}, 0.25}};
  ObjectSummary gone = chair;
  gone.instance = InstanceId{5};
  gone.state = ObjectState::kRemoved;
  gone.removed_utime = 77;
  chair.box.center_W = {1, 2, 3};
  chair.box.size = {0.5, 0.4, 0.9};
  ObjectSummary wall;
  wall.segments = {SegmentLabel{2}};
  wall.structure = StructureKind::kWall;
  list.objects = {chair, wall, gone};
  const object_list_t message = Encode(list, [](ClassId) { return std::string("chair"); });
  const Result<ObjectList> decoded = Decode(message);
  ASSERT_TRUE(decoded) << decoded.error().message;
  ASSERT_EQ(decoded->objects.size(), 2u);
  EXPECT_EQ(decoded->objects[0].class_probability, chair.class_probability);
  EXPECT_EQ(decoded->objects[0].area, chair.area);
  EXPECT_FALSE(decoded->objects[0].removed());
  EXPECT_TRUE(decoded->objects[1].removed());
  EXPECT_EQ(decoded->objects[1].removed_utime, 77);
  EXPECT_EQ(decoded->objects[0].instance, InstanceId{3});
  EXPECT_EQ(decoded->objects[0].segments, chair.segments);
  EXPECT_EQ(decoded->objects[0].box.size, chair.box.size);
  object_list_t bad = message;
  bad.objects[0].score = 2;
  EXPECT_FALSE(Decode(bad));
  bad = message;
  bad.objects[0].class_ids[0] = 0;
  EXPECT_FALSE(Decode(bad));
  bad = message;
  bad.objects[0].class_probabilities[1] = 1.5F;
  EXPECT_FALSE(Decode(bad));
  bad = message;
  bad.objects[0].orientation[0] = 7;
  EXPECT_FALSE(Decode(bad));
}

TEST(OctreeMessage, RejectsADamagedStream) {
  OccupancyMap map(0.01);
  map.Set({0, 0, 0}, BlockOccupancy(CellState::kFree));
  map.Set({1, 0, 0}, BlockOccupancy(CellState::kOccupied));
  Result<OctreeBytes> octree = BuildOctree(map, {});
  ASSERT_TRUE(octree);
  OctreeMessage whole;
  whole.map_id = "map";
  whole.published_utime = 5;
  whole.octree = *octree;
  whole.inflated_by = 0.2;
  whole.assumed_free = {{1, 2, -3}, {4, 5, 6}};
  const octree_t message = Encode(whole);
  const Result<OctreeMessage> decoded = Decode(message);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->octree.bytes, octree->bytes);
  EXPECT_EQ(decoded->octree.shell_m, octree->shell_m);
  EXPECT_EQ(decoded->published_utime, 5);
  EXPECT_EQ(decoded->inflated_by, 0.2);
  EXPECT_EQ(decoded->assumed_free, whole.assumed_free);
  octree_t bad = message;
  bad.data.pop_back();
  bad.data_size = static_cast<int32_t>(bad.data.size());
  EXPECT_FALSE(Decode(bad));
  bad = message;
  bad.resolution_m = 0.07;
  EXPECT_FALSE(Decode(bad));
}

}  // namespace
}  // namespace vismap
