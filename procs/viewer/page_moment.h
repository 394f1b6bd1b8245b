#pragma once

#include <tsl/robin_map.h>

#include <cstdint>
#include <string>
#include <vector>

#include "viewer/log_recording.h"
#include "viewer/surface_view.h"

namespace vismap {

/// What a page is told of the map at a moment.
MapSummary SummaryOf(const LogRecording& recording, const Moment& moment);

/// The surface at the moment of a log that one page looks at. It knows which blocks the page has
/// got, so that going to another moment sends only what differs.
class PageMoment : public SurfaceView {
 public:
  /// `recording` must outlive it.
  explicit PageMoment(const LogRecording* recording) : recording_(recording) {}

  /// Looks at another moment. Returns the blocks that the page lacks then, ascending.
  std::vector<BlockIndex> Show(const Moment& moment);
  const Moment& moment() const { return moment_; }
  /// Blocks of the last moments could not be read from the disk, and why; "" = all could.
  const std::string& problem() const { return problem_; }

  FrameBytes BytesOf(BlockIndex index) override;
  std::vector<BlockIndex> SortedIndices() const override;
  double block_edge_m() const override { return recording_->block_edge_m(); }
  int64_t revision() const override { return moment_.frames; }
  void OnForget() override { sent_.clear(); }
  /// What a page is told of the map.
  MapSummary Summary() const { return SummaryOf(*recording_, moment_); }

 private:
  using Hashes = tsl::robin_map<BlockIndex, uint64_t, BlockIndexHash>;
  const LogRecording* recording_;
  Moment moment_;
  Hashes shown_, sent_;
  std::string problem_;
};

}  // namespace vismap
