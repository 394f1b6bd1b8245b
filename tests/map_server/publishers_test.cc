#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vismap/map_delta_t.hpp>
#include <vismap/mesh_delta_t.hpp>

#include "map_server/mesh_publisher.h"
#include "map_server/occupancy_publisher.h"
#include "map_server/small_frames.h"
#include "support/analytic_map.h"
#include "wire/map_follower.h"
#include "wire/mesh_follower.h"

// Followers of a stream from which messages are lost at random end with exactly the state of the
// map, and are sent no more than they lack.

namespace vismap {
namespace {

using testing_support::AnalyticScene;
using testing_support::MemoryBus;

/// A map that grows along x by one more sphere per revision, each with a label of its own.
class GrowingMap {
 public:
  explicit GrowingMap(int spheres) : spheres_(spheres) { map_->revision = 0; }

  /// Adds the next sphere; the blocks that changed.
  std::vector<BlockIndex> Grow() {
    const int n = static_cast<int>(map_->revision) % spheres_;
    const Eigen::Vector3d center(0.3 * n, 0, 0);
    AnalyticScene scene;
    scene.distance = [&](const Eigen::Vector3d& p) {
      return testing_support::SphereDistance(p, center, 0.06 + 0.002 * n);
    };
    const auto label = SegmentLabel{static_cast<uint32_t>(n + 1)};
    scene.label = [&](const Eigen::Vector3d&) { return label; };
    SemanticMap one = testing_support::MakeAnalyticMap(
        scene, {center.array() - 0.14, center.array() + 0.14, 5}, {0.02, 4});
    std::vector<BlockIndex> changed;
    for (const BlockIndex& index : one.voxels.SortedIndices()) {
      map_->voxels.FindOrCreate(index) = std::move(*one.voxels.FindMutable(index));
      changed.push_back(index);
    }
    map_->labels.GrowLabels(static_cast<SegmentLabel>(n + 2));
    ++map_->revision;
    return changed;
  }

  /// Takes the last sphere away again, block by block; the blocks that changed.
  std::vector<BlockIndex> Shrink() {
    const double left = 0.3 * static_cast<double>(map_->revision - 1) - 0.15;
    std::vector<BlockIndex> changed;
    for (const BlockIndex& index : map_->voxels.SortedIndices()) {
      if (index.x * map_->voxels.block_size() < left) continue;
      Block& block = *map_->voxels.FindMutable(index);
      block.surface = nullptr;
      block.all_free = true;
      changed.push_back(index);
    }
    ++map_->revision;
    return changed;
  }

  SemanticMap& map() { return *map_; }

 private:
  int spheres_;
  std::unique_ptr<SemanticMap> map_ = std::make_unique<SemanticMap>(VoxelGridOptions{0.02, 4});
};

TEST(OccupancyPublisher, AFollowerThatLosesHalfOfAllMessagesEndsWithTheMap) {
  const std::unique_ptr<Bus> bus = MemoryBus();
  OccupancyPublisher publisher({}, bus.get());
  GrowingMap growing(20);
  publisher.Start(growing.map(), "map");
  MapFollower follower;
  std::mt19937 random(7);
  int64_t applied_blocks = 0;
  bus->Subscribe<map_delta_t>(kMapDeltaChannel, [&](const map_delta_t& message) {
    if (random() % 2 == 0) return;
    if (follower.Apply(*Decode(message)) == FollowOutcome::kApplied)
      applied_blocks += message.n_blocks;
  });
  for (int frame = 0; frame < 20; ++frame) {
    publisher.PublishChanges(growing.map(), growing.Grow());
    if (frame % 3 == 0 && !follower.in_sync())
      publisher.PublishSince(growing.map(), follower.position());
    while (bus->Spin(0)) {
    }
  }
  const auto is_level = [&] {
    return follower.occupancy() && follower.occupancy()->Digest() == publisher.Digest();
  };
  for (int round = 0; round < 100 && !is_level(); ++round) {
    publisher.PublishSince(growing.map(), follower.position());
    while (bus->Spin(0)) {
    }
  }
  EXPECT_TRUE(is_level());
  EXPECT_EQ(follower.position(), (FollowerPosition{"map", 20}));
  EXPECT_GT(follower.gaps(), 0);
  EXPECT_LE(applied_blocks, static_cast<int64_t>(publisher.blocks()) * 2)
      << "what was there already was not sent again and again";
}

TEST(OccupancyPublisher, AHeartbeatTellsThatTheLastUpdateWasLost) {
  const std::unique_ptr<Bus> bus = MemoryBus();
  OccupancyPublisher publisher({}, bus.get());
  GrowingMap growing(3);
  publisher.Start(growing.map(), "map");
  MapFollower follower;
  bool lose = false;
  FollowOutcome last = FollowOutcome::kApplied;
  bus->Subscribe<map_delta_t>(kMapDeltaChannel, [&](const map_delta_t& message) {
    if (!lose) last = follower.Apply(*Decode(message));
  });
  publisher.PublishSnapshot(growing.map());
  bus->Spin(0);
  lose = true;
  publisher.PublishChanges(growing.map(), growing.Grow());
  bus->Spin(0);
  lose = false;
  EXPECT_TRUE(follower.in_sync());
  bus->Every(0.05, [&] { publisher.Heartbeat(); });
  for (int i = 0; i < 100 && follower.in_sync(); ++i) bus->Spin(0.05);
  EXPECT_EQ(last, FollowOutcome::kNeedsSnapshot);
  EXPECT_EQ(follower.gaps(), 1);
}

class MeshStream : public ::testing::Test {
 protected:
  MeshStream() {
    publisher_.Start(growing_.map(), "map");
    bus_->Subscribe<mesh_delta_t>(kMeshDeltaChannel, [this](const mesh_delta_t& message) {
      for (const mesh_block_t& block : message.blocks) empty_blocks_ += block.n_vertices == 0;
      if (random_() % 100 >= lost_percent_) follower_.Apply(message);
    });
  }
  void Deliver() {
    while (bus_->Spin(0)) {
    }
  }
  void Grow() { AddChanges(growing_.Grow()); }
  void AddChanges(std::vector<BlockIndex> changed) {
    MapDelta delta;
    delta.changed_blocks = std::move(changed);
    publisher_.AddChanges(growing_.map(), delta);
  }
  std::string Truth() { return MeshPublisher::DigestOf(growing_.map(), {}); }

  std::unique_ptr<Bus> bus_ = MemoryBus();
  MeshPublisher publisher_{MeshingOptions{}, bus_.get()};
  GrowingMap growing_{12};
  MeshFollower follower_;
  std::mt19937 random_{11};
  unsigned lost_percent_ = 0;
  size_t empty_blocks_ = 0;  // sent
};

TEST_F(MeshStream, UpdatesBlockByBlockGiveTheMeshOfTheWholeMap) {
  for (int frame = 0; frame < 12; ++frame) {
    Grow();
    publisher_.PublishChanges(growing_.map());
    Deliver();
    ASSERT_EQ(follower_.Digest(), Truth()) << frame;
  }
  EXPECT_GT(follower_.block_count(), 12u);
  EXPECT_GT(follower_.Joined().triangles.size(), 1000u);
  EXPECT_EQ(follower_.triangle_count(), follower_.Joined().triangles.size());
}

TEST_F(MeshStream, MergedLabelsAndNewInstancesReachBlocksThatDidNotChange) {
  for (int frame = 0; frame < 4; ++frame) Grow();
  publisher_.PublishChanges(growing_.map());
  Deliver();
  const std::string before = follower_.Digest();
  LabelTable& labels = growing_.map().labels;
  labels.Merge(SegmentLabel{1}, SegmentLabel{3});
  ++growing_.map().revision;
  publisher_.PublishChanges(growing_.map());
  Deliver();
  EXPECT_NE(follower_.Digest(), before);
  EXPECT_EQ(follower_.Digest(), Truth());
  labels.GrowInstances(InstanceId{2});
  LabelRecord& record = labels.MutableRecord(SegmentLabel{2});
  record.frames = record.frames_with_detector = 1;
  record.instance_evidence[InstanceId{1}] = 1;
  record.class_evidence[ClassId{62}] = 1;
  ++growing_.map().revision;
  publisher_.PublishChanges(growing_.map());
  Deliver();
  EXPECT_EQ(follower_.Digest(), Truth());
  bool found = false;
  for (const MeshVertex& vertex : follower_.Joined().vertices)
    found = found || vertex.class_id == ClassId{62};
  EXPECT_TRUE(found);
}

TEST_F(MeshStream, AFollowerThatLosesAThirdOfAllMessagesEndsWithTheMap) {
  lost_percent_ = 33;
  for (int frame = 0; frame < 12; ++frame) {
    Grow();
    publisher_.PublishChanges(growing_.map());
    if (frame % 4 == 3) publisher_.PublishSince(growing_.map(), follower_.position());
    Deliver();
  }
  for (int round = 0; round < 100 && follower_.Digest() != Truth(); ++round) {
    publisher_.PublishSince(growing_.map(), follower_.position());
    Deliver();
  }
  EXPECT_EQ(follower_.Digest(), Truth());
  EXPECT_GT(follower_.gaps(), 0);
}

TEST_F(MeshStream, OnlyBlocksThatLostTheirSurfaceAreSentEmpty) {
  for (int frame = 0; frame < 4; ++frame) {
    Grow();
    publisher_.PublishChanges(growing_.map());
  }
  Deliver();
  empty_blocks_ = 0;  // spheres overwrite parts of earlier ones
  publisher_.PublishAll(growing_.map());
  Deliver();
  EXPECT_EQ(empty_blocks_, 0u);
  const size_t before = follower_.block_count();
  AddChanges(growing_.Shrink());
  publisher_.PublishChanges(growing_.map());
  Deliver();
  EXPECT_EQ(follower_.Digest(), Truth());
  EXPECT_GT(empty_blocks_, 0u);
  EXPECT_EQ(empty_blocks_, before - follower_.block_count());
}

TEST_F(MeshStream, AFollowerThatMissedTheEndOfASurfaceHearsOfItLater) {
  for (int frame = 0; frame < 4; ++frame) Grow();
  publisher_.PublishChanges(growing_.map());
  Deliver();
  lost_percent_ = 100;
  AddChanges(growing_.Shrink());
  publisher_.PublishChanges(growing_.map());
  publisher_.PublishAll(growing_.map());
  Grow();
  publisher_.PublishChanges(growing_.map());
  Deliver();
  lost_percent_ = 0;
  publisher_.PublishSince(growing_.map(), follower_.position());
  Deliver();
  EXPECT_EQ(follower_.Digest(), Truth());
}

TEST_F(MeshStream, ASelfContradictingMessageChangesNothing) {
  Grow();
  publisher_.PublishChanges(growing_.map());
  Deliver();
  const std::string before = follower_.Digest();
  mesh_delta_t bad{};
  bad.map_id = "map";
  bad.revision = 9;
  bad.full = true;
  bad.parts = 1;
  bad.n_blocks = 1;
  bad.blocks.resize(1);
  bad.blocks[0].edge_m = -1;
  EXPECT_EQ(follower_.Apply(bad), FollowOutcome::kBroken);
  EXPECT_EQ(follower_.Digest(), before);
}

}  // namespace
}  // namespace vismap
