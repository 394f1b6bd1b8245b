// Logs of every version of mesh_delta_t are read. meshes_v1.lcmlog and meshes_v2.lcmlog hold the
// same surface, which Python's package of each version wrote: two blocks, and one without surface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vismap/mesh_block_v1_t.hpp>
#include <vismap/mesh_delta_v1_t.hpp>

#include "logs/log_reader.h"
#include "wire/envelope.h"
#include "wire/mesh_follower.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;

/// Of this surface, as the first version computed it.
constexpr const char* kDigest = "3b84bff1493eb28b7ab2b9f42891cbc8";

std::vector<uint8_t> MessageIn(const std::string& log) {
  Result<LogReader> reader = LogReader::Open(std::string(VISMAP_SOURCE_DIR) + "/tests/logs/" + log);
  EXPECT_TRUE(reader) << log;
  while (reader) {
    const auto item = reader->Next();
    if (!item || !*item) break;
    const auto* event = std::get_if<LogEvent>(&**item);
    if (event != nullptr && event->channel == "MESH_DELTA") return *reader->ReadData(*event);
  }
  ADD_FAILURE() << log << " has no MESH_DELTA";
  return {};
}

mesh_delta_t Read(const std::string& log) {
  const auto message = Unpack<mesh_delta_t>(MessageIn(log), size_t{1} << 20);
  EXPECT_TRUE(message) << message.error().message;
  return message.value_or(mesh_delta_t{});
}

TEST(MeshVersions, TheFirstOneHasItsFingerprint) {
  EXPECT_EQ(mesh_delta_v1_t::getHash(), static_cast<int64_t>(0x4b9e90188ebe7395));
  EXPECT_EQ(mesh_block_v1_t::getHash(), static_cast<int64_t>(0x9fafe9930095d675));
}

TEST(MeshVersions, LogsOfBothHaveTheSameSurfaceAndDigest) {
  for (const std::string log : {"meshes_v1.lcmlog", "meshes_v2.lcmlog"}) {
    SCOPED_TRACE(log);
    const mesh_delta_t message = Read(log);
    EXPECT_EQ(message.utime, 2000);
    EXPECT_EQ(message.seq, 4);
    EXPECT_EQ(message.source, "map-server");
    ASSERT_EQ(message.blocks.size(), 3u);
    EXPECT_EQ(message.blocks[1].n_vertices, 0);
    MeshFollower follower;
    ASSERT_EQ(follower.Apply(message), FollowOutcome::kApplied);
    EXPECT_EQ(follower.position().map_id, "kitchen");
    EXPECT_EQ(follower.position().revision, 9);
    EXPECT_EQ(follower.block_count(), 2u);
    EXPECT_EQ(follower.triangle_count(), 5u);
    EXPECT_EQ(follower.Digest(), kDigest);
    const Mesh mesh = follower.Joined();
    ASSERT_EQ(mesh.vertices.size(), 9u);
    EXPECT_EQ(mesh.vertices[1].segment, SegmentLabel{1001});
    EXPECT_EQ(mesh.vertices[1].color, (Rgb8{11, 200, 3}));
  }
}

TEST(MeshVersions, TheFirstOneDoesNotKnowHowOftenTheSurfaceWasSeen) {
  EXPECT_THAT(Read("meshes_v1.lcmlog").blocks[0].seen, ElementsAre(0, 0, 0, 0, 0));
  EXPECT_THAT(Read("meshes_v2.lcmlog").blocks[0].seen, ElementsAre(1, 2, 3, 4, 5));
  for (const MeshVertex& vertex : Decode(Read("meshes_v1.lcmlog"))->mesh.blocks[2].mesh.vertices)
    EXPECT_EQ(vertex.seen, 0);
}

TEST(MeshVersions, ADamagedMessageOfTheFirstOneIsRefused) {
  std::vector<uint8_t> bytes = MessageIn("meshes_v1.lcmlog");
  bytes.back() ^= 1;
  const auto damaged = Unpack<mesh_delta_t>(bytes, size_t{1} << 20);
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().message, ::testing::HasSubstr("checksum"));
}

}  // namespace
}  // namespace vismap
