#include "base/class_names.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

TEST(ClassNames, AreThoseOfCoco) {
  EXPECT_EQ(ClassName(ClassId{0}), "unknown");
  EXPECT_EQ(ClassName(ClassId{1}), "person");
  EXPECT_EQ(ClassName(ClassId{13}), "stop sign");
  EXPECT_EQ(ClassName(ClassId{27}), "backpack");
  EXPECT_EQ(ClassName(ClassId{44}), "bottle");
  EXPECT_EQ(ClassName(ClassId{47}), "cup");
  EXPECT_EQ(ClassName(ClassId{62}), "chair");
  EXPECT_EQ(ClassName(ClassId{63}), "couch");
  EXPECT_EQ(ClassName(ClassId{64}), "potted plant");
  EXPECT_EQ(ClassName(ClassId{67}), "dining table");
  EXPECT_EQ(ClassName(ClassId{72}), "tv");
  EXPECT_EQ(ClassName(ClassId{82}), "refrigerator");
  EXPECT_EQ(ClassName(ClassId{84}), "book");
  EXPECT_EQ(ClassName(ClassId{90}), "toothbrush");
  EXPECT_EQ(ClassName(ClassId{200}), "class 200");
}

TEST(ClassNames, GoBothWays) {
  for (int id = 0; id <= 91; ++id) {
    EXPECT_EQ(ClassFromName(ClassName(static_cast<ClassId>(id))), static_cast<ClassId>(id));
  }
  EXPECT_FALSE(ClassFromName("sofa"));
}

}  // namespace
}  // namespace vismap
