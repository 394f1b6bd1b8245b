#include "depth_segmenter/frame_detection_join.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace vismap {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

rgbd_frame_t Frame(int64_t utime, int camera = 0) {
  rgbd_frame_t frame{};
  frame.utime = utime;
  frame.camera_id = camera;
  return frame;
}

detections_t Detections(int64_t utime, int camera = 0) {
  detections_t detections{};
  detections.utime = utime;
  detections.camera_id = camera;
  return detections;
}

/// Utimes of the frames that are released now; negative = without detections.
std::vector<int64_t> Leaving(FrameDetectionJoin* join, double now, double patience) {
  std::vector<int64_t> utimes;
  while (const auto joined = join->Next(now, patience)) {
    EXPECT_EQ(KeyOf(joined->detections.value_or(
                  Detections(joined->frame.utime, joined->frame.camera_id))),
              KeyOf(joined->frame));
    utimes.push_back(joined->detections ? joined->frame.utime : -joined->frame.utime);
  }
  return utimes;
}

using Utimes = std::vector<int64_t>;

TEST(FrameDetectionJoin, FrameWaitsForItsDetections) {
  FrameDetectionJoin join({.capacity = 10});
  join.AddFrame(Frame(1), 0);
  EXPECT_EQ(Leaving(&join, 1e9, kForever), Utimes{});
  join.AddDetections(Detections(1), 0);
  EXPECT_EQ(Leaving(&join, 1e9, kForever), Utimes{1});
  EXPECT_EQ(join.waiting(), 0U);
}

TEST(FrameDetectionJoin, DetectionsMayArriveFirst) {
  FrameDetectionJoin join({.capacity = 10});
  join.AddDetections(Detections(1), 0);
  join.AddFrame(Frame(1), 0);
  EXPECT_EQ(Leaving(&join, 0, kForever), Utimes{1});
}

TEST(FrameDetectionJoin, TellsHowLongAfterTheFrameItsDetectionsCame) {
  FrameDetectionJoin join({.capacity = 10});
  join.AddFrame(Frame(1), 5);
  join.AddDetections(Detections(1), 5.5);
  join.AddDetections(Detections(2), 6);
  join.AddFrame(Frame(2), 7);
  join.AddFrame(Frame(3), 7);
  EXPECT_EQ(join.Next(9, kForever)->detections_after_s, 0.5);
  EXPECT_EQ(join.Next(9, kForever)->detections_after_s, 0) << "they came first";
  EXPECT_EQ(join.Next(9, 0)->detections_after_s, 0) << "none came";
}

TEST(FrameDetectionJoin, FramesAreReleasedInTheirOrder) {
  FrameDetectionJoin join({.capacity = 10});
  for (const int64_t utime : {5, 3, 9}) join.AddFrame(Frame(utime), 0);
  join.AddDetections(Detections(9), 0);
  join.AddDetections(Detections(3), 0);
  EXPECT_EQ(Leaving(&join, 0, kForever), Utimes{});
  join.AddDetections(Detections(5), 0);
  EXPECT_EQ(Leaving(&join, 0, kForever), (Utimes{5, 3, 9}));
}

TEST(FrameDetectionJoin, DetectionsOfAnotherCameraOrTimeDoNotCount) {
  FrameDetectionJoin join({.capacity = 10});
  join.AddFrame(Frame(1, 0), 0);
  join.AddDetections(Detections(1, 1), 0);
  join.AddDetections(Detections(2, 0), 0);
  EXPECT_EQ(Leaving(&join, 0, kForever), Utimes{});
}

TEST(FrameDetectionJoin, FrameIsReleasedWhenPatienceEnds) {
  FrameDetectionJoin join({.capacity = 10});
  join.AddFrame(Frame(1), 100);
  join.AddFrame(Frame(2), 101);
  EXPECT_EQ(Leaving(&join, 101.9, 2), Utimes{});
  EXPECT_EQ(Leaving(&join, 102, 2), Utimes{-1});
  EXPECT_DOUBLE_EQ(join.Waited(102), 1);
  EXPECT_EQ(join.counters().frames_without, 1);
  join.AddDetections(Detections(1), 0);
  EXPECT_EQ(join.counters().detections_late, 1);
}

TEST(FrameDetectionJoin, WithoutPatienceArrivedDetectionsAreUsed) {
  FrameDetectionJoin join({.capacity = 10});
  join.AddDetections(Detections(2), 0);
  join.AddFrame(Frame(1), 0);
  join.AddFrame(Frame(2), 0);
  EXPECT_EQ(Leaving(&join, 0, 0), (Utimes{-1, 2}));
}

TEST(FrameDetectionJoin, MemoryIsBoundedAndLossIsCounted) {
  FrameDetectionJoin join({.capacity = 3});
  for (int64_t utime = 1; utime <= 10; ++utime) join.AddFrame(Frame(utime), 0);
  EXPECT_EQ(join.waiting(), 3U);
  EXPECT_EQ(join.counters().frames_dropped, 7);
  for (int64_t utime = 101; utime <= 110; ++utime) join.AddDetections(Detections(utime), 0);
  EXPECT_EQ(join.counters().detections_dropped, 7);
  for (const int64_t utime : {8, 9, 10}) join.AddDetections(Detections(utime), 0);
  EXPECT_EQ(Leaving(&join, 0, kForever), (Utimes{8, 9, 10}));
}

TEST(FrameDetectionJoin, RepeatedMessagesAreCountedAndIgnored) {
  FrameDetectionJoin join({.capacity = 10});
  join.AddFrame(Frame(1), 0);
  join.AddFrame(Frame(1), 0);
  join.AddDetections(Detections(1), 0);
  join.AddDetections(Detections(1), 0);
  EXPECT_EQ(Leaving(&join, 0, kForever), Utimes{1});
  EXPECT_EQ(join.counters().frames_repeated, 1);
  EXPECT_EQ(join.counters().detections_repeated, 1);
}

TEST(FrameDetectionJoin, FrameThatIsSentAgainAfterReleaseIsJoinedAgain) {
  FrameDetectionJoin join({.capacity = 10});
  join.AddFrame(Frame(1), 0);
  EXPECT_EQ(Leaving(&join, 0, 0), Utimes{-1});
  join.AddFrame(Frame(1), 1);
  join.AddDetections(Detections(1), 0);
  EXPECT_EQ(Leaving(&join, 1, kForever), Utimes{1});
}

TEST(FrameDetectionJoin, BytesAreBounded) {
  FrameDetectionJoin join({.capacity = 1000, .max_bytes = 40'000});
  rgbd_frame_t frame = Frame(0);
  frame.depth.resize(9000);
  detections_t detections = Detections(0);
  detections.detections.resize(1);
  detections.detections[0].runs.resize(1000);
  for (int i = 1; i <= 20; ++i) {
    frame.utime = i;
    join.AddFrame(frame, 0);
    detections.utime = 100 + i;
    join.AddDetections(detections, 0);
    EXPECT_LE(join.bytes(), 40'000u);
  }
  EXPECT_EQ(join.waiting(), 3u);
  EXPECT_EQ(join.counters().frames_dropped, 17);
  EXPECT_EQ(join.counters().detections_dropped, 18);
  frame.depth.resize(100'000);
  frame.utime = 50;
  join.AddFrame(frame, 0);
  EXPECT_EQ(Leaving(&join, 0, 0), Utimes{-50}) << "a single frame always fits";
  EXPECT_LE(join.bytes(), 10'000u);
}

TEST(FrameDetectionJoin, WhatWaitsTooLongIsDropped) {
  FrameDetectionJoin join({.max_wait_s = 60});
  join.AddFrame(Frame(1), 0);
  join.AddFrame(Frame(2), 50);
  join.AddDetections(Detections(7), 0);
  join.AddDetections(Detections(2), 50);
  join.DropLate(59);
  EXPECT_EQ(join.counters().frames_dropped, 0);
  join.DropLate(60);
  EXPECT_EQ(join.counters().frames_dropped, 1);
  EXPECT_EQ(join.counters().detections_dropped, 1);
  EXPECT_EQ(Leaving(&join, 60, kForever), Utimes{2});
  EXPECT_EQ(join.bytes(), 0u);
}

}  // namespace
}  // namespace vismap
