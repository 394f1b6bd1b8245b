#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace vismap {

/// Counts things that were left out, by the reason. Reasons that differ only in their numbers count
/// as one, and the first of them is shown. Keeps at most 50 different reasons.
class ReasonCounts {
 public:
  struct Reason {
    int64_t count = 0;
    std::string example;  ///< the first one
  };
  void Add(const std::string& reason);
  int64_t total() const { return total_; }
  /// The most frequent reason; count 0 = there is none.
  Reason MostFrequent() const;
  /// "3 x the pose is not rigid; 1 x there is no depth image": the most frequent reasons first, at
  /// most five of them.
  std::string Text() const;

 private:
  std::vector<const Reason*> Sorted() const;

  std::map<std::string, Reason> reasons_;  // by the text without its numbers
  int64_t total_ = 0;
};

/// "no usable frames (6 of 6: the pose is not rigid)", with the most frequent reason; `all` is the
/// number of all frames.
std::string NoUsableFramesText(const ReasonCounts& left_out, int64_t all);

/// "2 of 10 frames were left out: 2 x the pose is not rigid"; `all` is the number of all frames.
std::string LeftOutText(const ReasonCounts& left_out, int64_t all);

}  // namespace vismap
