#pragma once

#include "wire/update_sequence.h"

namespace vismap {

/// Notices that a map has gone back to an earlier revision, as a log does that is replayed again: a
/// follower ignores revisions that it has already, so it would stay as it is for ever.
class BackWatch {
 public:
  static constexpr double kPatience = 5;  ///< only older revisions were heard for so long [s]

  /// An update to `heard` came at time `now` [s]; the copy is at `own`. `full`: it is a snapshot,
  /// which is older than the copy also when another follower has asked for it. Returns true when
  /// the copy should be replaced.
  bool Heard(const FollowerPosition& heard, bool full, const FollowerPosition& own, double now) {
    const bool older = heard.map_id == own.map_id && heard.revision < own.revision;
    if (!older) since_ = kNever;
    if (!older || full) return false;
    if (since_ == kNever) since_ = now;
    if (now - since_ < kPatience) return false;
    since_ = kNever;
    return true;
  }

 private:
  static constexpr double kNever = -1;
  double since_ = kNever;
};

}  // namespace vismap
