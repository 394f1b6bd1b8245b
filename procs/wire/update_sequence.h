#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"

namespace vismap {

/// The state of a copy of a map: which map it is, and the revision up to which all updates were
/// applied.
struct FollowerPosition {
  std::string map_id;
  int64_t revision = -1;  ///< -1 = the copy is empty
  friend bool operator==(const FollowerPosition&, const FollowerPosition&) = default;
};

/// "MAP_ID@REVISION", the form used in requests for missing updates; "" when the copy is empty.
std::string ToText(const FollowerPosition& position);
/// The inverse of ToText.
Result<FollowerPosition> ParseFollowerPosition(const std::string& text);

/// What happened to an update, or to one part of it.
enum class FollowOutcome {
  kApplied,        ///< all its parts have arrived; the copy has advanced to its revision
  kWaiting,        ///< stored; other parts of the update have not arrived yet
  kIgnored,        ///< not needed: the copy already has this revision
  kNeedsSnapshot,  ///< cannot be applied: an earlier update is missing, or the copy is empty;
                   ///< request it
  kBroken,         ///< the update is inconsistent in itself or with the copy
  kTooLarge,       ///< the copy with this update would need more memory than allowed; the parts of
                   ///< the update were dropped
};

/// How much a follower keeps.
struct FollowLimits {
  size_t max_bytes = size_t{1024} << 20;  ///< of the copy, and again of parts that wait [bytes]
  double max_wait_s = 30;  ///< after the last new part of an update, its other parts are given up
};

/// The position of one update in its stream (MAP_DELTA or MESH_DELTA).
struct UpdateHead {
  std::string map_id;
  int64_t revision = 0;       ///< of the map after the update
  int64_t base_revision = 0;  ///< revision that the receiver must have; unused if `full`
  bool full = false;          ///< a snapshot: it replaces the whole copy
  int32_t part = 0;           ///< index of this part, 0 to parts - 1
  int32_t parts = 1;
  friend bool operator==(const UpdateHead&, const UpdateHead&) = default;
};

/// Collects the parts of an update, which may arrive in any order, and decides whether the update
/// can be applied. An update applies only to its base revision, so that the copy always equals some
/// earlier state of the original. Memory is bounded: parts of an update that never becomes complete
/// are dropped. It has no clock of its own: callers pass the current time `now` [s].
template <typename Update>
class UpdateSequence {
 public:
  /// Memory of a part besides what the caller counts [bytes].
  static constexpr size_t kPartBytes = sizeof(Update) + 128;

  explicit UpdateSequence(const FollowLimits& limits) : limits_(limits) {}

  /// Adds one part, which takes `bytes` of memory. When it returns kApplied, position() is that of
  /// the update, and ReleaseParts() returns all of its parts in ascending order, for the caller to
  /// apply.
  FollowOutcome AddPart(const UpdateHead& head, Update update, size_t bytes, double now) {
    ready_.clear();
    const bool same_map = head.map_id == position_.map_id;
    if (same_map && in_sync_ && head.revision <= position_.revision) return FollowOutcome::kIgnored;
    UpdateHead whole = head;
    whole.part = 0;
    if (!staged_ || *staged_ != whole) {
      const bool fits = head.full || (same_map && position_.revision >= 0 &&
                                      head.base_revision == position_.revision);
      if (!fits) return OnMissingUpdate();
      DropParts();
      staged_ = whole;
      staged_since_ = now;
    }
    if (parts_.contains(head.part)) return FollowOutcome::kWaiting;  // it was sent again
    if (staged_bytes_ + bytes + kPartBytes > limits_.max_bytes) {
      DropParts();
      OnMissingUpdate();
      return FollowOutcome::kTooLarge;
    }
    parts_.emplace(head.part, std::move(update));
    staged_bytes_ += bytes + kPartBytes;
    staged_since_ = now;
    if (parts_.size() < static_cast<size_t>(head.parts)) return FollowOutcome::kWaiting;
    for (auto& entry : parts_) ready_.push_back(std::move(entry.second));
    DropParts();
    position_ = {head.map_id, head.revision};
    in_sync_ = true;
    return FollowOutcome::kApplied;
  }

  /// Drops the parts of an update that has waited too long for its other parts. Returns how many.
  size_t GiveUpStaleParts(double now) {
    if (!staged_ || now - staged_since_ < limits_.max_wait_s) return 0;
    const size_t dropped = parts_.size();
    DropParts();
    return dropped;
  }

  std::vector<Update> ReleaseParts() { return std::exchange(ready_, {}); }

  /// Marks the copy as wrong: only a snapshot can be applied next.
  void RequireSnapshot() {
    OnMissingUpdate();
    position_.revision = -1;
  }

  bool in_sync() const { return in_sync_; }
  const FollowerPosition& position() const { return position_; }
  int64_t gaps() const { return gaps_; }                 ///< how often an update was missing
  size_t staged_bytes() const { return staged_bytes_; }  ///< memory of the parts that wait
  const FollowLimits& limits() const { return limits_; }

 private:
  void DropParts() {
    parts_.clear();
    staged_.reset();
    staged_bytes_ = 0;
  }

  // Keeps the staged parts, because the other parts of that update may still arrive.
  FollowOutcome OnMissingUpdate() {
    if (in_sync_) ++gaps_;
    in_sync_ = false;
    return FollowOutcome::kNeedsSnapshot;
  }

  FollowLimits limits_;
  FollowerPosition position_;
  bool in_sync_ = false;
  int64_t gaps_ = 0;
  std::optional<UpdateHead> staged_;  // head of the update being collected, with part = 0
  double staged_since_ = 0;           // when the last new part arrived [s]
  size_t staged_bytes_ = 0;
  std::map<int32_t, Update> parts_;  // of the staged update, by index
  std::vector<Update> ready_;        // parts of the update that was just completed
};

}  // namespace vismap
