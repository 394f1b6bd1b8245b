#include "requests/object_edits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string EditRefusal(const std::string& without) {
  const auto terms = ParseObjectEdits(without);
  return terms ? "none" : terms.error().message;
}

TEST(ObjectEdits, TermsNameObjectsAndWhatIsWanted) {
  const auto terms = ParseObjectEdits("id=7;class=cup:unknown;id=s12:inflate=0.15");
  ASSERT_TRUE(terms) << terms.error().message;
  ASSERT_EQ(terms->size(), 3u);
  EXPECT_EQ((*terms)[0].query.instance, InstanceId{7});
  EXPECT_EQ((*terms)[0].action, ObjectAction::kLeaveOut);
  EXPECT_EQ((*terms)[1].query.class_id, ClassId{47});
  EXPECT_EQ((*terms)[1].action, ObjectAction::kMakeUnknown);
  EXPECT_EQ((*terms)[2].query.segment, SegmentLabel{12});
  EXPECT_EQ((*terms)[2].action, ObjectAction::kInflate);
  EXPECT_EQ((*terms)[2].inflate_m, 0.15);
}

TEST(ObjectEdits, RefusesWhatNamesNoObjectOrNoAction) {
  EXPECT_THAT(EditRefusal(""), HasSubstr("no object is named"));
  EXPECT_THAT(EditRefusal(";"), AllOf(HasSubstr("without: ''"), HasSubstr("expected id=7")));
  EXPECT_THAT(EditRefusal("cup"), AllOf(HasSubstr("'cup'"), HasSubstr("class=NAME")));
  EXPECT_THAT(EditRefusal("id=x"), HasSubstr("'x' is not the id of an object"));
  EXPECT_THAT(EditRefusal("class=cups"), HasSubstr("'cups' is neither a COCO class"));
  EXPECT_THAT(EditRefusal("region=0,0,0,1,1,1"), HasSubstr("expected id=7"));
  EXPECT_THAT(EditRefusal("id=7:gone"), AllOf(HasSubstr("'id=7:gone'"), HasSubstr(":unknown")));
  for (const char* number : {"", "x", "nan", "inf", "-0.1", "0", "0.1m"}) {
    EXPECT_THAT(EditRefusal("id=7:inflate=" + std::string(number)),
                HasSubstr("not a number of metres above 0"));
  }
}

TEST(ObjectEdits, RefusesObjectsThatTheMapDoesNotHave) {
  const SemanticMap map(VoxelGridOptions{0.01, 4.0});
  ObjectSummary cup;
  cup.instance = InstanceId{3};
  cup.class_id = ClassId{47};
  const auto blocks = [](SegmentLabel) { return std::span<const BlockIndex>(); };
  const auto refusal = [&](const std::string& without) {
    const auto edits = ReadEdits(map, std::span(&cup, 1), blocks, without);
    if (!edits) return edits.error().message;
    const auto space = EditSpace(map, *edits, {});
    return space ? std::string("none") : space.error().message;
  };
  EXPECT_EQ(refusal("id=3"), "none");
  EXPECT_EQ(refusal("id=99"), "without: the map has no object with id 99; its instances are 3");
  EXPECT_THAT(refusal("class=chair"), HasSubstr("no object with class=62"));
  EXPECT_THAT(refusal("id=3:inflate=0.29"), HasSubstr("expected from 0 to 0.28"));
}

TEST(ObjectEdits, BlocksSurviveTheAnswer) {
  EditedSpace space;
  space.delta.voxel_size = 0.01;
  space.delta.blocks = {{{1, 2, 3}, BlockOccupancy(CellState::kFree)},
                        {{1, 2, 4}, BlockOccupancy(CellState::kUnknown)}};
  const Answer answer = AnswerOccupancy(space);
  EXPECT_EQ(answer.encoding, "occupancy");
  const auto read = ReadOccupancy(answer.payload);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*read, space.delta);
  EXPECT_FALSE(ReadOccupancy(std::vector<uint8_t>{1, 2, 3}));
}

}  // namespace
}  // namespace vismap
