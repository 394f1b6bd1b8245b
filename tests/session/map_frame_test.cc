#include "session/map_frame.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/random_detections.h"

namespace vismap {
namespace {

using testing_support::RandomNumbers;

struct InputFrame {
  RgbdFrame frame;
  std::optional<DetectionSet> detections;

  const DetectionSet* Detections() const { return detections ? &*detections : nullptr; }
};

/// Frames of random scenes, most of them with detections.
std::vector<InputFrame> RandomFrames(size_t count) {
  RandomNumbers random(5);
  const PinholeCamera camera = testing_support::RandomCamera(161, 119, &random);
  std::vector<InputFrame> frames;
  for (size_t i = 0; i < count; ++i) {
    InputFrame input{testing_support::RandomFrame(camera, &random), std::nullopt};
    input.frame.header.utime = static_cast<int64_t>(1000 * (i + 1));
    if (random.Chance(0.7)) input.detections = testing_support::RandomDetections(camera, &random);
    frames.push_back(std::move(input));
  }
  return frames;
}

SegmentationStageOptions SmallSegments() {
  SegmentationStageOptions options;
  options.segmentation.min_segment_px = 5000;  // scaled to the image's size: about 300 pixels
  return options;
}

MapSessionOptions CoarseGrid() {
  MapSessionOptions options;
  options.grid = VoxelGridOptions{0.06, 4};
  return options;
}

TEST(MapFrame, GivesTheSameAsItsStepsOneByOne) {
  const MapSessionOptions options = CoarseGrid();
  MapSession session(options, {});
  SemanticMap by_hand(options.grid);
  size_t matched = 0;
  for (const InputFrame& input : RandomFrames(6)) {
    const MappedFrame mapped = MapFrame(input.frame, input.Detections(), SmallSegments(), &session);
    const SegmentedFrame segmented = SegmentFrame(input.frame, input.Detections(), SmallSegments());
    const FrameAssociation association =
        Associate(segmented, {by_hand.voxels, by_hand.labels}, options.association);
    const MapDelta delta = IntegrateFrame(segmented, association, options.integration, &by_hand);
    EXPECT_EQ(DigestFrame(session.map(), mapped.association, mapped.delta),
              DigestFrame(by_hand, association, delta));
    EXPECT_EQ(mapped.delta.merged, delta.merged);
    EXPECT_EQ(mapped.delta.changed_blocks, delta.changed_blocks);
    matched += mapped.association.segments.size();
  }
  EXPECT_EQ(HashMap(session.map()), HashMap(by_hand));
  EXPECT_GT(matched, 6u);
  ASSERT_EQ(session.metadata().trajectory.size(), 6u);
  EXPECT_TRUE(session.Contains(CameraId{0}, 6000));
}

TEST(MapFrame, ASegmentedFrameGivesTheSameAsItsRgbdFrame) {
  MapSession whole(CoarseGrid(), {}), second_half(CoarseGrid(), {});
  for (const InputFrame& input : RandomFrames(3)) {
    MapFrame(input.frame, input.Detections(), SmallSegments(), &whole);
    MapFrame(SegmentFrame(input.frame, input.Detections(), SmallSegments()), &second_half);
  }
  EXPECT_EQ(HashMap(whole.map()), HashMap(second_half.map()));
}

TEST(MapFrame, MeasuresEachStageOnceWithTheClockThatIsPassedIn) {
  MapSession session(CoarseGrid(), {});
  double seconds = 0;
  std::vector<std::pair<std::string, double>> measured;
  const Stopwatch watch{[&] { return seconds += 0.5; },
                        [&](const char* stage, double ms) { measured.emplace_back(stage, ms); }};
  const InputFrame input = RandomFrames(1).front();
  MapFrame(input.frame, input.Detections(), SmallSegments(), &session, watch);
  EXPECT_EQ(measured, (std::vector<std::pair<std::string, double>>{
                          {"segmentation", 500}, {"association", 500}, {"integration", 500}}));
}

TEST(MapFrame, RefusesAFrameThatTheMapContains) {
  MapSession session(CoarseGrid(), {});
  const InputFrame input = RandomFrames(1).front();
  MapFrame(input.frame, input.Detections(), SmallSegments(), &session);
  const std::string before = HashMap(session.map());
  EXPECT_THROW(MapFrame(input.frame, input.Detections(), SmallSegments(), &session),
               std::logic_error);
  EXPECT_EQ(HashMap(session.map()), before);
}

TEST(MapSession, ACopyOfTheMapStaysAsItWasWhileAnotherThreadReadsItAndTheMapGrows) {
  MapSessionOptions options = CoarseGrid();
  options.integration.max_unpacked_blocks = 50;  // so that blocks are packed and unpacked
  MapSession alone(options, {}), copied(options, {});
  const std::vector<InputFrame> frames = RandomFrames(16);
  std::string before, from_thread;
  for (size_t i = 0; i < frames.size(); ++i) {
    MapFrame(frames[i].frame, frames[i].Detections(), SmallSegments(), &alone);
    const SemanticMap copy = copied.map();
    before = HashMap(copy);
    std::thread reader([&] { from_thread = HashMap(copy); });
    MapFrame(frames[i].frame, frames[i].Detections(), SmallSegments(), &copied);
    reader.join();
    EXPECT_EQ(from_thread, before);
    EXPECT_EQ(HashMap(copy), before) << "the frame changed the copy";
    ASSERT_EQ(HashMap(copied.map()), HashMap(alone.map())) << "the copy changed the map";
    ASSERT_NE(HashMap(copied.map()), before);
  }
  EXPECT_GT(MeasureMemory(copied.map().voxels).packed_blocks, 0u);
  EXPECT_EQ(BytesOf(copied.map()), BytesOf(alone.map()));
}

}  // namespace
}  // namespace vismap
