#include "requests/octree_request.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "freespace/coarsen.h"
#include "freespace/octree_cache.h"
#include "navigation/inflate.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

constexpr double kVoxel = 0.01;

map_request_t AnyRequest() {
  map_request_t request{};
  request.verb = "octree";
  request.unknown = map_request_t::UNKNOWN_DEFAULT;
  return request;
}

map_request_t RequestOf(const Eigen::Vector3d& min_W, const Eigen::Vector3d& max_W) {
  map_request_t request = AnyRequest();
  request.has_bbx = 1;
  Eigen::Map<Eigen::Vector3d>(request.bbx_min_W) = min_W;
  Eigen::Map<Eigen::Vector3d>(request.bbx_max_W) = max_W;
  return request;
}

std::string Refusal(const map_request_t& request) {
  const Result<OctreeRequest> read = ReadOctreeRequest(request, kVoxel, {});
  return read ? "" : read.error().message;
}

/// 1.6 m of free space along each axis from the origin, with a floor.
OccupancyMap FreeRoom() {
  OccupancyMap map(kVoxel);
  for (int i = 0; i < 20 * 20 * 20; ++i) {
    map.Set({i % 20, i / 20 % 20, i / 400},
            BlockOccupancy(i < 400 ? CellState::kOccupied : CellState::kFree));
  }
  return map;
}

Result<Answer> AnswerTo(const map_request_t& request, const OccupancyMap& map = FreeRoom()) {
  const Result<OctreeRequest> read = ReadOctreeRequest(request, kVoxel, {});
  if (!read) return tl::unexpected(read.error());
  return AnswerOctree(map, *read, 77);
}

TEST(OctreeRequest, IsClosedWhenItStatesNoPolicy) {
  const Result<OctreeRequest> read = ReadOctreeRequest(AnyRequest(), kVoxel, {});
  ASSERT_TRUE(read);
  EXPECT_EQ(read->tree.unknown, UnknownPolicy::kOccupied);
  EXPECT_EQ(read->tree.resolution_m, 0.05);
  EXPECT_FALSE(read->tree.bounds_W);
  map_request_t request = AnyRequest();
  request.unknown = map_request_t::UNKNOWN_ABSENT;
  EXPECT_EQ(ReadOctreeRequest(request, kVoxel, {})->tree.unknown, UnknownPolicy::kAbsent);
}

TEST(OctreeRequest, RefusesNumbersThatAreImpossibleAndSaysWhatIsAllowed) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double wrong : {kNan, kInfinity, -kInfinity, -0.05, 0.033, 1e-9, 0.01, 1.0}) {
    map_request_t request = AnyRequest();
    request.resolution_m = wrong;
    EXPECT_THAT(Refusal(request), HasSubstr("resolution")) << wrong;
    EXPECT_THAT(Refusal(request), HasSubstr("2 to 64 times the voxel size")) << wrong;
  }
  for (const double wrong : {kNan, kInfinity, -0.1, 5.1}) {
    map_request_t request = AnyRequest();
    request.inflate_m = wrong;
    EXPECT_THAT(Refusal(request), HasSubstr("inflate_m: expected a radius from 0 to 28 leaves"));
  }
  for (const int8_t wrong : std::initializer_list<int8_t>{7, -2, 2}) {
    map_request_t request = AnyRequest();
    request.unknown = wrong;
    EXPECT_EQ(Refusal(request), "unknown: expected -1 (closed), 0 (raw) or 1 (closed), found " +
                                    std::to_string(wrong));
    request = AnyRequest();
    request.tree = wrong;
    EXPECT_THAT(Refusal(request), HasSubstr("tree: expected 0 (OcTree) or 1 (ColorOcTree)"));
  }
  for (const double wrong : {kNan, kInfinity, -kInfinity}) {
    EXPECT_THAT(Refusal(RequestOf({0, 0, wrong}, {1, 1, 1})), HasSubstr("octree bounds"));
    EXPECT_THAT(Refusal(RequestOf({0, 0, 0}, {1, wrong, 1})), HasSubstr("octree bounds"));
  }
  EXPECT_THAT(Refusal(RequestOf({0, 1, 0}, {1, 0.5, 1})),
              HasSubstr("each minimum below its maximum; found (0, 1, 0) to (1, 0.5, 1) m"));
  EXPECT_THAT(Refusal(RequestOf({0, 0, 0}, {1, 0, 1})), HasSubstr("octree bounds"));
}

TEST(OctreeRequest, RefusesTextsThatMeanNothing) {
  map_request_t request = AnyRequest();
  request.argument = "policy=closed";
  EXPECT_THAT(Refusal(request), HasSubstr("argument: expected none, found 'policy=closed'"));
  request = AnyRequest();
  request.unknown = map_request_t::UNKNOWN_ABSENT;
  request.inflate_m = 0.2;
  EXPECT_THAT(Refusal(request), HasSubstr("only closed trees can be inflated"));
}

TEST(AnswerOctree, StatesWhatTheTreeIs) {
  const Result<Answer> answer = AnswerTo(RequestOf({0.1, 0.2, 0.3}, {1.1, 1.2, 1.3}));
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->encoding, "bt");
  ASSERT_TRUE(answer->octree);
  EXPECT_EQ(answer->octree->utime, 77);
  EXPECT_TRUE(answer->octree->bounds_W.min().isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
  EXPECT_EQ(answer->octree->resolution, 0.05);
  EXPECT_EQ(answer->octree->shell, 1);
  EXPECT_THAT(answer->message, HasSubstr("closed, leaves of 0.05 m"));
}

TEST(AnswerOctree, InUnseenSpaceIsFullOfOccupiedSpaceAndNeverEmpty) {
  const map_request_t unseen = RequestOf({10, 10, 10}, {12, 12, 12});
  const Result<Answer> answer = AnswerTo(unseen);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_THAT(answer->message, HasSubstr("nothing is known in this box, all of it is occupied"));
  const Result<OctreeStreamInfo> info = CheckOctree(answer->payload, "reply");
  ASSERT_TRUE(info) << info.error().message;
  EXPECT_GT(info->nodes, 0);
  map_request_t raw = unseen;
  raw.unknown = map_request_t::UNKNOWN_ABSENT;
  EXPECT_THAT(AnswerTo(raw).error().message, HasSubstr("nothing is known in this box"));
  EXPECT_THAT(AnswerTo(AnyRequest(), OccupancyMap(kVoxel)).error().message,
              HasSubstr("nothing is known yet, so that the tree would be empty"));
}

TEST(OctreeRequest, NeedsOnlyTheBlocksOfItsBox) {
  const OccupancyMap whole = FreeRoom();
  for (const double radius : {0.0, 0.17}) {
    map_request_t request = RequestOf({0.42, 0.3, 0.3}, {0.66, 0.6, 0.5});
    request.inflate_m = radius;
    const OctreeRequest read = *ReadOctreeRequest(request, kVoxel, {});
    OccupancyMap part(kVoxel);
    for (const BlockIndex& block : BlocksIn(whole.blocks(), *read.Region(8 * kVoxel)))
      part.Set(block, whole.At(block));
    EXPECT_LT(part.size(), whole.size() / 6);
    EXPECT_EQ(AnswerOctree(part, read, 0)->payload, AnswerOctree(whole, read, 0)->payload);
  }
}

TEST(AnswerOctree, InflatedIsTheTreeOfInflatedLeavesWithinTheBox) {
  const OccupancyMap map = FreeRoom();
  map_request_t request = RequestOf({0.1, 0.1, 0.1}, {0.9, 0.9, 0.9});
  request.inflate_m = 0.2;
  const Result<Answer> answer = AnswerTo(request, map);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->octree->inflated_by, 0.2);
  const OccupancyMap leaves = Coarsen(map, {.factor = 5});
  const OccupancyMap inflated = *Inflate(leaves, {.radius_m = 0.2});
  OctreeCache cache;
  cache.Update(inflated, inflated.SortedIndices());
  const Eigen::AlignedBox3d box(Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Constant(0.9));
  const Result<OctreeBytes> expected = cache.Encode(
      inflated, {.resolution_m = 0.05, .unknown = UnknownPolicy::kOccupied, .bounds_W = box});
  EXPECT_EQ(answer->payload, expected->bytes);
  request.inflate_m = 0;
  EXPECT_NE(AnswerTo(request, map)->payload, expected->bytes);
}

}  // namespace
}  // namespace vismap
