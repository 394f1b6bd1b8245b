#include "geometry/window_moments.h"

#include <cstddef>
#include <cstdlib>

#include "geometry/vector_clones.h"

// Alone in its file: GCC 12 does not vectorise ordinary functions beside cloned ones.

namespace vismap {

VISMAP_VECTOR_CLONES
void AddRow(const SumsRow& row, const uint8_t* reach, int dy, int count, Moments* moments) {
  const float* __restrict rn = row.n, * __restrict rx = row.x, * __restrict rxx = row.xx;
  const float* __restrict rw = row.w, * __restrict rxw = row.xw;
  Moments& __restrict m = *moments;
  const auto y = static_cast<float>(dy);
  const int distance = std::abs(dy);
  for (int i = 0; i < count; ++i) {
    const float in = reach[i] >= distance ? 1.0F : 0.0F;
    const float n = in * rn[i], x = in * rx[i], w = in * rw[i];
    const auto j = static_cast<size_t>(i);
    m.n[j] += n;
    m.x[j] += x;
    m.y[j] += y * n;
    m.xx[j] += in * rxx[i];
    m.xy[j] += y * x;
    m.yy[j] += y * (y * n);
    m.w[j] += w;
    m.xw[j] += in * rxw[i];
    m.yw[j] += y * w;
  }
}

}  // namespace vismap
