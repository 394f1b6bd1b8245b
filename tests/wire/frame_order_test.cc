#include "wire/frame_order.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace vismap {
namespace {

/// A reader that commits every frame as soon as FrameOrder releases it.
struct Committer {
  FrameOrder<int64_t> order;
  std::set<FrameKey> committed;
  std::vector<int64_t> sequence;

  void Add(int64_t utime, int64_t after, int camera = 0) {
    order.Add({CameraId{camera}, utime}, after, utime, 1, 0);
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

/// The frames that are left, in the order in which they leave when all predecessors are committed.
template <typename Frame>
std::vector<Frame> Remaining(FrameOrder<Frame> order) {
  std::vector<Frame> frames;
  while (const auto next = order.Next([](const FrameKey&) { return true; }))
    frames.push_back(*next);
  return frames;
}

TEST(FrameOrder, TheLastFramesOfTheCameraThatHoldsMostAreDroppedFirst) {
  FrameOrder<int> order({.max_frames = 4, .max_bytes = 1000, .max_wait_s = 30});
  const auto add = [&](int camera, int utime, size_t bytes) {
    order.Add({CameraId{camera}, utime}, utime - 1, utime, bytes, 0);
    return order.Trim(0).no_room;
  };
  EXPECT_EQ(add(0, 2, 1), 0);
  for (int utime = 10; utime < 13; ++utime) EXPECT_EQ(add(1, utime, 1), 0);
  EXPECT_EQ(add(1, 13, 1), 1) << "too many frames";
  EXPECT_EQ(add(1, 12, 1), 0) << "a held frame is replaced";
  EXPECT_EQ(add(0, 3, 1), 1);
  EXPECT_EQ(Remaining(order), (std::vector<int>{2, 10, 11, 3}));
  EXPECT_EQ(add(2, 20, 999), 1) << "too many bytes";
  EXPECT_EQ(Remaining(order), (std::vector<int>{2, 10, 11, 3}));
  EXPECT_LE(order.bytes(), 1000u);
}

TEST(FrameOrder, AFrameWhosePredecessorDoesNotComeIsGivenUp) {
  FrameOrder<int> order({.max_frames = 4, .max_bytes = 1000, .max_wait_s = 30});
  order.Add({CameraId{0}, 2}, 1, 2, 10, 0);
  order.Add({CameraId{0}, 3}, 2, 3, 10, 20);
  order.Add({CameraId{0}, 2}, 1, 2, 10, 25);  // sent again: it has waited since 0
  EXPECT_EQ(order.Trim(29).late, 0);
  EXPECT_EQ(order.OldestSeconds(29), 29);
  EXPECT_EQ(order.Trim(31).late, 1);
  EXPECT_EQ(Remaining(order), (std::vector<int>{3}));
}

}  // namespace
}  // namespace vismap
