#include "wire/frame_order.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace vismap {
namespace {

/// A reader that commits every frame as soon as FrameOrder releases it.
struct Committer {
  FrameOrder<int64_t> order{4};
  std::set<FrameKey> committed;
  std::vector<int64_t> sequence;

  void Add(int64_t utime, int64_t after, int camera = 0) {
    order.Add({CameraId{camera}, utime}, after, utime);
    while (const auto next =
               order.Next([&](const FrameKey& key) { return committed.contains(key); })) {
      sequence.push_back(*next);
      committed.insert({CameraId{camera}, *next});
    }
  }
};

using Utimes = std::vector<int64_t>;

TEST(FrameOrder, FramesWithoutPredecessorsKeepTheOrderOfArrival) {
  Committer reader;
  for (const int64_t utime : {3, 1, 2}) reader.Add(utime, -1);
  EXPECT_EQ(reader.sequence, (Utimes{3, 1, 2}));
}

TEST(FrameOrder, FramesWaitForALostPredecessor) {
  Committer reader;
  reader.Add(1, -1);
  reader.Add(3, 2);
  reader.Add(4, 3);
  EXPECT_EQ(reader.sequence, Utimes{1});
  EXPECT_EQ(reader.order.held(), 2U);
  reader.Add(2, -1);
  EXPECT_EQ(reader.sequence, (Utimes{1, 2, 3, 4}));
}

TEST(FrameOrder, RepeatedFrameReplacesThePredecessor) {
  Committer reader;  // it was restarted: the previous one has committed frame 1
  reader.Add(2, 1);
  EXPECT_TRUE(reader.sequence.empty());
  reader.Add(2, -1);
  EXPECT_EQ(reader.sequence, Utimes{2});
}

TEST(FrameOrder, CamerasDoNotWaitForEachOther) {
  Committer reader;
  reader.Add(1, -1, 0);
  reader.Add(2, 1, 1);
  EXPECT_EQ(reader.sequence, Utimes{1}) << "frame 1 of camera 1 has not arrived";
  EXPECT_EQ(reader.order.held(), 1U);
}

TEST(FrameOrder, MemoryIsBounded) {
  FrameOrder<int> order(2);
  EXPECT_TRUE(order.Add({CameraId{0}, 2}, 1, 2));
  EXPECT_TRUE(order.Add({CameraId{0}, 3}, 2, 3));
  EXPECT_FALSE(order.Add({CameraId{0}, 4}, 3, 4));
  EXPECT_TRUE(order.Add({CameraId{0}, 3}, 2, 30)) << "a held frame is replaced";
  EXPECT_EQ(order.held(), 2U);
}

}  // namespace
}  // namespace vismap
