#include "segmentation/runs.h"

#include <cstddef>
#include <cstring>

#include "base/parallel.h"

namespace vismap {
namespace {

constexpr int kBandRows = 32;

/// The first u' in [u, end) with bytes[u'] == 0 (NextZero) or != 0 (NextSet); `end` = none.
int NextZero(const uint8_t* bytes, int u, int end) {
  const void* found = std::memchr(bytes + u, 0, static_cast<size_t>(end - u));
  return found == nullptr ? end : static_cast<int>(static_cast<const uint8_t*>(found) - bytes);
}
int NextSet(const uint8_t* bytes, int u, int end) {
  for (uint64_t eight; u + 8 <= end; u += 8) {
    std::memcpy(&eight, bytes + u, sizeof(eight));
    if (eight != 0) break;
  }
  while (u < end && bytes[u] == 0) ++u;
  return u;
}

void AppendRuns(RunFlags flags, int v, int width, std::vector<Run>* runs) {
  for (int u = NextSet(flags.in, 0, width); u < width; u = NextSet(flags.in, u, width)) {
    const int end = u + 1 < width ? NextZero(flags.on, u + 1, width) : width;
    runs->push_back({v, u, end, 0});
    u = end;
  }
}

/// The runs of some neighbouring rows, which one thread finds.
struct Band {
  std::vector<Run> runs;
  std::vector<size_t> row_end;  ///< number of runs up to the end of each row
};

}  // namespace

RunTable::RunTable(int width, int height, const std::function<void(int, RunFlags)>& mark) {
  std::vector<Band> bands(static_cast<size_t>((height + kBandRows - 1) / kBandRows));
  ParallelFor(bands.size(), 1, [&](size_t i) {
    Band& band = bands[i];
    std::vector<uint8_t> flags(2 * static_cast<size_t>(width));
    const int first = static_cast<int>(i) * kBandRows;
    for (int v = first; v < std::min(height, first + kBandRows); ++v) {
      const RunFlags row{flags.data(), flags.data() + width};
      mark(v, row);
      AppendRuns(row, v, width, &band.runs);
      band.row_end.push_back(band.runs.size());
    }
  });
  row_begin_.reserve(static_cast<size_t>(height) + 1);
  for (const Band& band : bands) {
    const size_t before = runs_.size();
    for (const size_t end : band.row_end) row_begin_.push_back(before + end);
    runs_.insert(runs_.end(), band.runs.begin(), band.runs.end());
  }
}

}  // namespace vismap
