#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "codecs/label_codec.h"
#include "viewer/box_scene.h"
#include "viewer/evidence_answers.h"

namespace vismap {
namespace {

using testing_support::BlockOf;
using testing_support::CubeScene;

EvidenceFramePtr FrameAt(double x, int64_t utime, int camera = 0, size_t jpeg_bytes = 1000) {
  auto frame = std::make_shared<EvidenceFrame>();
  frame->header.camera_id = CameraId{camera};
  frame->header.utime = utime;
  frame->header.T_W_C.translation().x() = x;
  frame->jpeg.resize(jpeg_bytes);
  return frame;
}

TEST(EvidenceStore, KeepsFramesThatDiffer) {
  EvidenceStore store(1 << 20);
  store.Add(FrameAt(0, 1));
  store.Add(FrameAt(0.01, 2));
  EXPECT_EQ(store.frames().size(), 1U);
  store.Add(FrameAt(0.2, 3));
  EXPECT_EQ(store.frames().size(), 2U);
  EXPECT_NE(store.Find(CameraId{0}, 3), nullptr);
  EXPECT_EQ(store.Find(CameraId{1}, 3), nullptr);
  EXPECT_EQ(store.Find(CameraId{0}, 2), nullptr);
  // After a minute a newer frame takes the place of the old one.
  store.Add(FrameAt(0.01, 61000002));
  ASSERT_EQ(store.frames().size(), 2U);
  EXPECT_EQ(store.Find(CameraId{0}, 1), nullptr);
  EXPECT_NE(store.Find(CameraId{0}, 61000002), nullptr);
  store.Clear();
  EXPECT_TRUE(store.frames().empty());
  EXPECT_EQ(store.bytes(), 0U);
}

TEST(EvidenceStore, MemoryIsBoundedAndTheViewsStaySpread) {
  const size_t bytes = 200 * FrameAt(0, 0)->bytes();
  EvidenceStore store(bytes);
  constexpr int kFrames = 3000;
  constexpr double kStep = 0.06;  // [m]
  for (int i = 0; i < kFrames; ++i) {
    store.Add(FrameAt(kStep * i, 1000 * i));
    ASSERT_LE(store.bytes(), bytes);
  }
  EXPECT_GE(store.frames().size(), 100U);
  // No part of the way is without a frame.
  std::vector<double> places;
  for (const EvidenceFramePtr& frame : store.frames())
    places.push_back(frame->header.T_W_C.translation().x());
  std::sort(places.begin(), places.end());
  double gap = places.front();
  for (size_t i = 1; i < places.size(); ++i) gap = std::max(gap, places[i] - places[i - 1]);
  EXPECT_LT(gap, 3 * kFrames * kStep / static_cast<double>(places.size()));
  // A frame that alone is too large is not kept.
  store.Add(FrameAt(1e4, 1, 0, 2 * bytes));
  EXPECT_EQ(store.Find(CameraId{0}, 1), nullptr);
  EXPECT_GE(store.frames().size(), 100U);
}

TEST(EvidenceStore, NothingIsKeptWithoutMemory) {
  EvidenceStore store(0);
  store.Add(FrameAt(0, 1));
  EXPECT_TRUE(store.frames().empty());
}

// A frame of the cube's scene, with depth, and one detection over the cube.
EvidenceFramePtr CubeFrame(const CubeScene& scene, const Pose& T_W_C, int64_t utime) {
  auto frame = std::make_shared<EvidenceFrame>();
  frame->header.utime = utime;
  frame->header.camera = scene.camera;
  frame->header.T_W_C = T_W_C;
  frame->depth_step = 4;
  frame->depth_mm = Image<uint16_t>(80, 60);
  SegmentImage segments{Image<SegmentIndex>(320, 240), 2};
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const auto [instance, depth] = scene.NearestAt(T_W_C, u, v);
      segments.index(v, u) = SegmentIndex{instance == 7 ? 1 : 0};
      if (u % 4 == 0 && v % 4 == 0)
        frame->depth_mm(v / 4, u / 4) = static_cast<uint16_t>(1000 * depth);
    }
  }
  frame->labels = EncodeSegmentImage(segments);
  frame->segments = {{-1, ClassId::kUnknown, 0}, {0, ClassId{62}, 0.75F}};
  frame->jpeg = EncodeJpeg(Image<Rgb8>(320, 240, Rgb8{90, 90, 90}));
  return frame;
}

struct Asked {
  CubeScene scene;
  EvidenceFinder finder{1 << 24};
  EvidenceQuestion question;

  Asked() {
    question.blocks = std::make_shared<const std::vector<SurfaceBlock>>(
        std::vector<SurfaceBlock>{BlockOf(scene.parts)});
    question.map_id = "m";
    question.revision = 5;
    question.object.instance = InstanceId{7};
  }
  void Add(const Pose& T_W_C, int64_t utime) { finder.store().Add(CubeFrame(scene, T_W_C, utime)); }
  nlohmann::json List() {
    const HttpAnswer answer = EvidenceList("7", question, &finder);
    return nlohmann::json::parse(answer.body.begin(), answer.body.end());
  }
};

Pose At(double x, double y, double z, double turn = 0) {
  Pose T_W_C = Pose::Identity();
  T_W_C.translation() = Eigen::Vector3d(x, y, z);
  T_W_C.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return T_W_C;
}

TEST(Evidence, ListsViewsByTheirPixelsWithoutThoseThatDoNotShowTheObject) {
  Asked asked;
  asked.Add(At(0, 0, 0), 1000);
  asked.Add(At(-0.6, 0, -0.5), 2000);
  asked.Add(At(0, 0, 0, 2), 3000);         // looks away
  asked.Add(At(0.15, 0.1, 0.9, 0), 4000);  // the post fills the view
  const nlohmann::json list = asked.List();
  ASSERT_EQ(list["frames"].size(), 2U) << list;
  EXPECT_EQ(list["frames"][0]["utime"], 1000);
  EXPECT_EQ(list["frames"][1]["utime"], 2000);
  EXPECT_GT(list["frames"][0]["pixels"], list["frames"][1]["pixels"]);
  EXPECT_EQ(list["frames"][0]["url"], "/api/frame/0/1000.jpg?id=7");
  EXPECT_EQ(list["frames"][0]["detection"]["class_name"], "chair");
  EXPECT_GT(list["frames"][0]["detection"]["overlap"], 0.9);
  EXPECT_NEAR(list["frames"][0]["share"].get<double>(), 0.75, 0.2);
  EXPECT_EQ(list["frames"][1]["T_W_C"][3], -0.6);
  EXPECT_EQ(list["kept"]["frames"], 4);
  EXPECT_FALSE(list.contains("why"));
}

TEST(Evidence, ListsAtMostTwelveViewsOfDifferentPlaces) {
  Asked asked;
  for (int i = 0; i < 60; ++i)
    asked.Add(At(-0.8 + 0.2 * (i % 10), 0.2 * (i / 10) - 0.5, 0), 1000 * i);
  const nlohmann::json list = asked.List();
  EXPECT_EQ(list["frames"].size(), EvidenceFinder::kMostViews);
  double left = 0, right = 0;
  for (const nlohmann::json& frame : list["frames"]) {
    left = std::min(left, frame["T_W_C"][3].get<double>());
    right = std::max(right, frame["T_W_C"][3].get<double>());
  }
  EXPECT_GT(right - left, 0.79);  // the 12 places nearest to the middle span 0.6 m
}

TEST(Evidence, SaysWhyThereIsNone) {
  Asked asked;
  nlohmann::json list = asked.List();
  EXPECT_TRUE(list["frames"].empty());
  EXPECT_THAT(list["why"], testing::HasSubstr("no frame is kept yet"));
  asked.Add(At(0, 0, 0, 2), 3000);
  list = asked.List();
  EXPECT_TRUE(list["frames"].empty());
  EXPECT_THAT(list["why"], testing::HasSubstr("1 frame is kept"));
  asked.question.object.instance = InstanceId{8};
  const HttpAnswer gone = EvidenceList("8", asked.question, &asked.finder);
  EXPECT_EQ(gone.status, 404);
}

TEST(Evidence, PictureHasTheMaskOfTheObject) {
  Asked asked;
  asked.Add(At(0, 0, 0), 1000);
  const auto picture = [&](const char* target, const EvidenceQuestion* object) {
    const auto question = ReadPictureQuestion(*ParseTarget(target));
    EXPECT_TRUE(question) << target;
    return EvidencePicture(*question, object, &asked.finder);
  };
  const HttpAnswer plain = picture("/api/frame/0/1000.jpg", nullptr);
  EXPECT_EQ(plain.body, asked.finder.store().frames()[0]->jpeg);
  const HttpAnswer png = picture("/api/frame/0/1000.png?id=7&color=ff0000", &asked.question);
  EXPECT_EQ(png.content_type, "image/png");
  const HttpAnswer drawn = picture("/api/frame/0/1000.jpg?id=7&color=ff0000", &asked.question);
  const auto image = DecodeJpeg(drawn.body, 320, 240);
  ASSERT_TRUE(image);
  const Pose T_W_C = At(0, 0, 0);
  int right = 0;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const bool red = (*image)(v, u).r > (*image)(v, u).g + 20;
      const bool white = (*image)(v, u).g > 150;
      right += (red || white) == (asked.scene.NearestAt(T_W_C, u, v).first == 7);
    }
  }
  EXPECT_GT(right, 0.99 * 320 * 240);
  const auto small =
      DecodeJpeg(picture("/api/frame/0/1000.jpg?id=7&width=80", &asked.question).body);
  ASSERT_TRUE(small);
  EXPECT_EQ(small->width(), 80);
  EXPECT_EQ(picture("/api/frame/0/2000.jpg", nullptr).status, 404);
  EXPECT_EQ(picture("/api/frame/1/1000.jpg", nullptr).status, 404);
}

TEST(Evidence, WrongQuestionsAreRefused) {
  for (const char* target : {"/api/frame/",
                             "/api/frame/0",
                             "/api/frame/0/",
                             "/api/frame/0/.jpg",
                             "/api/frame//1.jpg",
                             "/api/frame/0/1.gif",
                             "/api/frame/0/1",
                             "/api/frame/-1/1.jpg",
                             "/api/frame/0/-1.jpg",
                             "/api/frame/0/1e3.jpg",
                             "/api/frame/+1/1.jpg",
                             "/api/frame/0/99999999999999999999.jpg",
                             "/api/frame/99999999999/1.jpg",
                             "/api/frame/0/1.jpg.jpg",
                             "/api/frame/0/../1.jpg",
                             "/api/frame/0/1.jpg?id=",
                             "/api/frame/0/1.jpg?id=x",
                             "/api/frame/0/1.jpg?id=0",
                             "/api/frame/0/1.jpg?id=-7",
                             "/api/frame/0/1.jpg?id=ss1",
                             "/api/frame/0/1.jpg?width=0",
                             "/api/frame/0/1.jpg?width=99999",
                             "/api/frame/0/1.jpg?color=red",
                             "/api/frame/0/1.jpg?color=-00001",
                             "/api/frame/0/1.jpg?what=1"}) {
    const auto question = ReadPictureQuestion(*ParseTarget(target));
    ASSERT_FALSE(question) << target;
    EXPECT_THAT(question.error().message, testing::HasSubstr(" ")) << target;
  }
  EXPECT_FALSE(ParseObjectName("4294967296"));
  EXPECT_EQ(ParseObjectName("s12")->number, 12U);
  EXPECT_TRUE(ParseObjectName("s12")->is_segment);
}

TEST(EvidenceRequest, AnExceptionIsAnAnswer) {
  const HttpAnswer answer =
      AnswerInTurn(100, 100, []() -> HttpAnswer { throw std::runtime_error("no memory is left"); });
  EXPECT_EQ(answer.status, 500);
  EXPECT_THAT(std::string(answer.body.begin(), answer.body.end()),
              testing::HasSubstr("no memory is left"));
}

TEST(EvidenceRequest, OneThatWaitedTooLongTakesNoTime) {
  int calls = 0;
  const auto work = [&] { return ++calls, JsonAnswer("{}"); };
  EXPECT_EQ(AnswerInTurn(100, 114.9, work).status, 200);
  EXPECT_EQ(AnswerInTurn(100, 115.1, work).status, 503);
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace vismap
