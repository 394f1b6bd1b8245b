#include "requests/request_argument.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

#include "base/printable.h"

namespace vismap {
namespace {

constexpr size_t kMostShown = 60;  // of a text that is repeated in an error

std::vector<std::string> SplitAt(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

std::string ListOf(const std::vector<std::string>& keys) {
  std::string list;
  for (const std::string& key : keys) list += (list.empty() ? "" : ", ") + key;
  return list;
}

}  // namespace

Result<RequestArgument> RequestArgument::Read(const std::string& text,
                                              const std::vector<std::string>& known) {
  RequestArgument argument;
  std::string* value = nullptr;
  for (const std::string& part : SplitAt(text, ';')) {
    const size_t equals = part.find('=');
    const std::string key = part.substr(0, equals);
    if (equals == std::string::npos && value != nullptr) {
      *value += ";" + part;
      continue;
    }
    if (equals == std::string::npos || std::find(known.begin(), known.end(), key) == known.end()) {
      return Fail("argument: expected key=value;key=value with the keys " + ListOf(known) +
                  ", found '" + PrintableText(part, kMostShown) + "'");
    }
    if (argument.values_.contains(key)) return Fail("argument: the key " + key + " comes twice");
    value = &argument.values_[key];
    *value = part.substr(equals + 1);
  }
  return argument;
}

std::string RequestArgument::Text(const std::string& key) const {
  const auto found = values_.find(key);
  return found == values_.end() ? "" : found->second;
}

Result<std::vector<double>> RequestArgument::Numbers(const std::string& key, size_t count) const {
  return ReadNumbersOf(key, Text(key), count);
}

Result<double> RequestArgument::Number(const std::string& key, double usual) const {
  if (!Has(key)) return usual;
  const Result<std::vector<double>> numbers = Numbers(key, 1);
  if (!numbers) return tl::unexpected(numbers.error());
  return numbers->front();
}

Result<std::vector<double>> ReadNumbersOf(const std::string& what, const std::string& text,
                                          size_t count) {
  std::vector<double> numbers;
  for (const std::string& word : SplitAt(text, ',')) {
    double number = NAN;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(number)) break;
    numbers.push_back(number);
  }
  if (numbers.size() == count && SplitAt(text, ',').size() == count && !text.ends_with(','))
    return numbers;
  return Fail(what + ": expected " + std::to_string(count) + " finite " +
              (count == 1 ? "number" : "numbers separated by commas") + ", found '" +
              PrintableText(text, kMostShown) + "'");
}

}  // namespace vismap
