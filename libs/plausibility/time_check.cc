#include "plausibility/time_check.h"

#include <bit>

#include "base/format.h"

namespace vismap {
namespace {

constexpr int64_t kFewest = 3;                        // fewer distances say nothing
constexpr int64_t kShortest = 500;                    // [us]: no camera takes 2000 images a second
constexpr int64_t kLongest = 15'000'000;              // [us] between the frames of a sequence
constexpr double kManyBackward = 0.2;                 // of the frames
constexpr int64_t kYear2200 = 7'258'118'400'000'000;  // [us since 1970]

}  // namespace

void TimeCheck::Add(int64_t utime) {
  const int64_t last = last_;
  last_ = utime;
  if (frames_++ == 0) return;
  if (utime == last) {
    ++repeated_;
  } else if (utime < last) {
    ++backward_;
  } else {
    // Unsigned, since the difference of two times may not fit into int64_t.
    const uint64_t distance = static_cast<uint64_t>(utime) - static_cast<uint64_t>(last);
    ++distances_[static_cast<size_t>(std::bit_width(distance) - 1)];
  }
}

// About the middle one of the distances between successive frames [us]; 0 = there are too few.
int64_t TimeCheck::Median() const {
  int64_t all = 0, below = 0;
  for (const int64_t count : distances_) all += count;
  if (all < kFewest) return 0;
  for (size_t i = 0; i + 1 < distances_.size(); ++i) {
    below += distances_[i];
    if (2 * below >= all) return (int64_t{1} << i) + (int64_t{1} << i) / 2;
  }
  return INT64_MAX;
}

std::optional<std::string> TimeCheck::Finding() const {
  if (repeated_ > 0) {
    return FormatCount(repeated_, "frame") + " of " + FormatCount(frames_) +
           " had the utime of the frame before (" + std::to_string(last_) +
           " is the last one); does the driver set the time of every image?";
  }
  if (static_cast<double>(backward_) > kManyBackward * static_cast<double>(frames_)) {
    return FormatCount(backward_, "frame") + " of " + FormatCount(frames_) +
           " had an older utime than the frame before; are they in the order in which they were "
           "taken?";
  }
  if (last_ > kYear2200) {
    return "the utime of the last frame, " + std::to_string(last_) +
           ", is after the year 2200; is it in microseconds, and not in nanoseconds?";
  }
  const int64_t median = Median();
  if (median == 0 || (median >= kShortest && median <= kLongest)) return std::nullopt;
  return "successive frames are about " +
         (median > kLongest ? FormatDuration(static_cast<double>(median) * 1e-6)
                            : std::to_string(median) + " us") +
         " apart, which is unusual; is their utime in microseconds" +
         (median > kLongest ? ", and not in nanoseconds?"
                            : ", and not in milliseconds or seconds?");
}

}  // namespace vismap
