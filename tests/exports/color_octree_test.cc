#include "exports/color_octree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/octomap.h>

#include <map>
#include <memory>
#include <sstream>
#include <string>

#include "exports/outputs.h"
#include "objects/read_out.h"
#include "render/palette.h"
#include "support/sphere_map.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

OctreeBytes TreeOf(const SemanticMap& map, UnknownPolicy unknown) {
  OutputOptions options;
  options.octree.resolution_m = 0.06;
  return *MakeOctree(map, {}, options, unknown);
}

template <typename Tree>
std::unique_ptr<Tree> Read(const std::vector<uint8_t>& bytes) {
  std::istringstream stream(std::string(bytes.begin(), bytes.end()));
  return std::unique_ptr<Tree>(dynamic_cast<Tree*>(octomap::AbstractOcTree::read(stream)));
}

Rgb8 ColorOfLabel(const SemanticMap& map, size_t label) {
  const ShownLabel shown = ShowLabels(map.labels)[label];
  MeshVertex vertex;
  vertex.segment = shown.segment;
  vertex.instance = shown.instance;
  vertex.class_id = shown.class_id;
  return VertexColor(vertex, Coloring::kClass);
}

TEST(ColorOctree, OctomapReadsTheSameLeavesWithTheColoursOfTheirLabels) {
  const SemanticMap map = testing_support::SphereMap();
  const Rgb8 left = ColorOfLabel(map, 1), right = ColorOfLabel(map, 2);
  ASSERT_NE(left, right);
  const OctreeBytes plain = TreeOf(map, UnknownPolicy::kAbsent);
  const Result<std::vector<uint8_t>> bytes = ColorOctree(plain.bytes, map);
  ASSERT_TRUE(bytes) << bytes.error().message;
  const auto tree = Read<octomap::ColorOcTree>(*bytes);
  ASSERT_NE(tree, nullptr);
  EXPECT_EQ(tree->getResolution(), 0.06);
  std::istringstream stream(std::string(plain.bytes.begin(), plain.bytes.end()));
  octomap::OcTree reference(0.06);
  ASSERT_TRUE(reference.readBinary(stream));

  int colored = 0;
  for (double z = -0.57; z < 0.6; z += 0.06) {
    for (double y = -0.57; y < 0.6; y += 0.06) {
      for (double x = -0.57; x < 0.6; x += 0.06) {
        const octomap::ColorOcTreeNode* node = tree->search(x, y, z);
        const octomap::OcTreeNode* same = reference.search(x, y, z);
        ASSERT_EQ(node == nullptr, same == nullptr);
        if (node == nullptr) continue;
        ASSERT_EQ(tree->isNodeOccupied(node), reference.isNodeOccupied(same));
        if (!tree->isNodeOccupied(node)) {
          ASSERT_FALSE(node->isColorSet());
          continue;
        }
        const Rgb8 color{node->getColor().r, node->getColor().g, node->getColor().b};
        if (std::abs(x - testing_support::kSphereCenter.x()) < 0.06 || color == kUnsegmentedColor)
          continue;
        ASSERT_EQ(color, x < testing_support::kSphereCenter.x() ? left : right) << x;
        ++colored;
      }
    }
  }
  EXPECT_GT(colored, 200);
}

TEST(ColorOctree, OfAClosedTreeHasTheSameOccupiedSpace) {
  const SemanticMap map = testing_support::SphereMap();
  const OctreeBytes plain = TreeOf(map, UnknownPolicy::kOccupied);
  const auto tree = Read<octomap::ColorOcTree>(ColorOctree(plain.bytes, map).value());
  ASSERT_NE(tree, nullptr);
  const octomap::ColorOcTreeNode* shell = tree->search(1.4, 0.0, 0.0);
  ASSERT_NE(shell, nullptr);
  EXPECT_TRUE(tree->isNodeOccupied(shell));
  EXPECT_EQ(shell->getColor().r, kUnsegmentedColor.r);
}

TEST(ColorOctree, RefusesWhatIsNoOctree) {
  const SemanticMap map = testing_support::SphereMap();
  std::vector<uint8_t> bytes = TreeOf(map, UnknownPolicy::kAbsent).bytes;
  bytes.pop_back();
  EXPECT_THAT(ColorOctree(bytes, map).error().message, HasSubstr("octree to be coloured"));
}

}  // namespace
}  // namespace vismap
