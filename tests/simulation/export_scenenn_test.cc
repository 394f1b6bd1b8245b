#include "simulation/export_scenenn.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "datasets/dataset.h"
#include "datasets/detections_file.h"
#include "datasets/image_file.h"
#include "simulation/room.h"
#include "simulation/tessellate.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
using testing_support::ExportSceneNn;

std::string ReadAll(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

void ExpectReadBackIsTheSame(const SyntheticOptions& options) {
  const TempFolder folder;
  const Result<void> written = ExportSceneNn(options, folder.path(), "901");
  ASSERT_TRUE(written) << written.error().message;
  const auto read = OpenDataset((folder / "901").string(), "");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ((*read)->format(), "scenenn");
  EXPECT_TRUE((*read)->skipped().empty());
  const auto source = LoadDetections((*read)->default_detections_path().value());
  ASSERT_TRUE(source) << source.error().message;
  const auto computed = MakeSyntheticDataset(options, {});
  const auto truth = MakeSyntheticDetections(options);
  ASSERT_EQ((*read)->size(), computed->size());
  for (size_t i = 0; i < computed->size(); ++i) {
    const Result<SensorFrame> a = (*read)->Read(i), b = computed->Read(i);
    ASSERT_TRUE(a) << a.error().message;
    EXPECT_EQ(a->depth, b->depth);
    EXPECT_EQ(a->color, b->color);
    EXPECT_EQ(a->header.utime, b->header.utime);
    EXPECT_EQ(a->header.frame_number, b->header.frame_number);
    EXPECT_EQ(a->header.camera, b->header.camera);
    EXPECT_EQ(a->header.T_W_C.matrix(), b->header.T_W_C.matrix());
    const Result<DetectionSet> c = (*source)->ForFrame(a->header), d = truth->ForFrame(b->header);
    ASSERT_TRUE(c) << c.error().message;
    ASSERT_EQ(c->detections.size(), d->detections.size());
    for (size_t k = 0; k < c->detections.size(); ++k) {
      EXPECT_EQ(c->detections[k].class_id, d->detections[k].class_id);
      EXPECT_EQ(c->detections[k].score, d->detections[k].score);
      EXPECT_EQ(c->detections[k].mask, d->detections[k].mask);
    }
  }
}

TEST(ExportSceneNn, ReadBackGivesTheSameFramesAndDetections) {
  ExpectReadBackIsTheSame({.frames = 5, .width = 160});
  ExpectReadBackIsTheSame({.scene = "office", .frames = 2, .width = 96});
}

TEST(ExportSceneNn, KeepsIdsThatNoByteHolds) {
  const TempFolder folder;
  const SyntheticOptions options{.scene = "office", .frames = 1, .width = 64};
  ASSERT_TRUE(ExportSceneNn(options, folder.path(), "901"));
  const FrameHeader header = MakeHeaders(options).front();
  const Image<uint16_t> ids = RenderInstances(MakeScene(options), header.camera, header.T_W_C);
  ASSERT_GT(*std::max_element(ids.pixels().begin(), ids.pixels().end()), 255);
  const auto read = ReadPng16(folder / "901/mask/mask_image00001.png", 64, 48);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*read, ids);
  EXPECT_THAT(ReadAll(folder / "901/901.xml"), HasSubstr("<label id=\"953\""));
}

TEST(ExportSceneNn, WritesTheTruthThatScorersRead) {
  const TempFolder folder;
  ASSERT_TRUE(ExportSceneNn({.frames = 5, .width = 160}, folder.path(), "901"));
  const std::string xml = ReadAll(folder / "901/901.xml");
  EXPECT_THAT(xml, HasSubstr(R"(text="couch" kind="sofa" nyu_class="sofa" coco_id="63" frames=)"));
  EXPECT_THAT(xml, HasSubstr(R"(text="unknown" kind="pillow" nyu_class="pillow" coco_id="0")"));
  const std::string ply = ReadAll(folder / "901/901.ply");
  size_t vertices = 0, faces = 0;
  std::istringstream header(ply);
  for (std::string word; header >> word && word != "end_header";) {
    if (word == "vertex") header >> vertices;
    if (word == "face") header >> faces;
  }
  EXPECT_GT(vertices, 10000u);
  EXPECT_GT(faces, 10000u);
  EXPECT_EQ(ply.size(), ply.find("end_header\n") + 11 + vertices * 17 + faces * 13);
}

TEST(ExportSceneNn, NamesWhatItCannotWrite) {
  const TempFolder folder;
  folder.Write("file", "not a folder");
  const Result<void> written = ExportSceneNn({.frames = 1, .width = 32}, folder / "file", "901");
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("/file/"));
}

TEST(Tessellate, PointsLieOnTheSurfaceOfTheirObject) {
  const Scene room = MakeRoom();
  const LabelledMesh mesh = Tessellate(room, 0.06, [](const auto&, const auto&) { return true; });
  ASSERT_EQ(mesh.points_W.size(), mesh.object_ids.size());
  for (size_t i = 0; i < mesh.points_W.size(); i += 7) {
    EXPECT_NEAR(SignedDistance(*FindObject(room, mesh.object_ids[i]), mesh.points_W[i]), 0, 1e-9);
    EXPECT_GT(SignedDistance(room, mesh.points_W[i]), -1e-4) << "inside of another object";
  }
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    for (size_t i = 0; i < 3; ++i) {
      const auto a = static_cast<size_t>(triangle[i]),
                 b = static_cast<size_t>(triangle[(i + 1) % 3]);
      ASSERT_LT((mesh.points_W[a] - mesh.points_W[b]).norm(), 0.06 * 1.6);
      ASSERT_EQ(mesh.object_ids[a], mesh.object_ids[b]);
    }
  }
}

// The inner area of the room without furniture is known: floor, ceiling and four walls.
TEST(Tessellate, CoversTheSurface) {
  Scene shell = MakeRoom();
  shell.objects.resize(6);
  const LabelledMesh mesh = Tessellate(shell, 0.05, [](const Eigen::Vector3d& p_W, const auto&) {
    return std::abs(p_W.x()) < 2.51 && std::abs(p_W.y()) < 2.01 && p_W.z() > -0.01 &&
           p_W.z() < 2.61;
  });
  double area = 0;
  for (const std::array<int, 3>& t : mesh.triangles) {
    const auto point = [&](size_t i) { return mesh.points_W[static_cast<size_t>(t[i])]; };
    area += 0.5 * (point(1) - point(0)).cross(point(2) - point(0)).norm();
  }
  const double expected = 2 * (5 * 4) + 2 * 2.6 * (5 + 4);
  EXPECT_NEAR(area, expected, 0.06 * expected);
}

}  // namespace
}  // namespace vismap
