#include "foreign/frame_joiner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "foreign/camera_joiners.h"
#include "foreign/frame_message.h"
#include "foreign/presets.h"
#include "support/foreign_builder.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

using namespace foreign_test;  // NOLINT
using ::testing::HasSubstr;

constexpr int64_t kStart = 1'760'000'000'000'000;

AdapterCameraOptions DimosOptions() {
  AdapterCameraOptions options;
  options.preset = AdapterPreset::kDimos;
  return WithPreset(options);
}

/// A joiner, and the frames that came out of it.
struct Joined {
  explicit Joined(const AdapterCameraOptions& options)
      : joiner(*FrameJoiner::Create(
            options, [this](ForeignFrame&& frame) { frames.push_back(std::move(frame)); })) {}
  void Add(const std::string& channel, const Bytes& bytes, int64_t received) {
    const Result<void> added = joiner.Add(channel, bytes, received);
    EXPECT_TRUE(added) << added.error().message;
  }
  std::vector<ForeignFrame> frames;
  FrameJoiner joiner;
};

Bytes Mounts(int64_t utime) {
  return Tf({Transform(utime, "base_link", "optical", OpticalInBody())});
}
Bytes Body(int64_t utime) {
  return Tf({Transform(utime, "world", "base_link", BodyAt(utime - kStart))});
}

/// A second of a DimOS robot: images at 10 Hz, odometry at 50 Hz, mounts after the images.
void AddSecond(Joined* joined, int64_t depth_delay = 750) {
  joined->Add(kInfoChannel, CameraInfo(kStart), kStart);
  for (int tick = -1; tick <= 51; ++tick) {
    const int64_t now = kStart + tick * 20'000 + 6000;
    joined->Add(kTfChannel, Body(now), now);
    if (tick % 5 != 0 || tick < 0 || tick >= 50) continue;
    const int64_t utime = kStart + tick * 20'000 + 10'000;
    joined->Add(kColorChannel, ColorImage(utime), utime);
    joined->Add(kDepthChannel, DepthImage(utime + depth_delay), utime + depth_delay);
    joined->Add(kTfChannel, Mounts(utime + depth_delay), utime + depth_delay + 10);
  }
}

TEST(FrameJoiner, JoinsImagesIntrinsicsAndPosesOfDimos) {
  Joined joined(DimosOptions());
  AddSecond(&joined);
  joined.joiner.Finish();
  ASSERT_EQ(joined.frames.size(), 10u) << joined.joiner.dropped().Text();
  EXPECT_EQ(joined.joiner.dropped().total(), 0) << joined.joiner.dropped().Text();
  for (const ForeignFrame& frame : joined.frames) {
    const Pose expected = BodyAt(frame.utime - kStart) * OpticalInBody();
    EXPECT_LT((frame.T_W_C.translation() - expected.translation()).norm(), 1e-4);
    EXPECT_LT(Eigen::AngleAxisd(frame.T_W_C.rotation().transpose() * expected.rotation()).angle(),
              1e-4);
    EXPECT_TRUE(frame.depth_registered);
    EXPECT_EQ(frame.color_camera.fx, kSmallCamera.fx);
    EXPECT_EQ(frame.color_camera.distortion, ForeignCamera::Distortion::kNone);
    EXPECT_EQ(frame.depth.utime, frame.utime + 750);
  }
}

TEST(FrameJoiner, LosesNothingAfterAPauseOfALogWithoutAClock) {
  Joined joined(DimosOptions());
  joined.Add(kInfoChannel, CameraInfo(kStart), kStart);
  const std::vector<int64_t> times_ms = {0, 100, 200, 300, 3800, 3900, 9000, 9100, 11000, 12500};
  for (const int64_t time : times_ms) {
    const int64_t utime = kStart + time * 1000 + 100'000;
    // The image comes first after the pause, and a pose between the two images.
    joined.Add(kColorChannel, ColorImage(utime), utime);
    joined.Add(kTfChannel, Body(utime - 6000), utime + 200);
    joined.Add(kDepthChannel, DepthImage(utime + 750), utime + 750);
    joined.Add(kTfChannel, Body(utime + 6000), utime + 6000);
    joined.Add(kTfChannel, Mounts(utime + 750), utime + 6100);
  }
  joined.joiner.Finish();
  EXPECT_EQ(joined.frames.size(), times_ms.size()) << joined.joiner.dropped().Text();
  EXPECT_EQ(joined.joiner.dropped().total(), 0) << joined.joiner.dropped().Text();
}

TEST(FrameJoiner, PassesPixelsOnUnchanged) {
  Joined joined(DimosOptions());
  AddSecond(&joined);
  ASSERT_FALSE(joined.frames.empty());
  const rgbd_frame_t message = ToMessage(std::move(joined.frames.front()), joined.joiner.options());
  const Result<SensorFrame> frame = Decode(message);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->depth, SmallSensorFrame().depth);
  EXPECT_EQ(frame->color, SmallColorBytes());
  EXPECT_EQ(frame->color_encoding, ColorEncoding::kRgb);
}

TEST(FrameJoiner, HandsOutAFrameAsSoonAsTheLaterPoseIsThere) {
  Joined joined(DimosOptions());
  AddSecond(&joined);
  const size_t before = joined.frames.size();
  const int64_t utime = kStart + 1'100'000;
  joined.Add(kTfChannel, Body(utime - 4000), utime - 4000);
  joined.Add(kColorChannel, ColorImage(utime), utime);
  joined.Add(kDepthChannel, DepthImage(utime), utime);
  EXPECT_EQ(joined.frames.size(), before);
  joined.Add(kTfChannel, Body(utime + 5000), utime + 5000);
  EXPECT_EQ(joined.frames.size(), before + 1);
}

TEST(FrameJoiner, GivesAFrameUpWhenNoLaterPoseComes) {
  Joined joined(DimosOptions());
  AddSecond(&joined);
  const size_t before = joined.frames.size();
  const int64_t utime = kStart + 2'000'000;
  joined.Add(kColorChannel, ColorImage(utime), utime);
  joined.Add(kDepthChannel, DepthImage(utime), utime);
  joined.joiner.Advance(utime + 199'000);
  EXPECT_EQ(joined.joiner.waiting(), 1);
  joined.joiner.Advance(utime + 201'000);
  EXPECT_EQ(joined.joiner.waiting(), 0);
  EXPECT_EQ(joined.frames.size(), before);
  EXPECT_THAT(joined.joiner.dropped().Text(), HasSubstr("from 'world' to 'base_link'"));
}

TEST(FrameJoiner, AReceiverThatWasStoppedGivesNothingUpThatHasCome) {
  Joined joined(DimosOptions());
  AddSecond(&joined);
  const size_t before = joined.frames.size();
  const int64_t utime = kStart + 1'040'000, later = utime + 900'000;
  joined.joiner.Advance(utime);
  joined.Add(kColorChannel, ColorImage(utime), utime);
  joined.Add(kDepthChannel, DepthImage(utime), utime);
  for (int i = 0; i < 3; ++i) joined.Add(kInfoChannel, CameraInfo(utime), later + i * 60'000);
  joined.Add(kTfChannel, Body(utime + 5000), later + 200'000);
  EXPECT_EQ(joined.frames.size(), before + 1) << joined.joiner.dropped().Text();
  joined.Add(kColorChannel, ColorImage(utime + 500'000), later + 200'000);
  joined.Add(kDepthChannel, DepthImage(utime + 500'000), later + 200'000);
  EXPECT_EQ(joined.joiner.dropped().total(), 0);
  joined.joiner.Advance(later + 401'000);
  EXPECT_EQ(joined.joiner.dropped().total(), 1);
}

TEST(FrameJoiner, CountsDepthWithoutColorAndColorWithoutDepth) {
  Joined joined(DimosOptions());
  AddSecond(&joined);
  const int64_t utime = kStart + 1'010'000;
  joined.Add(kDepthChannel, DepthImage(utime), utime);
  joined.Add(kColorChannel, ColorImage(utime + 50'000), utime + 50'000);
  joined.joiner.Advance(utime + 2'000'000);
  EXPECT_EQ(joined.joiner.dropped().total(), 2);
  EXPECT_THAT(joined.joiner.dropped().Text(), HasSubstr("no colour image within 20 ms"));
  EXPECT_THAT(joined.joiner.dropped().Text(), HasSubstr("no depth image within 20 ms"));
}

/// A message whose own time and time of receipt can be changed.
struct TimedMessage {
  std::string channel;
  std::function<Bytes(int64_t utime)> make;
  int64_t utime = 0, received = 0;
};

/// Half a second of a DimOS robot, images at 10 Hz, poses at 50 Hz.
std::vector<TimedMessage> HalfASecond(bool depth_first) {
  std::vector<TimedMessage> messages;
  const auto add = [&](const char* channel, int64_t utime, const auto& make) {
    messages.push_back({channel, make, utime, utime});
  };
  add(kInfoChannel, kStart - 20'000, CameraInfo);
  for (int tick = -1; tick <= 26; ++tick) {
    const int64_t now = kStart + tick * 20'000 + 6000;
    add(kTfChannel, now, [now](int64_t utime) {
      return Tf({Transform(utime, "world", "base_link", BodyAt(now - kStart))});
    });
    if (tick % 5 != 0 || tick < 0 || tick >= 25) continue;
    const auto depth_of = [](int64_t utime) { return DepthImage(utime); };
    if (depth_first) add(kDepthChannel, now + 3000, depth_of);
    add(kColorChannel, now + 4000, ColorImage);
    if (!depth_first) add(kDepthChannel, now + 4700, depth_of);
    add(kTfChannel, now + 4800, Mounts);
  }
  return messages;
}

/// The frames that the messages give, by their times; checks their poses.
std::map<int64_t, Pose> FramesOf(const std::vector<TimedMessage>& messages, ReasonCounts* ignored) {
  Joined joined(DimosOptions());
  for (const TimedMessage& message : messages)
    joined.Add(message.channel, message.make(message.utime), message.received);
  joined.joiner.Finish();
  std::map<int64_t, Pose> poses;
  for (const ForeignFrame& frame : joined.frames) {
    const Pose truth = BodyAt(frame.utime - kStart) * OpticalInBody();
    EXPECT_LT((frame.T_W_C.translation() - truth.translation()).norm(), 1e-3);
    poses[frame.utime] = frame.T_W_C;
  }
  *ignored = joined.joiner.ignored();
  return poses;
}

constexpr int64_t kHour = 3'600'000'000;
constexpr int64_t kWrongBy[] = {kHour, -kHour, 100'000 * kHour, 5'000'000, -5'000'000};

TEST(FrameJoiner, AMessageWithAWrongTimeOfReceiptCostsNothing) {
  for (const bool depth_first : {false, true}) {
    const std::vector<TimedMessage> messages = HalfASecond(depth_first);
    ReasonCounts ignored;
    const auto expected = FramesOf(messages, &ignored);
    ASSERT_EQ(expected.size(), 5u);
    EXPECT_EQ(ignored.total(), 0) << ignored.Text();
    for (size_t i = 0; i < messages.size(); ++i) {
      for (const int64_t wrong : kWrongBy) {
        std::vector<TimedMessage> changed = messages;
        changed[i].received += wrong;
        const auto frames = FramesOf(changed, &ignored);
        ASSERT_EQ(frames.size(), expected.size())
            << messages[i].channel << " " << i << " " << wrong;
        for (const auto& [utime, pose] : expected)
          EXPECT_EQ(pose.matrix(), frames.at(utime).matrix());
        if (i > 0 && i + 1 < messages.size()) {
          EXPECT_THAT(ignored.Text(), HasSubstr("1 x the log has a message at a time that is far"));
        }
      }
    }
  }
}

TEST(FrameJoiner, AMessageWithAWrongTimeCostsNoOtherFrame) {
  for (const bool depth_first : {false, true}) {
    const std::vector<TimedMessage> messages = HalfASecond(depth_first);
    ReasonCounts ignored;
    const auto expected = FramesOf(messages, &ignored);
    for (size_t i = 0; i < messages.size(); ++i) {
      for (const int64_t wrong : kWrongBy) {
        std::vector<TimedMessage> changed = messages;
        changed[i].utime += wrong;
        const auto frames = FramesOf(changed, &ignored);
        const bool is_image =
            messages[i].channel == kColorChannel || messages[i].channel == kDepthChannel;
        for (const auto& [utime, pose] : expected) {
          const bool own = is_image && std::abs(utime - messages[i].utime) < 5000;
          EXPECT_TRUE(own || frames.contains(utime))
              << messages[i].channel << " " << i << " " << wrong << ", frame " << utime - kStart;
        }
      }
    }
  }
}

TEST(FrameJoiner, FollowsARobotWhoseClockIsSetBack) {
  Joined joined(DimosOptions());
  AddSecond(&joined);
  const size_t before = joined.frames.size();
  const int64_t later = kStart + 60'000'000;  // a simulation starts again, at time 0
  joined.joiner.Advance(later);
  for (int tick = 0; tick < 30; ++tick) {
    const int64_t utime = tick * 20'000, now = later + utime;
    joined.Add(kTfChannel,
               Tf({Transform(utime, "world", "base_link", BodyAt(utime)),
                   Transform(utime, "base_link", "optical", OpticalInBody())}),
               now);
    if (tick % 5 != 3) continue;
    joined.Add(kColorChannel, ColorImage(utime + 5000), now + 5000);
    joined.Add(kDepthChannel, DepthImage(utime + 5000), now + 5000);
  }
  EXPECT_EQ(joined.frames.size(), before + 6) << joined.joiner.dropped().Text();
}

// A SLAM sends the poses of its last 1.5 seconds again, in one message, while images wait.
TEST(FrameJoiner, LosesNoFrameWhenPosesAreSentAgain) {
  Joined joined(DimosOptions());
  joined.Add(kInfoChannel, CameraInfo(kStart), kStart);
  for (int tick = 0; tick <= 151; ++tick) {
    const int64_t now = kStart + tick * 20'000;
    joined.Add(kTfChannel, Body(now), now);
    joined.Add(kTfChannel, Mounts(now), now);
    if (tick % 5 == 2) {
      joined.Add(kColorChannel, ColorImage(now + 9000), now + 9000);
      joined.Add(kDepthChannel, DepthImage(now + 9000), now + 9500);
    }
    if (tick % 50 != 47) continue;
    std::vector<foreign::geometry_msgs::TransformStamped> again;
    for (int64_t time = std::max(kStart, now - 1'500'000); time <= now; time += 20'000)
      again.push_back(Transform(time, "world", "base_link", BodyAt(time - kStart)));
    joined.Add(kTfChannel, Tf(again), now + 12'000);
  }
  joined.joiner.Finish();
  EXPECT_EQ(joined.frames.size(), 30u) << joined.joiner.dropped().Text();
  for (const ForeignFrame& frame : joined.frames)
    EXPECT_TRUE(frame.T_W_C.isApprox(BodyAt(frame.utime - kStart) * OpticalInBody(), 1e-4));
}

TEST(FrameJoiner, IgnoresOnlyThePoseThatCannotBeUsed) {
  foreign::geometry_msgs::TransformStamped bad = Transform(kStart, "base_link", "arm", BodyAt(0));
  bad.transform.rotation.w = 3;
  Joined joined(DimosOptions());
  joined.Add(kInfoChannel, CameraInfo(kStart), kStart);
  for (int i = 0; i < 2; ++i) {
    const int64_t utime = kStart + i * 20'000;
    joined.Add(kTfChannel, Tf({bad, Transform(utime, "world", "optical", BodyAt(0))}), utime);
  }
  joined.Add(kColorChannel, ColorImage(kStart + 10'000), kStart + 21'000);
  joined.Add(kDepthChannel, DepthImage(kStart + 10'000), kStart + 21'000);
  EXPECT_EQ(joined.frames.size(), 1u) << joined.joiner.dropped().Text();
  EXPECT_EQ(joined.joiner.dropped().total(), 0);
  EXPECT_EQ(joined.joiner.ignored().total(), 2);
  EXPECT_THAT(
      joined.joiner.ignored().Text(),
      HasSubstr("2 x /tf#tf2_msgs.TFMessage: TFMessage, the pose of 'arm' in 'base_link': a "
                "pose is not finite, or its quaternion"));
}

AdapterCameraOptions DrakeOptions() {
  AdapterCameraOptions options;
  options.preset = AdapterPreset::kDrake;
  options.intrinsics = {52, 52, 31.5, 23.5};
  options.camera_frame = "camera";
  return WithPreset(options);
}

TEST(FrameJoiner, TakesTheFirstChannelOfDrakeWhoseImagesCanBeUsed) {
  foreign::drake::lcmt_image_array array{};
  ASSERT_GT(array.decode(DrakeImages(0).data(), 0, 1 << 20), 0);
  const auto only = [&](std::vector<foreign::drake::lcmt_image> images) {
    foreign::drake::lcmt_image_array part = array;
    part.images = std::move(images);
    part.num_images = static_cast<int32_t>(part.images.size());
    return Pack(part);
  };
  foreign::drake::lcmt_image damaged = array.images[0];
  damaged.data[damaged.data.size() / 2] ^= 0xff;
  foreign::drake::lcmt_image unknown = array.images[0];
  unknown.channel_type = 9;
  const std::vector<Bytes> useless = {only({array.images[1]}), only({array.images[0]}),
                                      only({damaged, array.images[1]}),
                                      only({unknown, array.images[1]}), only({})};
  for (const bool keep_pixels : {true, false}) {
    size_t frames = 0;
    Result<FrameJoiner> joiner = FrameJoiner::Create(
        DrakeOptions(), [&](ForeignFrame&&) { ++frames; }, keep_pixels);
    for (int tick = 0; tick < 20; ++tick) {
      const int64_t utime = tick * 20'000;
      EXPECT_TRUE(joiner->Add("DRAKE_VIEWER_DRAW", DrakeDraw(utime, "camera", BodyAt(0)), utime));
      for (size_t i = 0; i < useless.size(); ++i)
        (void)joiner->Add("DRAKE_RGBD_CAMERA_IMAGES_" + std::to_string(i), useless[i], utime);
      EXPECT_TRUE(joiner->Add("DRAKE_RGBD_CAMERA_IMAGES_good", DrakeImages(utime), utime));
    }
    joiner->Finish();
    EXPECT_EQ(frames, 20u) << joiner->dropped().Text();
    EXPECT_EQ(joiner->options().depth_channel, "DRAKE_RGBD_CAMERA_IMAGES_good");
    EXPECT_EQ(joiner->options().color_channel, "DRAKE_RGBD_CAMERA_IMAGES_good");
    const std::string told = joiner->dropped().Text();
    EXPECT_THAT(told, HasSubstr("has no depth image"));
    EXPECT_THAT(told, HasSubstr("has no colour image"));
    EXPECT_THAT(told, HasSubstr("an image cannot be decoded"));
  }
}

TEST(FrameJoiner, BoundsImagesWithoutPixels) {
  AdapterCameraOptions options = DimosOptions();
  options.queue_mb = 1;
  Result<FrameJoiner> joiner = FrameJoiner::Create(
      options, [](ForeignFrame&&) {}, false);
  for (int i = 0; i < 10'000; ++i)
    EXPECT_TRUE(joiner->Add(kDepthChannel, DepthImage(kStart + i), kStart));
  EXPECT_LT(joiner->waiting(), (1 << 20) / 128);
  EXPECT_THAT(joiner->dropped().Text(), HasSubstr("adapter.queue_mb"));
}

TEST(FrameJoiner, SaysThatIntrinsicsAreMissing) {
  Joined joined(DimosOptions());
  joined.Add(kColorChannel, ColorImage(kStart), kStart);
  joined.Add(kDepthChannel, DepthImage(kStart), kStart);
  joined.Add(kColorChannel, ColorImage(kStart + 100'000), kStart + 100'000);
  joined.joiner.Advance(kStart + 1'400'000);
  EXPECT_EQ(joined.joiner.waiting(), 1) << "they may come a second late";
  joined.joiner.Advance(kStart + 1'600'001);
  EXPECT_EQ(joined.joiner.waiting(), 0);
  EXPECT_THAT(joined.joiner.dropped().Text(), HasSubstr("no intrinsics came on /camera_info"));
}

TEST(FrameJoiner, RejectsIntrinsicsOfAnotherSize) {
  AdapterCameraOptions options = DimosOptions();
  Joined joined(options);
  foreign::sensor_msgs::CameraInfo info{};
  ASSERT_GT(info.decode(CameraInfo(kStart).data(), 0, 4096), 0);
  info.width = 1280;
  joined.Add(kInfoChannel, Pack(info), kStart);
  joined.Add(kColorChannel, ColorImage(kStart), kStart);
  joined.Add(kDepthChannel, DepthImage(kStart), kStart);
  joined.joiner.Finish();
  EXPECT_THAT(joined.joiner.dropped().Text(), HasSubstr("for images of 1280x48"));
}

TEST(FrameJoiner, BoundsTheBytesOfWhatWaits) {
  AdapterCameraOptions options = DimosOptions();
  options.queue_mb = 1;
  options.wait_ms = 60'000;
  options.intrinsics_wait_ms = 60'000;
  Joined joined(options);
  for (int i = 0; i < 200; ++i) {
    const int64_t utime = kStart + i * 1000;
    joined.Add(kColorChannel, ColorImage(utime), utime);
    joined.Add(kDepthChannel, DepthImage(utime), utime);
  }
  const auto pair = static_cast<int64_t>(SmallColorBytes().size() + SmallDepthBytes().size());
  EXPECT_LE(joined.joiner.waiting(), (1 << 20) / pair);
  EXPECT_GT(joined.joiner.waiting(), (1 << 20) / pair - 3);
  EXPECT_THAT(joined.joiner.dropped().Text(), HasSubstr("adapter.queue_mb"));
}

TEST(FrameJoiner, TakesTheTimeOfReceiptWhenTold) {
  AdapterCameraOptions options = DimosOptions();
  options.time = ImageTime::kReceived;
  Joined joined(options);
  AddSecond(&joined);
  const size_t before = joined.frames.size();
  for (int i = 0; i < 2; ++i) {
    const int64_t now = kStart + 1'060'000 + 40'000 * i;
    joined.Add(kTfChannel, Body(now - 5000), now - 5000);
    joined.Add(kColorChannel, ColorImage(0), now);
    joined.Add(kDepthChannel, DepthImage(0), now + 10);
    joined.Add(kTfChannel, Body(now + 5000), now + 5000);
  }
  ASSERT_EQ(joined.frames.size(), before + 2);
  EXPECT_EQ(joined.frames.back().utime, kStart + 1'100'000);
}

// Images without times. After a second the computer sets its clock, and then sets it back.
TEST(FrameJoiner, TimesOfReceiptFollowAWallClockThatIsSet) {
  AdapterCameraOptions options = DimosOptions();
  options.time = ImageTime::kReceived;
  Joined joined(options);
  joined.Add(kInfoChannel, CameraInfo(kStart), kStart);
  const auto offset_at = [](int tick) -> int64_t {
    return tick >= 50 && tick < 100 ? 3'600'000'000 : 0;
  };
  for (int tick = 0; tick <= 151; ++tick) {
    const int64_t now = kStart + tick * 20'000;
    joined.joiner.SetWallOffset(offset_at(tick));
    joined.Add(kTfChannel,
               Tf({Transform(now + offset_at(tick), "world", "base_link", BodyAt(now - kStart))}),
               now);
    joined.Add(kTfChannel, Mounts(now + offset_at(tick)), now);
    if (tick % 5 != 2) continue;
    joined.Add(kColorChannel, ColorImage(0), now + 9000);
    joined.Add(kDepthChannel, DepthImage(0), now + 9500);
  }
  joined.joiner.Finish();
  EXPECT_EQ(joined.frames.size(), 30u) << joined.joiner.dropped().Text();
  for (size_t i = 0; i < joined.frames.size(); ++i) {
    const int tick = static_cast<int>(5 * i + 2);
    const int64_t since = tick * 20'000 + 9000;
    EXPECT_EQ(joined.frames[i].utime, kStart + since + offset_at(tick));
    EXPECT_TRUE(joined.frames[i].T_W_C.isApprox(BodyAt(since) * OpticalInBody(), 1e-4)) << tick;
  }
}

TEST(FrameJoiner, DropsImagesOfOneTimeAndSaysWhatToDo) {
  Joined joined(DimosOptions());
  AddSecond(&joined);
  const int64_t utime = joined.frames.back().utime;
  joined.Add(kColorChannel, ColorImage(utime), utime + 100'000);
  joined.Add(kDepthChannel, DepthImage(utime), utime + 100'000);
  EXPECT_THAT(joined.joiner.dropped().Text(), HasSubstr("set adapter.time to RECEIVED"));
}

TEST(FrameJoiner, SaysWhatToDoWhenAllImagesHaveTheTimeZero) {
  Joined joined(DimosOptions());
  for (int i = 0; i < 3; ++i) {
    joined.Add(kColorChannel, ColorImage(0), kStart + i * 100'000);
    joined.Add(kDepthChannel, DepthImage(0), kStart + i * 100'000);
  }
  joined.joiner.Finish();
  EXPECT_TRUE(joined.frames.empty());
  EXPECT_THAT(joined.joiner.dropped().Text(), HasSubstr("set adapter.time to RECEIVED"));
}

TEST(FrameJoiner, ReportsMessagesThatCannotBeUsed) {
  Joined joined(DimosOptions());
  Bytes damaged = ColorImage(kStart);
  damaged.resize(damaged.size() / 2);
  EXPECT_FALSE(joined.joiner.Add(kColorChannel, damaged, kStart));
  EXPECT_FALSE(joined.joiner.Add(kDepthChannel, {}, kStart));
  EXPECT_FALSE(joined.joiner.Add(kDepthChannel, ColorImage(kStart), kStart));
  EXPECT_TRUE(joined.joiner.Add("/other#sensor_msgs.Image", damaged, kStart));
  EXPECT_EQ(joined.joiner.dropped().total(), 3);
}

TEST(FrameJoiner, SetsTheDepthCameraBesideTheColorCamera) {
  AdapterCameraOptions options = DimosOptions();
  Joined joined(options);
  AddSecond(&joined);
  const size_t before = joined.frames.size();
  joined.Add(options.depth_intrinsics_channel, CameraInfo(kStart), kStart + 1'020'000);
  Pose T_body_depth = OpticalInBody();
  T_body_depth.translation().y() += 0.05;
  for (int i = 0; i < 2; ++i) {
    joined.Add(kTfChannel, Tf({Transform(kStart + i, "base_link", "depth_optical", T_body_depth)}),
               kStart + 1'021'000);
  }
  const int64_t utime = kStart + 1'020'000;
  joined.Add(kColorChannel, ColorImage(utime), utime);
  joined.Add(kDepthChannel, DepthImage(utime, "depth_optical"), utime);
  joined.Add(kTfChannel, Body(utime + 5000), utime + 5000);
  ASSERT_EQ(joined.frames.size(), before + 1) << joined.joiner.dropped().Text();
  const ForeignFrame& frame = joined.frames.back();
  EXPECT_FALSE(frame.depth_registered);
  EXPECT_TRUE(frame.T_color_depth.isApprox(OpticalInBody().inverse() * T_body_depth, 1e-9));
}

TEST(FrameJoiner, ReadsDrakeFromTimeZero) {
  AdapterCameraOptions options;
  options.preset = AdapterPreset::kDrake;
  options.intrinsics = {52, 52, 31.5, 23.5};
  options.camera_frame = "camera::optical";
  Joined joined(WithPreset(options));
  for (int tick = 0; tick < 64; ++tick) {
    const int64_t utime = tick * 15'625;
    joined.Add("DRAKE_VIEWER_DRAW",
               DrakeDraw(utime, "camera::optical", BodyAt(utime) * OpticalInBody()), utime);
    if (tick % 6 == 0) joined.Add("DRAKE_RGBD_CAMERA_IMAGES_a", DrakeImages(utime), utime);
    if (tick % 6 == 0) joined.Add("DRAKE_RGBD_CAMERA_IMAGES_b", DrakeImages(utime), utime);
  }
  joined.joiner.Finish();
  ASSERT_GE(joined.frames.size(), 10u) << joined.joiner.dropped().Text();
  EXPECT_EQ(joined.frames[0].utime, 0);
  EXPECT_EQ(joined.joiner.options().depth_channel, "DRAKE_RGBD_CAMERA_IMAGES_a");
  EXPECT_EQ(joined.frames[1].color->format, PixelFormat::kRgba);
  EXPECT_EQ(joined.frames[1].depth.format, PixelFormat::kDepth16Zlib);
  for (const ForeignFrame& frame : joined.frames) {
    const Pose expected = BodyAt(frame.utime) * OpticalInBody();
    EXPECT_LT((frame.T_W_C.translation() - expected.translation()).norm(), 1e-3);
  }
  const Result<SensorFrame> decoded =
      Decode(ToMessage(std::move(joined.frames[1]), joined.joiner.options()));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->depth, SmallSensorFrame().depth);
}

TEST(FrameJoiner, TellsLinksOfTwoRobotsApart) {
  const auto joined_with = [](const std::string& camera_frame) {
    AdapterCameraOptions options;
    options.preset = AdapterPreset::kDrake;
    options.intrinsics = {52, 52, 31.5, 23.5};
    options.camera_frame = camera_frame;
    auto joined = std::make_unique<Joined>(WithPreset(options));
    for (int tick = 0; tick < 64; ++tick) {
      const int64_t utime = tick * 15'625;
      const Pose pose = BodyAt(utime) * OpticalInBody();
      Pose other = pose;
      other.translation().z() += 5;
      joined->Add("DRAKE_VIEWER_DRAW", DrakeDraw(utime, "camera::optical", pose), utime);
      joined->Add("DRAKE_VIEWER_DRAW", DrakeDraw(utime, "camera::optical", other, 4), utime);
      if (tick % 6 == 0) joined->Add("DRAKE_RGBD_CAMERA_IMAGES_a", DrakeImages(utime), utime);
    }
    joined->joiner.Finish();
    return joined;
  };
  for (const int robot : {3, 4}) {
    const auto joined = joined_with(FrameOfRobot("camera::optical", robot));
    ASSERT_GE(joined->frames.size(), 10u) << joined->joiner.dropped().Text();
    for (const ForeignFrame& frame : joined->frames) {
      const double height = frame.T_W_C.translation().z();
      EXPECT_NEAR(height, 0.4 + 0.3 + (robot == 4 ? 5 : 0), 1e-3) << robot;
    }
  }
  const auto ambiguous = joined_with("camera::optical");
  EXPECT_LE(ambiguous->frames.size(), 1u) << "until the other robot is heard of";
  EXPECT_THAT(ambiguous->joiner.dropped().Text(),
              HasSubstr("several robots have a frame 'camera::optical'; call it "
                        "camera::optical@3 or camera::optical@4"));
}

TEST(FrameJoiner, ReadsBotCoreThroughTransformAndThroughBodyWithAMount) {
  for (const bool through_body : {false, true}) {
    AdapterCameraOptions options;
    options.preset = AdapterPreset::kBotcore;
    options.intrinsics = {52, 52, 31.5, 23.5};
    if (through_body) {
      options.pose_channels = {"POSE_BODY"};
      options.mounts = {"body OPENNI_FRAME_LEFT 0.2 0.02 0.3 0.5 -0.5 0.5 -0.5"};
    }
    Joined joined(WithPreset(options));
    for (int tick = 0; tick < 100; ++tick) {
      const int64_t utime = kStart + tick * 10'000;
      const Pose body = BodyAt(utime - kStart);
      joined.Add("POSE_BODY", BotPose(utime, body), utime);
      joined.Add("OPENNI_FRAME_LEFT_TO_LOCAL", BotTransform(utime, body * OpticalInBody()), utime);
      if (tick % 10 == 5) joined.Add("OPENNI_FRAME", BotImages(utime + 3000, utime + 4000), utime);
    }
    joined.joiner.Finish();
    ASSERT_EQ(joined.frames.size(), 10u) << joined.joiner.dropped().Text();
    for (const ForeignFrame& frame : joined.frames) {
      const Pose expected = BodyAt(frame.utime - kStart) * OpticalInBody();
      EXPECT_TRUE(frame.T_W_C.isApprox(expected, 1e-4)) << through_body;
    }
  }
}

// bot-frames: camera in head, head in body, body in local; the head turns.
TEST(FrameJoiner, FollowsAChainOfTransformsOfBotFrames) {
  AdapterCameraOptions options;
  options.preset = AdapterPreset::kBotcore;
  options.intrinsics = {52, 52, 31.5, 23.5};
  options.pose_channels = {"POSE_BODY", "HEAD_TO_BODY", "OPENNI_FRAME_LEFT_TO_HEAD"};
  const auto head_at = [](int64_t since_start) { return BodyAt(2 * since_start); };
  Joined joined(WithPreset(options));
  for (int tick = 0; tick < 100; ++tick) {
    const int64_t utime = kStart + tick * 10'000;
    joined.Add("POSE_BODY", BotPose(utime, BodyAt(utime - kStart)), utime);
    joined.Add("HEAD_TO_BODY", BotTransform(utime, head_at(utime - kStart)), utime);
    joined.Add("OPENNI_FRAME_LEFT_TO_HEAD", BotTransform(utime, OpticalInBody()), utime);
    if (tick % 10 == 5) joined.Add("OPENNI_FRAME", BotImages(utime + 3000, utime + 4000), utime);
  }
  joined.joiner.Finish();
  ASSERT_EQ(joined.frames.size(), 10u) << joined.joiner.dropped().Text();
  for (const ForeignFrame& frame : joined.frames) {
    const int64_t time = frame.utime - kStart;
    EXPECT_TRUE(frame.T_W_C.isApprox(BodyAt(time) * head_at(time) * OpticalInBody(), 1e-4));
  }
}

TEST(FrameJoiner, ClearsValuesThatMeanNothing) {
  const uint16_t some = SmallSensorFrame().depth(20, 30);
  Image<uint16_t> expected = SmallSensorFrame().depth;
  std::replace(expected.data(), expected.data() + expected.size(), some, uint16_t{0});
  ASSERT_NE(expected, SmallSensorFrame().depth);
  AdapterCameraOptions options = DimosOptions();
  options.none_values = {0, 65535, static_cast<double>(some), 1.5, 1e6};
  const auto cleared = [&](PixelFormat format, const Bytes& bytes) {
    ForeignImage image{0, "", kSmallCamera.width, kSmallCamera.height, format, bytes};
    Result<ForeignImage> corrected = Corrected(std::move(image), false, options);
    EXPECT_TRUE(corrected) << corrected.error().message;
    EXPECT_EQ(corrected->format, PixelFormat::kDepth16);
    return corrected->bytes;
  };
  Bytes bytes(expected.size() * 2);
  std::memcpy(bytes.data(), expected.data(), bytes.size());
  EXPECT_EQ(cleared(PixelFormat::kDepth16, SmallDepthBytes()), bytes);
  EXPECT_EQ(cleared(PixelFormat::kDepth16Zlib, Zipped(SmallDepthBytes())), bytes);

  const std::vector<float> metres = {0.5F, 1.5F, 2, -1};
  Bytes floats(16);
  std::memcpy(floats.data(), metres.data(), 16);
  const Result<ForeignImage> corrected =
      Corrected({0, "", 2, 2, PixelFormat::kDepthFloat, floats}, false, options);
  ASSERT_TRUE(corrected);
  std::vector<float> found(4);
  std::memcpy(found.data(), corrected->bytes.data(), 16);
  EXPECT_EQ(found[0], 0.5F);
  EXPECT_TRUE(std::isnan(found[1]));
  EXPECT_EQ(found[2], 2);

  options.none_values = {0, 65535};  // what all readers know
  EXPECT_EQ(Corrected({0, "", 2, 2, PixelFormat::kDepth16Zlib, {1, 2}}, false, options)->bytes,
            Bytes({1, 2}));
  options.none_values = {3};
  const auto damaged = Corrected({0, "", 2, 2, PixelFormat::kDepth16Zlib, {1, 2}}, false, options);
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().message, HasSubstr("a depth image cannot be decoded"));
}

TEST(FrameJoiner, SwapsRedAndBlueWhenTold) {
  AdapterCameraOptions options = DimosOptions();
  options.swap_red_blue = true;
  Joined joined(options);
  AddSecond(&joined);
  ASSERT_FALSE(joined.frames.empty());
  EXPECT_EQ(joined.frames[0].color->format, PixelFormat::kBgr);
}

TEST(FrameJoiner, NamesTheKeyThatIsMissing) {
  const auto error = [](AdapterCameraOptions options) {
    const Result<FrameJoiner> joiner =
        FrameJoiner::Create(WithPreset(options), [](ForeignFrame&&) {});
    return joiner ? "" : joiner.error().message;
  };
  AdapterCameraOptions options;
  EXPECT_THAT(error(options), HasSubstr("adapter.depth_channel"));
  options.preset = AdapterPreset::kBotcore;
  EXPECT_THAT(error(options), HasSubstr("adapter.intrinsics is not set"));
  options.preset = AdapterPreset::kDrake;
  options.intrinsics = {1, 1, 1, 1};
  EXPECT_THAT(error(options), HasSubstr("adapter.camera_frame"));
  options.camera_frame = "link";
  EXPECT_EQ(error(options), "");
  options.mounts = {"a b 1 2 3"};
  EXPECT_THAT(error(options), HasSubstr("adapter.mounts"));
}

std::vector<AdapterCameraOptions> TwoCameras() {
  AdapterCameraOptions left = DimosOptions(), right = DimosOptions();
  right.camera_id = 1;
  right.color_channel = "/right/color_image#sensor_msgs.Image";
  right.depth_channel = "/right/depth_image#sensor_msgs.Image";
  return {left, right};
}

TEST(CameraJoiners, JoinEachCameraAndTellOfEach) {
  std::vector<AdapterCameraOptions> cameras = TwoCameras();
  cameras[1].intrinsics_channel = "/right/camera_info#sensor_msgs.CameraInfo";
  std::vector<size_t> frames;
  Result<CameraJoiners> joiners = CameraJoiners::Create(
      cameras, [&](size_t camera, ForeignFrame&&) { frames.push_back(camera); });
  ASSERT_TRUE(joiners) << joiners.error().message;
  const auto add = [&](const std::string& channel, const Bytes& bytes, int64_t received) {
    const Result<void> added = joiners->Add(channel, bytes, received);
    EXPECT_TRUE(added) << added.error().message;
  };
  add(kInfoChannel, CameraInfo(kStart), kStart);
  for (int tick = 0; tick < 4; ++tick) {
    const int64_t utime = kStart + tick * 100'000;
    add(kTfChannel, Body(utime - 4000), utime - 4000);
    add(kTfChannel, Mounts(utime - 3000), utime - 3000);
    for (const AdapterCameraOptions& camera : cameras) {
      add(camera.color_channel, ColorImage(utime), utime);
      add(camera.depth_channel, DepthImage(utime), utime + 1);
    }
    add(kTfChannel, Body(utime + 4000), utime + 4000);
  }
  EXPECT_THAT(frames, ::testing::Each(0u)) << "the other one has no intrinsics, and does not delay";
  EXPECT_GE(frames.size(), 3u);
  joiners->Finish();
  EXPECT_EQ(joiners->frames(), static_cast<int64_t>(frames.size()));
  EXPECT_THAT(joiners->DroppedText(), HasSubstr("camera 1: 4 x no intrinsics came on /right/"));
}

TEST(CameraJoiners, RejectCamerasThatDoNotFitTogether) {
  const auto error = [](const std::vector<AdapterCameraOptions>& cameras) {
    const auto joiners = CameraJoiners::Create(cameras, [](size_t, ForeignFrame&&) {});
    return joiners ? std::string() : joiners.error().message;
  };
  std::vector<AdapterCameraOptions> cameras = TwoCameras();
  EXPECT_EQ(error(cameras), "");
  cameras[1].root = "map";
  EXPECT_THAT(error(cameras),
              HasSubstr("adapter.root is 'world' of camera 0 and 'map' of camera 1"));
  cameras = TwoCameras();
  cameras[1].depth_channel = cameras[0].depth_channel;
  EXPECT_THAT(error(cameras), HasSubstr("adapter.depth_channel"));
  cameras = TwoCameras();
  cameras[1].depth_channel.clear();
  EXPECT_THAT(error(cameras), HasSubstr("camera 1: adapter.depth_channel is not set"));
}

}  // namespace
}  // namespace vismap
