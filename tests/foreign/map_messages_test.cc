#include "foreign/map_messages.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "support/temp_folder.h"
#include "wire/envelope.h"

namespace vismap {
namespace {

constexpr int64_t kMapUtime = 1'760'000'000'000'250;

ObjectSummary Chair() {
  ObjectSummary chair;
  chair.instance = InstanceId{7};
  chair.segments = {SegmentLabel{5}};
  chair.class_id = *ClassFromName("chair");
  chair.score = 0.75;
  chair.box.center_W = {1, 2, 0.5};
  chair.box.size = {0.4, 0.6, 0.9};
  chair.box.R_W_B = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
  return chair;
}

std::vector<ObjectSummary> MapObjects() {
  ObjectSummary segment;
  segment.segments = {SegmentLabel{12}};
  segment.box.size = {1, 1, 1};
  ObjectSummary removed = Chair();
  removed.instance = InstanceId{8};
  removed.state = ObjectState::kRemoved;
  ObjectSummary floor = segment;
  floor.segments = {SegmentLabel{1}};
  floor.structure = StructureKind::kFloor;
  return {Chair(), segment, floor, removed};
}

Mesh OneTriangle() {
  Mesh mesh;
  mesh.vertices.resize(3);
  mesh.vertices[1].position_W = {1, 0, 0};
  mesh.vertices[2].position_W = {0, 1, 0};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// Cells of 10 cm: free at (-1, 2), occupied at (1, 2), free at (1, 3), and much above and below.
OccupancyMap SomeSpace() {
  OccupancyMap space(0.1);
  const auto set = [&](int x, int y, int z, CellState state) {
    const VoxelIndex cell{x, y, z};
    OccupancyPlanes planes = space.At(BlockOf(cell)).Planes();
    const auto offset = static_cast<size_t>(OffsetInBlock(cell));
    auto& bits = state == CellState::kFree ? planes.free : planes.occupied;
    bits[offset / 64] |= uint64_t{1} << (offset % 64);
    space.Set(BlockOf(cell), BlockOccupancy(planes));
  };
  set(-1, 2, 3, CellState::kFree);
  set(-1, 2, -1, CellState::kOccupied);  // the floor
  set(1, 2, 3, CellState::kFree);
  set(1, 2, 4, CellState::kOccupied);
  set(1, 3, 3, CellState::kFree);
  set(1, 3, 20, CellState::kOccupied);  // the ceiling
  return space;
}

const std::vector<SurfacePoint> kPoints = {{{0.5F, 0.25F, 1.5F}, {255, 128, 1}},
                                           {{-2, 3, 0.125F}, {10, 20, 30}}};

template <typename Message>
void Write(const TempFolder& folder, const std::string& name, Message message) {
  folder.Write(name, Pack(message));
}

TEST(MapMessages, AreReadByThePythonOfLcmGen) {
  const TempFolder folder;
  const std::vector<ObjectSummary> objects = MapObjects();
  const std::vector<Mesh> meshes = {OneTriangle(), {}, OneTriangle(), {}};
  Write(folder, "messages/cloud", ToPointCloud2(kPoints, "world", kMapUtime));
  Write(folder, "messages/drake_cloud", ToDrakeCloud(kPoints, "world", kMapUtime));
  const auto costmap = ToCostmap(SomeSpace(), {0.1, 0.1, 1, -1}, "world", kMapUtime);
  ASSERT_TRUE(costmap) << costmap.error().message;
  Write(folder, "messages/costmap", *costmap);
  Write(folder, "messages/detections", ToDetections(objects, ClassName, "world", kMapUtime));
  Write(folder, "messages/deformable", ToDeformable(objects, meshes, ClassName));
  std::set<std::string> shown = {"instance_3_cup", "segment_12"};
  Write(folder, "messages/director", ToTreeviewer(kPoints, objects, ClassName, kMapUtime, &shown));
  EXPECT_EQ(shown, (std::set<std::string>{"instance_7_chair", "segment_12"}));

  const std::string source = VISMAP_SOURCE_DIR, path = folder.path().string();
  std::filesystem::create_directories(folder / "types");
  const std::string types = std::string(LCM_GEN) + " --python --ppath " + path + "/types " +
                            source + "/lcmtypes/foreign/*.lcm";
  ASSERT_EQ(std::system(types.c_str()), 0) << types;
  const std::string read = "PYTHONDONTWRITEBYTECODE=1 python3 " + source +
                           "/tests/foreign/read_map_messages.py " + path + "/types " + path +
                           "/messages";
  EXPECT_EQ(std::system(read.c_str()), 0) << read;
}

TEST(MapMessages, AnEmptyMapIsAnEmptyCloudAndGrid) {
  EXPECT_EQ(ToPointCloud2({}, "world", 0).width, 0);
  const auto costmap = ToCostmap(OccupancyMap(0.1), {}, "world", 0);
  ASSERT_TRUE(costmap);
  EXPECT_EQ(costmap->info.width, 0);
}

TEST(MapMessages, AGridThatIsTooLargeIsAnError) {
  OccupancyMap space(0.1);
  space.Set({0, 0, 0}, BlockOccupancy(CellState::kFree));
  space.Set({100'000, 100'000, 0}, BlockOccupancy(CellState::kFree));
  const auto costmap = ToCostmap(space, {}, "world", 0);
  ASSERT_FALSE(costmap);
  EXPECT_NE(costmap.error().message.find("costmap_resolution_m"), std::string::npos);
}

TEST(MapMessages, KeepOnePointPerCube) {
  Mesh mesh;
  for (const float x : {0.01F, 0.02F, 0.06F, -0.01F}) {
    mesh.vertices.emplace_back();
    mesh.vertices.back().position_W = {x, 0, 0};
  }
  const std::vector<SurfacePoint> points = ThinOut(mesh, 0.05);
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[0].p_W.x(), 0.01F);
  EXPECT_EQ(points[1].p_W.x(), 0.06F);
}

}  // namespace
}  // namespace vismap
