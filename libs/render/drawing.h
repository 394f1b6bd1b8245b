#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "geometry/image.h"

namespace vismap {

/// The colour of text and thin lines.
inline constexpr Rgb8 kInk{40, 40, 40};

/// Writes one line of text with its baseline at the pixel (u, v). `size` 1 = letters of about 22
/// pixels. What lies outside of the image is left out, in all functions of this file.
void DrawText(const std::string& text, int u, int v, double size, Rgb8 color, Image<Rgb8>* image,
              int thickness = 1);
/// The width of that text [px].
int TextWidth(const std::string& text, double size);

/// Fills `width` x `height` pixels from the corner (u, v).
void FillBox(int u, int v, int width, int height, Rgb8 color, Image<Rgb8>* image);
/// A smooth line between two pixels (u, v).
void DrawLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Rgb8 color, int thickness,
              Image<Rgb8>* image);
void DrawDisc(const Eigen::Vector2d& center, int radius, Rgb8 color, Image<Rgb8>* image);
/// Copies a picture to the corner (u, v) of a larger one, into which it must fit.
void Paste(const Image<Rgb8>& part, int u, int v, Image<Rgb8>* whole);

/// A line of a legend: a few swatches, then the text.
struct LegendEntry {
  std::vector<Rgb8> swatches;
  std::string text;
};

/// A bar of colours (RampColor) for the values from `low` to `high`.
struct ColorScale {
  std::string title;      ///< what is coloured
  std::string low, high;  ///< the ends, with units
};

/// What stands above and below a picture.
struct Caption {
  std::string title;
  std::vector<LegendEntry> legend;
  std::optional<ColorScale> scale;
  /// Of pictures without perspective: a bar of a round length is drawn. 0 = there is none.
  double pixels_per_metre = 0;
};

inline constexpr int kTitleRows = 36;  ///< above a picture [px]
/// The rows of the caption below a picture, when both together have `height` rows [px].
int LegendRows(int height);

/// The picture with its caption, `height` pixels high in all.
Image<Rgb8> WithCaption(const Image<Rgb8>& picture, const Caption& caption, int height);

/// A length [m] like 0.1, 0.2, 0.5, 1, 2 that is not longer than `longest` [m], but at least 0.4
/// times as long.
double RoundLength(double longest);

/// "1.25 m"; digits that are zero at the end are left out.
std::string MetresText(double metres);

}  // namespace vismap
