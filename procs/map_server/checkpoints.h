#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "session/map_session.h"

namespace vismap {

/// Copies of a map after some of its frames, from which it can be made again. They share with the
/// map what has not changed since.
class Checkpoints {
 public:
  /// `frames`: between two of them. `max_bytes`: of all together, where what they share counts
  /// several times.
  Checkpoints(int64_t frames, size_t max_bytes) : frames_(frames), max_bytes_(max_bytes) {}

  /// Keeps a copy if enough frames came since the newest one. When there are too many, the oldest
  /// but one goes, so that one near the beginning stays.
  void AddIfDue(const MapSession& session);
  /// Keeps this one, whose revision is above that of all others.
  void Add(std::shared_ptr<const MapSession> session);
  void Clear() { copies_.clear(); }
  /// Drops those that contain frame `revision`.
  void DropFrom(int64_t revision);
  /// The newest one without frame `revision`; nullptr when there is none.
  std::shared_ptr<const MapSession> NewestBefore(int64_t revision) const;

  size_t size() const { return copies_.size(); }
  size_t bytes() const;
  static constexpr size_t kMost = 8;

 private:
  int64_t frames_;
  size_t max_bytes_;
  std::vector<std::shared_ptr<const MapSession>> copies_;  // by revision
};

}  // namespace vismap
