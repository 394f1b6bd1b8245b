#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>
#include <vismap/object_list_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "config/process_options.h"
#include "runtime/bus.h"
#include "runtime/status.h"
#include "runtime/worker.h"
#include "viewer/evidence_finder.h"
#include "viewer/map_copy.h"
#include "viewer/web_server.h"

namespace vismap {

/// Keeps frames, and answers in which of them an object is seen and what it looks like there:
/// GET /api/evidence and /api/frame/..., see procs/README.md. All long work is done by a thread of
/// its own.
class Evidence {
 public:
  static constexpr int kMostWaiting = 16;  ///< requests; further ones are refused

  /// All must outlive it.
  Evidence(const ViewerOptions& options, Bus* bus, const MapCopy* surface, Status* status);

  bool enabled() const { return options_.evidence_mb > 0; }
  /// Keeps the frame if it is due and shows something new.
  void Offer(std::shared_ptr<const segmented_frame_t> message);
  /// The frames belong to a map that is gone.
  void ForgetFrames();
  /// Which segments discovered objects have.
  void SetObjects(const object_list_t& objects);
  static bool Answers(const std::string& path);
  /// For paths that it answers. `reply` is called once, now or later.
  void Get(const HttpTarget& target, const WebHandler::Reply& reply);

 private:
  struct Kept {
    size_t frames = 0, bytes = 0;
  };
  /// Whether a question about an object can be asked now; else the answer that says why not.
  tl::expected<EvidenceQuestion, HttpAnswer> Ask(const std::string& name);
  template <typename Work>
  void Start(Work work, const WebHandler::Reply& reply);
  void GetList(const HttpTarget& target, const WebHandler::Reply& reply);
  void GetPicture(const HttpTarget& target, const WebHandler::Reply& reply);
  SurfaceBlocks Blocks();
  void ReleaseBlocks();

  ViewerOptions options_;
  Bus* bus_;
  const MapCopy* surface_;
  Status* status_;
  double next_offer_ = 0;                                 // MonotonicSeconds
  int offers_ = 0, waiting_ = 0;                          // under way
  std::map<uint32_t, std::vector<uint32_t>> discovered_;  // segments, by the first of them
  SurfaceBlocks blocks_;                                  // of this map and revision:
  std::string blocks_map_id_;
  int64_t blocks_revision_ = -1;
  double blocks_time_ = 0;
  std::shared_ptr<EvidenceFinder> finder_;  // used by the worker's thread alone
  Worker worker_;                           // last, so that its thread ends first
};

}  // namespace vismap
