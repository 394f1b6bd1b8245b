#include "exports/outputs.h"

#include <gtest/gtest.h>

#include "exports/ply.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

TEST(WriteObjectMeshes, RemovesMeshesOfAnEarlierRunAndNothingThatItDidNotWrite) {
  const TempFolder folder;
  const PlyInfo with_classes{"map", {{ClassId{1}, "person"}, {ClassId{62}, "chair"}}};
  for (const std::string name : {"instance_3_chair.ply", "instance_7.ply", "segment_12.ply"})
    ASSERT_TRUE(WritePly(folder / name, Mesh{}, with_classes));
  ASSERT_TRUE(WritePly(folder / "segment_copy.ply", Mesh{}, {}));
  folder.Write("segment_notes.ply", "mine");
  folder.Write("segment_13.ply", "mine");
  folder.Write("segment_14.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n");
  folder.Write("instance_8.ply", "");
  folder.Write("instance_3_chair.ply.bak", "mine");
  fs::create_directory(folder / "segment_15.ply");
  fs::create_symlink("elsewhere", folder / "segment_16.ply");

  ASSERT_TRUE(WriteObjectMeshes({}, {}, folder.path()));
  for (const std::string name : {"instance_3_chair.ply", "instance_7.ply", "segment_12.ply"})
    EXPECT_FALSE(fs::exists(folder / name)) << name;
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 8);
}

}  // namespace
}  // namespace vismap
