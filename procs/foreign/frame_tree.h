#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/result.h"
#include "foreign/pose_track.h"

namespace vismap {

/// The pose of a child in its parent at one time.
struct EdgeSample {
  std::string parent, child;
  int64_t utime = 0;  ///< [us]
  Pose T_parent_child = Pose::Identity();
};

/// The name of a robot's frame where several robots may have frames of one name: "camera@2".
std::string FrameOfRobot(const std::string& frame, int robot);

/// A tree of coordinate frames that move against each other, as tf and bot-frames have it: every
/// frame has one parent. It keeps at most 4096 frames, and 400000 samples of all of them. The name
/// "camera" also stands for the frame of a robot, "camera@2", as long as no other robot has one of
/// this name.
class FrameTree {
 public:
  enum class State {
    kFound,    ///< `pose` is set
    kWaiting,  ///< `why` may pass with the next messages
    kNever,    ///< `why` will not pass
  };
  struct Answer {
    State state = State::kWaiting;
    Pose pose = Pose::Identity();
    std::string why = {};  ///< a sentence
  };

  explicit FrameTree(const PoseLookupOptions& options) : options_(options) {}

  /// Adds an edge that holds at all times and that no message replaces.
  void AddMount(const std::string& parent, const std::string& child, const Pose& T_parent_child);
  /// Adds what a message said that was received at `received` [us]. A frame that gets another
  /// parent forgets the one before. Returns a sentence about what is left out because of its time
  /// or the limits above; "" = nothing.
  std::string Add(const EdgeSample& sample, int64_t received);

  /// The receiver's clock was set back to `now` [us].
  void RestartWaits(int64_t now);

  /// T_target_source at a time. `now`: the receiver's time [us].
  Answer Find(const std::string& target, const std::string& source, int64_t utime,
              int64_t now) const;

  /// Names of the frames that have a parent, for messages; the first twenty.
  std::string FramesText() const;

  /// How many samples are kept.
  size_t size() const;

 private:
  struct Edge {
    std::string parent;
    PoseTrack track;
    bool mount = false;
  };
  size_t SamplesPerFrame() const;
  Edge& EdgeOf(const std::string& child);
  /// Names of the frames of robots that a name may stand for.
  std::vector<std::string> OfRobots(const std::string& frame) const;
  std::string Resolve(const std::string& frame) const;
  std::vector<std::string> PathToRoot(const std::string& frame) const;
  Answer UpTo(const std::vector<std::string>& path, size_t end, int64_t utime, int64_t now) const;

  PoseLookupOptions options_;
  std::map<std::string, Edge> edges_;  // by child
};

}  // namespace vismap
