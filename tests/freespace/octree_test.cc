#include "freespace/octree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include <cstdlib>
#include <filesystem>
#include <limits>
#include <utility>

#include "base/file.h"
#include "freespace/octomap_reference.h"
#include "freespace/octree_builder.h"
#include "freespace/octree_reading.h"
#include "freespace/random_occupancy.h"
#include "support/analytic_map.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
using testing_support::CellAt;
using testing_support::EncodeOctree;
using testing_support::OctomapBytes;
using testing_support::Random;
using testing_support::RandomOccupancy;
using testing_support::ReadOctree;
using testing_support::Text;
using Tree = std::unique_ptr<octomap::OcTree>;

TEST(EncodeOctree, BytesAreThoseOfOctomap) {
  for (uint64_t seed = 0; seed < 12; ++seed) {
    const OccupancyMap leaves = RandomOccupancy(seed, 10 + 20 * static_cast<int>(seed));
    for (const UnknownPolicy unknown : {UnknownPolicy::kAbsent, UnknownPolicy::kOccupied}) {
      const Result<OctreeBytes> octree = EncodeOctree(leaves, 0.05, unknown, std::nullopt);
      ASSERT_TRUE(octree);
      ASSERT_EQ(Text(octree->bytes), OctomapBytes(leaves, 0.05, unknown, *leaves.KnownCells()));
    }
  }
}

TEST(EncodeOctree, BoundsCutTheTreeAndAreClosedWhollyEvenBeyondTheMap) {
  const OccupancyMap leaves = RandomOccupancy(77, 120);
  const Eigen::AlignedBox3d bounds_W(Eigen::Vector3d(-0.55, -3.0, -0.2),
                                     Eigen::Vector3d(2.35, 0.4, 0.15));
  const OccupancyBox box{{-11, -60, -4}, {47, 8, 3}};
  for (const UnknownPolicy unknown : {UnknownPolicy::kAbsent, UnknownPolicy::kOccupied}) {
    const Result<OctreeBytes> octree = EncodeOctree(leaves, 0.05, unknown, bounds_W);
    ASSERT_TRUE(octree);
    EXPECT_EQ(Text(octree->bytes), OctomapBytes(leaves, 0.05, unknown, box));
    EXPECT_TRUE(octree->bounds_W.isApprox(bounds_W, 1e-9));
  }
}

TEST(EncodeOctree, BoundsThatAreImpossibleOrTooLargeAreErrors) {
  const OccupancyMap leaves = RandomOccupancy(77, 120);
  const auto encode = [&](double low, double high, UnknownPolicy unknown) {
    return EncodeOctree(
        leaves, 0.05, unknown,
        Eigen::AlignedBox3d(Eigen::Vector3d(low, low, low), Eigen::Vector3d(high, high, high)));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const UnknownPolicy unknown : {UnknownPolicy::kAbsent, UnknownPolicy::kOccupied}) {
    for (const auto& [low, high] : {std::pair(nan, nan),
                                    {-infinity, infinity},
                                    {1.0, -1.0},
                                    {1.0, 1.0},
                                    {0.026, 0.049},
                                    {2000.0, 2001.0}})
      EXPECT_THAT(encode(low, high, unknown).error().message, HasSubstr("octree bounds"));
  }
  for (const double reach : {999.97, 1e300}) {
    EXPECT_THAT(encode(-reach, reach, UnknownPolicy::kOccupied).error().message,
                HasSubstr("too large to write unknown space as occupied"));
    const Result<OctreeBytes> open = encode(-reach, reach, UnknownPolicy::kAbsent);
    ASSERT_TRUE(open) << open.error().message;
    EXPECT_EQ(open->bytes, EncodeOctree(leaves, 0.05, UnknownPolicy::kAbsent, std::nullopt)->bytes);
  }
}

/// The box and at least `leaves` leaves around it, up to whole cubes of 32 leaves.
OccupancyBox OuterBox(const OccupancyBox& box, int leaves) {
  const auto down = [&](int at) {
    return static_cast<int32_t>(32 * std::floor((at - leaves) / 32.0));
  };
  const auto up = [&](int at) {
    return static_cast<int32_t>(32 * std::ceil((at + leaves) / 32.0));
  };
  return {{down(box.min.x), down(box.min.y), down(box.min.z)},
          {up(box.max.x), up(box.max.y), up(box.max.z)}};
}

TEST(ClosedOctree, BytesAreThoseOfOctomapWithTheShellOccupied) {
  for (uint64_t seed = 30; seed < 33; ++seed) {
    const OccupancyMap leaves = RandomOccupancy(seed, 20 * static_cast<int>(seed - 29));
    const OccupancyBox known = *leaves.KnownCells();
    const Result<OctreeBytes> octree =
        EncodeOctree(leaves, 0.05, UnknownPolicy::kOccupied, std::nullopt, 0.33);
    ASSERT_TRUE(octree);
    EXPECT_EQ(octree->shell_m, 0.33);
    ASSERT_EQ(Text(octree->bytes),
              OctomapBytes(leaves, 0.05, UnknownPolicy::kOccupied, known, OuterBox(known, 7)));
  }
}

TEST(ClosedOctree, WithinBoundsWhatLiesOutsideOfThemIsOccupiedAlsoWhereTheMapIsFree) {
  const OccupancyMap leaves = RandomOccupancy(78, 150);
  const OccupancyBox box{{-11, -60, -4}, {37, 8, 3}};
  const Eigen::AlignedBox3d bounds_W(Eigen::Vector3d(-0.55, -3.0, -0.2),
                                     Eigen::Vector3d(1.85, 0.4, 0.15));
  const Result<OctreeBytes> octree =
      EncodeOctree(leaves, 0.05, UnknownPolicy::kOccupied, bounds_W, 1);
  ASSERT_TRUE(octree);
  EXPECT_TRUE(octree->bounds_W.isApprox(bounds_W, 1e-9));
  EXPECT_EQ(Text(octree->bytes),
            OctomapBytes(leaves, 0.05, UnknownPolicy::kOccupied, box, OuterBox(box, 20)));
  const auto raw = [&](double shell_m) {
    return EncodeOctree(leaves, 0.05, UnknownPolicy::kAbsent, bounds_W, shell_m);
  };
  EXPECT_EQ(raw(1)->bytes, raw(0)->bytes) << "only closed trees have a shell";
  EXPECT_EQ(raw(1)->shell_m, 0);
}

// Collision checkers take a point without a node for free.
TEST(ClosedOctree, EveryPointWithinTheShellIsOccupied) {
  OccupancyMap leaves(0.05);
  for (int i = 0; i < 64; ++i)
    leaves.Set({i % 4 - 2, i / 4 % 4, i / 16 - 3}, BlockOccupancy(CellState::kFree));
  for (const double shell_m : {1.0, 2.5}) {
    const Result<OctreeBytes> octree =
        EncodeOctree(leaves, 0.05, UnknownPolicy::kOccupied, std::nullopt, shell_m);
    ASSERT_TRUE(octree);
    EXPECT_LT(octree->bytes.size(), 2000u) << "the shell has large nodes";
    const Result<Tree> tree = ReadOctree(octree->bytes, "closed");
    ASSERT_TRUE(tree) << tree.error().message;
    const Eigen::AlignedBox3d& bounds = octree->bounds_W;
    const Eigen::Vector3d size = bounds.sizes().array() + 2 * shell_m;
    Random random(4);
    int outside = 0;
    for (int i = 0; i < 200000; ++i) {
      Eigen::Vector3d p_W;
      for (int axis = 0; axis < 3; ++axis) {
        p_W[axis] = bounds.min()[axis] - shell_m + 1e-9 +
                    (size[axis] - 2e-9) * random.Below(1 << 20) / ((1 << 20) - 1);
      }
      const bool inside = bounds.contains(p_W);
      outside += !inside;
      if (inside) continue;
      ASSERT_EQ(CellAt(**tree, p_W), CellState::kOccupied) << p_W.transpose();
    }
    EXPECT_GT(outside, 100000);
    EXPECT_EQ(CellAt(**tree, bounds.center()), CellState::kFree);
  }
}

TEST(ClosedOctree, OfABoxInUnseenSpaceIsFullOfOccupiedSpace) {
  const OccupancyMap leaves = RandomOccupancy(5, 60);
  const Eigen::AlignedBox3d far(Eigen::Vector3d(40, 40, 40), Eigen::Vector3d(41, 42, 43));
  const Result<OctreeBytes> octree = EncodeOctree(leaves, 0.05, UnknownPolicy::kOccupied, far, 1);
  ASSERT_TRUE(octree);
  EXPECT_GT(octree->nodes, 0);
  for (const Eigen::Vector3d& p_W : {far.min(), far.max(), Eigen::Vector3d(far.center())})
    EXPECT_EQ(CellAt(**ReadOctree(octree->bytes, "far"), p_W), CellState::kOccupied);
}

TEST(ClosedOctree, ShellEndsWithTheKeySpaceAndSaysSo) {
  OccupancyMap leaves(0.05);
  leaves.Set({-4096, 0, 4095}, BlockOccupancy(CellState::kFree));
  const Result<OctreeBytes> octree =
      EncodeOctree(leaves, 0.05, UnknownPolicy::kOccupied, std::nullopt, 1);
  ASSERT_TRUE(octree);
  EXPECT_THAT(octree->left_out, HasSubstr("parts of the occupied shell"));
  const Result<Tree> tree = ReadOctree(octree->bytes, "edge");
  EXPECT_EQ(CellAt(**tree, {-1638.3, 0.1, 1638.3}), CellState::kFree);
  EXPECT_EQ(CellAt(**tree, {-1638.3, -0.9, 1638.3}), CellState::kOccupied);
  EXPECT_EQ(CellAt(**tree, {-1637.1, 0.1, 1638.3}), CellState::kOccupied);
}

TEST(BuildOctree, WithBoundsGivesTheBytesOfTheWholeMapWithinThem) {
  Random random(17);
  const OccupancyMap voxels = RandomOccupancy(6, 250, 0.02);
  for (const double resolution : {0.04, 0.06, 0.1, 0.22}) {
    for (int i = 0; i < 20; ++i) {
      OctreeOptions options;
      options.resolution_m = resolution;
      options.unknown = i % 2 == 0 ? UnknownPolicy::kOccupied : UnknownPolicy::kAbsent;
      const Eigen::Vector3d low(random.Below(100), random.Below(100), random.Below(60));
      const Eigen::Vector3d size(20 + random.Below(60), 20 + random.Below(60),
                                 20 + random.Below(40));
      const Eigen::Vector3d min_W = 0.0137 * (low.array() - 55).matrix();
      options.bounds_W = Eigen::AlignedBox3d(min_W, min_W + 0.0137 * size);
      Result<OctreeBuilder> whole = OctreeBuilder::Make(voxels.cell_size(), options);
      whole->Update(voxels, voxels.SortedIndices());
      const Result<OctreeBytes> expected = whole->Build(options.unknown);
      const Result<OctreeBytes> found = BuildOctree(voxels, options);
      ASSERT_TRUE(expected && found);
      ASSERT_EQ(found->bytes, expected->bytes) << resolution << " " << i;
    }
  }
}

TEST(EncodeOctree, ReadBackGivesEveryCellAgain) {
  const OccupancyMap leaves = RandomOccupancy(21, 150);
  const Result<OctreeBytes> octree =
      EncodeOctree(leaves, 0.05, UnknownPolicy::kAbsent, std::nullopt);
  ASSERT_TRUE(octree);
  const Result<Tree> tree = ReadOctree(octree->bytes, "tree");
  ASSERT_TRUE(tree) << tree.error().message;
  EXPECT_EQ(static_cast<int64_t>((*tree)->size()), octree->nodes);
  for (int z = -20; z < 30; ++z) {
    for (int y = -48; y < 48; ++y) {
      for (int x = -40; x < 48; ++x) {
        const Eigen::Vector3d p_W = (Eigen::Vector3d(x, y, z).array() + 0.5) * 0.05;
        ASSERT_EQ(CellAt(**tree, p_W), leaves.At(VoxelIndex{x, y, z}));
      }
    }
  }
}

TEST(EncodeOctree, EmptyMapIsAnEmptyTree) {
  const Result<OctreeBytes> octree =
      EncodeOctree(OccupancyMap(0.05), 0.05, UnknownPolicy::kOccupied, std::nullopt);
  ASSERT_TRUE(octree);
  EXPECT_EQ(octree->nodes, 0);
  EXPECT_TRUE(octree->bounds_W.isEmpty());
  const Result<Tree> tree = ReadOctree(octree->bytes, "tree");
  ASSERT_TRUE(tree) << tree.error().message;
  EXPECT_EQ(CellAt(**tree, {0, 0, 0}), CellState::kUnknown);
}

TEST(EncodeOctree, HugeUnknownBoxStaysSmall) {
  OccupancyMap leaves(0.05);
  leaves.Set({-64, -64, -64}, BlockOccupancy(CellState::kFree));
  leaves.Set({63, 63, 63}, BlockOccupancy(CellState::kFree));
  const Result<OctreeBytes> octree =
      EncodeOctree(leaves, 0.05, UnknownPolicy::kOccupied, std::nullopt);
  ASSERT_TRUE(octree);
  EXPECT_LT(octree->bytes.size(), 1000u) << "a billion cells, all in large nodes";
  EXPECT_EQ(CellAt(**ReadOctree(octree->bytes, "tree"), {0, 0, 0}), CellState::kOccupied);
}

TEST(EncodeOctree, MapBeyondTheKeySpaceIsLeftOutAndItsEdgeIsNot) {
  OccupancyMap leaves(0.05);
  leaves.Set({-4096, 0, 4095}, BlockOccupancy(CellState::kOccupied));
  const Result<OctreeBytes> octree =
      EncodeOctree(leaves, 0.05, UnknownPolicy::kAbsent, std::nullopt);
  ASSERT_TRUE(octree);
  EXPECT_EQ(CellAt(**ReadOctree(octree->bytes, "tree"), {-1638.3, 0.1, 1638.3}),
            CellState::kOccupied);
  leaves.Set({4096, 0, 0}, BlockOccupancy(CellState::kFree));
  const auto cut = EncodeOctree(leaves, 0.05, UnknownPolicy::kAbsent, std::nullopt);
  ASSERT_TRUE(cut);
  EXPECT_EQ(cut->bytes, octree->bytes);
  EXPECT_THAT(cut->left_out, HasSubstr("1638.4 m"));
}

TEST(ChooseOctreeGrid, TakesWholeMultiplesAndNamesTheNearest) {
  EXPECT_EQ(ChooseOctreeGrid(0.01, 0)->factor, 5);
  EXPECT_EQ(ChooseOctreeGrid(0.02, 0)->factor, 3);
  EXPECT_EQ(ChooseOctreeGrid(0.05, 0)->factor, 2) << "never one voxel per leaf";
  EXPECT_EQ(ChooseOctreeGrid(0.01, 0.07)->factor, 7);
  EXPECT_EQ(ChooseOctreeGrid(0.01, 0.07)->resolution, 0.07);
  for (const double wrong : {0.05, 0.02, 0.031, 100.0, 1e-9, -0.04}) {
    EXPECT_FALSE(ChooseOctreeGrid(0.02, wrong)) << wrong;
  }
  EXPECT_THAT(ChooseOctreeGrid(0.02, 0.05).error().message, HasSubstr("nearest is 0.06 m"));
  EXPECT_THAT(ChooseOctreeGrid(0.02, 0.02).error().message, HasSubstr("nearest is 0.04 m"));
  EXPECT_FALSE(ChooseOctreeGrid(0.02, std::nan("")));
}

TEST(BuildOctree, RefusesAFreeFractionThatIsNone) {
  OctreeOptions options;
  options.free_fraction = 0;
  EXPECT_FALSE(BuildOctree(OccupancyMap(0.01), options));
}

/// A room seen from inside with a table board of 2 cm; the distance in it is exact.
testing_support::AnalyticScene RoomWithBoard() {
  testing_support::AnalyticScene scene;
  scene.distance = [](const Eigen::Vector3d& p) {
    const double room = -testing_support::BoxDistance(p, {0.003, 0.004, 0.001}, {0.9, 0.8, 0.6});
    const double board = testing_support::BoxDistance(p, {0.1, 0.05, 0.013}, {0.4, 0.3, 0.01});
    return std::min(room, board);
  };
  return scene;
}

TEST(BuildOctree, NoFreeLeafOfARoomContainsSolidDeeperThanAVoxel) {
  const testing_support::AnalyticScene scene = RoomWithBoard();
  testing_support::AnalyticRegion region;
  region.min_W.setConstant(-1.1);
  region.max_W.setConstant(1.1);
  const OccupancyMap map = ClassifyMap(MakeAnalyticMap(scene, region, {0.01, 4.0}), {});
  const Result<OctreeBytes> octree = BuildOctree(map, {});
  ASSERT_TRUE(octree);
  EXPECT_EQ(octree->resolution, 0.05);
  const Result<Tree> read = ReadOctree(octree->bytes, "room");
  ASSERT_TRUE(read);
  const octomap::OcTree& tree = **read;
  double free_volume = 0;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (tree.isNodeOccupied(*leaf)) continue;
    const double size = leaf.getSize();
    const Eigen::Vector3d center(leaf.getX(), leaf.getY(), leaf.getZ());
    free_volume += std::pow(size, 3);
    for (double z = 0.005; z < size; z += 0.01) {
      for (double y = 0.005; y < size; y += 0.01) {
        for (double x = 0.005; x < size; x += 0.01) {
          const Eigen::Vector3d from_center = Eigen::Vector3d(x, y, z).array() - size / 2;
          ASSERT_GT(scene.distance(center + from_center), -0.01);
        }
      }
    }
  }
  const double true_volume = 1.8 * 1.6 * 1.2 - 0.8 * 0.6 * 0.02;
  EXPECT_GT(free_volume, 0.75 * true_volume);
  EXPECT_LT(free_volume, true_volume);
  for (double x = -0.28; x < 0.48; x += 0.01) {
    EXPECT_EQ(CellAt(tree, {x, 0.05, 0.013}), CellState::kOccupied) << "the board has no hole";
  }
}

class OctreeFile : public ::testing::Test {
 protected:
  OctreeFile() : folder_(::testing::TempDir() + "vismap_octree_" + std::to_string(getpid())) {
    std::filesystem::create_directories(folder_);
    const OccupancyMap leaves = RandomOccupancy(5, 60);
    octree_ = *EncodeOctree(leaves, 0.05, UnknownPolicy::kAbsent, std::nullopt);
  }
  ~OctreeFile() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
  OctreeBytes octree_;
};

TEST_F(OctreeFile, IsReadByOctomap) {
  const std::filesystem::path path = folder_ / "map.bt";
  ASSERT_TRUE(WriteOctree(path, octree_));
  EXPECT_EQ(ReadFileBytes(path), octree_.bytes);
  const octomap::OcTree tree(path.string());
  EXPECT_EQ(static_cast<int64_t>(tree.size()), octree_.nodes);
  EXPECT_EQ(tree.getResolution(), octree_.resolution);
}

TEST_F(OctreeFile, IsAcceptedByConvertOctree) {
  if (std::system("command -v convert_octree > /dev/null") != 0) {
    GTEST_SKIP() << "convert_octree (octomap-tools) is not installed";
  }
  const std::string path = (folder_ / "map.bt").string();
  ASSERT_TRUE(WriteOctree(path, octree_));
  const std::string command = "convert_octree " + path + " " + path + ".ot > /dev/null 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
  const std::unique_ptr<octomap::AbstractOcTree> converted(
      octomap::AbstractOcTree::read(path + ".ot"));
  ASSERT_NE(converted, nullptr);
  EXPECT_EQ(static_cast<int64_t>(converted->size()), octree_.nodes);
}

TEST_F(OctreeFile, MissingFolderIsAnError) {
  EXPECT_FALSE(WriteOctree(folder_ / "none" / "map.bt", octree_));
}

TEST_F(OctreeFile, AnEmptyTreeIsNotWrittenAndLeavesNoOlderFile) {
  const std::filesystem::path path = folder_ / "map.bt";
  ASSERT_TRUE(WriteOctree(path, octree_));
  for (const UnknownPolicy unknown : {UnknownPolicy::kAbsent, UnknownPolicy::kOccupied}) {
    OctreeOptions options;
    options.unknown = unknown;
    const Result<void> written = WriteOctree(path, *BuildOctree(OccupancyMap(0.01), options));
    ASSERT_FALSE(written);
    EXPECT_NE(written.error().message.find("there is no octree of the map in " + folder_.string()),
              std::string::npos);
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
  }
}

TEST_F(OctreeFile, OneOfAnEarlierRunIsSetAside) {
  const std::filesystem::path path = folder_ / "map.bt", aside = folder_ / "map.bt.previous";
  EXPECT_TRUE(SetOctreeAside(path)) << "there is none";
  for (int run = 0; run < 2; ++run) {
    ASSERT_TRUE(WriteOctree(path, octree_));
    ASSERT_TRUE(SetOctreeAside(path));
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_EQ(ReadFileBytes(aside), octree_.bytes);
  }
  ASSERT_TRUE(WriteOctree(path, octree_));
  std::filesystem::remove(aside);
  std::filesystem::create_directories(aside / "mine");
  const Result<void> done = SetOctreeAside(path);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("map.bt.previous"), std::string::npos);
}

TEST_F(OctreeFile, EveryCutIsAnError) {
  for (size_t size = 0; size < octree_.bytes.size(); ++size) {
    const std::span<const uint8_t> cut(octree_.bytes.data(), size);
    ASSERT_FALSE(CheckOctree(cut, "cut")) << "at " << size;
  }
  std::vector<uint8_t> longer = octree_.bytes;
  longer.push_back(0);
  EXPECT_FALSE(CheckOctree(longer, "longer"));
}

TEST_F(OctreeFile, FlippedBytesGiveATreeOrAnError) {
  Random random(99);
  for (int i = 0; i < 3000; ++i) {
    std::vector<uint8_t> bytes = octree_.bytes;
    const size_t range = i % 3 == 0 ? 200 : bytes.size();
    const size_t at = static_cast<size_t>(random.Next()) % range;
    bytes[at] = static_cast<uint8_t>(random.Next());
    const Result<Tree> tree = ReadOctree(bytes, "flipped");
    if (tree) CellAt(**tree, {0.1, 0.2, 0.3});
  }
}

TEST(CheckOctree, EndlessNestingIsAnErrorNotAStackOverflow) {
  const std::string header = "# Octomap OcTree binary file\nid OcTree\nsize 9\nres 0.05\ndata\n";
  std::vector<uint8_t> bytes(header.begin(), header.end());
  bytes.resize(bytes.size() + 1000000, 0xff);
  const Result<OctreeStreamInfo> checked = CheckOctree(bytes, "evil");
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message, HasSubstr("evil"));
}

TEST(CheckOctree, AcceptsTreesOfOtherPrograms) {
  const char* data = std::getenv("VISMAP_DATA");
  if (data == nullptr) GTEST_SKIP() << "VISMAP_DATA is not set";
  const std::filesystem::path folder = std::filesystem::path(data) / "octomap";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << folder << " is not there";
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".bt") continue;
    const Result<Tree> tree = ReadOctree(*ReadFileBytes(entry.path()), entry.path());
    EXPECT_TRUE(tree) << tree.error().message;
    ++read;
  }
  EXPECT_GT(read, 0);
}

}  // namespace
}  // namespace vismap
