#include "map_server/object_links.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

// Objects of two maps of the same frames, which are compared by what the frames show.

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

/// A map whose label i is the only one of object i.
LabelTable OneLabelPerObject(uint32_t count) {
  LabelTable table;
  table.GrowLabels(SegmentLabel{count + 1});
  for (uint32_t i = 1; i <= count; ++i) {
    LabelRecord& record = table.MutableRecord(SegmentLabel{i});
    record.frames = record.frames_with_detector = 10;
    record.instance_evidence[InstanceId{i}] = 9;
    record.class_evidence[ClassId{1}] = 9;
  }
  return table;
}

/// A frame that shows these labels, with as many pixels each.
std::vector<SeenSegment> Frame(const std::vector<std::pair<uint32_t, int32_t>>& segments) {
  std::vector<SeenSegment> seen;
  for (const auto& [label, pixels] : segments) seen.push_back({SegmentLabel{label}, pixels});
  return seen;
}

std::set<InstanceId> Objects(uint32_t count) {
  std::set<InstanceId> objects;
  for (uint32_t i = 1; i <= count; ++i) objects.insert(InstanceId{i});
  return objects;
}

ObjectLinks Link(const SeenByFrame& before, const SeenByFrame& after) {
  const LabelTable labels = OneLabelPerObject(9);
  return LinkObjects({before, labels, Objects(9)}, {after, labels, Objects(9)});
}

TEST(ObjectLinks, AreBetweenObjectsThatTheSamePixelsShow) {
  const SeenByFrame before = {{1, Frame({{1, 100}, {2, 50}, {0, 900}})},
                              {2, Frame({{1, 80}, {2, 10}})}};
  const SeenByFrame after = {{1, Frame({{4, 100}, {2, 50}, {0, 900}})},
                             {2, Frame({{4, 80}, {4, 10}})}};
  const ObjectLinks links = Link(before, after);
  EXPECT_THAT(links.became,
              ElementsAre(Pair(InstanceId{1}, InstanceId{4}), Pair(InstanceId{2}, InstanceId{2})));
  EXPECT_THAT(links.joined, IsEmpty());
  EXPECT_THAT(links.split, IsEmpty());
  EXPECT_THAT(links.gone, IsEmpty());
  EXPECT_THAT(links.came, IsEmpty());
  EXPECT_EQ(Sentence(links), "2 objects found again");
}

TEST(ObjectLinks, SayWhichOnesWereJoinedAndWhichWereSplit) {
  const SeenByFrame before = {{1, Frame({{1, 100}, {5, 60}, {5, 59}})},
                              {2, Frame({{3, 70}, {7, 40}, {0, 30}})}};
  const SeenByFrame after = {{1, Frame({{2, 100}, {5, 60}, {6, 59}})},
                             {2, Frame({{2, 70}, {0, 40}, {8, 30}})}};
  const ObjectLinks links = Link(before, after);
  EXPECT_THAT(links.joined,
              ElementsAre(Pair(InstanceId{2}, ElementsAre(InstanceId{1}, InstanceId{3}))));
  EXPECT_THAT(links.split,
              ElementsAre(Pair(InstanceId{5}, ElementsAre(InstanceId{5}, InstanceId{6}))));
  EXPECT_THAT(links.gone, ElementsAre(InstanceId{7}));
  EXPECT_THAT(links.came, ElementsAre(InstanceId{8}));
  EXPECT_THAT(Sentence(links),
              AllOf(HasSubstr("1 and 3 joined to 2"), HasSubstr("5 split to 5 and 6"),
                    HasSubstr("1 object gone"), HasSubstr("1 object new")));
  EXPECT_EQ(LinksJson(links),
            R"({"became":[[1,2],[3,2],[5,5]],"joined":[[[1,3],2]],"split":[[5,[5,6]]],)"
            R"("gone":[7],"came":[8]})");
}

TEST(ObjectLinks, AreOfObjectsAndFramesThatCount) {
  const LabelTable labels = OneLabelPerObject(9);
  const SeenByFrame before = {{1, Frame({{1, 100}, {2, 100}})}, {2, Frame({{2, 999}})}};
  const SeenByFrame after = {{1, Frame({{1, 100}, {2, 100}})}, {3, Frame({{1, 999}})}};
  const ObjectLinks links = LinkObjects({before, labels, Objects(1)}, {after, labels, Objects(9)});
  EXPECT_THAT(links.became, ElementsAre(Pair(InstanceId{1}, InstanceId{1})));
  EXPECT_THAT(links.came, ElementsAre(InstanceId{2}));
}

}  // namespace
}  // namespace vismap
