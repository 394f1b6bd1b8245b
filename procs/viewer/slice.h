#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "base/result.h"
#include "freespace/slice.h"
#include "viewer/http_rules.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Arguments axis=x|y|z, at=METRES and, optional, res=METRES and distance=0|1.
Result<SliceQuestion> ReadSlice(const HttpTarget& target);
/// Whether such arguments ask for distances, too.
bool AsksForDistances(const HttpTarget& target);

struct SliceDistances;
/// u32 size of a JSON, the JSON, the states and, with distances, padding to 4 bytes and a float32
/// for each cell. `problem`: why there are no distances, though they were asked for; "" = none.
std::vector<uint8_t> EncodeSlice(const Slice& slice, const SliceQuestion& question,
                                 const FollowerPosition& position,
                                 const SliceDistances* distances = nullptr,
                                 const std::string& problem = "");

/// Answers GET /api/slice. Keeps the last slice, since several pages look at the same one, and cuts
/// at most 10 new ones per second.
class SliceAnswers {
 public:
  static constexpr double kMostPerSecond = 10;
  /// Gives the map to cut, or says why there is none.
  using FindMap = std::function<tl::expected<const OccupancyMap*, HttpAnswer>()>;

  /// `now` in MonotonicSeconds. The slice is there until the next call.
  tl::expected<const Slice*, HttpAnswer> Find(const SliceQuestion& question,
                                              const OccupancyMap& map,
                                              const FollowerPosition& position, double now);
  /// The same for a map that takes time to find: asks for it only when a new slice may be cut.
  tl::expected<const Slice*, HttpAnswer> Find(const SliceQuestion& question, double cell_size_m,
                                              const FindMap& find_map,
                                              const FollowerPosition& position, double now);

 private:
  // map_id, revision, axis, layer, size of cells that was asked for
  using Key = std::tuple<std::string, int64_t, int, double, double>;
  std::optional<Key> kept_;
  Slice slice_;  // belongs to kept_
  double tokens_ = kMostPerSecond, filled_ = 0;
};

}  // namespace vismap
