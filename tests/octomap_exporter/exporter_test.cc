#include "octomap_exporter/exporter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "base/file.h"
#include "freespace/octree_builder.h"
#include "octomap_exporter/exporter_on_a_bus.h"
#include "requests/object_edits.h"
#include "support/temp_folder.h"
#include "wire/octree_follower.h"
#include "wire/octree_message.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// With the trees that it publishes.
class PublishedTrees : public testing_support::ExporterOnABus {
 protected:
  PublishedTrees() {
    config_.octomap_exporter.coarse_resolution_m = 0.2;
    for (const Channel& channel :
         {kOctomapChannel, kOctomapRawChannel, kOctomapCoarseChannel, kOctomapInflatedChannel}) {
      bus_->Subscribe<octree_t>(channel,
                                [this, name = std::string(channel.name)](const octree_t& tree) {
                                  trees_[name].push_back(tree);
                                });
    }
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

  std::map<std::string, std::vector<octree_t>> trees_;
};

TEST_F(PublishedTrees, PublishesTheMapClosedRawAndCoarse) {
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

TEST_F(PublishedTrees, SendsNoTreeWhileNothingIsKnownAndSaysWhy) {
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

TEST_F(PublishedTrees, AReaderThatComesWhileTheMapStandsStillHasATreeWithinTwoSeconds) {
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

TEST_F(PublishedTrees, NavigationTellsRevisionsAndAges) {
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
  constexpr int64_t kClocks = 1000;  // two clocks are read one after the other [us]
  EXPECT_NEAR(static_cast<double>(navigation_.server_utime - heard), 0, kClocks)
      << "the map server is silent";
  process_status_t status{};
  status.process = "map-server";
  status.state = "stopping";
  bus_->Publish(kStatusChannel, status);
  const int64_t stopped = navigation_.published_utime;
  ASSERT_TRUE(SpinUntil([&] { return navigation_.published_utime > stopped; }, 3));
  EXPECT_NEAR(static_cast<double>(navigation_.server_utime - heard), 0, kClocks)
      << "what stops is no sign of life";
  status.state = "running";
  bus_->Publish(kStatusChannel, status);
  EXPECT_TRUE(SpinUntil([&] { return navigation_.server_utime > heard + kClocks; }, 2));
}

TEST_F(PublishedTrees, AFollowerOfDeltasHasTheBytesOfTheWholeTree) {
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

TEST_F(PublishedTrees, AnswersBoxResolutionAndPolicy) {
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

TEST_F(PublishedTrees, LeavesObjectsOutAsTheMapServerSays) {
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

TEST_F(PublishedTrees, SaysWhenNoMapServerAnswersWhichObjects) {
  Start();
  FillRoom();
  SendMap();
  map_request_t request = Request("octomap");
  request.without = "id=7";
  ASSERT_TRUE(SpinUntil([&] { return HasRevision("OCTOMAP_COARSE", 1); }));
  EXPECT_THAT(Ask(request).message, HasSubstr("has not answered within 5 s"));
}

TEST_F(PublishedTrees, HonoursAConfigThatWantsOctomapRaw) {
  config_.octomap_exporter.unknown = UnknownPolicy::kAbsent;
  Start();
  FillRoom();
  SendMap();
  ASSERT_TRUE(SpinUntil([&] { return HasRevision("OCTOMAP_COARSE", 1); }));
  EXPECT_EQ(trees_["OCTOMAP"].back().data, Expected(UnknownPolicy::kAbsent));
  EXPECT_THAT(status_.findings(), ElementsAre(HasSubstr("octomap_exporter.unknown: ABSENT")));
}

TEST_F(PublishedTrees, WritesBothFiles) {
  const TempFolder folder;
  config_.octomap_exporter.output_folder = folder.path().string();
  Start();
  FillRoom();
  SendMap();
  ASSERT_TRUE(SpinUntil([&] { return std::filesystem::exists(folder / "octree.closed.bt"); }));
  EXPECT_EQ(ReadFileBytes(folder / "octree.bt").value(), Expected(UnknownPolicy::kAbsent));
  EXPECT_EQ(ReadFileBytes(folder / "octree.closed.bt").value(), Expected(UnknownPolicy::kOccupied));
}

TEST_F(PublishedTrees, FilesAreOfThePresentMapOrSetAside) {
  const TempFolder folder;
  const std::string names[] = {"octree.bt", "octree.closed.bt"};
  for (const std::string& name : names) folder.Write(name, "of an earlier run");
  config_.octomap_exporter.output_folder = folder.path().string();
  const auto expect_none = [&](const char* when) {
    for (const std::string& name : names) {
      EXPECT_FALSE(std::filesystem::exists(folder / name)) << when;
      EXPECT_TRUE(std::filesystem::exists(folder / (name + ".previous"))) << when;
    }
  };
  Start();
  expect_none("nothing is known yet");
  EXPECT_EQ(std::filesystem::file_size(folder / "octree.closed.bt.previous"), 17u);
  FillRoom();
  SendMap();
  ASSERT_TRUE(SpinUntil([&] { return std::filesystem::exists(folder / "octree.closed.bt"); }));
  const std::vector<uint8_t> closed = Expected(UnknownPolicy::kOccupied);
  map_ = OccupancyMap(kVoxel);
  SendMap();
  ASSERT_TRUE(SpinUntil([&] { return !std::filesystem::exists(folder / "octree.closed.bt"); }));
  expect_none("the map was reset");
  EXPECT_EQ(ReadFileBytes(folder / "octree.closed.bt.previous").value(), closed);
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
