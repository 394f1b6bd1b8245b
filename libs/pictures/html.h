#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "geometry/image.h"

namespace vismap {

/// A text from outside as HTML: one line (PrintableText) in which &, <, >, " and ' are escaped.
std::string Escaped(std::string_view text);
/// The same for several lines, which stay lines.
std::string EscapedLines(std::string_view text);
/// JSON for a <script> element, which no "</script>" in it can end.
std::string ScriptJson(std::string_view json);

/// An HTML table. All texts must have been escaped.
class HtmlTable {
 public:
  explicit HtmlTable(std::vector<std::string> heads) : heads_(std::move(heads)) {}
  /// `attributes` of the row, such as " id=x".
  void Add(std::vector<std::string> cells, const std::string& attributes = "");
  bool empty() const { return rows_.empty(); }
  std::string Html() const;

 private:
  std::vector<std::string> heads_;
  std::string rows_;
};

/// A picture in the page itself.
std::string WebpFigure(const Image<Rgb8>& image, const std::string& caption);
std::string PngFigure(const Image<Rgb8>& image, const std::string& caption);
/// An <img> without caption.
std::string WebpImage(const Image<Rgb8>& image, const std::string& alt);

}  // namespace vismap
