#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/reason_counts.h"
#include "base/result.h"
#include "foreign/foreign_messages.h"
#include "foreign/frame_tree.h"
#include "foreign/time_gate.h"

namespace vismap {

/// A depth image, its colour image, and what is known about them.
struct ForeignFrame {
  int64_t utime = 0;  ///< of the colour image, of depth when there is no colour [us]
  std::optional<ForeignImage> color;
  ForeignImage depth;
  ForeignCamera color_camera;  ///< set when there is colour
  ForeignCamera depth_camera;  ///< as color_camera when depth is registered
  bool depth_registered = true;
  Pose T_color_depth = Pose::Identity();
  Pose T_W_C = Pose::Identity();  ///< of the colour camera, or of the depth camera without colour
  int64_t received = 0;           ///< when the last image of it came [us]
};

/// The image with the pixels that the options want: red and blue exchanged, values of depth that
/// mean nothing cleared. Fails on an image that cannot be decoded for that.
Result<ForeignImage> Corrected(ForeignImage image, bool is_color,
                               const AdapterCameraOptions& options);

/// Joins the messages of other robots' programs to RGB-D frames of one camera with poses: finds the
/// colour image of each depth image, the intrinsics, and the pose at the time of the image. Knows
/// no bus and no clock, so that a running adapter and a log give the same frames. Frames come in
/// the order of their depth images. What waits is bounded in time and bytes. A wrong time costs no
/// other frame, be it that of an image, of a pose, or that at which a log received a message, see
/// TimeGate. A channel that a * stands for is the only one as soon as an image that can be used
/// came on it.
class FrameJoiner {
 public:
  using Sink = std::function<void(ForeignFrame&&)>;

  /// For options with their preset. Fails as CheckComplete does. With `keep_pixels` false, frames
  /// have images without bytes, to scan a log. `sink` gets each frame.
  static Result<FrameJoiner> Create(const AdapterCameraOptions& options, Sink sink,
                                    bool keep_pixels = true);

  /// Takes a message that was received at `received` [us]. `number` is kept in its images. Messages
  /// of other channels are ignored. Fails on a message that cannot be used, which is counted, too.
  Result<void> Add(const std::string& channel, std::span<const uint8_t> bytes, int64_t received,
                   int64_t number = -1);

  /// Gives up what has waited for too long at `now` [us], on the clock of `received`. This time is
  /// relied on. Once it was called, Add gives nothing up by itself: call it when no more messages
  /// have arrived, so that a receiver that was stopped for a while does not give up what has come.
  void Advance(int64_t now);
  /// The end: nothing more will come.
  void Finish();
  /// What must be added to `received` to have the time of the wall clock, which may be set while a
  /// robot runs [us]. Only images that count as taken when they are received have it.
  void SetWallOffset(int64_t offset) { wall_offset_ = offset; }

  int64_t frames() const { return frames_; }
  int64_t waiting() const { return static_cast<int64_t>(depths_.size() + pairs_.size()); }
  /// Images that became no frame, and messages that could not be used, by the reason.
  const ReasonCounts& dropped() const { return dropped_; }
  /// Poses and times that were not used, and parts of messages whose other parts were, by the
  /// reason.
  const ReasonCounts& ignored() const { return ignored_; }
  /// How many messages of each channel came.
  const std::map<std::string, int64_t>& received() const { return received_; }
  const AdapterCameraOptions& options() const { return options_; }

 private:
  struct Waiting {
    ForeignImage image;
    int64_t received = 0;
  };
  /// What keeps a pair from being a frame; nothing when `why` is empty.
  struct Missing {
    std::string why = {};
    bool never = false;  // waiting does not help
    double wait_ms = 0;  // longest wait for it
  };
  struct Pair {
    std::optional<ForeignImage> color;
    ForeignImage depth;
    int64_t received = 0;
    int64_t utime() const { return color ? color->utime : depth.utime; }
  };

  FrameJoiner(const AdapterCameraOptions& options, Sink sink, bool keep_pixels);
  bool Wants(const std::string& channel) const;
  void Arrive(int64_t received);
  void RestartWaits();
  Result<void> LockChannels(const std::string& channel, const ForeignMessage& message);
  Result<void> AddImages(const std::string& channel, ForeignMessage message, int64_t received,
                         int64_t number);
  Result<void> Prepare(ForeignImage* image, bool is_color, int64_t received, int64_t number);
  void AddInTime(ForeignMessage message, int64_t now);
  void AddColor(ForeignImage image, int64_t received);
  void AddDepth(ForeignImage image, int64_t received);
  void AddPair(Pair pair);
  void Settle(int64_t now);
  bool PairFirstDepth(int64_t now);
  bool JoinFirstPair(int64_t now);
  Missing Complete(const Pair& pair, int64_t now, ForeignFrame* frame) const;
  Missing FindCameras(const Pair& pair, ForeignFrame* frame) const;
  Missing FindPoses(const Pair& pair, int64_t now, ForeignFrame* frame) const;
  std::optional<ForeignCamera> ColorCamera(const ForeignImage& image) const;
  bool IsRegistered(const Pair& pair) const;
  void DropOldColors(int64_t now);
  void BoundBytes();
  void Drop(const std::string& why) { dropped_.Add(why); }
  void DropForItsTime(bool wrong);

  AdapterCameraOptions options_;
  Sink sink_;
  bool keep_pixels_;
  FrameTree tree_;
  std::optional<ForeignCamera> color_camera_, depth_camera_;
  std::deque<Waiting> colors_, depths_;  // in order of arrival
  std::deque<Pair> pairs_;
  size_t waiting_bytes_ = 0;
  int64_t now_ = 0;                  // the latest time at which a message came
  std::optional<int64_t> advanced_;  // of the last Advance
  int64_t wall_offset_ = 0;          // [us]
  static constexpr int64_t kArrivalSlack = 50'000, kImageSlack = 1'000'000;  // [us]
  TimeGate<std::monostate> arrivals_{kArrivalSlack};
  TimeGate<ForeignImage> color_times_{kImageSlack}, depth_times_{kImageSlack};
  TimeGate<Pair> pair_times_{kImageSlack};
  int64_t last_color_utime_ = -1;
  int64_t least_color_gap_ = 0;  // [us]; 0 = not known
  std::optional<int64_t> last_utime_;
  int64_t frames_ = 0;
  bool finished_ = false;
  ReasonCounts dropped_, ignored_;
  std::map<std::string, int64_t> received_;
};

}  // namespace vismap
