#include <gmock/gmock.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <set>
#include <thread>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>

#include "hostile/hostile_bus.h"
#include "hostile/hostile_frames.h"
#include "mapfile/map_file.h"
#include "runtime/clock.h"
#include "runtime/transport.h"
#include "support/mutations.h"

// What requests on the bus can do: neither reach other files than maps, nor stop the mapping, nor
// fill a disk.

namespace vismap::hostile {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

class Requests : public HostileBus {
 protected:
  Requests() {
    bus().Subscribe<map_reply_t>(kMapReplyChannel, [this](const map_reply_t& reply) {
      if (reply.requester == bus().source()) replies_[reply.request_id] = reply;
    });
  }

  static map_request_t Request(int64_t id, const std::string& verb, const std::string& path = "",
                               const std::string& argument = "") {
    map_request_t request{};
    request.request_id = id;
    request.verb = verb;
    request.path = path;
    request.argument = argument;
    return request;
  }
  map_reply_t Ask(const std::string& verb, const std::string& path = "") {
    const map_request_t request = Request(next_id_++, verb, path);
    double next = 0;
    EXPECT_TRUE(SpinUntil([&] {
      if (MonotonicSeconds() >= next) {  // a request may be lost when there are too many
        bus().Publish(kMapRequestChannel, request);
        next = MonotonicSeconds() + 3;
      }
      return replies_.contains(request.request_id);
    })) << verb
        << " " << path;
    return replies_[request.request_id];
  }
  std::unique_ptr<ChildProcess> StartServer(const std::string& more = "") {
    return Start("map-server",
                 "map_server { map_folder: \"" + maps().string() + "\" " + more + " }");
  }
  /// Integrates so many frames, with times from `utime` on.
  void Map(int frames, int64_t utime = 1000) {
    const int64_t before = Commits(frame_commit_t::STATUS_INTEGRATED);
    for (int i = 0; i < frames; ++i)
      bus().Publish(kSegmentedFrameChannel, Segmented(Wall(utime + i)));
    ASSERT_TRUE(
        SpinUntil([&] { return Commits(frame_commit_t::STATUS_INTEGRATED) == before + frames; }));
  }
  fs::path maps() const { return processes_.folder() / "maps"; }
  static std::string Text(const fs::path& path) {
    const auto bytes = ReadFileBytes(path);
    return bytes ? std::string(bytes->begin(), bytes->end()) : bytes.error().message;
  }

  int64_t next_id_ = 1;
  std::map<int64_t, map_reply_t> replies_;  // by id
};

/// A folder for maps with all that a client could aim at, and a file outside.
class Names : public Requests {
 protected:
  Names() {
    fs::create_directory(maps());
    EXPECT_TRUE(WriteFileAtomically(victim(), "mine"));
    EXPECT_TRUE(WriteFileAtomically(maps() / "notes.vismap", "mine, too"));
    EXPECT_TRUE(WriteFileAtomically(maps() / "empty.vismap", ""));
    fs::create_symlink(victim(), maps() / "link.vismap");
    fs::create_symlink("/dev/zero", maps() / "device.vismap");
    fs::create_symlink(processes_.folder(), maps() / "elsewhere");
    fs::create_directory(maps() / "folder.vismap");
    EXPECT_EQ(mkfifo((maps() / "pipe.vismap").c_str(), 0600), 0);
  }

  fs::path victim() const { return processes_.folder() / "victim"; }
  std::vector<std::string> Bad() const {
    return {victim().string(),
            victim().string() + ".vismap",
            "../victim",
            "../../../../../../../../tmp/victim",
            "elsewhere/victim",
            "./a",
            "a/b",
            "/",
            "..",
            ".",
            "...",
            ".profile",
            "~/.profile",
            "a\nb",
            "\x1b[2J",
            "a b",
            "a\\b",
            "a%2f..%2fb",
            "\xff\xfe",
            "\xc0\xae\xc0\xae/victim",
            std::string(101, 'a'),
            std::string(60000, 'a'),
            "notes",
            "empty",
            "link",
            "device",
            "folder",
            "pipe",
            "link.vismap"};
  }
  /// Names in the folder for maps and in that above.
  std::set<std::string> Files() const {
    std::set<std::string> names;
    for (const fs::path& folder : {maps(), processes_.folder()}) {
      for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().string());
    }
    return names;
  }
};

TEST_F(Names, NoSaveReachesAnotherFileThanASavedMap) {
  const auto server = StartServer();
  Map(1);
  const std::set<std::string> before = Files();
  for (const std::string& name : Bad()) {
    const map_reply_t reply = Ask("save", name);
    EXPECT_FALSE(reply.ok) << name;
    EXPECT_LT(reply.message.size(), 1001u);
    EXPECT_EQ(reply.message.find_first_of("\n\x1b\xff"), std::string::npos);
  }
  EXPECT_EQ(Files(), before);
  EXPECT_EQ(Text(victim()), "mine");
  EXPECT_EQ(Text(maps() / "notes.vismap"), "mine, too");
  EXPECT_FALSE(Ask("save").ok) << "there is no default file";
  EXPECT_TRUE(Ask("save", "kitchen").ok) << "the server still runs";
  EXPECT_LT(server->StandardError().size(), 20'000u);
}

TEST_F(Names, NoLoadReadsAnotherFileOrWaits) {
  const auto server = StartServer();
  Map(1);
  const double start = MonotonicSeconds();
  for (const std::string& name : Bad()) EXPECT_FALSE(Ask("load", name).ok) << name;
  EXPECT_LT(MonotonicSeconds() - start, 20);
  const map_reply_t reply = Ask("statistics");
  EXPECT_EQ(reply.revision, 1) << "the map is still there";
}

TEST_F(Names, AMapKeepsItsPermissionsAndItsKeptFilesAreOutOfReach) {
  const auto server = StartServer();
  Map(1);
  ASSERT_TRUE(Ask("save", "kitchen").ok);
  const fs::perms owner = fs::perms::owner_read | fs::perms::owner_write;
  fs::permissions(maps() / "kitchen.vismap", owner);
  Map(1, 5000);
  ASSERT_TRUE(Ask("save", "kitchen.vismap").ok) << "the same name";
  EXPECT_EQ(fs::status(maps() / "kitchen.vismap").permissions(), owner);
  const std::string kept = Text(maps() / "kitchen.vismap.previous");
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(Ask("save", "kitchen.vismap.previous").ok);
  EXPECT_EQ(Text(maps() / "kitchen.vismap.previous"), kept);
  EXPECT_TRUE(fs::exists(maps() / "kitchen.vismap.previous.vismap"));
}

TEST_F(Requests, SavesUnderManyNamesDoNotFillTheDisk) {
  const auto server = StartServer("map_folder_mb: 1");
  Map(1);
  int refused = 0;
  for (int i = 0; i < 400 && refused < 3; ++i)
    refused += Ask("save", "flood-" + std::to_string(i)).ok ? 0 : 1;
  EXPECT_EQ(refused, 3);
  uint64_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(maps())) bytes += entry.file_size();
  EXPECT_LT(bytes, 3u << 20);
  EXPECT_THAT(replies_.rbegin()->second.message, HasSubstr("is full"));
}

TEST_F(Requests, ResetsDoNotCostTheSavedMap) {
  const std::string path = (processes_.folder() / "kept.vismap").string();
  const auto server =
      StartServer("recover: true save_period_s: 0.05 save_on_exit: \"" + path + "\"");
  Map(20);
  ASSERT_TRUE(Ask("save").ok);
  const std::string hash = Ask("statistics").message;
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(Ask("reset").ok);
    SpinFor(0.3);
    if (i > 0) Map(1, 5000);
    SpinFor(0.3);
  }
  server->Signal(SIGTERM);
  EXPECT_EQ(server->WaitForExit(), 0);
  EXPECT_EQ(LoadMap(path + ".replaced")->map_hash, hash);
}

TEST_F(Requests, DamagedFilesDoNotKeepTheServerFromStarting) {
  const fs::path path = processes_.folder() / "kept.vismap";
  for (const std::string content : {"", "VISMAP\r\n", "a letter"}) {
    for (const std::string ending : {"", ".previous", ".replaced", ".journal"})
      EXPECT_TRUE(WriteFileAtomically(path.string() + ending, content));
    const auto server = StartServer("recover: true save_on_exit: \"" + path.string() + "\"");
    Map(1);
    EXPECT_TRUE(Ask("save").ok);
    EXPECT_EQ(LoadMap(path)->map.revision, 1);
    EXPECT_FALSE(status_["map-server"].findings.empty());
    server->Signal(SIGTERM);
    EXPECT_EQ(server->WaitForExit(), 0) << server->StandardError();
  }
  for (int i = 1; i <= 3; ++i)
    EXPECT_TRUE(fs::exists(path.string() + ".unusable-" + std::to_string(i)));
}

TEST_F(Requests, OctreesOfAnyBoxAreAnsweredOrRefused) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto server = StartServer();
  Map(3);
  for (const double reach : {1000.0, 1e9, 1e300, kInfinity, std::nan(""), -1.0}) {
    for (const int8_t unknown : {map_request_t::UNKNOWN_ABSENT, map_request_t::UNKNOWN_OCCUPIED}) {
      map_request_t request = Request(next_id_++, "octree");
      request.has_bbx = 1;
      request.unknown = unknown;
      std::fill_n(request.bbx_min_W, 3, -reach);
      std::fill_n(request.bbx_max_W, 3, reach);
      bus().Publish(kMapRequestChannel, request);
      ASSERT_TRUE(SpinUntil([&] { return replies_.contains(request.request_id); })) << reach;
      const bool answered =
          unknown == map_request_t::UNKNOWN_ABSENT && std::isfinite(reach) && reach > 0;
      EXPECT_EQ(replies_[request.request_id].ok, answered) << reach;
    }
  }
  ExpectPeakBelow(300, "map-server", server->pid());
}

TEST_F(Requests, AreAnsweredBeforeFramesThatWait) {
  const auto server = StartServer();
  Map(1);
  segmented_frame_t message = Segmented(Wall(1));
  constexpr int kFrames = 500;
  for (int i = 0; i < kFrames; ++i) {
    message.utime = message.frame.utime = 10'000 + i;
    bus().Publish(kSegmentedFrameChannel, message);
  }
  const map_reply_t reply = Ask("frames");
  EXPECT_TRUE(reply.ok);
  EXPECT_LT(reply.revision, kFrames / 2);
  EXPECT_TRUE(SpinUntil([&] { return Commits(frame_commit_t::STATUS_INTEGRATED) == kFrames + 1; }));
}

/// Maps frames without a pause, and counts them.
class MappingWhile : public Requests {
 protected:
  /// Frames per second that are mapped while `attack` is called again and again.
  double Rate(
      double seconds, const std::function<void()>& attack = [] {}) {
    const int64_t before = Commits(frame_commit_t::STATUS_INTEGRATED);
    const double start = MonotonicSeconds();
    int64_t sent = 0, done = 0;
    while (MonotonicSeconds() < start + seconds) {
      for (; sent < done + 4; ++sent) {  // some always wait
        const Eigen::Vector3d position(0.01 * static_cast<double>(utime_ % 400), 0, 0);
        bus().Publish(kSegmentedFrameChannel, Segmented(Wall(utime_++, position)));
      }
      attack();
      bus().Spin(0.005);
      done = Commits(frame_commit_t::STATUS_INTEGRATED) - before;
    }
    EXPECT_TRUE(
        SpinUntil([&] { return Commits(frame_commit_t::STATUS_INTEGRATED) == before + sent; }));
    return static_cast<double>(done) / seconds;
  }

  int64_t utime_ = 100'000;
};

TEST_F(MappingWhile, TwentyMeshRequestsComePerSecond) {
  const auto server = StartServer();
  Rate(3);
  double next = 0;
  const double alone = Rate(4);
  const double flooded = Rate(4, [&] {
    if (MonotonicSeconds() < next) return;
    next = MonotonicSeconds() + 0.05;
    bus().Publish(kMapRequestChannel, Request(next_id_++, "mesh", "", "ply"));
  });
  RecordProperty("alone", std::to_string(alone));
  RecordProperty("flooded", std::to_string(flooded));
  EXPECT_GT(flooded, 0.35 * alone);
  EXPECT_GT(replies_.size(), 0u) << "but some requests are carried out";
}

TEST_F(MappingWhile, BadRequestsComeAsFastAsTheyCanBeSent) {
  const auto server = StartServer();
  Rate(2);
  const double alone = Rate(3);
  std::atomic<bool> stop = false;
  std::thread attacker([&] {
    const auto stranger = Bus::Open({processes_.url(), "stranger"});
    map_request_t request = Request(0, std::string(1000, '\n'));
    while (stranger && !stop) {
      ++request.request_id;
      (*stranger)->Publish(kMapRequestChannel, request);
    }
  });
  const double flooded = Rate(4);
  const map_reply_t reply = Ask("frames");
  stop = true;
  attacker.join();
  RecordProperty("alone", std::to_string(alone));
  RecordProperty("flooded", std::to_string(flooded));
  EXPECT_GT(flooded, 0.1 * alone);
  EXPECT_TRUE(reply.ok);
  EXPECT_LT(server->StandardError().size(), 20'000u);
  EXPECT_LT(ProcessMegabytes(server->pid()), 300);
}

TEST_F(Requests, BadOnesFillNeitherLogNorTerminal) {
  const auto server = StartServer();
  const auto exporter = Start("octomap-exporter");
  bool escapes = false;
  bus().Subscribe<map_reply_t>(kMapReplyChannel, [&](const map_reply_t& reply) {
    escapes = escapes || reply.message.find_first_of("\n\x1b") != std::string::npos;
  });
  for (int i = 0; i < 50'000; ++i) {
    map_request_t request = Request(
        next_id_++, i % 2 == 0 ? "no\nerror   map-server: all is lost\x1b[2J" : "octomap-\x1b]0;x");
    request.source = "\x1b[31mstranger\n" + std::to_string(i);
    bus().PublishAsIs(kMapRequestChannel, request);
    bus().Spin(0);
  }
  EXPECT_TRUE(Ask("statistics").ok);
  for (const auto* process : {server.get(), exporter.get()}) {
    const std::string log = process->StandardError();
    EXPECT_LT(log.size(), 50'000u);
    EXPECT_EQ(log.find('\x1b'), std::string::npos);
    EXPECT_THAT(log, Not(HasSubstr("\nerror ")));
  }
  EXPECT_FALSE(escapes) << "in a reply";
  EXPECT_LT(ProcessMegabytes(server->pid()), 200);
}

TEST_F(Requests, UnreadableMessagesFillNoLog) {
  std::vector<std::unique_ptr<ChildProcess>> processes;
  processes.push_back(StartServer());
  processes.push_back(Start("depth-segmenter"));
  processes.push_back(Start("octomap-exporter"));
  processes.push_back(processes_.Start("detector", {"--detections", "synthetic:room"}));
  ASSERT_TRUE(processes_.WaitForReady({"detector"}));
  const Result<LcmUrl> url = ParseLcmUrl(processes_.url());
  auto raw = OpenTcpqTransport(url->hub, nullptr);
  ASSERT_TRUE(raw);
  map_request_t request = Request(1, "\n\x1b[2J");
  const std::vector<uint8_t> other_type = Pack(request);
  TestRandom random(5);
  for (int i = 0; i < 50'000; ++i) {
    std::vector<uint8_t> bytes = other_type;
    for (int j = 0; j < 20; ++j)
      bytes[random.Below(bytes.size())] = static_cast<uint8_t>(random.Below(256));
    ASSERT_TRUE((*raw)->Publish(kAllChannels[random.Below(kAllChannels.size())].name, bytes));
    if (i % 100 == 0) bus().Spin(0);
  }
  SpinFor(1);
  EXPECT_TRUE(Ask("statistics").ok);
  for (const auto& process : processes) {
    EXPECT_TRUE(process->Running());
    EXPECT_LT(process->StandardError().size(), 30'000u);
    EXPECT_EQ(process->StandardError().find('\x1b'), std::string::npos);
  }
}

TEST_F(Requests, ThatAreRepeatedAreCarriedOutOnce) {
  const auto server = StartServer();
  Map(5);
  for (int i = 0; i < 2000; ++i) bus().Publish(kMapRequestChannel, Request(777, "reset"));
  ASSERT_TRUE(SpinUntil([&] { return replies_.contains(777); }));
  SpinFor(1.5);
  EXPECT_EQ(Counter("map-server", "requests_done"), 1);
}

}  // namespace
}  // namespace vismap::hostile
