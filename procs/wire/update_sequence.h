#pragma once

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
/// earlier state of the original.
template <typename Update>
class UpdateSequence {
 public:
  /// Adds one part. When it returns kApplied, position() is that of the update, and ReleaseParts()
  /// returns all of its parts in ascending order, for the caller to apply.
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

  /// Marks the copy as wrong: only a snapshot can be applied next.
  void RequireSnapshot() {
    OnMissingUpdate();
    position_.revision = -1;
  }

  bool in_sync() const { return in_sync_; }
  const FollowerPosition& position() const { return position_; }
  int64_t gaps() const { return gaps_; }  ///< how often an update was missing

 private:
  // Keeps the staged parts, because the other parts of that update may still arrive.
  FollowOutcome OnMissingUpdate() {
    if (in_sync_) ++gaps_;
    in_sync_ = false;
    return FollowOutcome::kNeedsSnapshot;
  }

  FollowerPosition position_;
  bool in_sync_ = false;
  int64_t gaps_ = 0;
  std::optional<UpdateHead> staged_;  // head of the update being collected, with part = 0
  std::map<int32_t, Update> parts_;   // of the staged update, by index
  std::vector<Update> ready_;         // parts of the update that was just completed
};

}  // namespace vismap
