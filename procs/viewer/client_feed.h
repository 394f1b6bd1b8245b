#pragma once

#include <tsl/robin_set.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.h"
#include "viewer/board.h"
#include "viewer/surface_view.h"

namespace vismap {

/// How much a page may get at once.
struct FeedLimits {
  /// Bytes that may be saved up while there is nothing to send.
  double most_allowance = 4 << 20;
  /// Binary bytes that the page may have got without having said so (`ack`).
  int64_t most_unacknowledged = 8 << 20;
  bool has_moments = false;  ///< the page may ask for moments of a log
};

/// One WebSocket message to a page.
struct OutFrame {
  FrameBytes bytes;
  bool is_text = false;
};

/// Decides what one page gets next. It holds no content: of a block it knows only that the page
/// lacks its newest state, and of the rest which change was sent last. So memory is bounded by the
/// number of blocks, however slow the page is, and the page gets the newest state of everything
/// when it reads again. It has no socket and no clock of its own: times `now` are in seconds.
class ClientFeed {
 public:
  static constexpr int kMostMessagesPerSecond = 50;  ///< from the page, ...
  /// ... where one that acknowledges so many bytes does not count.
  static constexpr int64_t kFreeAcknowledgement = 1 << 16;
  static constexpr size_t kMostNotices = 16;
  /// Larger texts about objects and the like wait until they may be sent, and take at most half of
  /// what is sent while blocks wait.
  static constexpr size_t kSmallText = 1 << 16;
  static constexpr size_t kBatchBytes = 1 << 18;  ///< of blocks in one message, about
  /// A page that wants the newest moment of a log, whatever it is.
  static constexpr int64_t kNewestMoment = INT64_MAX;

  /// Both must outlive it.
  ClientFeed(SurfaceView* surface, const Board* board, std::string hello, FeedLimits limits = {});

  /// The blocks changed in the copy of the map.
  void OnChanges(const SurfaceChanges& changes);
  /// The page lacks just these blocks, whatever it lacked before.
  void SetLacking(const std::vector<BlockIndex>& blocks);
  /// The page must forget all blocks and gets them again.
  void Restart();
  /// A text from the page. An Error is the reason why the connection must end.
  Result<void> OnText(std::string_view text, double now);
  void AddNotice(std::string level, std::string sentence);
  /// Bytes that may be sent in addition to what is left, for the surface and pictures.
  void Allow(double bytes);
  /// False when it has saved up all that it may.
  bool NeedsAllowance() const { return allowance_ < limits_.most_allowance; }

  /// The next message; nullopt = nothing, at present. Must not be called again before that message
  /// was sent. `now` decides when the state of the map is due again.
  std::optional<OutFrame> Next(double now);

  /// The moment that the page has asked for since the last call, as a number of frames.
  std::optional<int64_t> TakeMoment() { return std::exchange(moment_wanted_, std::nullopt); }
  /// The state of the map is told at once.
  void TellMap() { map_due_ = 0; }
  bool WantsPicture(int camera_id) const { return pictures_wanted_.contains(camera_id); }
  const std::set<int>& pictures_wanted() const { return pictures_wanted_; }
  /// Blocks whose newest state the page lacks.
  size_t waiting() const { return dirty_.size() + batch_.size(); }
  int64_t unacknowledged() const { return sent_bytes_ - acknowledged_; }
  /// Memory [bytes], about.
  size_t bytes() const;

 private:
  Result<void> ReadAck(const nlohmann::json& json);
  Result<void> ReadWant(const nlohmann::json& json);
  std::optional<OutFrame> NextText(double now);
  std::optional<OutFrame> NextTopic();
  std::optional<OutFrame> NextPath();
  std::optional<OutFrame> NextPicture();
  Result<void> ReadMoment(const nlohmann::json& json);
  std::optional<OutFrame> NextBlocks();
  FrameBytes NextBlock();
  void FollowCentre(double now);
  void FillBatch();
  OutFrame Count(FrameBytes bytes);

  SurfaceView* surface_;
  const Board* board_;
  std::string hello_;  // empty once it was sent
  FeedLimits limits_;
  std::optional<int64_t> moment_wanted_;
  bool reset_ = true;  // the next text about the map tells the page to forget all blocks
  double map_due_ = 0;
  std::deque<std::string> notices_;
  std::array<int64_t, Board::kTopics> sent_topics_{};  // number of the change that was sent last
  std::map<int, int64_t> sent_pictures_;               // by camera
  std::map<int, size_t> sent_positions_;               // by camera
  int64_t paths_number_ = -1;

  bool wants_mesh_ = true, wants_processes_ = true, wants_batches_ = false;
  std::set<int> pictures_wanted_;
  std::optional<Eigen::Vector3d> centre_W_;         // [m] blocks near it come first
  std::optional<Eigen::Vector3d> sorted_centre_W_;  // [m] by which the batch is sorted
  double next_sort_ = 0;

  // A block is in one of them or in both; those of the batch are sent first, from its end.
  tsl::robin_set<BlockIndex, BlockIndexHash> dirty_;
  std::vector<BlockIndex> batch_;

  double allowance_ = 0;  // [bytes]; negative after a large message
  double text_debt_ = 0;  // bytes of other data that are due before the next large text
  int64_t sent_bytes_ = 0, acknowledged_ = 0;
  double second_ = 0;  // when the counted messages of the page began
  int messages_ = 0;
  double next_resync_ = 0;
};

}  // namespace vismap
