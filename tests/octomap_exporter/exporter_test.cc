#include "octomap_exporter/exporter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <memory>

#include "base/file.h"
#include "freespace/octree_builder.h"
#include "requests/object_edits.h"
#include "runtime/clock.h"
#include "support/occupancy_snapshot.h"
#include "support/temp_folder.h"
#include "wire/octree_follower.h"
#include "wire/octree_message.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing_support::SnapshotOf;

constexpr double kVoxel = 0.02;

/// An exporter on a bus of its own, a map that it follows, and what it publishes.
class ExporterOnABus : public ::testing::Test {
 protected:
  ExporterOnABus() {
    config_.grid.voxel_size_m = kVoxel;
    config_.octomap_exporter.period_s = 0.05;
    config_.octomap_exporter.coarse_resolution_m = 0.2;
    for (const Channel& channel :
         {kOctomapChannel, kOctomapRawChannel, kOctomapCoarseChannel, kOctomapInflatedChannel}) {
      bus_->Subscribe<octree_t>(channel,
                                [this, name = std::string(channel.name)](const octree_t& tree) {
                                  trees_[name].push_back(tree);
                                });
    }
    bus_->Subscribe<navigation_status_t>(
        kNavigationChannel, [this](const navigation_status_t& message) { navigation_ = message; });
    bus_->Subscribe<map_reply_t>(kMapReplyChannel,
                                 [this](const map_reply_t& reply) { replies_.push_back(reply); });
  }

  void Start() { exporter_ = std::make_unique<Exporter>(config_, bus_.get(), &status_); }

  template <typename Condition>
  bool SpinUntil(const Condition& condition, double seconds = 10) {
    const double end = MonotonicSeconds() + seconds;
    while (!condition() && MonotonicSeconds() < end) bus_->Spin(0.01);
    return condition();
  }
  void SpinFor(double seconds) {
    SpinUntil([] { return false; }, seconds);
  }

  /// Sends the whole map as its next revision.
  void SendMap() {
    ++revision_;
    bus_->Publish(kMapDeltaChannel,
                  Encode(MapUpdate{1000 * revision_, "m", revision_, -1, 0, 1, SnapshotOf(map_)}));
  }
  /// Changes one block, and sends the change.
  void Change(BlockIndex index, CellState state) {
    map_.Set(index, BlockOccupancy(state));
    OccupancyDelta delta{kVoxel, false, {{index, map_.At(index)}}};
    ++revision_;
    bus_->Publish(kMapDeltaChannel, Encode(MapUpdate{1000 * revision_, "m", revision_,
                                                     revision_ - 1, 0, 1, std::move(delta)}));
  }
  void FillRoom() {
    for (int i = 0; i < 12 * 12 * 8; ++i)
      map_.Set({i % 12 - 4, i / 12 % 12 - 5, i / 144}, BlockOccupancy(CellState::kFree));
    for (int i = 0; i < 12 * 12; ++i)
      map_.Set({i % 12 - 4, i / 12 - 5, 0}, BlockOccupancy(CellState::kOccupied));
  }
  bool HasRevision(const std::string& channel, int64_t revision) {
    return !trees_[channel].empty() && trees_[channel].back().revision == revision;
  }
  std::vector<uint8_t> Expected(UnknownPolicy unknown, double resolution = 0) {
    OctreeOptions options = config_.octree;
    options.unknown = unknown;
    options.resolution_m = resolution;
    return BuildOctree(map_, options)->bytes;
  }
  /// By a full rebuild.
  std::vector<uint8_t> ExpectedInflated(double radius) {
    OctreeOptions options = config_.octree;
    OctreeBuilder builder = *OctreeBuilder::Make(kVoxel, options);
    builder.Update(map_, map_.SortedIndices());
    const OccupancyMap inflated = *Inflate(builder.leaves(), {.radius_m = radius});
    options.unknown = UnknownPolicy::kOccupied;
    options.resolution_m = builder.resolution();
    OctreeCache cache;
    cache.Update(inflated, inflated.SortedIndices());
    return cache.Encode(inflated, options)->bytes;
  }
  map_reply_t Ask(map_request_t request) {
    request.request_id = ++next_id_;
    bus_->Publish(kMapRequestChannel, request);
    EXPECT_TRUE(SpinUntil(
        [&] { return !replies_.empty() && replies_.back().request_id == request.request_id; }));
    return replies_.empty() ? map_reply_t{} : replies_.back();
  }
  static map_request_t Request(const std::string& verb) {
    map_request_t request{};
    request.verb = verb;
    request.unknown = map_request_t::UNKNOWN_DEFAULT;
    return request;
  }

  std::unique_ptr<Bus> bus_ = std::move(*Bus::Open({"memq://", "test"}));
  Status status_{bus_.get(), "octomap-exporter"};
  VismapConfig config_;
  std::unique_ptr<Exporter> exporter_;
  OccupancyMap map_{kVoxel};
  int64_t revision_ = 0, next_id_ = 0;
  std::map<std::string, std::vector<octree_t>> trees_;
  navigation_status_t navigation_{};
  std::vector<map_reply_t> replies_;
};

TEST_F(ExporterOnABus, PublishesTheMapClosedRawAndCoarse) {
  Start();
  FillRoom();
  SendMap();
  for (int64_t revision = 1; revision < 4; ++revision) {
    ASSERT_TRUE(SpinUntil([&] { return HasRevision("OCTOMAP_COARSE", revision); }));
    const octree_t& closed = trees_["OCTOMAP"].back();
    EXPECT_EQ(closed.data, Expected(UnknownPolicy::kOccupied));
    EXPECT_EQ(closed.unknown, octree_t::UNKNOWN_OCCUPIED);
    EXPECT_EQ(closed.shell_m, 1);
    EXPECT_EQ(closed.utime, 1000 * revision);
    EXPECT_LT(WallUtime() - closed.published_utime, 10'000'000);
    EXPECT_EQ(trees_["OCTOMAP_RAW"].back().data, Expected(UnknownPolicy::kAbsent));
    EXPECT_EQ(trees_["OCTOMAP_RAW"].back().unknown, octree_t::UNKNOWN_ABSENT);
    EXPECT_EQ(trees_["OCTOMAP_COARSE"].back().data, Expected(UnknownPolicy::kOccupied, 0.2));
    EXPECT_EQ(trees_["OCTOMAP_COARSE"].back().resolution_m, 0.2);
    EXPECT_TRUE(Decode(closed)) << Decode(closed).error().message;
    const octree_t& inflated = trees_["OCTOMAP_INFLATED"].back();
    EXPECT_EQ(inflated.data, ExpectedInflated(0.2));
    EXPECT_EQ(inflated.inflated_by_m, 0.2);
    EXPECT_EQ(closed.inflated_by_m, 0);
    Change({static_cast<int32_t>(revision), 2, 3}, CellState::kOccupied);
  }
}

TEST_F(ExporterOnABus, SendsNoTreeWhileNothingIsKnownAndSaysWhy) {
  Start();
  ASSERT_TRUE(SpinUntil([&] { return navigation_.published_utime > 0; }));
  EXPECT_EQ(navigation_.revision, -1);
  EXPECT_EQ(navigation_.server_utime, 0);
  EXPECT_THAT(navigation_.message, HasSubstr("no map has come on MAP_DELTA"));
  SendMap();
  ASSERT_TRUE(SpinUntil([&] { return navigation_.revision == 1; }));
  SpinFor(0.3);
  EXPECT_THAT(navigation_.message, HasSubstr("no space in the map is free or occupied"));
  EXPECT_THAT(navigation_.channels, IsEmpty());
  EXPECT_GT(navigation_.server_utime, 0);
  for (const auto& [channel, trees] : trees_) EXPECT_THAT(trees, IsEmpty()) << channel;
  EXPECT_THAT(Ask(Request("octomap")).message, HasSubstr("nothing is known yet"));

  Change({0, 0, 0}, CellState::kFree);
  ASSERT_TRUE(SpinUntil([&] { return HasRevision("OCTOMAP", 2); }));
  Change({0, 0, 0}, CellState::kUnknown);
  ASSERT_TRUE(SpinUntil([&] { return navigation_.revision == 3; }));
  trees_.clear();
  SpinFor(2);
  EXPECT_THAT(trees_, IsEmpty()) << "the tree of a map that is gone is not repeated";
}

TEST_F(ExporterOnABus, AReaderThatComesWhileTheMapStandsStillHasATreeWithinTwoSeconds) {
  Start();
  FillRoom();
  SendMap();
  ASSERT_TRUE(SpinUntil([&] { return HasRevision("OCTOMAP_COARSE", 1); }));
  for (int reader = 0; reader < 3; ++reader) {
    const octree_t before = trees_["OCTOMAP"].back();
    SpinFor(0.4 * reader);
    trees_.clear();
    ASSERT_TRUE(SpinUntil([&] { return trees_.size() == 4; }, 2));
    const octree_t& again = trees_["OCTOMAP"].back();
    EXPECT_EQ(again.data, before.data);
    EXPECT_EQ(again.utime, before.utime);
    EXPECT_GT(again.published_utime, before.published_utime);
  }
}

TEST_F(ExporterOnABus, NavigationTellsRevisionsAndAges) {
  Start();
  FillRoom();
  SendMap();
  ASSERT_TRUE(SpinUntil([&] { return navigation_.n_outputs == 4; }));
  EXPECT_THAT(navigation_.channels,
              ElementsAre("OCTOMAP", "OCTOMAP_RAW", "OCTOMAP_INFLATED", "OCTOMAP_COARSE"));
  EXPECT_THAT(navigation_.revisions, ElementsAre(1, 1, 1, 1));
  EXPECT_THAT(navigation_.utimes, ElementsAre(1000, 1000, 1000, 1000));
  EXPECT_EQ(navigation_.message, "");
  EXPECT_EQ(navigation_.map_id, "m");
  EXPECT_EQ(navigation_.in_sync, 1);
  const int64_t heard = navigation_.server_utime, told = navigation_.published_utime;
  EXPECT_LE(heard, told);
  ASSERT_TRUE(SpinUntil([&] { return navigation_.published_utime > told + 1'500'000; }, 3));
  EXPECT_EQ(navigation_.server_utime, heard) << "the map server is silent";
  process_status_t status{};
  status.process = "map-server";
  bus_->Publish(kStatusChannel, status);
  EXPECT_TRUE(SpinUntil([&] { return navigation_.server_utime > heard; }, 2));
}

TEST_F(ExporterOnABus, AFollowerOfDeltasHasTheBytesOfTheWholeTree) {
  OctreeFollower follower;
  bool deaf = false;
  int64_t bytes = 0;
  bus_->Subscribe<octree_delta_t>(kOctomapDeltaChannel, [&](const octree_delta_t& message) {
    if (deaf) return;
    Result<OctreeUpdate> update = Decode(message);
    ASSERT_TRUE(update) << update.error().message;
    bytes += message.payload_size;
    follower.Apply(std::move(*update), MonotonicSeconds());
  });
  Start();
  FillRoom();
  SendMap();
  for (int32_t step = 1; step < 12; ++step) {
    ASSERT_TRUE(SpinUntil([&] { return HasRevision("OCTOMAP_COARSE", revision_); }));
    if (!follower.in_sync() && !deaf) {
      map_request_t request = Request("octomap-delta");
      request.argument = ToText(follower.position());
      bytes = 0;
      EXPECT_EQ(Ask(request).message, "published on OCTOMAP_DELTA");
      ASSERT_TRUE(SpinUntil([&] { return follower.position().revision == revision_; }));
      EXPECT_LT(bytes, 1000) << "only what was missed";
    }
    if (!deaf) {
      ASSERT_EQ(follower.position().revision, revision_) << step;
      const Result<OctreeBytes> closed = follower.Build(UnknownPolicy::kOccupied);
      const Result<OctreeBytes> raw = follower.Build(UnknownPolicy::kAbsent);
      ASSERT_TRUE(closed && raw);
      ASSERT_EQ(closed->bytes, trees_["OCTOMAP"].back().data) << step;
      ASSERT_EQ(raw->bytes, trees_["OCTOMAP_RAW"].back().data) << step;
    }
    deaf = step == 4 || step == 5;
    Change({step - 5, step % 3, step % 4},
           step % 5 == 0 ? CellState::kUnknown : CellState::kOccupied);
  }
  EXPECT_EQ(follower.gaps(), 1);
}

TEST_F(ExporterOnABus, AnswersBoxResolutionAndPolicy) {
  Start();
  FillRoom();
  SendMap();
  ASSERT_TRUE(SpinUntil([&] { return HasRevision("OCTOMAP_COARSE", 1); }));
  map_request_t request = Request("octomap");
  request.has_bbx = 1;
  request.resolution_m = 0.04;
  for (int axis = 0; axis < 3; ++axis) request.bbx_max_W[axis] = 0.8;
  const map_reply_t reply = Ask(request);
  ASSERT_TRUE(reply.ok) << reply.message;
  EXPECT_EQ(reply.has_octree, 1);
  EXPECT_EQ(reply.unknown, map_request_t::UNKNOWN_OCCUPIED);
  EXPECT_EQ(reply.resolution_m, 0.04);
  EXPECT_NEAR(reply.bbx_max_W[2], 0.8, 1e-9);
  EXPECT_EQ(reply.shell_m, 1);
  EXPECT_EQ(reply.revision, 1);
  EXPECT_EQ(reply.data_utime, 1000);
  OctreeOptions options = config_.octree;
  options.unknown = UnknownPolicy::kOccupied;
  options.resolution_m = 0.04;
  options.bounds_W = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(0.8)};
  EXPECT_EQ(reply.payload, BuildOctree(map_, options)->bytes);
  request.unknown = 7;
  EXPECT_THAT(Ask(request).message, HasSubstr("unknown: expected -1"));
}

TEST_F(ExporterOnABus, LeavesObjectsOutAsTheMapServerSays) {
  int asked = 0;
  bus_->Subscribe<map_request_t>(kMapRequestChannel, [&](const map_request_t& request) {
    if (request.verb != "occupancy") return;
    map_reply_t reply{};
    reply.requester = request.source;
    reply.request_id = request.request_id;
    reply.ok = request.without == "id=7";
    if (++asked == 1) return;  // the first one is lost
    reply.message = reply.ok ? "1 block differs" : "without: the map has no object with id 99";
    EditedSpace space;
    space.delta = {kVoxel, false, {{{1, 1, 0}, BlockOccupancy(CellState::kFree)}}};
    reply.payload = AnswerOccupancy(space).payload;
    reply.payload_size = static_cast<int32_t>(reply.payload.size());
    bus_->Publish(kMapReplyChannel, reply);
  });
  Start();
  FillRoom();
  SendMap();
  ASSERT_TRUE(SpinUntil([&] { return HasRevision("OCTOMAP_COARSE", 1); }));
  map_request_t request = Request("octomap");
  request.without = "id=7";
  const map_reply_t reply = Ask(request);
  ASSERT_TRUE(reply.ok) << reply.message;
  EXPECT_EQ(asked, 2);
  const std::vector<uint8_t> with = Expected(UnknownPolicy::kOccupied);
  EXPECT_EQ(trees_["OCTOMAP"].back().data, with) << "what is published has all objects";
  map_.Set({1, 1, 0}, BlockOccupancy(CellState::kFree));
  EXPECT_EQ(reply.payload, Expected(UnknownPolicy::kOccupied));
  EXPECT_NE(reply.payload, with);
  map_request_t question = Request("clearance");
  question.argument = "at=0.24,0.24,0.08";
  const auto text = [&] {
    const map_reply_t told = Ask(question);
    return std::string(told.payload.begin(), told.payload.end());
  };
  EXPECT_THAT(text(), HasSubstr("\"distance_m\":0.0,"));
  question.without = "id=7";
  EXPECT_THAT(text(), testing::AllOf(HasSubstr("\"distance_m\":0.0"),
                                     testing::Not(HasSubstr("\"distance_m\":0.0,"))));
  request.without = "id=99";
  const map_reply_t refusal = Ask(request);
  EXPECT_FALSE(refusal.ok);
  EXPECT_THAT(refusal.message, HasSubstr("no object with id 99"));
}

TEST_F(ExporterOnABus, SaysWhenNoMapServerAnswersWhichObjects) {
  Start();
  FillRoom();
  SendMap();
  map_request_t request = Request("octomap");
  request.without = "id=7";
  ASSERT_TRUE(SpinUntil([&] { return HasRevision("OCTOMAP_COARSE", 1); }));
  EXPECT_THAT(Ask(request).message, HasSubstr("has not answered within 5 s"));
}

TEST_F(ExporterOnABus, HonoursAConfigThatWantsOctomapRaw) {
  config_.octomap_exporter.unknown = UnknownPolicy::kAbsent;
  Start();
  FillRoom();
  SendMap();
  ASSERT_TRUE(SpinUntil([&] { return HasRevision("OCTOMAP_COARSE", 1); }));
  EXPECT_EQ(trees_["OCTOMAP"].back().data, Expected(UnknownPolicy::kAbsent));
  EXPECT_THAT(status_.findings(), ElementsAre(HasSubstr("octomap_exporter.unknown: ABSENT")));
}

TEST_F(ExporterOnABus, WritesBothFiles) {
  const TempFolder folder;
  config_.octomap_exporter.output_folder = folder.path().string();
  Start();
  FillRoom();
  SendMap();
  ASSERT_TRUE(SpinUntil([&] { return std::filesystem::exists(folder / "octree.closed.bt"); }));
  EXPECT_EQ(ReadFileBytes(folder / "octree.bt").value(), Expected(UnknownPolicy::kAbsent));
  EXPECT_EQ(ReadFileBytes(folder / "octree.closed.bt").value(), Expected(UnknownPolicy::kOccupied));
}

TEST(LatchedTrees, LargeTreesAreRepeatedAsSeldomAsTheBudgetDemands) {
  const std::unique_ptr<Bus> bus = std::move(*Bus::Open({"memq://", "test"}));
  int received = 0;
  bus->Subscribe<octree_t>(kOctomapChannel, [&](const octree_t&) { ++received; });
  double now = 0;
  LatchedTrees latched(bus.get(), 1000, [&] { return now; });
  const auto repeats = [&](size_t bytes) {
    octree_t tree{};
    tree.data.resize(bytes);
    tree.data_size = static_cast<int32_t>(bytes);
    latched.Publish(kOctomapChannel, tree);
    while (bus->Spin(0)) {
    }
    received = 0;
    for (int i = 0; i < 600; ++i) {  // a minute
      now += 0.1;
      latched.Repeat();
      while (bus->Spin(0)) {
      }
    }
    return received;
  };
  EXPECT_NEAR(repeats(100), 40, 3) << "every 1.5 s";
  EXPECT_NEAR(repeats(10000), 6, 1) << "every 10 s";
  latched.Clear();
  now += 100;
  received = 0;
  latched.Repeat();
  while (bus->Spin(0)) {
  }
  EXPECT_EQ(received, 0);
}

}  // namespace
}  // namespace vismap
