#include "render/drawing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "render/palette.h"
#include "render/render_mesh.h"

namespace vismap {
namespace {

constexpr int kMargin = 12;
constexpr int kRow = 22;
constexpr int kScaleWidth = 260;
constexpr double kTextSize = 0.48;
constexpr Rgb8 kFrame{120, 120, 120};

// A view of the pixels of an image for OpenCV's drawing functions.
cv::Mat AsMat(Image<Rgb8>* image) {
  return {image->height(), image->width(), CV_8UC3, image->data()};
}

cv::Scalar ToScalar(Rgb8 color) {
  return {static_cast<double>(color.r), static_cast<double>(color.g), static_cast<double>(color.b)};
}

// OpenCV's lines take fractions of a pixel as whole numbers.
constexpr int kFractionBits = 4;
cv::Point ToPoint(const Eigen::Vector2d& pixel) {
  const auto fixed = [](double value) {
    return static_cast<int>(std::lround(std::clamp(value, -1e5, 1e5) * (1 << kFractionBits)));
  };
  return {fixed(pixel.x()), fixed(pixel.y())};
}

int EntryWidth(const LegendEntry& entry) {
  return static_cast<int>(entry.swatches.size()) * 18 + 8 + TextWidth(entry.text, kTextSize) + 24;
}

void DrawEntry(const LegendEntry& entry, int u, int v, Image<Rgb8>* image) {
  for (const Rgb8 color : entry.swatches) {
    FillBox(u, v + 3, 15, 15, kFrame, image);
    FillBox(u + 1, v + 4, 13, 13, color, image);
    u += 18;
  }
  DrawText(entry.text, u + 6, v + 16, kTextSize, kInk, image);
}

// Writes the entries in columns from (u, v) within `rows` rows up to the column `right`. If not all
// fit, the last line tells how many are missing.
void DrawLegend(const std::vector<LegendEntry>& entries, int u, int v, int right, int rows,
                Image<Rgb8>* image) {
  for (size_t first = 0; first < entries.size(); first += static_cast<size_t>(rows)) {
    const size_t last = std::min(entries.size(), first + static_cast<size_t>(rows));
    int width = 0;
    for (size_t i = first; i < last; ++i) width = std::max(width, EntryWidth(entries[i]));
    if (u + width > right && first > 0) {
      DrawText("+" + std::to_string(entries.size() - first) + " more", u, v + kRow - 6, kTextSize,
               kInk, image);
      return;
    }
    for (size_t i = first; i < last; ++i)
      DrawEntry(entries[i], u, v + static_cast<int>(i - first) * kRow, image);
    u += width;
  }
}

void DrawScale(const ColorScale& scale, int u, int v, Image<Rgb8>* image) {
  DrawText(scale.title, u, v + 14, kTextSize, kInk, image);
  for (int i = 0; i < kScaleWidth; ++i)
    FillBox(u + i, v + kRow, 1, 16, RampColor(i / (kScaleWidth - 1.0)), image);
  DrawText(scale.low, u, v + 2 * kRow + 12, kTextSize, kInk, image);
  DrawText(scale.high, u + kScaleWidth - TextWidth(scale.high, kTextSize), v + 2 * kRow + 12,
           kTextSize, kInk, image);
}

// A bar that ends at the column `right`. Returns where it begins.
int DrawLengthBar(double pixels_per_metre, int right, int v, Image<Rgb8>* image) {
  const double metres = RoundLength(160 / pixels_per_metre);
  const int width = static_cast<int>(std::lround(metres * pixels_per_metre));
  const std::string text = MetresText(metres);
  const int begin = right - std::max(width, TextWidth(text, kTextSize));
  FillBox(begin, v + kRow + 6, width, 3, kInk, image);
  for (const int end : {begin, begin + width - 1}) FillBox(end, v + kRow + 1, 2, 13, kInk, image);
  DrawText(text, begin, v + 14, kTextSize, kInk, image);
  return begin;
}

}  // namespace

void DrawText(const std::string& text, int u, int v, double size, Rgb8 color, Image<Rgb8>* image,
              int thickness) {
  cv::putText(AsMat(image), text, {u, v}, cv::FONT_HERSHEY_SIMPLEX, size, ToScalar(color),
              thickness, cv::LINE_AA);
}

int TextWidth(const std::string& text, double size) {
  int baseline = 0;
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, &baseline).width;
}

void FillBox(int u, int v, int width, int height, Rgb8 color, Image<Rgb8>* image) {
  const int left = std::max(u, 0), right = std::min(u + width, image->width());
  if (left >= right) return;
  for (int row = std::max(v, 0); row < std::min(v + height, image->height()); ++row)
    std::fill(image->row(row) + left, image->row(row) + right, color);
}

void DrawLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Rgb8 color, int thickness,
              Image<Rgb8>* image) {
  if (!from.allFinite() || !to.allFinite()) return;
  cv::line(AsMat(image), ToPoint(from), ToPoint(to), ToScalar(color), thickness, cv::LINE_AA,
           kFractionBits);
}

void DrawDisc(const Eigen::Vector2d& center, int radius, Rgb8 color, Image<Rgb8>* image) {
  if (!center.allFinite()) return;
  cv::circle(AsMat(image), ToPoint(center), radius << kFractionBits, ToScalar(color), cv::FILLED,
             cv::LINE_AA, kFractionBits);
}

void Paste(const Image<Rgb8>& part, int u, int v, Image<Rgb8>* whole) {
  for (int row = 0; row < part.height(); ++row)
    std::copy_n(part.row(row), part.width(), whole->row(v + row) + u);
}

int LegendRows(int height) { return std::max(3, height / 7 / kRow) * kRow + kMargin; }

Image<Rgb8> WithCaption(const Image<Rgb8>& picture, const Caption& caption, int height) {
  Image<Rgb8> whole(picture.width(), height, kBackground);
  Paste(picture, 0, kTitleRows, &whole);
  DrawText(caption.title, kMargin, kTitleRows - 12, 0.62, kInk, &whole);
  const int v = height - LegendRows(height), rows = (LegendRows(height) - kMargin) / kRow;
  int left = kMargin, right = picture.width() - kMargin;
  if (caption.pixels_per_metre > 0)
    right = DrawLengthBar(caption.pixels_per_metre, right, v, &whole) - 2 * kMargin;
  if (caption.scale) {
    DrawScale(*caption.scale, left, v, &whole);
    left += kScaleWidth + 3 * kMargin;
  }
  DrawLegend(caption.legend, left, v, right, rows, &whole);
  return whole;
}

double RoundLength(double longest) {
  if (!(longest > 1e-6) || !std::isfinite(longest)) return 1e-6;
  const double decade = std::pow(10, std::floor(std::log10(longest)));
  const double digit = longest / decade;
  return decade * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

std::string MetresText(double metres) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f", metres);
  std::string digits = text;
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.ends_with('.')) digits.pop_back();
  return (digits == "-0" ? "0" : digits) + " m";
}

}  // namespace vismap
