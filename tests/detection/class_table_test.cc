#include "detection/class_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/class_names.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ClassTable, CocoHasItsEightyClasses) {
  const ClassTable table = Coco80();
  ASSERT_EQ(table.size(), 80u);
  EXPECT_EQ(ClassName(table[0]), "person");
  EXPECT_EQ(ClassName(table[11]), "stop sign");
  EXPECT_EQ(ClassName(table[56]), "chair");
  EXPECT_EQ(ClassName(table[62]), "tv");
  EXPECT_EQ(ClassName(table[79]), "toothbrush");
  EXPECT_EQ(Coco90().size(), 90u);
  EXPECT_EQ(Coco90()[61], ClassId{62});
}

TEST(ClassTable, FilesNameOneClassPerLine) {
  const TempFolder folder;
  folder.Write("names.txt", "dining table\r\n1000 fire extinguisher\n-\ncup\n\n");
  const auto table = LoadClassTable((folder / "names.txt").string());
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_THAT(*table, ElementsAre(ClassId{67}, ClassId{1000}, ClassId::kUnknown, ClassId{47}));
}

TEST(ClassTable, ErrorsNameFileAndLine) {
  const TempFolder folder;
  const auto error = [&](const std::string& text) {
    folder.Write("names.txt", text);
    const auto table = LoadClassTable((folder / "names.txt").string());
    EXPECT_FALSE(table) << text;
    return table ? "" : table.error().message;
  };
  EXPECT_THAT(error("chair\nthrone\n"), AllOf(HasSubstr("names.txt:2"), HasSubstr("\"throne\"")));
  EXPECT_THAT(error("0 nothing\n"), HasSubstr("[1, 65535]"));
  EXPECT_THAT(error("7\n"), HasSubstr("names.txt:1"));
  EXPECT_THAT(error("chair\n\ncup\n"), HasSubstr("names.txt:3"));
  EXPECT_THAT(error(""), HasSubstr("no classes"));
  EXPECT_FALSE(LoadClassTable((folder / "none.txt").string()));
}

}  // namespace
}  // namespace vismap
