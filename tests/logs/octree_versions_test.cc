// Logs of every version of octree_t, map_request_t and map_reply_t are read. octrees_v1.lcmlog and
// octrees_v2.lcmlog hold one message of each, with the same content as far as both versions have
// it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <vismap/map_reply_v1_t.hpp>
#include <vismap/map_request_v1_t.hpp>
#include <vismap/octree_v1_t.hpp>

#include "logs/log_reader.h"
#include "wire/envelope.h"
#include "wire/octree_message.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;

/// The data of each channel.
std::map<std::string, std::vector<uint8_t>> Messages(const std::string& log) {
  std::map<std::string, std::vector<uint8_t>> messages;
  Result<LogReader> reader = LogReader::Open(std::string(VISMAP_SOURCE_DIR) + "/tests/logs/" + log);
  EXPECT_TRUE(reader) << log;
  while (reader) {
    const auto item = reader->Next();
    if (!item || !*item) break;
    const auto* event = std::get_if<LogEvent>(&**item);
    if (event != nullptr) messages[event->channel] = *reader->ReadData(*event);
  }
  return messages;
}

template <typename Message>
Message Read(const std::string& log, const std::string& channel) {
  const auto message = Unpack<Message>(Messages(log)[channel], size_t{1} << 20);
  EXPECT_TRUE(message) << message.error().message;
  return message.value_or(Message{});
}

TEST(OctreeVersions, TheFirstOnesHaveTheirFingerprints) {
  EXPECT_EQ(octree_v1_t::getHash(), static_cast<int64_t>(0x6bd8808b3be031b7));
  EXPECT_EQ(map_request_v1_t::getHash(), static_cast<int64_t>(0x81b3f5f25e1f2526));
  EXPECT_EQ(map_reply_v1_t::getHash(), static_cast<int64_t>(0x2a476678bccb021a));
}

TEST(OctreeVersions, AnOctreeOfBothIsTheSameTree) {
  const octree_t older = Read<octree_t>("octrees_v1.lcmlog", "OCTOMAP");
  const octree_t newer = Read<octree_t>("octrees_v2.lcmlog", "OCTOMAP");
  const Result<OctreeMessage> a = Decode(older), b = Decode(newer);
  ASSERT_TRUE(a) << a.error().message;
  ASSERT_TRUE(b) << b.error().message;
  EXPECT_EQ(a->octree.bytes, b->octree.bytes);
  EXPECT_GT(a->octree.nodes, 10);
  EXPECT_EQ(a->octree.bounds_W.max(), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(b->octree.bounds_W.max(), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(a->octree.unknown, UnknownPolicy::kOccupied);
  EXPECT_EQ(a->revision, 2);
  EXPECT_EQ(older.source, "octomap-exporter");
  EXPECT_EQ(older.seq, 4);
  EXPECT_EQ(a->octree.shell_m, 0) << "the first version had none";
  EXPECT_EQ(a->published_utime, 0);
  EXPECT_EQ(b->octree.shell_m, 1);
  EXPECT_EQ(b->published_utime, 2500);
  EXPECT_THAT(b->assumed_free, ElementsAre(VoxelIndex{1, 2, 3}));
}

TEST(OctreeVersions, ARequestOfBothAsksForTheSame) {
  for (const std::string log : {"octrees_v1.lcmlog", "octrees_v2.lcmlog"}) {
    const auto request = Read<map_request_t>(log, "MAP_REQUEST");
    EXPECT_EQ(request.request_id, 17);
    EXPECT_EQ(request.verb, "octree");
    EXPECT_EQ(request.argument, "a");
    EXPECT_EQ(request.path, "p");
    EXPECT_EQ(request.has_bbx, 1);
    EXPECT_EQ(request.bbx_max_W[2], 5);
    EXPECT_EQ(request.resolution_m, 0.05);
    EXPECT_EQ(request.unknown, map_request_t::UNKNOWN_OCCUPIED);
    EXPECT_EQ(request.tree, map_request_t::TREE_OCCUPANCY);
  }
  EXPECT_EQ(Read<map_request_t>("octrees_v1.lcmlog", "MAP_REQUEST").inflate_m, 0);
  EXPECT_EQ(Read<map_request_t>("octrees_v2.lcmlog", "MAP_REQUEST").inflate_m, 0.2);
}

TEST(OctreeVersions, AReplyOfBothHasTheSamePayload) {
  const auto older = Read<map_reply_t>("octrees_v1.lcmlog", "MAP_REPLY");
  const auto newer = Read<map_reply_t>("octrees_v2.lcmlog", "MAP_REPLY");
  EXPECT_EQ(older.requester, "planner");
  EXPECT_EQ(older.ok, 1);
  EXPECT_EQ(older.message, "done");
  EXPECT_EQ(older.payload, newer.payload);
  EXPECT_EQ(older.has_octree, 0);
  EXPECT_EQ(newer.has_octree, 1);
  EXPECT_EQ(newer.bbx_min_W[1], -2);
}

}  // namespace
}  // namespace vismap
