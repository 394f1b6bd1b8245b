#include "pictures/slice_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "render/palette.h"
#include "render/render_mesh.h"

namespace vismap {
namespace {

constexpr int kLeft = 100, kBottom = 42, kTop = 8, kRight = 24;  // around the cells [px]
constexpr double kTickText = 0.42;
constexpr const char* kAxisNames[] = {"x", "y", "z"};

Rgb8 ColorOf(uint8_t state) {
  return state == static_cast<uint8_t>(CellState::kFree)       ? kFreeColor
         : state == static_cast<uint8_t>(CellState::kOccupied) ? kOccupiedColor
                                                               : kNotSeenColor;
}

/// Rows of a picture between its title and its legend.
int PictureRows(int height) { return height - kTitleRows - LegendRows(height); }
/// Columns and rows of these that are left for cells.
int PlotColumns(int columns) { return std::max(1, columns - kLeft - kRight); }
int PlotRows(int rows) { return std::max(1, rows - kTop - kBottom); }

/// Where the cells of a slice are in the picture.
struct Plot {
  const Slice& slice;
  double scale = 1;       ///< pixels per cell
  int left = 0, top = 0;  ///< corner [px]
  int width = 0, height = 0;

  Plot(const Slice& shown, int picture_width, int picture_height) : slice(shown) {
    const double wide = PlotColumns(picture_width), high = PlotRows(picture_height);
    scale = std::min(wide / slice.width, high / slice.height);
    width = std::max(1, static_cast<int>(scale * slice.width));
    height = std::max(1, static_cast<int>(scale * slice.height));
    left = kLeft + (static_cast<int>(wide) - width) / 2;
    top = kTop + (static_cast<int>(high) - height) / 2;
  }
  int Column(int u) const { return std::min(static_cast<int>(u / scale), slice.width - 1); }
  /// Rows of the slice go up, those of the picture down.
  int Row(int v) const {
    return slice.height - 1 - std::min(static_cast<int>(v / scale), slice.height - 1);
  }
  uint8_t StateAt(int u, int v) const {
    return slice.states[static_cast<size_t>(Row(v)) * static_cast<size_t>(slice.width) +
                        static_cast<size_t>(Column(u))];
  }
  double PixelsPerMetre() const { return scale / slice.cell_m; }
};

// Distances of the picture's pixels from what is occupied in the slice [m], at the size of the
// plot; empty when nothing is occupied.
cv::Mat DistancesOf(const Plot& plot) {
  const Slice& slice = plot.slice;
  cv::Mat passable(slice.height, slice.width, CV_8U);
  bool any = false;
  for (int row = 0; row < slice.height; ++row) {
    for (int column = 0; column < slice.width; ++column) {
      const bool occupied =
          slice.states[static_cast<size_t>(row) * static_cast<size_t>(slice.width) +
                       static_cast<size_t>(column)] == static_cast<uint8_t>(CellState::kOccupied);
      any = any || occupied;
      passable.at<uint8_t>(slice.height - 1 - row, column) = occupied ? 0 : 1;
    }
  }
  if (!any) return {};
  cv::Mat cells, metres;
  cv::distanceTransform(passable, cells, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::resize(cells, metres, {plot.width, plot.height}, 0, 0, cv::INTER_LINEAR);
  return metres * slice.cell_m;
}

int LevelOf(float distance_m, const std::vector<double>& levels) {
  return static_cast<int>(std::count_if(levels.begin(), levels.end(), [&](double level) {
    return static_cast<double>(distance_m) >= level;
  }));
}

void DrawCells(const Plot& plot, const std::vector<double>& contours_m, Image<Rgb8>* picture) {
  const cv::Mat distances = DistancesOf(plot);
  for (int v = 0; v < plot.height; ++v) {
    for (int u = 0; u < plot.width; ++u) {
      const uint8_t state = plot.StateAt(u, v);
      Rgb8& pixel = (*picture)(plot.top + v, plot.left + u);
      pixel = ColorOf(state);
      if (distances.empty() || state != static_cast<uint8_t>(CellState::kFree)) continue;
      const int level = LevelOf(distances.at<float>(v, u), contours_m);
      const int right =
          LevelOf(distances.at<float>(v, std::min(u + 1, plot.width - 1)), contours_m);
      const int below =
          LevelOf(distances.at<float>(std::min(v + 1, plot.height - 1), u), contours_m);
      if (level != right || level != below) pixel = kInk;
    }
  }
}

std::string TickText(double metres, double step) {
  char text[32];
  const int digits = step >= 1 ? 0 : step >= 0.1 ? 1 : 2;
  std::snprintf(text, sizeof text, "%.*f", digits, std::abs(metres) < step / 2 ? 0.0 : metres);
  return text;
}

// Ticks with numbers below and at the left.
void DrawAxes(const Plot& plot, int axis, Image<Rgb8>* picture) {
  const Slice& slice = plot.slice;
  const std::array<int, 2> others = OtherAxes(axis);
  const double scale = plot.PixelsPerMetre(), step = RoundLength(100 / scale);
  const int bottom = plot.top + plot.height;
  const double end_u = slice.origin_m[0] + slice.width * slice.cell_m;
  for (double at = std::ceil(slice.origin_m[0] / step) * step; at <= end_u; at += step) {
    const int u = plot.left + static_cast<int>((at - slice.origin_m[0]) * scale);
    FillBox(u, bottom, 1, 6, kInk, picture);
    const std::string text = TickText(at, step);
    DrawText(text, u - TextWidth(text, kTickText) / 2, bottom + 19, kTickText, kInk, picture);
  }
  const double end_v = slice.origin_m[1] + slice.height * slice.cell_m;
  for (double at = std::ceil(slice.origin_m[1] / step) * step; at <= end_v; at += step) {
    const int v = bottom - 1 - static_cast<int>((at - slice.origin_m[1]) * scale);
    FillBox(plot.left - 6, v, 6, 1, kInk, picture);
    const std::string text = TickText(at, step);
    DrawText(text, plot.left - 10 - TextWidth(text, kTickText), v + 4, kTickText, kInk, picture);
  }
  const std::string u_name = std::string(kAxisNames[others[0]]) + " [m]";
  const std::string v_name = std::string(kAxisNames[others[1]]) + " [m]";
  DrawText(u_name, plot.left + plot.width / 2 - 20, bottom + 36, kTickText, kInk, picture);
  DrawText(v_name, std::max(2, plot.left - kLeft + 4), plot.top + plot.height / 2 + 4, kTickText,
           kInk, picture);
}

LegendEntry StateEntry(const Slice& slice, CellState state, const char* name) {
  const auto cells =
      std::count(slice.states.begin(), slice.states.end(), static_cast<uint8_t>(state));
  char text[80];
  std::snprintf(text, sizeof text, "%s: %.2f m^2", name,
                static_cast<double>(cells) * slice.cell_m * slice.cell_m);
  return {{ColorOf(static_cast<uint8_t>(state))}, text};
}

Caption SliceCaption(const Slice& slice, const std::string& title,
                     const SlicePictureOptions& options) {
  Caption caption;
  caption.title = title;
  caption.legend = {StateEntry(slice, CellState::kFree, "free"),
                    StateEntry(slice, CellState::kOccupied, "occupied"),
                    StateEntry(slice, CellState::kUnknown, "unknown")};
  std::string lines = "lines: ";
  for (const double level : options.contours_m)
    lines += (level == options.contours_m.front() ? "" : ", ") + TickText(level, 0.01);
  if (!options.contours_m.empty())
    caption.legend.push_back({{}, lines + " m from what is occupied in the slice"});
  caption.legend.push_back({{}, "cells of " + MetresText(slice.cell_m)});
  return caption;
}

}  // namespace

double SliceCellFor(const OccupancyMap& map, int axis, const SlicePictureOptions& options) {
  const std::optional<OccupancyBox> known = map.KnownCells();
  if (!known) return 0;
  const std::array<int32_t, 3> size{known->max.x - known->min.x, known->max.y - known->min.y,
                                    known->max.z - known->min.z};
  const std::array<int, 2> others = OtherAxes(axis);
  // Cells are aligned, so there may be one more.
  const auto most = static_cast<int>(kMostSliceSide);
  const int columns = std::min(PlotColumns(options.width), most) - 1;
  const int rows = std::min(PlotRows(PictureRows(options.height)), most) - 1;
  const double wide = size[static_cast<size_t>(others[0])] * 1.0 / columns;
  const double high = size[static_cast<size_t>(others[1])] * 1.0 / rows;
  return std::ceil(std::max({wide, high, 1.0})) * map.cell_size();
}

Image<Rgb8> RenderSlice(const Slice& slice, const SliceQuestion& question, const std::string& title,
                        const SlicePictureOptions& options) {
  Require(options.width >= 320 && options.height >= 240,
          "a picture of a slice has at least 320 x 240 pixels");
  const int rows = PictureRows(options.height);
  Image<Rgb8> picture(options.width, rows, kBackground);
  if (slice.states.empty()) {
    DrawText("nothing is known of the space of this map", kLeft, rows / 2, 0.62, kInk, &picture);
    return WithCaption(picture, {title, {}, {}, 0}, options.height);
  }
  const Plot plot(slice, options.width, rows);
  DrawCells(plot, options.contours_m, &picture);
  DrawAxes(plot, question.axis, &picture);
  Caption caption = SliceCaption(slice, title, options);
  caption.pixels_per_metre = plot.PixelsPerMetre();
  return WithCaption(picture, caption, options.height);
}

}  // namespace vismap
