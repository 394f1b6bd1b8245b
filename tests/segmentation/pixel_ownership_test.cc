#include "segmentation/pixel_ownership.h"

#include <gtest/gtest.h>

#include "support/random_scenes.h"
#include "support/refine_frames.h"

namespace vismap {
namespace {

using namespace testing_support;

PixelOwnership OwnershipOf(const DetectionSet& set, const RefineOptions& options = {}) {
  return {set, options, kWidth, kHeight};
}

int CountPixels(const PixelOwnership& ownership, DetectionIndex k) {
  int pixels = 0;
  ownership.ForPixelsOf(k, [&](int, int) { ++pixels; });
  return pixels;
}

std::vector<DetectionIndex> Indices(const std::vector<int>& numbers) {
  std::vector<DetectionIndex> indices;
  for (const int number : numbers) indices.push_back(static_cast<DetectionIndex>(number));
  return indices;
}

TEST(PixelOwnership, RanksByScoreThenSmallerMaskThenLowerIndex) {
  const DetectionSet set =
      Set({Rectangle(kCup, 0.5F, 0, 0, 20, 20), Rectangle(kTable, 0.5F, 0, 0, 10, 10),
           Rectangle(kChair, 0.9F, 0, 0, 90, 90), Rectangle(kCup, 0.5F, 100, 0, 20, 20),
           Rectangle(kCup, 0.1F, 0, 0, 5, 5)});
  RefineOptions options;
  options.min_score = 0.2;
  EXPECT_EQ(OwnershipOf(set, options).ranking(), Indices({2, 1, 0, 3}));
}

TEST(PixelOwnership, APixelInTwoMasksBelongsToTheBetterOneUnlessPixelsAreShared) {
  const DetectionSet set =
      Set({Rectangle(kTable, 0.6F, 0, 0, 30, 10), Rectangle(kCup, 0.9F, 20, 0, 30, 10)});
  const PixelOwnership resolved = OwnershipOf(set);
  EXPECT_FALSE(resolved.is_shared());
  EXPECT_EQ(CountPixels(resolved, DetectionIndex{0}), 200);
  EXPECT_EQ(CountPixels(resolved, DetectionIndex{1}), 300);
  RefineOptions options;
  options.resolve_overlaps = false;
  const PixelOwnership shared = OwnershipOf(set, options);
  EXPECT_TRUE(shared.is_shared());
  EXPECT_EQ(CountPixels(shared, DetectionIndex{0}), 300);
  std::vector<DetectionIndex> owners;
  shared.ForOwnersOf(5, 25, [&](DetectionIndex k) { owners.push_back(k); });
  EXPECT_EQ(owners, Indices({1, 0}));
}

TEST(PixelOwnership, DuplicatesAreOneDetectionWithAllTheirPixels) {
  const DetectionSet set =
      Set({Rectangle(kChair, 0.7F, 0, 0, 100, 50), Rectangle(kChair, 0.9F, 0, 10, 100, 50)});
  const PixelOwnership ownership = OwnershipOf(set);
  EXPECT_EQ(ownership.ranking(), Indices({1}));
  EXPECT_EQ(ownership.detection_count(), 2u);
  EXPECT_EQ(CountPixels(ownership, DetectionIndex{1}), 100 * 60);
  EXPECT_TRUE(ownership.MaskOf(DetectionIndex{1}).Contains(5, 50));
}

TEST(PixelOwnership, OtherClassesAndMuchSmallerMasksAreNoDuplicates) {
  const Detection chair = Rectangle(kChair, 0.9F, 0, 0, 100, 100);
  EXPECT_EQ(OwnershipOf(Set({chair, Rectangle(kTable, 0.7F, 0, 0, 100, 90)})).ranking().size(), 2u);
  EXPECT_EQ(OwnershipOf(Set({chair, Rectangle(kChair, 0.7F, 0, 0, 33, 100)})).ranking().size(), 2u);
  EXPECT_EQ(OwnershipOf(Set({chair, Rectangle(kChair, 0.7F, 0, 0, 34, 100)})).ranking().size(), 1u);
}

TEST(PixelOwnership, ADuplicateGetsNoPixelOfTheMaskOfAnotherThing) {
  const DetectionSet set =
      Set({Rectangle(kChair, 0.9F, 0, 0, 100, 100), Rectangle(kChair, 0.8F, 0, 0, 120, 100),
           Rectangle(kCup, 0.3F, 110, 0, 50, 100)});
  const PixelOwnership ownership = OwnershipOf(set);
  EXPECT_EQ(CountPixels(ownership, DetectionIndex{0}), 110 * 100);
  EXPECT_EQ(CountPixels(ownership, DetectionIndex{2}), 50 * 100);
}

TEST(PixelOwnership, AllWaysToAskAgreeOnRandomMasks) {
  RandomNumbers random(1);
  for (int round = 0; round < 20; ++round) {
    std::vector<Detection> detections;
    for (int k = 0; k < 6; ++k) {  // some reach beyond the image
      detections.push_back(Rectangle(random.Chance(0.5) ? kCup : kChair,
                                     static_cast<float>(random.Real(0, 1)), random.Whole(-30, 180),
                                     random.Whole(-30, 130), random.Whole(1, 80),
                                     random.Whole(1, 80)));
    }
    RefineOptions options;
    options.resolve_overlaps = random.Chance(0.5);
    const DetectionSet set = Set(std::move(detections));
    const PixelOwnership ownership = OwnershipOf(set, options);
    for (const DetectionIndex k : ownership.ranking()) {
      Image<uint8_t> visited(kWidth, kHeight), owned(kWidth, kHeight), named(kWidth, kHeight);
      ownership.ForPixelsOf(k, [&](int v, int u) { visited(v, u) = 1; });
      for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < kWidth; ++u) {
          owned(v, u) = ownership.Owns(k, v, u) ? 1 : 0;
          ownership.ForOwnersOf(v, u, [&](DetectionIndex i) { named(v, u) |= i == k ? 1 : 0; });
        }
      }
      EXPECT_TRUE(visited == owned) << "round " << round;
      EXPECT_TRUE(visited == named) << "round " << round;
    }
  }
}

}  // namespace
}  // namespace vismap
