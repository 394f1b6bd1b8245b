#include "pictures/slice_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "render/palette.h"
#include "render/png.h"
#include "render/render_mesh.h"

namespace vismap {
namespace {

size_t CountColor(const Image<Rgb8>& image, Rgb8 color) {
  return static_cast<size_t>(std::count(image.pixels().begin(), image.pixels().end(), color));
}

// 64 x 32 cells of 5 cm, free but for an occupied column and an unknown stripe of 8 cells.
Slice OneColumn() {
  Slice slice;
  slice.cell_m = 0.05;
  slice.origin_m[0] = -1;
  slice.origin_m[1] = 2;
  slice.width = 64;
  slice.height = 32;
  slice.states.assign(64 * 32, static_cast<uint8_t>(CellState::kFree));
  for (size_t row = 0; row < 32; ++row)
    for (size_t column = 56; column < 64; ++column)
      slice.states[row * 64 + column] = static_cast<uint8_t>(CellState::kUnknown);
  slice.states[16 * 64 + 20] = static_cast<uint8_t>(CellState::kOccupied);
  return slice;
}

Image<Rgb8> Draw(const Slice& slice, const SlicePictureOptions& options) {
  const Image<Rgb8> image = RenderSlice(slice, {}, "slice", options);
  if (const char* folder = std::getenv("VISMAP_PICTURES")) {
    EXPECT_TRUE(WritePng(std::filesystem::path(folder) / "slice.png", image));
  }
  return image;
}

TEST(SlicePicture, StatesHaveTheirShareOfThePicture) {
  const Image<Rgb8> image = Draw(OneColumn(), {.width = 800, .height = 600, .contours_m = {}});
  ASSERT_EQ(image.width(), 800);
  ASSERT_EQ(image.height(), 600);
  const auto free = static_cast<double>(CountColor(image, kFreeColor));
  const auto unknown = static_cast<double>(CountColor(image, kNotSeenColor));
  const auto occupied = static_cast<double>(CountColor(image, kOccupiedColor));
  // The legend has some pixels of each colour, too.
  EXPECT_NEAR(unknown / free, 8.0 / 56, 0.01);
  EXPECT_NEAR(occupied / free, 1.0 / (56 * 32), 0.002);
  EXPECT_GT(free, 800 * 300 * 0.7);
}

TEST(SlicePicture, ContoursAreCirclesAroundWhatIsOccupied) {
  const auto ink = [](std::vector<double> levels) {
    const Image<Rgb8> image =
        Draw(OneColumn(), {.width = 800, .height = 600, .contours_m = std::move(levels)});
    size_t count = 0;
    for (int v = 100; v < 425; ++v)
      for (int u = 130; u < 700; ++u) count += image(v, u) == kInk;
    return static_cast<double>(count);
  };
  const double nothing = ink({}), quarter = ink({0.25}), half = ink({0.5});
  EXPECT_EQ(nothing, 0);
  EXPECT_GT(quarter, 100);
  EXPECT_NEAR(half / quarter, 2, 0.3);
  EXPECT_NEAR(ink({0.25, 0.5}), half + quarter, 0.02 * half);
}

TEST(SlicePicture, FirstAxisGoesRightAndSecondUp) {
  Slice slice = OneColumn();
  const Image<Rgb8> image = Draw(slice, {.width = 800, .height = 600, .contours_m = {}});
  // The unknown stripe is at the right. The occupied cell of row 16 of 32 is below the middle by
  // half a cell, at column 20 of 64.
  double mean_unknown = 0, mean_u = 0, mean_v = 0, found = 0;
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 800; ++u) {
      if (image(v, u) == kNotSeenColor) mean_unknown = u;
      if (!(image(v, u) == kOccupiedColor)) continue;
      mean_u += u;
      mean_v += v;
      ++found;
    }
  }
  ASSERT_GT(found, 20);
  EXPECT_GT(mean_unknown, 600);
  EXPECT_LT(mean_u / found, 400);
  slice.states[16 * 64 + 20] = 1;
  slice.states[30 * 64 + 20] = 2;
  const Image<Rgb8> higher = Draw(slice, {.width = 800, .height = 600, .contours_m = {}});
  int first_row = 0;
  while (std::count(higher.row(first_row), higher.row(first_row) + 800, kOccupiedColor) == 0)
    ++first_row;
  EXPECT_LT(first_row, mean_v / found - 50);
}

TEST(SlicePicture, EmptyAndTinyAndHugeSlices) {
  const Image<Rgb8> empty = Draw({}, {});
  EXPECT_EQ(CountColor(empty, kFreeColor), 0u);
  EXPECT_LT(CountColor(empty, kBackground), empty.size());
  Slice one;
  one.cell_m = 0.01;
  one.width = one.height = 1;
  one.states = {1};
  EXPECT_GT(CountColor(Draw(one, {}), kFreeColor), 10000u);
  Slice wide;
  wide.cell_m = 0.01;
  wide.width = 4096;
  wide.height = 1;
  wide.states.assign(4096, 1);
  EXPECT_GT(CountColor(Draw(wide, {}), kFreeColor), 100u);
}

// A map of 848 layers that are free, and one that is occupied.
OccupancyMap LayersWith(int occupied_layer) {
  OccupancyMap map(0.01);
  for (int block = 0; block < 106; ++block) {
    OccupancyPlanes planes;
    planes.free.fill(~uint64_t{0});
    const int layer = occupied_layer - kBlockSide * block;
    if (layer >= 0 && layer < kBlockSide) {
      planes.free[static_cast<size_t>(layer)] = 0;
      planes.occupied[static_cast<size_t>(layer)] = ~uint64_t{0};
    }
    map.Set({0, 0, block}, BlockOccupancy(planes));
  }
  return map;
}

TEST(SlicePicture, NothingThatIsOneVoxelThickVanishesInATallMap) {
  SlicePictureOptions options;
  options.contours_m.clear();
  for (int layer = 0; layer < 848; ++layer) {
    const OccupancyMap map = LayersWith(layer);
    SliceQuestion question;
    question.axis = 0;
    question.at_m = 0.035;
    question.cell_m = SliceCellFor(map, 0, options);
    const Result<Slice> slice = CutSlice(map, question);
    ASSERT_TRUE(slice);
    const Image<Rgb8> picture = RenderSlice(*slice, question, "a slice", options);
    int rows = 0;
    for (int v = kTitleRows; v < options.height - LegendRows(options.height); ++v)
      for (int u = 0; u < options.width; ++u) rows += picture(v, u) == kOccupiedColor;
    EXPECT_GT(rows, 0) << layer;
  }
}

TEST(SlicePicture, CellsGrowUntilEachHasAPixel) {
  OccupancyMap map(0.01);
  EXPECT_EQ(SliceCellFor(map, 2, {}), 0);
  map.Set({0, 0, 0}, BlockOccupancy(CellState::kFree));
  EXPECT_EQ(SliceCellFor(map, 2, {}), 0.01);
  map.Set({500, 0, 0}, BlockOccupancy(CellState::kFree));  // 4008 cells along x
  EXPECT_NEAR(SliceCellFor(map, 2, {}), 0.03, 1e-9);
  EXPECT_NEAR(SliceCellFor(map, 0, {}), 0.01, 1e-9);
}

}  // namespace
}  // namespace vismap
