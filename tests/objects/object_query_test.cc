#include "objects/object_query.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismap {
namespace {

using ::testing::HasSubstr;

ObjectSummary Thing(uint32_t instance, uint32_t segment, ClassId class_id,
                    const Eigen::Vector3d& center_W) {
  ObjectSummary object;
  object.instance = static_cast<InstanceId>(instance);
  object.segments = {static_cast<SegmentLabel>(segment)};
  object.class_id = class_id;
  object.box.center_W = center_W;
  object.box.size = {0.4, 0.4, 0.4};
  return object;
}

std::vector<ObjectSummary> Objects() {
  std::vector<ObjectSummary> objects{
      Thing(1, 3, ClassId{62}, {0, 0, 0}), Thing(4, 5, ClassId{67}, {2, 0, 0}),
      Thing(0, 9, ClassId::kUnknown, {2, 1, 0}), Thing(6, 7, ClassId{62}, {0, 0, 0})};
  objects[3].state = ObjectState::kRemoved;
  return objects;
}

/// The first segments of what is selected.
std::vector<uint32_t> Selected(const std::string& text) {
  const Result<ObjectQuery> query = ParseObjectQuery(text);
  EXPECT_TRUE(query) << query.error().message;
  const auto objects = SelectObjects(Objects(), *query);
  EXPECT_TRUE(objects) << objects.error().message;
  std::vector<uint32_t> segments;
  for (const ObjectSummary& object : *objects) segments.push_back(Raw(object.segments[0]));
  return segments;
}

std::string ErrorOf(const std::string& text) {
  const Result<ObjectQuery> query = ParseObjectQuery(text);
  if (!query) return query.error().message;
  const auto objects = SelectObjects(Objects(), *query);
  EXPECT_FALSE(objects) << text;
  return objects ? "" : objects.error().message;
}

using Segments = std::vector<uint32_t>;

TEST(ObjectQuery, SelectsByIdClassAndRegion) {
  EXPECT_EQ(Selected(""), (Segments{3, 5, 9, 7}));
  EXPECT_EQ(Selected("id=4"), Segments{5});
  EXPECT_EQ(Selected("id=s9"), Segments{9});
  EXPECT_EQ(Selected("id=segment_9"), Segments{9});
  EXPECT_EQ(Selected("class=chair"), (Segments{3, 7}));
  EXPECT_EQ(Selected("class=67"), Segments{5});
  EXPECT_EQ(Selected("class=dining table;id=4"), Segments{5});
  EXPECT_EQ(Selected("region=1.5,-1,-1,3,2,1"), (Segments{5, 9}));
  EXPECT_EQ(Selected("region=0.19,0,0,1,1,1"),
            Segments{3});  // by its edge; removed ones are nowhere
  EXPECT_EQ(Selected("region=0.21,0,0,1,1,1"), Segments{});
  EXPECT_EQ(Selected("class=cup"), Segments{});
}

TEST(ObjectQuery, SaysWhatIsWrong) {
  EXPECT_THAT(ErrorOf("id=99"), HasSubstr("no object with id 99; its instances are 1, 4, 6"));
  EXPECT_THAT(ErrorOf("id=s99"), HasSubstr("no object with id s99"));
  for (const std::string id : {"", "0", "-1", "x", "s", "7 ", "4294967296"})
    EXPECT_THAT(ErrorOf("id=" + id), HasSubstr("'" + id + "' is not the id"));
  EXPECT_THAT(ErrorOf("class=chairs"), HasSubstr("'chairs' is neither a COCO class"));
  for (const std::string region :
       {"", "1", "0,0,0,1,1", "0,0,0,1,1,1,1", "0,0,0,1,1,x", "0,0,0,1,1,nan", "0,0,2,1,1,1"})
    EXPECT_THAT(ErrorOf("region=" + region), HasSubstr("'" + region + "' is not a region"));
  EXPECT_THAT(ErrorOf("colour=red"), HasSubstr("unknown condition for objects 'colour=red'"));
}

TEST(ObjectQuery, ItsTextIsReadBack) {
  for (const std::string text : {"", "id=4", "id=s9;class=62", "region=0.1,-2,0,1.25,1,1e-07"}) {
    const Result<ObjectQuery> query = ParseObjectQuery(text);
    ASSERT_TRUE(query) << text;
    EXPECT_EQ(ToText(*query), text);
  }
}

}  // namespace
}  // namespace vismap
