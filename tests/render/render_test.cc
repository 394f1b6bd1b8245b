#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <span>

#include "base/parallel.h"
#include "objects/map_mesh.h"
#include "render/overview.h"
#include "render/paint.h"
#include "render/png.h"
#include "render/render_mesh.h"
#include "render/webp.h"
#include "support/analytic_map.h"
#include "support/mesh_checks.h"

namespace vismap {
namespace {

using namespace testing_support;
using Eigen::Vector3d;

constexpr VoxelGridOptions kGrid{.voxel_size_m = 0.025, .truncation_voxels = 4};
constexpr SegmentLabel kWalls{1}, kFloor{2}, kTable{3}, kBall{4};
constexpr ClassId kDiningTable{67};

// A room with a floor, a ceiling, four walls, a table (an instance) and a ball (discovered), seen
// from the inside.
SemanticMap Room() {
  const Vector3d center(0, 0, 1), half(1.5, 1, 1);
  const auto table = [](const Vector3d& p) {
    return BoxDistance(p, Vector3d(-0.6, 0.2, 0.35), Vector3d(0.5, 0.3, 0.35));
  };
  const auto ball = [](const Vector3d& p) { return SphereDistance(p, {0.8, -0.4, 0.25}, 0.25); };
  const auto walls = [=](const Vector3d& p) { return -BoxDistance(p, center, half); };
  const AnalyticScene scene{.distance =
                                [=](const Vector3d& p) {
                                  return std::min({walls(p), table(p), ball(p)});
                                },
                            .label =
                                [=](const Vector3d& p) {
                                  if (table(p) < std::min(walls(p), ball(p))) return kTable;
                                  if (ball(p) < walls(p)) return kBall;
                                  return p.z() < 0.05 ? kFloor : kWalls;
                                },
                            .color =
                                [](const Vector3d& p) {
                                  return p.z() < 0.05 ? Rgb8{160, 110, 60} : Rgb8{90, 130, 200};
                                }};
  SemanticMap map = MakeAnalyticMap(
      scene, {.min_W = Vector3d(-1.7, -1.2, -0.2), .max_W = Vector3d(1.7, 1.2, 2.2)}, kGrid);
  for (const SegmentLabel label : {kWalls, kFloor, kBall}) {
    AddEvidence(&map, label, InstanceId::kNone, ClassId::kUnknown, 10, 0);
  }
  AddEvidence(&map, kTable, InstanceId{3}, kDiningTable, 10, 9);
  return map;
}

std::string Name(ClassId id) { return id == kDiningTable ? "dining table" : ""; }

// Saves a picture if the environment variable VISMAP_PICTURES names a folder.
void Keep(const Image<Rgb8>& image, const std::string& name) {
  if (const char* folder = std::getenv("VISMAP_PICTURES")) {
    EXPECT_TRUE(WritePng(std::filesystem::path(folder) / name, image));
  }
}

Mesh OneTriangle() {
  Mesh mesh;
  mesh.vertices.resize(3);
  mesh.vertices[0].position_W = {-1, -1, 0};
  mesh.vertices[1].position_W = {1, -1, 0};
  mesh.vertices[2].position_W = {0, 1, 0};
  for (MeshVertex& vertex : mesh.vertices) {
    vertex.normal_W = Eigen::Vector3f::UnitZ();
    vertex.instance = InstanceId{1};
  }
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

size_t CountNot(const Image<Rgb8>& image, Rgb8 color) {
  return image.size() -
         static_cast<size_t>(std::count(image.pixels().begin(), image.pixels().end(), color));
}

TEST(RenderMesh, FrontIsDrawnWithItsTrueAreaAndBackIsNot) {
  SceneBox scene;
  scene.size = Vector3d(2, 2, 0.1);
  const View view = TopDownView(scene, 200, 200);
  const Image<Rgb8> front = RenderMesh(OneTriangle(), view, Coloring::kInstance);
  const double pixels = 2 * view.scale * view.scale;  // an area of 2 square metres
  EXPECT_NEAR(static_cast<double>(CountNot(front, kBackground)), pixels, 0.03 * pixels);
  Mesh back = OneTriangle();
  std::swap(back.triangles[0][0], back.triangles[0][1]);
  EXPECT_EQ(CountNot(RenderMesh(back, view, Coloring::kInstance), kBackground), 0u);
}

TEST(RenderMesh, NearerSurfaceHidesFartherWhateverTheOrder) {
  Mesh mesh = OneTriangle();
  for (MeshVertex vertex : OneTriangle().vertices) {
    vertex.position_W.z() = 0.5F;
    vertex.instance = InstanceId{2};
    mesh.vertices.push_back(vertex);
  }
  SceneBox scene;
  scene.size = Vector3d(2, 2, 2);
  for (const bool perspective : {false, true}) {
    const View view =
        perspective ? PerspectiveView(scene, 0.3, 1.4, 200, 200) : TopDownView(scene, 200, 200);
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    const Image<Rgb8> one = RenderMesh(mesh, view, Coloring::kInstance);
    std::swap(mesh.triangles[0], mesh.triangles[1]);
    EXPECT_EQ(one, RenderMesh(mesh, view, Coloring::kInstance));
    const auto middle = ProjectToView(view, Vector3d(0, 0, 0.5));
    ASSERT_TRUE(middle);
    const Rgb8 seen = one(static_cast<int>(middle->y()), static_cast<int>(middle->x()));
    const Rgb8 near = StrongColor(2);
    // Lit from the viewer, so a little darker than the palette.
    EXPECT_NEAR(seen.r / (near.r + 1.0), seen.g / (near.g + 1.0), 0.05);
    EXPECT_NEAR(seen.r / (near.r + 1.0), seen.b / (near.b + 1.0), 0.05);
  }
}

TEST(RenderMesh, SameForAnyNumberOfThreads) {
  const Mesh mesh = ExtractMesh(Room());
  const View view = BestPerspectiveView(mesh, FrameScene(mesh, Vector3d::UnitZ()), 300, 200);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return RenderMesh(mesh, view, Coloring::kInstance);
  };
  EXPECT_EQ(with_threads(1), with_threads(4));
}

TEST(View, WholeSceneIsInThePicture) {
  const Mesh mesh = ExtractMesh(Room());
  const SceneBox scene = FrameScene(mesh, Vector3d::UnitZ());
  for (const View& view : {TopDownView(scene, 300, 500), TopDownView(scene, 500, 300),
                           PerspectiveView(scene, 2, 0.6, 400, 300)}) {
    for (const MeshVertex& vertex : mesh.vertices) {
      const auto pixel = ProjectToView(view, vertex.position_W.cast<double>());
      ASSERT_TRUE(pixel);
      EXPECT_TRUE(pixel->x() > 0 && pixel->x() < view.width);
      EXPECT_TRUE(pixel->y() > 0 && pixel->y() < view.height);
    }
  }
}

TEST(View, BestViewIsFilledButNotOverfull) {
  const Mesh mesh = ExtractMesh(Room());
  const View view = BestPerspectiveView(mesh, FrameScene(mesh, Vector3d::UnitZ()), 300, 400);
  const Image<Rgb8> image = RenderMesh(mesh, view, Coloring::kInstance);
  int left = 300, right = 0;
  for (int v = 0; v < 400; ++v) {
    for (int u = 0; u < 300; ++u) {
      if (image(v, u) == kBackground) continue;
      left = std::min(left, u);
      right = std::max(right, u);
    }
  }
  EXPECT_GT(left, 0);
  EXPECT_LT(right, 299);
  EXPECT_GT(right - left, 260);
}

TEST(View, FromAboveTheTableIsSeenThroughTheCeiling) {
  const Mesh mesh = ExtractMesh(Room());
  const View view = TopDownView(FrameScene(mesh, Vector3d::UnitZ()), 400, 300);
  const Image<Rgb8> image = RenderMesh(mesh, view, Coloring::kInstance);
  const auto pixel = ProjectToView(view, Vector3d(-0.6, 0.2, 0.7));
  const Rgb8 seen = image(static_cast<int>(pixel->y()), static_cast<int>(pixel->x()));
  const Rgb8 table = StrongColor(3);
  EXPECT_NEAR(seen.r, table.r, 6);
  EXPECT_NEAR(seen.g, table.g, 6);
  EXPECT_NEAR(seen.b, table.b, 6);
}

TEST(EstimateUp, FindsTheFloorsNormal) {
  const Mesh mesh = ExtractMesh(Room());
  EXPECT_GT(EstimateUp(mesh).z(), 0.999);
  // The same room in a world that was turned over, with a rough hint from the cameras.
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(1.9F, Eigen::Vector3f(1, 0.2F, -0.3F).normalized()).toRotationMatrix();
  Mesh turned = mesh;
  for (MeshVertex& vertex : turned.vertices) {
    vertex.position_W = turn * vertex.position_W;
    vertex.normal_W = turn * vertex.normal_W;
  }
  const Vector3d truth = turn.cast<double>().col(2);
  const Vector3d hint = Eigen::AngleAxisd(0.4, Vector3d::UnitX()) * truth;
  EXPECT_GT(EstimateUp(turned, hint).dot(truth), 0.999);
  EXPECT_EQ(EstimateUp({}), Vector3d::UnitZ());
}

TEST(Palette, IdsNextToEachOtherLookDifferent) {
  const auto difference = [](Rgb8 a, Rgb8 b) {
    return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
  };
  for (uint32_t id = 1; id < 200; ++id) {
    for (uint32_t other = id + 1; other < id + 5; ++other) {
      EXPECT_GT(difference(StrongColor(id), StrongColor(other)), 60) << id << " " << other;
    }
    EXPECT_GT(difference(PaleColor(id), PaleColor(id + 1)), 8) << id;
    EXPECT_GT(difference(StrongColor(id), PaleColor(id)), 60) << id;
  }
}

TEST(Legend, NamesClassesWithCounts) {
  std::vector<ObjectSummary> objects(5);
  for (size_t i = 0; i < 3; ++i) {
    objects[i].instance = InstanceId{static_cast<uint32_t>(i + 1)};
    objects[i].class_id = i < 2 ? kDiningTable : ClassId{5};
  }
  objects[3].segments = {kBall};
  objects[4].segments = {kFloor};
  objects[4].structure = StructureKind::kWall;
  const auto legend = MakeLegend(objects, Coloring::kInstance, Name);
  ASSERT_EQ(legend.size(), 5u);
  EXPECT_EQ(legend[0].text, "class 5 x1");
  EXPECT_EQ(legend[1].text, "dining table x2");
  EXPECT_EQ(legend[1].swatches, (std::vector<Rgb8>{StrongColor(1), StrongColor(2)}));
  EXPECT_EQ(legend[2].text, "unknown object x1");
  EXPECT_EQ(legend[2].swatches, (std::vector<Rgb8>{PaleColor(4)}));
  EXPECT_EQ(legend[3].text, "structure x1");
}

TEST(Overview, ShowsTheMap) {
  const SemanticMap map = Room();
  const Mesh mesh = ExtractMesh(map);
  const auto objects = SummarizeObjects(map, mesh);
  for (const auto& [coloring, name] :
       {std::pair(Coloring::kInstance, "room_instance.png"),
        std::pair(Coloring::kRgb, "room_rgb.png"), std::pair(Coloring::kClass, "room_class.png"),
        std::pair(Coloring::kSegment, "room_segment.png")}) {
    const Image<Rgb8> image =
        RenderMapOverview(mesh, objects, Name, "room: 1 object", {.coloring = coloring});
    EXPECT_EQ(image.width(), 1600);
    EXPECT_EQ(image.height(), 900);
    EXPECT_GT(CountNot(image, kBackground), image.size() / 4);
    Keep(image, name);
  }
}

TEST(Overview, EmptyMapGivesAPictureToo) {
  EXPECT_EQ(RenderMapOverview({}, {}, {}, "empty").width(), 1600);
}

TEST(Overview, SurvivesAMeshOfNonsense) {
  // Meshes also come from files.
  Mesh mesh = OneTriangle();
  const float values[] = {std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity(), 3e38F, -3e38F, 0};
  for (const float x : values) {
    for (const float y : values) {
      MeshVertex vertex;
      vertex.position_W = {x, y, 1};
      mesh.vertices.push_back(vertex);
    }
  }
  for (uint32_t i = 0; i + 2 < mesh.vertices.size(); ++i)
    mesh.triangles.push_back({i, i + 1, i + 2});
  EXPECT_EQ(RenderMapOverview(mesh, {}, {}, "nonsense").height(), 900);
}

TEST(Png, DecodesToTheSamePixels) {
  Image<Rgb8> image(3, 2);
  image(1, 2) = {255, 10, 30};
  const auto bytes = EncodePng(image);
  const cv::Mat decoded = cv::imdecode(bytes, cv::IMREAD_COLOR);
  ASSERT_EQ(decoded.cols, 3);
  ASSERT_EQ(decoded.rows, 2);
  EXPECT_EQ(decoded.at<cv::Vec3b>(1, 2), cv::Vec3b(30, 10, 255));
  EXPECT_FALSE(WritePng("/nonexistent/a.png", image));
}

TEST(Ramp, IsDarkThenBrightAndKeepsToItsEnds) {
  const auto brightness = [](Rgb8 c) { return 0.3 * c.r + 0.59 * c.g + 0.11 * c.b; };
  for (double value = 0; value < 0.99; value += 0.02)
    EXPECT_LT(brightness(RampColor(value)), brightness(RampColor(value + 0.02)) + 1) << value;
  EXPECT_EQ(RampColor(-5), RampColor(0));
  EXPECT_EQ(RampColor(7), RampColor(1));
  EXPECT_EQ(RampColor(std::numeric_limits<double>::quiet_NaN()), RampColor(0));
}

TEST(Paint, HeightsGoFromFloorToCeilingInAnyDirection) {
  Mesh mesh = ExtractMesh(Room());
  const ColorScale scale = PaintHeights(Vector3d::UnitZ(), &mesh);
  EXPECT_EQ(scale.low, "0 m");
  EXPECT_EQ(scale.high, "2 m");
  for (const MeshVertex& vertex : mesh.vertices) {
    const Rgb8 expected = RampColor(static_cast<double>(vertex.position_W.z()) / 2);
    EXPECT_NEAR(vertex.color.g, expected.g, 6) << vertex.position_W.transpose();
  }
  EXPECT_EQ(PaintHeights(-Vector3d::UnitZ(), &mesh).low, "-2 m");
}

TEST(Paint, OftenSeenSurfaceIsBrighter) {
  Mesh mesh = OneTriangle();
  mesh.vertices[1].seen = 1;
  mesh.vertices[2].seen = 255;
  PaintSeen(&mesh);
  EXPECT_EQ(mesh.vertices[0].color, kUnsegmentedColor);
  EXPECT_EQ(mesh.vertices[1].color, RampColor(0));
  EXPECT_NEAR(mesh.vertices[2].color.r, RampColor(1).r, 3);
}

TEST(Paint, WhatIsAboveTheCutIsGone) {
  Mesh mesh = ExtractMesh(Room());
  const size_t before = mesh.triangles.size();
  CutAbove(Vector3d::UnitZ(), 1.0, &mesh);
  EXPECT_LT(mesh.triangles.size(), before * 3 / 4);
  EXPECT_GT(mesh.triangles.size(), before / 4);
  for (const MeshVertex& vertex : mesh.vertices) EXPECT_LT(vertex.position_W.z(), 1.0F);
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t corner : triangle) ASSERT_LT(corner, mesh.vertices.size());
  CutAbove(Vector3d::UnitZ(), -100, &mesh);
  EXPECT_TRUE(mesh.triangles.empty() && mesh.vertices.empty());
}

TEST(View, TurntableShowsTheWholeSceneFromAllAround) {
  const Mesh mesh = ExtractMesh(Room());
  const SceneBox scene = FrameScene(mesh, Vector3d::UnitZ());
  const std::vector<View> views = TurntableViews(scene, 8, 0.6, 400, 300);
  ASSERT_EQ(views.size(), 8u);
  for (const View& view : views) {
    for (const MeshVertex& vertex : mesh.vertices) {
      const auto pixel = ProjectToView(view, vertex.position_W.cast<double>());
      ASSERT_TRUE(pixel);
      EXPECT_TRUE(pixel->x() > 0 && pixel->x() < 400 && pixel->y() > 0 && pixel->y() < 300);
    }
  }
  const auto eye = [&](size_t i) -> Vector3d { return views[i].T_V_W.inverse().translation(); };
  EXPECT_NEAR((eye(0) + eye(4) - 2 * scene.center_W).head<2>().norm(), 0, 1e-9);
  EXPECT_NEAR(eye(0).z(), eye(3).z(), 1e-9);
}

TEST(Caption, HasLegendScaleAndBar) {
  const Image<Rgb8> picture(600, 300, kBackground);
  Caption caption;
  const Image<Rgb8> bare = WithCaption(picture, caption, 420);
  EXPECT_EQ(CountNot(bare, kBackground), 0u);
  caption.scale = ColorScale{"height", "0 m", "1 m"};
  const size_t scale = CountNot(WithCaption(picture, caption, 420), kBackground);
  EXPECT_GT(scale, 260u * 16u);
  caption.pixels_per_metre = 100;
  const size_t bar = CountNot(WithCaption(picture, caption, 420), kBackground) - scale;
  EXPECT_GT(bar, 100u * 3u);  // 1 m
  EXPECT_LT(bar, 100u * 3u + 250u);
  caption.legend.assign(100, {{{200, 0, 0}}, "one of very many"});
  EXPECT_GT(CountNot(WithCaption(picture, caption, 420), kBackground), scale + bar);
}

TEST(Caption, LengthsAreRound) {
  for (const double longest : {0.003, 0.1999, 0.2, 0.51, 1.0, 7.0, 49.9, 1234.5}) {
    const double length = RoundLength(longest);
    EXPECT_LE(length, longest * (1 + 1e-9));
    EXPECT_GE(length, 0.4 * longest);
    const double digit = length / std::pow(10, std::floor(std::log10(length * 1.0001)));
    EXPECT_TRUE(std::abs(digit - 1) < 1e-6 || std::abs(digit - 2) < 1e-6 ||
                std::abs(digit - 5) < 1e-6)
        << longest << " " << length;
  }
  EXPECT_EQ(MetresText(1.5), "1.5 m");
  EXPECT_EQ(MetresText(20), "20 m");
  EXPECT_EQ(MetresText(-0.001), "0 m");
}

// The content of the chunks of an animation with this name.
std::vector<std::vector<uint8_t>> Chunks(std::span<const uint8_t> file, const std::string& name) {
  std::vector<std::vector<uint8_t>> found;
  for (size_t at = 12; at + 8 <= file.size();) {
    const size_t size = file[at + 4] + (file[at + 5] << 8) + (file[at + 6] << 16);
    if (at + 8 + size > file.size()) return {};
    if (std::equal(name.begin(), name.end(), file.begin() + static_cast<std::ptrdiff_t>(at)))
      found.emplace_back(file.begin() + static_cast<std::ptrdiff_t>(at + 8),
                         file.begin() + static_cast<std::ptrdiff_t>(at + 8 + size));
    at += 8 + size + size % 2;
  }
  return found;
}

TEST(Webp, AnimationHasEachPictureWithItsTime) {
  WebpAnimation animation(33, 20, 250, 90);
  for (const uint8_t red : {uint8_t{20}, uint8_t{220}})
    animation.Add(Image<Rgb8>(33, 20, Rgb8{red, 100, 60}));
  EXPECT_THROW(animation.Add(Image<Rgb8>(32, 20)), std::logic_error);
  const std::vector<uint8_t> file = animation.Finish();
  const size_t size = file[4] + (file[5] << 8) + (file[6] << 16);
  EXPECT_EQ(size + 8, file.size());
  const auto heads = Chunks(file, "VP8X");
  ASSERT_EQ(heads.size(), 1u);
  EXPECT_EQ(heads[0], (std::vector<uint8_t>{2, 0, 0, 0, 32, 0, 0, 19, 0, 0}));
  const auto frames = Chunks(file, "ANMF");
  ASSERT_EQ(frames.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(frames[i][12], 250);  // ms
    // The picture of a frame, as a file of its own.
    std::vector<uint8_t> single{'R', 'I', 'F', 'F', 0, 0, 0, 0, 'W', 'E', 'B', 'P'};
    single.insert(single.end(), frames[i].begin() + 16, frames[i].end());
    const auto bytes = static_cast<uint32_t>(single.size() - 8);
    for (size_t k = 0; k < 4; ++k) single[4 + k] = static_cast<uint8_t>(bytes >> (8 * k));
    const cv::Mat decoded = cv::imdecode(single, cv::IMREAD_COLOR);
    ASSERT_EQ(decoded.cols, 33);
    ASSERT_EQ(decoded.rows, 20);
    EXPECT_NEAR(decoded.at<cv::Vec3b>(10, 16)[2], i == 0 ? 20 : 220, 4);
  }
}

}  // namespace
}  // namespace vismap
