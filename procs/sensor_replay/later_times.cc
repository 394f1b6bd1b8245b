#include "sensor_replay/later_times.h"

#include <algorithm>
#include <optional>
#include <set>

#include "wire/pose_digest.h"

namespace vismap {
namespace {

constexpr size_t kCompared = 50;               // frames of the sequence
constexpr int64_t kLatest = int64_t{1} << 61;  // so that times cannot overflow [us]

using TimesByPose = std::multimap<std::string, int64_t>;

// The shift under which the map has most of the sequence's poses at their times; none when it has
// fewer than two of them, since many sequences begin at the same pose.
std::optional<int64_t> ShiftOfSamePoses(const Dataset& dataset, const TimesByPose& in_map) {
  std::map<int64_t, size_t> votes;
  for (size_t i = 0; i < std::min(kCompared, dataset.size()); ++i) {
    const FrameHeader header = dataset.Header(i);
    std::set<int64_t> shifts;
    const auto [begin, end] = in_map.equal_range(PoseDigest(header.T_W_C));
    for (auto found = begin; found != end && shifts.size() < kCompared; ++found)
      shifts.insert(found->second - header.utime);
    for (const int64_t shift : shifts) ++votes[shift];
  }
  const auto best = std::max_element(
      votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const size_t enough = std::min<size_t>(2, in_map.size());
  if (best == votes.end() || best->second < enough) return std::nullopt;
  return best->first;
}

}  // namespace

int64_t LaterTimes(const Dataset& dataset, const std::map<FrameKey, std::string>& in_map) {
  const FrameHeader first = dataset.Header(0);
  TimesByPose of_camera;
  int64_t newest = -1;
  for (const auto& [key, pose] : in_map) {
    if (key.camera_id != first.camera_id || key.utime < 0 || key.utime > kLatest) continue;
    of_camera.emplace(pose, key.utime);
    newest = std::max(newest, key.utime);
  }
  if (newest < first.utime) return 0;
  if (const std::optional<int64_t> same = ShiftOfSamePoses(dataset, of_camera)) return *same;
  const int64_t step = dataset.size() > 1 ? dataset.Header(1).utime - first.utime : 33333;
  return newest + std::max<int64_t>(1, step) - first.utime;
}

}  // namespace vismap
