#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <vismap/pose_correction_t.hpp>

#include "map_server/live_map.h"
#include "runtime/bus.h"
#include "runtime/status.h"
#include "runtime/worker.h"
#include "wire/pose_correction.h"

namespace vismap {

/// Makes the map again when a POSE_CORRECTION brings new poses of its frames: a thread of its own
/// integrates the frames of the journal, from the newest checkpoint before the first changed frame
/// on, with the threads that mapping leaves, while the server goes on with the old map. Then the
/// new map takes the place of the old one. It is the map that the same frames with these poses
/// give. Each correction is answered on MAP_REPLY when the map has its poses, or when it is
/// refused; the answer says which objects are which (LinksJson). A correction that comes while a
/// map is being made is added to the one before, and that map is given up.
class PoseCorrections {
 public:
  /// Subscribes to POSE_CORRECTION. All must outlive it.
  PoseCorrections(const MapServerOptions& options, LiveMap* map, Bus* bus, Status* status);
  ~PoseCorrections() { GiveUp(); }

  /// Ends the work that has begun; those who wait for it are told.
  void Stop();

 private:
  struct Requester {
    std::string source;
    int64_t request_id = 0;
    std::string sentence;  ///< what becomes of the frames
  };
  struct Frame {
    int64_t revision = 0;
    Pose T_W_C = Pose::Identity();
  };
  /// A map that is being made; the thread and the bus have it in turn.
  struct Rebuild {
    MapSession session;
    Checkpoints checkpoints;    ///< of the old map, as far as they hold, and then of this one
    std::vector<Frame> frames;  ///< to be integrated, in their order
    std::shared_ptr<std::atomic<bool>> given_up;
    SeenByFrame seen{};  ///< by those that were integrated
    std::optional<Error> error = std::nullopt;
  };
  struct Change {
    std::vector<JournaledPose> poses;  ///< of the frames whose pose changes
    int64_t first = 0;                 ///< revision of the first one of them
    size_t named = 0, unknown = 0;     ///< frames of the correction that the map has, and has not
    std::map<FrameKey, Pose> old_poses;
  };

  void OnCorrection(const pose_correction_t& message);
  Result<std::string> Begin(const pose_correction_t& message);
  Result<Change> FindChange(const PoseCorrection& correction) const;
  Result<std::vector<Frame>> FramesAfter(int64_t revision) const;
  Result<void> Start(const Change& change);
  void StartRound(const std::shared_ptr<Rebuild>& rebuild);
  void EndRound(const std::shared_ptr<Rebuild>& rebuild);
  void Integrate(Rebuild* rebuild) const;
  void IntegrateAll(Rebuild* rebuild) const;
  void Replace(Rebuild* rebuild);
  void Abandon(const std::string& reason);
  void GiveUp();
  void Reply(const Requester& requester, bool ok, const std::string& sentence,
             const std::string& json = "");
  void ReplyAll(bool ok, const std::string& sentence, const std::string& json = "");

  bool accepts_;
  LiveMap& map_;
  Bus& bus_;
  Status& status_;
  std::vector<Requester> waiting_;      // for the map that is being made
  std::map<FrameKey, Pose> old_poses_;  // of the map that is there, where they differ
  std::shared_ptr<std::atomic<bool>>
      given_up_;           // of the rebuild that counts; nullptr = there is none
  std::string frames_id_;  // of its map
  int rounds_ = 0;
  double start_ = 0;  // of the rebuild, MonotonicSeconds
  Worker worker_;
};

}  // namespace vismap
