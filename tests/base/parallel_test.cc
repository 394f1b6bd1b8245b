#include "base/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace vismap {
namespace {

TEST(ParallelForGroups, VisitsEveryIndexOnceInGroupsOfThatSize) {
  for (const size_t size : {1, 3, 64}) {
    for (const size_t count : {0, 1, 2, 3, 64, 65, 200}) {
      std::vector<int> visits(count);
      std::vector<size_t> ends(count);
      ParallelForGroups(count, size, [&](size_t from, size_t to) {
        for (size_t i = from; i < to; ++i) ++visits[i];
        ends[from] = to;
      });
      EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), static_cast<long>(count));
      for (size_t from = 0; from < count; from += size)
        EXPECT_EQ(ends[from], std::min(from + size, count)) << size << " of " << count;
    }
  }
}

}  // namespace
}  // namespace vismap
