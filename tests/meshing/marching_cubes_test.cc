#include "meshing/marching_cubes.h"

#include <gtest/gtest.h>
#include <octomap/octomap_types.h>
// Needs the types of octomap_types.h.
#include <octomap/MCTables.h>

#include <set>

#include "base/parallel.h"
#include "support/analytic_map.h"
#include "support/mesh_blocks.h"
#include "support/mesh_checks.h"
#include "support/sphere_map.h"
#include "support/voxel_reading.h"

namespace vismap {
namespace {

using namespace testing_support;
using Eigen::Vector3d;

// Every voxel is solid or empty at random, which gives all 256 cases of a cell.
SemanticMap NoiseMap(uint64_t seed) {
  SemanticMap map(kSphereGrid);
  uint64_t state = seed;
  const auto next = [&state] {
    state += 0x9E3779B97F4A7C15ull;
    uint64_t z = (state ^ (state >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  };
  for (int32_t i = 0; i < 27; ++i) {
    auto voxels = std::make_unique<SurfaceVoxels>();
    voxels->weight.fill(128);
    voxels->observations.fill(1);
    for (int16_t& d : voxels->distance) d = static_cast<int16_t>(next() % 40001) - 20000;
    map.voxels.FindOrCreate({i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1}).surface = std::move(voxels);
  }
  return map;
}

TEST(MarchingCubesTables, CornerOrderIsOurs) {
  // A single corner behind the surface is cut off by the three edges that meet there.
  const int edges_of_corner[8][3] = {{0, 3, 8}, {0, 1, 9}, {1, 2, 10}, {2, 3, 11},
                                     {4, 7, 8}, {4, 5, 9}, {5, 6, 10}, {6, 7, 11}};
  for (int corner = 0; corner < 8; ++corner) {
    const int* row = octomap::triTable[1 << corner];
    EXPECT_EQ(std::set<int>(row, row + 3),
              std::set<int>(edges_of_corner[corner], edges_of_corner[corner] + 3));
    EXPECT_EQ(row[3], -1);
  }
}

TEST(ExtractSurface, SphereHasTheTrueRadiusAndNormals) {
  const Mesh mesh = ExtractSurface(SphereMap());
  ASSERT_GT(mesh.vertices.size(), 1000u);
  for (const MeshVertex& vertex : mesh.vertices) {
    const Vector3d from_center = vertex.position_W.cast<double>() - kSphereCenter;
    EXPECT_NEAR(from_center.norm(), kSphereRadius, 0.1 * kSphereGrid.voxel_size_m);
    EXPECT_NEAR(vertex.normal_W.norm(), 1, 1e-5);
    EXPECT_GT(vertex.normal_W.cast<double>().dot(from_center.normalized()), 0.9995);
    EXPECT_EQ(vertex.color, (Rgb8{10, 200, 30}));
  }
}

TEST(ExtractSurface, SphereIsClosedAndFacesOut) {
  const Mesh mesh = ExtractSurface(SphereMap());
  const EdgeUse edges = CountEdges(mesh);
  EXPECT_EQ(edges.border, 0u);
  EXPECT_EQ(edges.nonmanifold, 0u);
  // Euler: a closed surface without handles.
  EXPECT_EQ(static_cast<long>(mesh.vertices.size() + mesh.triangles.size()) -
                static_cast<long>(edges.paired),
            2);
  const double truth = 4.0 / 3 * 3.14159265358979 * kSphereRadius * kSphereRadius * kSphereRadius;
  EXPECT_NEAR(EnclosedVolume(mesh), truth, 0.01 * truth);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Vector3d corner = mesh.vertices[mesh.triangles[i][0]].position_W.cast<double>();
    ASSERT_GT(FaceVector(mesh, i).dot(corner - kSphereCenter), 0);
  }
}

TEST(ExtractSurface, BoxHasTheTrueVolume) {
  const Vector3d half(0.2, 0.11, 0.15);
  const AnalyticScene scene{
      .distance = [&](const Vector3d& p) { return BoxDistance(p, kSphereCenter, half); }};
  const Mesh mesh = ExtractSurface(MakeAnalyticMap(scene, CubeRegion(0.5), kSphereGrid));
  const EdgeUse edges = CountEdges(mesh);
  EXPECT_EQ(edges.border + edges.nonmanifold, 0u);
  EXPECT_NEAR(EnclosedVolume(mesh), 8 * half.prod(), 0.02 * 8 * half.prod());
  for (const MeshVertex& vertex : mesh.vertices) {
    EXPECT_NEAR(BoxDistance(vertex.position_W.cast<double>(), kSphereCenter, half), 0,
                0.3 * kSphereGrid.voxel_size_m);
  }
}

TEST(ExtractSurface, AnySignsGiveAMeshThatIsClosedExceptAtTheRim) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const SemanticMap map = NoiseMap(seed);
    const Mesh mesh = ExtractSurface(map, {.jump_fraction = 2, .min_component_triangles = 0});
    ASSERT_GT(mesh.triangles.size(), 10000u);
    // Cells lie between the outermost voxel centres.
    const float low = -7.5F * 0.02F + 1e-5F, high = 15.5F * 0.02F - 1e-5F;
    std::map<std::pair<uint32_t, uint32_t>, int> balance;
    for (const auto& triangle : mesh.triangles) {
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t a = triangle[i], b = triangle[(i + 1) % 3];
        balance[std::minmax(a, b)] += a < b ? 1 : -1;
      }
    }
    for (const auto& [edge, sum] : balance) {
      if (sum == 0) continue;
      const Eigen::Vector3f p = mesh.vertices[edge.first].position_W;
      const Eigen::Vector3f q = mesh.vertices[edge.second].position_W;
      const bool on_rim = (p.array() < low && q.array() < low).any() ||
                          (p.array() > high && q.array() > high).any();
      EXPECT_TRUE(on_rim) << p.transpose() << " - " << q.transpose();
    }
  }
}

TEST(ExtractSurface, PlaneThroughBlockBordersHasNoCracksAndNoDoubles) {
  // Exactly in the border between two blocks, and exactly through voxel centres.
  for (const double height : {0.16, 0.17}) {
    const AnalyticScene scene{.distance = [&](const Vector3d& p) { return p.z() - height; }};
    const Mesh mesh = ExtractSurface(MakeAnalyticMap(scene, CubeRegion(0.5), kSphereGrid));
    std::set<std::array<float, 3>> positions;
    for (const MeshVertex& vertex : mesh.vertices) {
      const auto& p = vertex.position_W;
      EXPECT_TRUE(positions.insert({p.x(), p.y(), p.z()}).second);
      EXPECT_NEAR(p.z(), height, 0.011 * kSphereGrid.voxel_size_m);
      EXPECT_GT(vertex.normal_W.z(), 0.9999F);
    }
    // 50 voxel centres per axis make a grid of 49 x 49 cells, whose rim has 4 x 49 edges.
    EXPECT_EQ(mesh.vertices.size(), 50u * 50u);
    EXPECT_EQ(mesh.triangles.size(), 2u * 49u * 49u);
    const EdgeUse edges = CountEdges(mesh);
    EXPECT_EQ(edges.border, 4u * 49u);
    EXPECT_EQ(edges.nonmanifold, 0u);
  }
}

TEST(ExtractSurface, VerticesBelongToTheSideTheyLieOn) {
  const Mesh mesh = ExtractSurface(SphereMap());
  for (const MeshVertex& vertex : mesh.vertices) {
    const double side = vertex.position_W.x() - kSphereCenter.x();
    if (std::abs(side) < kSphereGrid.voxel_size_m) continue;
    EXPECT_EQ(vertex.segment, side < 0 ? SegmentLabel{1} : SegmentLabel{2});
  }
}

TEST(ExtractSurface, MergedLabelsReadAsTheSurvivor) {
  SemanticMap map = SphereMap();
  map.labels.Merge(SegmentLabel{1}, SegmentLabel{2});
  for (const MeshVertex& vertex : ExtractSurface(map).vertices) {
    EXPECT_EQ(vertex.segment, SegmentLabel{1});
  }
}

TEST(ExtractSurface, SurfaceWithoutVotesTakesTheLabelNextToIt) {
  SemanticMap map = SphereMap();
  const Mesh before = ExtractSurface(map);
  // Strip the votes of every voxel on a checkerboard: each keeps neighbours that have them.
  for (const BlockIndex index : map.voxels.SortedIndices()) {
    Block* block = map.voxels.FindMutable(index);
    if (!block->surface) continue;
    for (int i = 0; i < kBlockVoxels; ++i) {
      if ((i + i / 8 + i / 64) % 2 == 0) block->surface->slot_label[static_cast<size_t>(i)] = {};
    }
  }
  const Mesh after = ExtractSurface(map);
  ASSERT_EQ(after.vertices.size(), before.vertices.size());
  for (const MeshVertex& vertex : after.vertices) EXPECT_NE(vertex.segment, SegmentLabel::kNone);
}

TEST(ExtractSurface, GatesOnWeightAndObservations) {
  const AnalyticScene scene{.distance = [](const Vector3d& p) {
    return SphereDistance(p, kSphereCenter, kSphereRadius);
  }};
  const SemanticMap map = MakeAnalyticMap(scene, CubeRegion(0.6, 3), kSphereGrid);
  EXPECT_FALSE(ExtractSurface(map, {.min_observations = 3}).triangles.empty());
  EXPECT_TRUE(ExtractSurface(map, {.min_observations = 4}).triangles.empty());
  EXPECT_FALSE(ExtractSurface(map, {.min_weight = 2.9}).triangles.empty());
  EXPECT_TRUE(ExtractSurface(map, {.min_weight = 3.0}).triangles.empty());
}

TEST(ExtractSurface, JumpBetweenTwoSurfacesIsNoSurface) {
  // Left half: deep behind a surface; right half: free. Nothing was seen in between.
  const AnalyticScene scene{
      .distance = [](const Vector3d& p) { return p.x() < 0 ? -0.99 * 4 * 0.02 : 1.0; }};
  const SemanticMap map = MakeAnalyticMap(scene, CubeRegion(0.3), kSphereGrid);
  EXPECT_TRUE(ExtractSurface(map).triangles.empty());
  EXPECT_FALSE(ExtractSurface(map, {.jump_fraction = 1.1}).triangles.empty());
}

TEST(ExtractSurface, SmallFloatingPiecesAreDroppedOnRequest) {
  const Vector3d speck(0.45, 0.45, 0.45);
  const AnalyticScene scene{.distance = [&](const Vector3d& p) {
    return std::min(SphereDistance(p, kSphereCenter, kSphereRadius),
                    SphereDistance(p, speck, 0.025));
  }};
  const SemanticMap map = MakeAnalyticMap(scene, CubeRegion(0.6), kSphereGrid);
  const Mesh all = ExtractSurface(map, {.min_component_triangles = 0});
  const Mesh cleaned = ExtractSurface(map, {.min_component_triangles = 200});
  EXPECT_LT(cleaned.triangles.size(), all.triangles.size());
  EXPECT_EQ(CountEdges(cleaned).border, 0u);
  for (const MeshVertex& vertex : cleaned.vertices) {
    EXPECT_GT((vertex.position_W.cast<double>() - speck).norm(), 0.1);
  }
}

TEST(ExtractSurface, SurfaceBetweenAFreeBlockAndASurfaceBlockIsKept) {
  // The surface lies half a voxel beyond the border of a block that only holds free voxels.
  SemanticMap map(kSphereGrid);
  map.voxels.FindOrCreate({-1, 0, 0}).all_free = true;
  auto voxels = std::make_unique<SurfaceVoxels>();
  voxels->weight.fill(128);
  voxels->observations.fill(2);
  voxels->distance.fill(-8000);
  map.voxels.FindOrCreate({0, 0, 0}).surface = std::move(voxels);
  EXPECT_EQ(ExtractSurface(map).triangles.size(), 2u * 7u * 7u);
}

TEST(ExtractSurface, EmptyMapGivesEmptyMesh) {
  const Mesh mesh = ExtractSurface(SemanticMap(kSphereGrid));
  EXPECT_TRUE(mesh.vertices.empty());
  EXPECT_TRUE(mesh.triangles.empty());
}

TEST(ExtractSurface, SameForAnyNumberOfThreads) {
  const SemanticMap map = SphereMap();
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return ExtractSurface(map);
  };
  EXPECT_TRUE(SameMesh(with_threads(1), with_threads(4)));
}

TEST(MeshBlocks, AllBlocksTogetherAreTheWholeMesh) {
  for (const SemanticMap& map : {SphereMap(), NoiseMap(9)}) {
    const MeshingOptions options{.min_component_triangles = 0};
    const std::vector<BlockIndex> all = map.voxels.SortedIndices();
    const std::vector<BlockMesh> delta = MeshBlocks(map, all, ShowSegments(map.labels), options);
    TriangleSet whole, parts;
    AppendTriangles(ExtractSurface(map, options), &whole);
    for (const BlockMesh& part : delta) AppendTriangles(part.mesh, &parts);
    std::sort(whole.begin(), whole.end());
    std::sort(parts.begin(), parts.end());
    EXPECT_EQ(whole, parts);
    EXPECT_TRUE(std::is_sorted(delta.begin(), delta.end(),
                               [](const auto& a, const auto& b) { return a.block < b.block; }));
  }
}

TEST(MeshBlocks, FollowingChangesGivesTheSameAsStartingOver) {
  SemanticMap map = SphereMap();
  std::map<BlockIndex, Mesh> shown;
  const auto apply = [&](const std::vector<BlockMesh>& delta) {
    for (const BlockMesh& part : delta) shown[part.block] = part.mesh;
  };
  apply(MeshBlocks(map, map.voxels.SortedIndices(), ShowSegments(map.labels)));
  // Change a block that the surface passes, and erase another.
  const BlockIndex changed =
      BlockOf(VoxelAt(map.voxels, kSphereCenter + Vector3d(kSphereRadius, 0, 0)));
  const BlockIndex erased =
      BlockOf(VoxelAt(map.voxels, kSphereCenter - Vector3d(0, kSphereRadius, 0)));
  for (int16_t& d : map.voxels.FindMutable(changed)->surface->distance) {
    d = static_cast<int16_t>(std::max(d - 3000, -kTruncationSteps));
  }
  map.voxels.Erase(erased);
  const std::vector<BlockIndex> blocks{changed, erased};
  const std::vector<BlockMesh> update = MeshBlocks(map, blocks, ShowSegments(map.labels));
  EXPECT_LT(update.size(), 60u);
  apply(update);
  const std::vector<BlockMesh> fresh =
      MeshBlocks(map, map.voxels.SortedIndices(), ShowSegments(map.labels));
  for (const BlockMesh& part : fresh) {
    EXPECT_TRUE(SameMesh(part.mesh, shown[part.block]));
    shown.erase(part.block);
  }
  for (const auto& [block, mesh] : shown) EXPECT_TRUE(mesh.triangles.empty());
}

}  // namespace
}  // namespace vismap
