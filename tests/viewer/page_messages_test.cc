#include "viewer/page_messages.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "viewer/mesh_messages.h"

namespace vismap {
namespace {

using testing_support::SomeBlock;

template <typename Number>
Number At(const std::vector<uint8_t>& bytes, size_t offset) {
  Number number{};
  EXPECT_LE(offset + sizeof number, bytes.size());
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

TEST(PageMessages, BlockHasHeaderAndArraysAtMultiplesOfFour) {
  const std::vector<uint8_t> bytes = EncodePageBlock(SomeBlock(-1, 2, 3, 1), 0x1122334455667788, 9);
  EXPECT_EQ(bytes[0], 1);
  EXPECT_EQ(At<uint16_t>(bytes, 2), 0);
  EXPECT_EQ(At<int32_t>(bytes, 4), -1);
  EXPECT_EQ(At<int32_t>(bytes, 8), 2);
  EXPECT_EQ(At<int32_t>(bytes, 12), 3);
  EXPECT_EQ(At<float>(bytes, 16), 0.5F);
  EXPECT_EQ(At<uint32_t>(bytes, 20), 9u);
  EXPECT_EQ(At<uint32_t>(bytes, 24), 3u);
  EXPECT_EQ(At<uint32_t>(bytes, 28), 1u);
  EXPECT_EQ(At<uint64_t>(bytes, 32), 0x1122334455667788u);
  const size_t positions = kPageBlockHeader, normals = positions + 24, colors = normals + 12;
  const size_t segments = colors + 12, instances = segments + 12, classes = instances + 12;
  const size_t indices = classes + 8;  // 3 * 2 bytes, padded
  EXPECT_EQ(At<uint16_t>(bytes, positions), 40000);
  EXPECT_EQ(At<uint16_t>(bytes, positions + 8), 40001);
  EXPECT_EQ(At<int8_t>(bytes, normals), -127);
  EXPECT_EQ(At<uint8_t>(bytes, colors + 4), 11);
  EXPECT_EQ(At<uint8_t>(bytes, colors + 7), 201) << "how often it was seen";
  EXPECT_EQ(At<uint32_t>(bytes, segments + 8), 100002u);
  EXPECT_EQ(At<uint32_t>(bytes, instances), 7u);
  EXPECT_EQ(At<uint16_t>(bytes, classes + 4), 62);
  EXPECT_EQ(At<uint16_t>(bytes, indices + 4), 2);
  EXPECT_EQ(bytes.size(), indices + 8);
}

TEST(PageMessages, BlockWithManyVerticesHasWideIndices) {
  const std::vector<uint8_t> bytes = EncodePageBlock(SomeBlock(0, 0, 0, 21846), 1, 1);
  EXPECT_EQ(At<uint16_t>(bytes, 2), 1);
  EXPECT_EQ(At<uint32_t>(bytes, bytes.size() - 4), 65537u);
}

TEST(PageMessages, DeletedBlockIsItsHeader) {
  const std::vector<uint8_t> bytes = EncodeDeletedBlock({4, 5, -6}, 0.5, 3);
  EXPECT_EQ(bytes.size(), kPageBlockHeader);
  EXPECT_EQ(At<int32_t>(bytes, 12), -6);
  EXPECT_EQ(At<uint32_t>(bytes, 24), 0u);
}

// The page's own tests decode this file. VISMAP_WRITE_GOLDEN=1 writes it anew.
TEST(PageMessages, BlockIsAsInTheFileThatThePageIsTestedWith) {
  const std::string path = std::string(VISMAP_SOURCE_DIR) + "/tests/viewer/block.bin";
  const std::vector<uint8_t> bytes = EncodePageBlock(SomeBlock(-1, 2, 3, 2), 0x0102030405060708, 5);
  if (std::getenv("VISMAP_WRITE_GOLDEN") != nullptr) {
    ASSERT_TRUE(WriteFileAtomically(path, std::span<const uint8_t>(bytes)));
  }
  const auto golden = ReadFileBytes(path);
  ASSERT_TRUE(golden);
  EXPECT_EQ(bytes, *golden);
}

TEST(PageMessages, PictureHasPaddedJsonBeforeItsJpeg) {
  const std::vector<uint8_t> jpeg = {0xff, 0xd8, 1};
  const std::vector<uint8_t> bytes = EncodePicture(3, "{\"a\":1}", jpeg);
  EXPECT_EQ(bytes[0], 2);
  EXPECT_EQ(bytes[1], 3);
  EXPECT_EQ(At<uint32_t>(bytes, 4), 8u);
  EXPECT_EQ(std::string(bytes.begin() + 8, bytes.begin() + 16), "{\"a\":1} ");
  EXPECT_EQ(std::vector<uint8_t>(bytes.begin() + 16, bytes.end()), jpeg);
}

TEST(PageMessages, TextFromTheBusIsAlwaysValidJson) {
  object_list_t list{};
  list.map_id = "a\"\x80\xff";
  list.n_objects = 1;
  list.objects.resize(1);
  list.objects[0].class_name = "\x01 chair";
  list.objects[0].removed_utime = 5;
  const auto json = nlohmann::json::parse(ObjectsText(list));
  EXPECT_EQ(json["kind"], "objects");
  EXPECT_TRUE(json["objects"][0]["removed"]);
  EXPECT_FALSE(json["objects"][0].contains("center"));
  EXPECT_EQ(nlohmann::json::parse(ErrorText("\xc3(")).size(), 1u);
}

TEST(PageMessages, MapSaysDigestAsSixteenDigitsAndResetOnlyWhenItIsOne) {
  MapSummary map;
  map.digest = 0xab;
  const auto json = nlohmann::json::parse(MapText(map, 3, false));
  EXPECT_EQ(json["digest"], "00000000000000ab");
  EXPECT_EQ(json["waiting"], 3);
  EXPECT_EQ(json["bytes"], nlohmann::json::object());
  map.bytes["labels"] = 12;
  map.server_start_utime = 77;
  const auto measured = nlohmann::json::parse(MapText(map, 0, false));
  EXPECT_EQ(measured["bytes"]["labels"], 12);
  EXPECT_EQ(measured["server_start_utime"], 77);
  EXPECT_FALSE(json.contains("reset"));
  EXPECT_TRUE(nlohmann::json::parse(MapText(map, 0, true))["reset"]);
}

}  // namespace
}  // namespace vismap
