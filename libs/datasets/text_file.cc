#include "datasets/text_file.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <system_error>

#include "base/byte_order_mark.h"
#include "base/file.h"

namespace vismap {
namespace {

constexpr std::string_view kBlanks = " \t\r,";

std::vector<std::string_view> SplitWords(std::string_view line) {
  std::vector<std::string_view> words;
  for (size_t begin = line.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
  return words;
}

}  // namespace

Result<std::string> ReadTextFile(const std::filesystem::path& path, uint64_t max_bytes) {
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, max_bytes);
  if (!bytes) return Fail(bytes.error().message);
  const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    return Fail(path.string() + ": the text is UTF-16; save it as UTF-8");
  return std::string(WithoutByteOrderMark(text));
}

std::vector<TextLine> SplitLines(std::string_view text) {
  std::vector<TextLine> lines;
  for (int number = 1; !text.empty(); ++number) {
    const size_t end = std::min(text.find('\n'), text.size());
    TextLine line{number, SplitWords(text.substr(0, end))};
    if (!line.words.empty() && line.words[0][0] != '#') lines.push_back(std::move(line));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

tl::unexpected<Error> FailAtLine(const std::filesystem::path& path, const TextLine& line,
                                 const std::string& expected) {
  const char* begin = line.words.front().data();
  const char* end = line.words.back().data() + line.words.back().size();
  const std::string_view found(begin, static_cast<size_t>(end - begin));
  return Fail(path.string() + ":" + std::to_string(line.number) + ": expected " + expected +
              ", found \"" + std::string(found.substr(0, 80)) + "\"");
}

std::optional<double> ParseNumber(std::string_view word) {
  // The C library of older Windows, on which 7-Scenes was recorded, prints NaN and infinity like
  // "-1.#IND".
  if (word.find(".#") != std::string_view::npos) return std::numeric_limits<double>::quiet_NaN();
  if (word.starts_with('+')) word.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error == std::errc::result_out_of_range) return std::nullopt;
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

std::optional<int64_t> ParseInteger(std::string_view word) {
  int64_t number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

Result<std::vector<double>> ReadNumbers(const std::filesystem::path& path, size_t count) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error().message);
  std::vector<double> numbers;
  for (const TextLine& line : SplitLines(*text)) {
    for (const std::string_view word : line.words) {
      const std::optional<double> number = ParseNumber(word);
      if (!number) {
        return Fail(path.string() + ":" + std::to_string(line.number) +
                    ": expected a number, found \"" + std::string(word.substr(0, 40)) + "\"");
      }
      numbers.push_back(*number);
    }
  }
  if (numbers.size() != count) {
    return Fail(path.string() + ": expected " + std::to_string(count) + " numbers, found " +
                std::to_string(numbers.size()));
  }
  return numbers;
}

Eigen::Matrix4d RowMajor4x4(const double* numbers) {
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers);
}

std::optional<int64_t> NumberInName(std::string_view name, std::string_view prefix,
                                    std::string_view suffix) {
  if (name.size() <= prefix.size() + suffix.size() || !name.starts_with(prefix) ||
      !name.ends_with(suffix)) {
    return std::nullopt;
  }
  const std::string_view digits =
      name.substr(prefix.size(), name.size() - prefix.size() - suffix.size());
  if (!std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; })) {
    return std::nullopt;
  }
  return ParseInteger(digits);
}

Result<std::vector<NumberedFile>> ListNumberedFiles(const NamePattern& pattern) {
  std::vector<NumberedFile> files;
  std::error_code error;
  std::filesystem::directory_iterator entry(pattern.folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    for (const std::string& suffix : pattern.suffixes) {
      const auto number = NumberInName(name, pattern.prefix, suffix);
      if (number) files.push_back({*number, entry->path()});
    }
  }
  if (error)
    return Fail(pattern.folder.string() + ": the folder cannot be listed: " + error.message());
  std::sort(files.begin(), files.end(),
            [](const NumberedFile& a, const NumberedFile& b) { return a.number < b.number; });
  const auto twice = std::adjacent_find(
      files.begin(), files.end(),
      [](const NumberedFile& a, const NumberedFile& b) { return a.number == b.number; });
  if (twice != files.end()) {
    return Fail(pattern.folder.string() + ": expected one file " + pattern.prefix + "N" +
                pattern.suffixes[0] + " per number, but two files have number " +
                std::to_string(twice->number));
  }
  return files;
}

}  // namespace vismap
