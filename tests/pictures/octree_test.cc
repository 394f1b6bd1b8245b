#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/octomap.h>

#include <random>
#include <set>
#include <sstream>

#include "pictures/octree_file.h"
#include "pictures/octree_picture.h"
#include "render/palette.h"

// Octrees are written by OctoMap itself.

namespace vismap {
namespace {

using ::testing::HasSubstr;
constexpr double kLeaf = 0.1;

std::vector<uint8_t> Bytes(const std::ostringstream& stream) {
  const std::string text = stream.str();
  return {text.begin(), text.end()};
}

octomap::point3d Center(int x, int y, int z) {
  const auto at = [](int i) { return static_cast<float>((i + 0.5) * kLeaf); };
  return {at(x), at(y), at(z)};
}

// Random leaves and a large free cube, which becomes a leaf of many sizes.
octomap::ColorOcTree RandomTree() {
  octomap::ColorOcTree tree(kLeaf);
  std::mt19937 random(5);
  for (int i = 0; i < 400; ++i) {
    const auto at = [&] { return static_cast<int>(random() % 40) - 20; };
    const octomap::point3d p = Center(at(), at(), at());
    tree.updateNode(p, random() % 2 == 0);
    tree.setNodeColor(p.x(), p.y(), p.z(), static_cast<uint8_t>(random()), 7, 9);
  }
  for (int x = 32; x < 64; ++x)
    for (int y = 0; y < 32; ++y)
      for (int z = 0; z < 32; ++z) tree.updateNode(Center(x, y, z), false);
  tree.updateInnerOccupancy();
  tree.prune();
  return tree;
}

void ExpectSameLeaves(const OctreeLeaves& leaves, octomap::ColorOcTree& tree) {
  EXPECT_NEAR(leaves.cells.cell_size(), kLeaf, 1e-12);
  for (int x = -22; x < 66; ++x) {
    for (int y = -22; y < 34; ++y) {
      for (int z = -22; z < 34; ++z) {
        const octomap::ColorOcTreeNode* node = tree.search(Center(x, y, z));
        const CellState state = leaves.cells.At(VoxelIndex{x, y, z});
        const CellState expected = node == nullptr             ? CellState::kUnknown
                                   : tree.isNodeOccupied(node) ? CellState::kOccupied
                                                               : CellState::kFree;
        ASSERT_EQ(state, expected) << x << " " << y << " " << z;
        if (!leaves.colors || expected != CellState::kOccupied) continue;
        const auto& colors = leaves.colors->at(BlockOf(VoxelIndex{x, y, z}));
        const Rgb8 color = colors[static_cast<size_t>(OffsetInBlock(VoxelIndex{x, y, z}))];
        ASSERT_EQ(color.r, node->getColor().r);
      }
    }
  }
}

TEST(ReadOctree, FullAndBinaryTreesOfOctoMap) {
  octomap::ColorOcTree tree = RandomTree();
  std::ostringstream full, binary, plain;
  ASSERT_TRUE(tree.write(full));
  const auto colored = ReadOctree(Bytes(full), "tree.ot");
  ASSERT_TRUE(colored) << colored.error().message;
  ASSERT_TRUE(colored->colors);
  ExpectSameLeaves(*colored, tree);

  octomap::OcTree same(kLeaf);
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf)
    same.setNodeValue(leaf.getKey(), leaf->getLogOdds());
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    // Larger leaves are written leaf by leaf.
    const int cells = 1 << (tree.getTreeDepth() - leaf.getDepth());
    for (int i = 0; cells > 1 && i < cells * cells * cells; ++i) {
      const double corner = (cells - 1) * kLeaf / 2;
      same.setNodeValue(
          octomap::point3d(static_cast<float>(leaf.getX() - corner + i % cells * kLeaf),
                           static_cast<float>(leaf.getY() - corner + i / cells % cells * kLeaf),
                           static_cast<float>(leaf.getZ() - corner + i / cells / cells * kLeaf)),
          leaf->getLogOdds());
    }
  }
  ASSERT_TRUE(same.write(plain));
  const auto full_plain = ReadOctree(Bytes(plain), "plain.ot");
  ASSERT_TRUE(full_plain) << full_plain.error().message;
  EXPECT_FALSE(full_plain->colors);
  ExpectSameLeaves(*full_plain, tree);
  ASSERT_TRUE(same.writeBinaryConst(binary));
  const auto small = ReadOctree(Bytes(binary), "tree.bt");
  ASSERT_TRUE(small) << small.error().message;
  ExpectSameLeaves(*small, tree);
}

TEST(ReadOctree, EveryDamageGivesAnErrorThatNamesTheFile) {
  octomap::ColorOcTree tree = RandomTree();
  std::ostringstream stream;
  ASSERT_TRUE(tree.write(stream));
  const std::vector<uint8_t> whole = Bytes(stream);
  for (size_t size = 0; size < whole.size(); size += 1 + size / 7) {
    const auto cut = ReadOctree(std::span(whole).first(size), "cut.ot");
    ASSERT_FALSE(cut) << size;
    EXPECT_THAT(cut.error().message, HasSubstr("cut.ot"));
  }
  std::vector<uint8_t> longer = whole;
  longer.push_back(0);
  EXPECT_FALSE(ReadOctree(longer, "longer.ot"));
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    std::vector<uint8_t> damaged = whole;
    damaged[random() % damaged.size()] ^= static_cast<uint8_t>(1 + random() % 255);
    const auto read = ReadOctree(damaged, "damaged.ot");
    const std::string problem = read ? "damaged.ot" : read.error().message;
    EXPECT_THAT(problem, HasSubstr("damaged.ot"));
  }
  std::string text(whole.begin(), whole.end());
  text.replace(text.find("ColorOcTree"), 11, "StampedTree");
  const auto other = ReadOctree(std::vector<uint8_t>(text.begin(), text.end()), "stamped.ot");
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("found 'StampedTree'"));
}

// A closed box of 8 x 8 x 8 leaves: occupied outside, free inside.
OctreeLeaves Box() {
  OctreeLeaves leaves;
  leaves.cells = OccupancyMap(kLeaf);
  OccupancyPlanes planes;
  for (int i = 0; i < kBlockVoxels; ++i) {
    const auto inside = [](int at) { return at > 0 && at < 7; };
    const bool free = inside(i & 7) && inside(i >> 3 & 7) && inside(i >> 6);
    (free ? planes.free : planes.occupied)[static_cast<size_t>(i) / 64] |= uint64_t{1} << (i % 64);
  }
  leaves.cells.Set({0, 0, 0}, BlockOccupancy(planes));
  return leaves;
}

size_t FacesOf(const LeafCubes& cubes) { return cubes.mesh.triangles.size() / 10; }

TEST(LeafCubes, FacesTowardFreeSpaceAreMadeAndThoseTowardTheUnknownAreNot) {
  const auto cubes = MakeLeafCubes(Box(), {});
  ASSERT_TRUE(cubes);
  EXPECT_EQ(cubes->free, 216);
  EXPECT_EQ(cubes->occupied, 296);
  EXPECT_EQ(FacesOf(*cubes), 6u * 36u);
  for (const auto& triangle : cubes->mesh.triangles) {
    const auto& v = cubes->mesh.vertices;
    const Eigen::Vector3f a = v[triangle[0]].position_W, b = v[triangle[1]].position_W,
                          c = v[triangle[2]].position_W;
    // Front sides look into the box.
    const Eigen::Vector3f normal = (b - a).cross(c - a).normalized();
    EXPECT_NEAR((normal - v[triangle[0]].normal_W).norm(), 0, 1e-4);
    EXPECT_GT(normal.dot(Eigen::Vector3f::Constant(0.4F) - a), 0);
  }
}

TEST(LeafCubes, WithoutFreeLeavesAllSidesAreMade) {
  OctreeLeaves leaves;
  leaves.cells = OccupancyMap(kLeaf);
  leaves.cells.Set({0, 0, 0}, BlockOccupancy(CellState::kOccupied));
  EXPECT_EQ(FacesOf(*MakeLeafCubes(leaves, {})), 6u * 64u);
  EXPECT_EQ(FacesOf(*MakeLeafCubes({}, {})), 0u);
}

TEST(LeafCubes, CutIsClosedAndShownInItsOwnHeights) {
  const auto cut = MakeLeafCubes(Box(), {.below_m = 0.35});
  ASSERT_TRUE(cut);
  // Layers 0, 1 and 2: floor, three walls' rows of 6 at four sides in layers 1 and 2, and the cut
  // through the walls of layer 2: 64 - 36 leaves.
  EXPECT_EQ(FacesOf(*cut), 36u + 2u * 4u * 6u + 28u);
  EXPECT_EQ(cut->scale->low, "0.05 m");
  EXPECT_EQ(cut->scale->high, "0.25 m");
  const auto down = MakeLeafCubes(Box(), {.up_W = -Eigen::Vector3d::UnitZ(), .below_m = -0.45});
  EXPECT_EQ(FacesOf(*down), 36u + 2u * 4u * 6u + 28u);
}

TEST(LeafCubes, ColoursAreThoseOfTheFileWhenAskedFor) {
  OctreeLeaves leaves = Box();
  BlockColors colors;
  colors.fill({10, 200, 30});
  leaves.colors.emplace().emplace(BlockIndex{0, 0, 0}, colors);
  const auto with = [&](bool file_colors) {
    const auto cubes = MakeLeafCubes(leaves, {.file_colors = file_colors});
    std::set<uint8_t> greens;
    for (const MeshVertex& vertex : cubes->mesh.vertices) greens.insert(vertex.color.g);
    return greens;
  };
  EXPECT_EQ(with(true), (std::set<uint8_t>{110, 200}));  // and the darker edges
  EXPECT_GT(with(false).size(), 6u);
}

}  // namespace
}  // namespace vismap
