#include "pictures/html.h"

#include <span>

#include "base/base64.h"
#include "base/printable.h"
#include "render/png.h"
#include "render/webp.h"

namespace vismap {
namespace {

constexpr int kQuality = 82;              // of pictures with shades
constexpr size_t kLongestLine = 100'000;  // [bytes]

std::string Image64(std::span<const uint8_t> file, const char* type, const std::string& alt) {
  return std::string("<img src=\"data:image/") + type + ";base64," + Base64(file) + "\" alt=\"" +
         alt + "\">";
}

std::string Figure(const std::string& image, const std::string& caption) {
  return "<figure>" + image + "<figcaption>" + caption + "</figcaption></figure>\n";
}

}  // namespace

std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char letter : PrintableText(text, kLongestLine)) {
    switch (letter) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += letter;
    }
  }
  return escaped;
}

std::string EscapedLines(std::string_view text) {
  std::string lines;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    lines += Escaped(text.substr(0, end)) + "\n";
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  }
  return lines;
}

std::string ScriptJson(std::string_view json) {
  std::string safe;
  for (const char letter : json) {
    if (letter == '<') {
      safe += "\\u003c";
    } else {
      safe += letter;
    }
  }
  return safe;
}

void HtmlTable::Add(std::vector<std::string> cells, const std::string& attributes) {
  rows_ += "<tr" + attributes + ">";
  for (const std::string& cell : cells) rows_ += "<td>" + cell + "</td>";
  rows_ += "</tr>\n";
}

std::string HtmlTable::Html() const {
  std::string html = "<div class=\"table\"><table>";
  if (!heads_.empty()) {
    html += "<thead><tr>";
    for (const std::string& head : heads_) html += "<th scope=\"col\">" + head + "</th>";
    html += "</tr></thead>";
  }
  return html + "<tbody>\n" + rows_ + "</tbody></table></div>\n";
}

std::string WebpFigure(const Image<Rgb8>& image, const std::string& caption) {
  return Figure(Image64(EncodeWebp(image, kQuality), "webp", caption), caption);
}

std::string PngFigure(const Image<Rgb8>& image, const std::string& caption) {
  return Figure(Image64(EncodePng(image), "png", caption), caption);
}

std::string WebpImage(const Image<Rgb8>& image, const std::string& alt) {
  return Image64(EncodeWebp(image, kQuality), "webp", alt);
}

}  // namespace vismap
