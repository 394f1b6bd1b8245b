#include "evaluation/xml_labels.h"

#include <algorithm>
#include <array>
#include <utility>

namespace vismap {
namespace {

constexpr std::string_view kBlank = " \t\r\n";
constexpr std::string_view kLabel = "<label";

std::string Unescape(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 5> kEntities{
      {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}}};
  std::string plain;
  while (!text.empty()) {
    const auto* const entity = std::find_if(kEntities.begin(), kEntities.end(), [&](const auto& e) {
      return text.starts_with(e.first);
    });
    plain.push_back(entity == kEntities.end() ? text.front() : entity->second);
    text.remove_prefix(entity == kEntities.end() ? 1 : entity->first.size());
  }
  return plain;
}

void SkipBlanks(std::string_view* text) {
  text->remove_prefix(std::min(text->find_first_not_of(kBlank), text->size()));
}

// Reads NAME="VALUE" at the front of the text and removes it. Returns false if the text does not
// begin with an attribute.
bool ReadAttribute(std::string_view* text, std::map<std::string, std::string>* attributes) {
  const size_t equals = text->find('=');
  if (equals == std::string_view::npos) return false;
  std::string_view key = text->substr(0, equals);
  key = key.substr(0, std::min(key.find_first_of(kBlank), key.size()));
  text->remove_prefix(equals + 1);
  SkipBlanks(text);
  if (key.empty() || text->empty()) return false;
  const char quote = text->front();
  const size_t end = text->find(quote, 1);
  if ((quote != '"' && quote != '\'') || end == std::string_view::npos) return false;
  (*attributes)[std::string(key)] = Unescape(text->substr(1, end - 1));
  text->remove_prefix(end + 1);
  return true;
}

// The length of the comment at the front of the text; 0 if there is none.
size_t CommentSize(std::string_view text) {
  if (!text.starts_with("<!--")) return 0;
  const size_t end = text.find("-->");
  return end == std::string_view::npos ? text.size() : end + 3;
}

}  // namespace

Result<std::vector<std::map<std::string, std::string>>> ParseXmlLabels(std::string_view text,
                                                                       const std::string& name) {
  std::vector<std::map<std::string, std::string>> labels;
  for (size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<')) {
    text.remove_prefix(at);
    const bool is_label = text.starts_with(kLabel) && text.size() > kLabel.size() &&
                          kBlank.find(text[kLabel.size()]) != std::string_view::npos;
    if (!is_label) {
      text.remove_prefix(std::max<size_t>(1, CommentSize(text)));
      continue;
    }
    text.remove_prefix(kLabel.size());
    labels.emplace_back();
    for (SkipBlanks(&text); !text.starts_with('/') && !text.starts_with('>'); SkipBlanks(&text)) {
      const std::string_view attribute = text;
      if (!ReadAttribute(&text, &labels.back())) {
        return Fail(name + ": label element " + std::to_string(labels.size()) +
                    ": expected attributes NAME=\"VALUE\", found '" +
                    std::string(attribute.substr(0, 40)) + "'");
      }
    }
  }
  return labels;
}

}  // namespace vismap
