#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"

namespace vismap {

/// Where a follower of a map stands: which map, and up to which revision it has all updates.
struct FollowerPosition {
  std::string map_id;
  int64_t revision = -1;  ///< -1 = it has nothing
  friend bool operator==(const FollowerPosition&, const FollowerPosition&) = default;
};

/// "MAP_ID@REVISION", as requests for what was missed carry it; empty when it has nothing.
std::string ToText(const FollowerPosition& position);
Result<FollowerPosition> ParseFollowerPosition(const std::string& text);

/// What became of an update.
enum class FollowOutcome {
  kApplied,        ///< the copy is one step further
  kWaiting,        ///< a part of an update; others are missing
  kIgnored,        ///< nothing new: an old update, or a snapshot of what is here already
  kNeedsSnapshot,  ///< an update is missing, or nothing is known yet: ask for what is missing
  kBroken,         ///< the update contradicts itself or the copy; a snapshot is needed
};

/// What the updates of a stream (MAP_DELTA, MESH_DELTA) say of their place in it.
struct UpdateHead {
  std::string map_id;
  int64_t revision = 0;       ///< of the stream after the update
  int64_t base_revision = 0;  ///< what the receiver must have; of no meaning when full
  bool full = false;          ///< replaces everything
  int32_t part = 0;           ///< this is part 0..parts-1 of the update
  int32_t parts = 1;
  friend bool operator==(const UpdateHead&, const UpdateHead&) = default;
};

/// Brings the parts of updates together, in any order, and says when they may be applied: on top of
/// exactly what they were made for, so that a copy is always some state of the original.
template <typename Update>
class UpdateSequence {
 public:
  /// Takes one part. With kApplied, ReleaseParts() returns all parts of the update, ascending, and
  /// the position is that after it.
  FollowOutcome AddPart(const UpdateHead& head, Update update) {
    ready_.clear();
    const bool same_map = head.map_id == position_.map_id;
    if (same_map && in_sync_ && head.revision <= position_.revision) return FollowOutcome::kIgnored;
    UpdateHead whole = head;
    whole.part = 0;
    if (!staged_ || *staged_ != whole) {
      const bool fits = head.full || (same_map && position_.revision >= 0 &&
                                      head.base_revision == position_.revision);
      if (!fits) return OnMissingUpdate();
      staged_ = whole;
      parts_.clear();
    }
    parts_.insert_or_assign(head.part, std::move(update));
    if (parts_.size() < static_cast<size_t>(head.parts)) return FollowOutcome::kWaiting;
    for (auto& entry : parts_) ready_.push_back(std::move(entry.second));
    parts_.clear();
    staged_.reset();
    position_ = {head.map_id, head.revision};
    in_sync_ = true;
    return FollowOutcome::kApplied;
  }

  std::vector<Update> ReleaseParts() { return std::exchange(ready_, {}); }

  /// The copy cannot be trusted any more: only a full update helps.
  void RequireSnapshot() {
    OnMissingUpdate();
    position_.revision = -1;
  }

  bool in_sync() const { return in_sync_; }
  const FollowerPosition& position() const { return position_; }
  int64_t gaps() const { return gaps_; }  ///< how often updates were missing

 private:
  // What is staged stays: its other parts may come yet.
  FollowOutcome OnMissingUpdate() {
    if (in_sync_) ++gaps_;
    in_sync_ = false;
    return FollowOutcome::kNeedsSnapshot;
  }

  FollowerPosition position_;
  bool in_sync_ = false;
  int64_t gaps_ = 0;
  std::optional<UpdateHead> staged_;  // with part = 0
  std::map<int32_t, Update> parts_;
  std::vector<Update> ready_;
};

}  // namespace vismap
