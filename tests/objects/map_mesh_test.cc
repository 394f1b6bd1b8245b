#include "objects/map_mesh.h"

#include <gtest/gtest.h>

#include "support/sphere_map.h"

namespace vismap {
namespace {

using namespace testing_support;

TEST(ExtractMesh, InstanceAndClassComeFromTheEvidence) {
  SemanticMap map = SphereMap();
  AddEvidence(&map, SegmentLabel{1}, InstanceId{7}, ClassId{62}, 10, 9);
  AddEvidence(&map, SegmentLabel{2}, InstanceId{0}, ClassId{0}, 10, 0);
  for (const MeshVertex& vertex : ExtractMesh(map).vertices) {
    const bool left = vertex.segment == SegmentLabel{1};
    EXPECT_EQ(vertex.instance, left ? InstanceId{7} : InstanceId::kNone);
    EXPECT_EQ(vertex.class_id, left ? ClassId{62} : ClassId::kUnknown);
  }
}

}  // namespace
}  // namespace vismap
