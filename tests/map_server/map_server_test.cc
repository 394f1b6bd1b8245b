#include "map_server/map_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>
#include <vismap/map_delta_t.hpp>
#include <vismap/mesh_delta_t.hpp>

#include "runtime/clock.h"
#include "small_frames.h"
#include "support/temp_folder.h"
#include "wire/map_follower.h"
#include "wire/mesh_follower.h"

// A whole map server, on a bus of its own.

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using testing_support::CoarseMap;
using testing_support::MemoryBus;
using testing_support::SmallMessage;

class ServerOnABus : public ::testing::Test {
 protected:
  ServerOnABus() {
    bus_->Subscribe<frame_commit_t>(kMapCommitChannel, [this](const frame_commit_t& commit) {
      commits_.push_back(commit);
      channels_.emplace_back(kMapCommitChannel.name);
    });
    bus_->Subscribe<map_delta_t>(kMapDeltaChannel, [this](const map_delta_t&) {
      channels_.emplace_back(kMapDeltaChannel.name);
    });
    bus_->Subscribe<map_reply_t>(kMapReplyChannel,
                                 [this](const map_reply_t& reply) { replies_.push_back(reply); });
    config_.grid = CoarseMap().grid;
  }

  void Start() { server_ = std::make_unique<MapServer>(config_, bus_.get(), &status_); }
  void Deliver() {
    do {
      bus_->WaitUntilSent(10);
    } while (bus_->Spin(0));
  }
  /// The commits that a frame leads to.
  std::vector<frame_commit_t> Send(const segmented_frame_t& message) {
    commits_.clear();
    bus_->Publish(kSegmentedFrameChannel, message);
    Deliver();
    return commits_;
  }
  map_reply_t Ask(const std::string& verb, const std::string& argument = "",
                  const std::string& path = "") {
    map_request_t request{};
    request.request_id = ++last_request_;
    request.verb = verb;
    request.argument = argument;
    request.path = path;
    replies_.clear();
    bus_->Publish(kMapRequestChannel, request);
    // A request may wait a little for its turn.
    const double deadline = MonotonicSeconds() + 10;
    while (replies_.empty() && MonotonicSeconds() < deadline) bus_->Spin(0.01);
    Deliver();
    EXPECT_THAT(replies_, SizeIs(1)) << verb;
    return replies_.empty() ? map_reply_t{} : replies_.back();
  }

  VismapConfig config_;
  std::unique_ptr<Bus> bus_ = MemoryBus();
  Status status_{bus_.get(), "map-server"};
  std::unique_ptr<MapServer> server_;
  std::vector<frame_commit_t> commits_;
  std::vector<map_reply_t> replies_;
  std::vector<std::string> channels_;  // of the messages that came, in order
  int64_t last_request_ = 0;
};

TEST_F(ServerOnABus, AnswersEveryFrameWithOneCommit) {
  Start();
  const auto first = Send(SmallMessage(1000));
  ASSERT_THAT(first, SizeIs(1));
  EXPECT_EQ(first[0].status, frame_commit_t::STATUS_INTEGRATED);
  EXPECT_EQ(first[0].utime, 1000);
  EXPECT_EQ(first[0].camera_id, 3);
  EXPECT_EQ(first[0].frame_number, 17);
  EXPECT_EQ(first[0].revision, 1);
  EXPECT_THAT(first[0].digest, SizeIs(32));
  EXPECT_EQ(first[0].input_digest, DigestInput(SmallMessage(1000)));
  EXPECT_THAT(channels_, ElementsAre("MAP_DELTA", "MAP_COMMIT"));

  const auto again = Send(SmallMessage(1000));
  ASSERT_THAT(again, SizeIs(1));
  EXPECT_EQ(again[0].status, frame_commit_t::STATUS_DUPLICATE);
  EXPECT_EQ(again[0].revision, 1);
  EXPECT_EQ(again[0].digest, "");
  EXPECT_EQ(status_.counter("frames_integrated"), 1);
  EXPECT_EQ(status_.counter("frames_duplicate"), 1);
}

TEST_F(ServerOnABus, IntegratesInTheOrderThatTheSourceAsksFor) {
  Start();
  EXPECT_THAT(Send(SmallMessage(2000, 1000)), SizeIs(0));
  EXPECT_EQ(status_.counter("frames_held"), 1);
  const auto both = Send(SmallMessage(1000));
  ASSERT_THAT(both, SizeIs(2));
  EXPECT_EQ(both[0].utime, 1000);
  EXPECT_EQ(both[1].utime, 2000);
  EXPECT_EQ(status_.counter("frames_held"), 0);
}

TEST_F(ServerOnABus, SkipsAFrameThatCannotBeUsedAndIntegratesTheNext) {
  Start();
  EXPECT_THAT(Send(SmallMessage(2000, 1000)), SizeIs(0));
  segmented_frame_t broken = SmallMessage(1000);
  broken.frame.color_camera.fx = -1;
  const auto commits = Send(broken);
  ASSERT_THAT(commits, SizeIs(2));
  EXPECT_EQ(commits[0].status, frame_commit_t::STATUS_SKIPPED);
  EXPECT_THAT(commits[0].reason, HasSubstr("utime 1000"));
  EXPECT_EQ(commits[1].status, frame_commit_t::STATUS_INTEGRATED);
  EXPECT_EQ(commits[1].utime, 2000);
  EXPECT_EQ(status_.counter("frames_skipped"), 1);
  Send(SmallMessage(3000));
  EXPECT_THAT(Send(broken), SizeIs(1)) << "is skipped again";
}

// A frame at another place than the others.
segmented_frame_t MovedMessage(int64_t utime, double x) {
  segmented_frame_t message = SmallMessage(utime);
  message.frame.T_W_C[3] = x;
  return message;
}

TEST_F(ServerOnABus, TellsWhichFramesWereLeftOutAndWhy) {
  Start();
  segmented_frame_t broken = SmallMessage(1000);
  broken.frame.color_camera.fx = -1;
  Send(broken);
  EXPECT_THAT(status_.findings(), ElementsAre(HasSubstr("1 of 1 frames were left out: 1 x ")));
  Ask("reset");
  Send(SmallMessage(1000));
  EXPECT_THAT(status_.findings(), SizeIs(0)) << "of another map";
}

TEST_F(ServerOnABus, TellsOfOtherFramesWithAUsedUtimeButNotOfRepeatedOnes) {
  Start();
  for (int i = 0; i < 3; ++i) Send(MovedMessage(0, 0.1 * i));
  EXPECT_EQ(status_.counter("frames_with_used_utime"), 2);
  EXPECT_THAT(status_.findings(),
              ElementsAre(AllOf(HasSubstr("2 of 3 frames were left out"),
                                HasSubstr("another frame of camera 3, utime 0"))));
  Send(MovedMessage(1000, 0));
  Send(MovedMessage(1000, 0));  // the last frame again
  Send(MovedMessage(0, 0));     // an older frame again
  EXPECT_EQ(status_.counter("frames_with_used_utime"), 2);
  Send(MovedMessage(0, 0.7));  // another frame with an older one's time
  EXPECT_EQ(status_.counter("frames_with_used_utime"), 3);
}

TEST_F(ServerOnABus, TellsThatDepthIsOutOfRange) {
  Start();
  for (int i = 1; i <= 8; ++i) {
    segmented_frame_t message = SmallMessage(33333 * i);
    message.frame.depth_unit_m = 0.1;
    Send(message);
  }
  EXPECT_THAT(status_.findings(), ::testing::Contains(HasSubstr("0.1 m per step")));
}

// The same view from places that are metres apart.
TEST_F(ServerOnABus, TellsThatPosesContradictEachOther) {
  Start();
  for (int i = 1; i <= 8; ++i) Send(MovedMessage(33333 * i, 2.0 * i));
  EXPECT_THAT(status_.findings(),
              ::testing::Contains(::testing::AnyOf(HasSubstr("surface in common"),
                                                   HasSubstr("contradict each other"))));
}

TEST_F(ServerOnABus, TellsThatTimesAreUnusual) {
  Start();
  for (int i = 1; i <= 8; ++i) Send(SmallMessage(int64_t{33'333'333} * i));
  EXPECT_THAT(status_.findings(), ElementsAre(HasSubstr("in nanoseconds")));
}

TEST_F(ServerOnABus, AfterAResetIntegratesTheSameFramesIntoAnotherMap) {
  Start();
  const auto before = Send(SmallMessage(1000));
  const map_reply_t reset = Ask("reset");
  EXPECT_TRUE(reset.ok);
  EXPECT_EQ(reset.revision, 0);
  EXPECT_EQ(reset.message, "the map is empty now; it is map " + reset.map_id);
  EXPECT_NE(reset.map_id, before.at(0).map_id);
  const auto after = Send(SmallMessage(1000));
  ASSERT_THAT(after, SizeIs(1));
  EXPECT_EQ(after[0].status, frame_commit_t::STATUS_INTEGRATED);
  EXPECT_EQ(after[0].map_id, reset.map_id);
  EXPECT_EQ(after[0].digest, before[0].digest);
}

TEST_F(ServerOnABus, CarriesOutTheVerbsThatReadTheMap) {
  Start();
  MeshFollower follower;
  bus_->Subscribe<mesh_delta_t>(kMeshDeltaChannel,
                                [&](const mesh_delta_t& message) { follower.Apply(message); });
  Send(SmallMessage(1000));
  Send(SmallMessage(2000));
  const auto json = [](const map_reply_t& reply) {
    return nlohmann::json::parse(reply.payload.begin(), reply.payload.end(), nullptr, false);
  };
  EXPECT_EQ(json(Ask("frames")), nlohmann::json::parse("[[3, 1000], [3, 2000]]"));
  const map_reply_t statistics = Ask("statistics");
  EXPECT_EQ(statistics.message, HashMap(server_->map().session().map()));
  EXPECT_EQ(json(statistics)["occupancy_digest"], Ask("snapshot").message);
  EXPECT_THAT(Ask("objects").message, HasSubstr(" objects and segments"));
  EXPECT_EQ(Ask("octree").encoding, "bt");
  EXPECT_EQ(Ask("mesh", "ply").encoding, "ply");
  EXPECT_EQ(Ask("mesh", "digest").message, follower.Digest());
  EXPECT_EQ(Ask("mesh").message, "published on MESH_DELTA");
  EXPECT_EQ(follower.position().revision, 2);
}

TEST_F(ServerOnABus, AnswersAreOfTheMapAtTheTimeOfTheRequestAndFramesGoOnMeanwhile) {
  Start();
  Send(SmallMessage(1000));
  const std::string hash = HashMap(server_->map().session().map());
  const std::string map_id = server_->map().session().metadata().map_id;
  map_request_t request{};
  for (const char* verb : {"map", "statistics", "octree", "frames"}) {
    request.verb = verb;
    request.request_id = ++last_request_;
    bus_->Publish(kMapRequestChannel, request);
  }
  const double deadline = MonotonicSeconds() + 10;
  for (int64_t utime = 2000; utime <= 4000; utime += 1000)
    bus_->Publish(kSegmentedFrameChannel, SmallMessage(utime));
  while ((replies_.size() < 4 || commits_.size() < 4) && MonotonicSeconds() < deadline)
    bus_->Spin(0.01);
  EXPECT_EQ(server_->map().session().map().revision, 4);
  ASSERT_THAT(replies_, SizeIs(4));
  EXPECT_EQ(replies_[0].revision, 1);
  EXPECT_EQ(replies_[0].message, hash);
  for (const map_reply_t& reply : replies_) {
    EXPECT_TRUE(reply.ok) << reply.message;
    EXPECT_EQ(reply.map_id, map_id);
    EXPECT_LE(reply.revision, 4);
  }
}

TEST_F(ServerOnABus, FollowersGetInStepWhileFramesComeWithoutAPause) {
  Start();
  MapFollower space;
  MeshFollower mesh;
  int asked = 0;
  bool hears = false;
  const auto ask = [&](const char* verb, const FollowerPosition& position) {
    map_request_t request{};
    request.verb = verb;
    request.argument = ToText(position);
    request.request_id = ++last_request_;
    bus_->Publish(kMapRequestChannel, request);
  };
  bus_->Subscribe<map_delta_t>(kMapDeltaChannel, [&](const map_delta_t& message) {
    if (hears) space.Apply(*Decode(message));
  });
  bus_->Subscribe<mesh_delta_t>(kMeshDeltaChannel, [&](const mesh_delta_t& message) {
    if (hears) mesh.Apply(message);
  });
  int64_t utime = 0;
  const auto frame = [&] {
    utime += 1000;
    const double x = 0.01 * static_cast<double>(utime / 1000 % 50);
    bus_->Publish(kSegmentedFrameChannel, MovedMessage(utime, x));
    bus_->Spin(0);
  };
  for (int i = 0; i < 20; ++i) frame();
  hears = true;
  const double deadline = MonotonicSeconds() + 10;
  while (!(space.in_sync() && mesh.in_sync()) && MonotonicSeconds() < deadline) {
    if (asked++ == 0) ask("snapshot", space.position());
    if (asked == 2) ask("mesh", mesh.position());
    frame();
  }
  EXPECT_TRUE(space.in_sync());
  EXPECT_TRUE(mesh.in_sync());
}

// The parts of a surface that a follower asked for, made and sent by other threads, and what the
// map server publishes meanwhile.
TEST_F(ServerOnABus, UpdatesStayInOrderWhenAThreadSendsThem) {
  bus_->SendByThread();
  config_.map_server.mesh_period_s = 0;
  Start();
  MeshFollower mesh;
  bool hears = false, has_surface = false;
  bus_->Subscribe<mesh_delta_t>(kMeshDeltaChannel, [&](const mesh_delta_t& message) {
    if (!hears) return;
    mesh.Apply(message);
    has_surface = mesh.in_sync() && mesh.position().revision >= 0;
  });
  int64_t utime = 0;
  const auto frame = [&] {
    utime += 1000;
    bus_->Publish(kSegmentedFrameChannel,
                  MovedMessage(utime, 0.01 * static_cast<double>(utime / 1000 % 50)));
    bus_->WaitUntilSent(10);
    bus_->Spin(0);
  };
  for (int i = 0; i < 20; ++i) frame();
  const auto ask = [&] {
    map_request_t request{};
    request.verb = "mesh";
    request.argument = ToText(mesh.position());
    request.request_id = ++last_request_;
    bus_->Publish(kMapRequestChannel, request);
  };
  const double deadline = MonotonicSeconds() + 20;
  for (int round = 0; round < 5; ++round) {
    mesh = MeshFollower();
    has_surface = false;
    hears = true;
    for (int i = 0; !has_surface && MonotonicSeconds() < deadline; ++i) {
      if (i % 50 == 0) ask();
      frame();
    }
    EXPECT_TRUE(has_surface);
  }
  EXPECT_EQ(bus_->counters().at("MESH_DELTA").lost, 0);
  const std::string digest = Ask("mesh", "digest").message;
  EXPECT_EQ(mesh.Digest(), digest);
}

TEST_F(ServerOnABus, ALoadWaitsForTheSaveBeforeIt) {
  const TempFolder folder;
  config_.map_server.map_folder = (folder / "maps").string();
  Start();
  for (int64_t utime = 1; utime <= 3; ++utime) {
    Send(SmallMessage(1000 * utime));
    map_request_t request{};
    for (const char* verb : {"save", "load"}) {
      request.verb = verb;
      request.path = "a";
      request.request_id = ++last_request_;
      bus_->Publish(kMapRequestChannel, request);
    }
    replies_.clear();
    const double deadline = MonotonicSeconds() + 10;
    while (replies_.size() < 2 && MonotonicSeconds() < deadline) bus_->Spin(0.01);
    ASSERT_THAT(replies_, SizeIs(2));
    EXPECT_THAT(replies_[0].message, HasSubstr("saved"));
    EXPECT_THAT(replies_[1].message, HasSubstr("with " + std::to_string(utime) + " frames"));
  }
}

TEST_F(ServerOnABus, ARequestThatIsStillAnsweredWhenTheMapIsReplacedIsAboutTheOldOne) {
  Start();
  Send(SmallMessage(1000));
  const std::string map_id = server_->map().session().metadata().map_id;
  map_request_t request{};
  request.verb = "map";
  request.request_id = ++last_request_;
  bus_->Publish(kMapRequestChannel, request);
  bus_->Spin(0);
  server_->map().Reset();
  const double deadline = MonotonicSeconds() + 10;
  while (replies_.empty() && MonotonicSeconds() < deadline) bus_->Spin(0.01);
  ASSERT_THAT(replies_, SizeIs(1));
  EXPECT_EQ(replies_[0].map_id, map_id);
  EXPECT_EQ(replies_[0].revision, 1);
}

TEST_F(ServerOnABus, RefusesWhatItCannotDo) {
  Start();
  EXPECT_THAT(
      Ask("fly").message,
      HasSubstr(
          "known are cell, frames, load, map, mesh, objects, occupancy, octree, points, reset, "
          "save, snapshot, statistics"));
  EXPECT_THAT(Ask("save").message, HasSubstr("no name given to save the map as"));
  EXPECT_THAT(Ask("load").message, HasSubstr("expected the name of a map"));
  EXPECT_THAT(Ask("mesh", "x").message, HasSubstr("argument of mesh"));
  EXPECT_THAT(Ask("snapshot", "x").message, HasSubstr("argument of snapshot"));
  EXPECT_FALSE(Ask("objects", "id=x").ok);
  EXPECT_EQ(status_.counter("requests_refused"), 6);
}

TEST_F(ServerOnABus, SavesAndLoadsOnRequest) {
  const TempFolder folder;
  config_.map_server.map_folder = (folder / "maps").string();
  const std::string path = (folder / "maps" / "a.vismap").string();
  Start();
  Send(SmallMessage(1000));
  const std::string hash = Ask("statistics").message;
  EXPECT_THAT(Ask("save", "", "a").message, HasSubstr(path + ", map hash " + hash));
  Ask("reset");
  EXPECT_THAT(Ask("save", "", "a").message, HasSubstr("the map is empty"));
  const map_reply_t loaded = Ask("load", "", "a");
  EXPECT_THAT(loaded.message, HasSubstr("loaded " + path + " with 1 frames as map test-"));
  EXPECT_EQ(loaded.revision, 1);
  EXPECT_EQ(Ask("statistics").message, hash);
  EXPECT_EQ(Send(SmallMessage(1000)).at(0).status, frame_commit_t::STATUS_DUPLICATE);
}

TEST_F(ServerOnABus, RecoversTheMapThatWasSavedLast) {
  const TempFolder folder;
  config_.map_server.save_on_exit = (folder / "kept.vismap").string();
  Start();
  const Result<std::string> nothing = server_->map().Recover();
  ASSERT_TRUE(nothing);
  EXPECT_EQ(*nothing, "nothing to recover: there is no " + config_.map_server.save_on_exit +
                          "; frames lacking that were committed later: 0");
  Send(SmallMessage(1000));
  EXPECT_TRUE(server_->map().Save());
  Send(SmallMessage(2000));

  const std::unique_ptr<Bus> bus = MemoryBus();
  Status status(bus.get(), "map-server");
  MapServer again(config_, bus.get(), &status);
  const Result<std::string> recovered = again.map().Recover();
  ASSERT_TRUE(recovered) << recovered.error().message;
  EXPECT_THAT(*recovered, HasSubstr("with 1 frames"));
  EXPECT_THAT(*recovered, HasSubstr("frames lacking that were committed later: 1"));
  EXPECT_THAT(again.map().StatusMessage(), HasSubstr("1 frames that the map had are lacking"));
  bus->Publish(kSegmentedFrameChannel, SmallMessage(2000));
  while (bus->Spin(0)) {
  }
  EXPECT_EQ(again.map().StatusMessage(), "");
}

TEST_F(ServerOnABus, AResetDoesNotCostTheSavedMap) {
  const TempFolder folder;
  const std::string path = (folder / "kept.vismap").string();
  config_.map_server.save_on_exit = path;
  Start();
  Send(SmallMessage(1000));
  Send(SmallMessage(2000));
  const std::string hash = Ask("statistics").message;
  EXPECT_TRUE(Ask("save").ok);
  for (int64_t utime = 1; utime < 5; ++utime) {
    Ask("reset");
    const map_reply_t refused = Ask("save");
    EXPECT_FALSE(refused.ok);
    EXPECT_THAT(refused.message, HasSubstr("the map is empty"));
    EXPECT_TRUE(server_->map().SaveAtEnd()) << "which is no failure of the server";
    Send(SmallMessage(utime));
    EXPECT_TRUE(Ask("save").ok);
  }
  EXPECT_EQ(LoadMap(path)->map.revision, 1);
  EXPECT_EQ(LoadMap(path + ".replaced")->map_hash, hash);
}

TEST_F(ServerOnABus, StartsWithTheOlderFileWhenTheNewestCannotBeUsed) {
  const TempFolder folder;
  const std::string path = (folder / "kept.vismap").string();
  config_.map_server.save_on_exit = path;
  Start();
  ASSERT_TRUE(server_->map().Recover());
  Send(SmallMessage(1000));
  EXPECT_TRUE(server_->map().Save());
  Send(SmallMessage(2000));
  EXPECT_TRUE(server_->map().Save());
  folder.Write("kept.vismap", "");

  const std::unique_ptr<Bus> bus = MemoryBus();
  Status status(bus.get(), "map-server");
  MapServer again(config_, bus.get(), &status);
  const Result<std::string> recovered = again.map().Recover();
  ASSERT_TRUE(recovered) << recovered.error().message;
  EXPECT_THAT(*recovered, HasSubstr("kept.vismap.previous with 1 frames"));
  EXPECT_THAT(*recovered, HasSubstr("committed later: 1")) << "the journal knows the second frame";
  EXPECT_THAT(status.findings(), ElementsAre(HasSubstr("kept.vismap.unusable-1")));
  EXPECT_TRUE(std::filesystem::exists(path + ".unusable-1"));
}

}  // namespace
}  // namespace vismap
