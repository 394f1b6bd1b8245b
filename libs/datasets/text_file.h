#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace vismap {

/// Whole text file; fails naming it. At most 1 GiB.
Result<std::string> ReadTextFile(const std::filesystem::path& path);

/// One line of a text file, cut at blanks and commas.
struct TextLine {
  int number = 0;  ///< from 1, as editors count
  std::vector<std::string_view> words;
};

/// The lines of `text` that are neither blank nor begin with '#'. The words point into `text`.
std::vector<TextLine> SplitLines(std::string_view text);

/// A floating-point number in C syntax whatever the locale; "inf", "nan" and Windows' "-1.#IND" are
/// numbers too (not finite). None when the whole word is not one.
std::optional<double> ParseNumber(std::string_view word);

/// A decimal integer; none when the whole word is not one.
std::optional<int64_t> ParseInteger(std::string_view word);

/// All numbers of a text file; fails naming file, line and word, or when there are not exactly
/// `count` of them.
Result<std::vector<double>> ReadNumbers(const std::filesystem::path& path, size_t count);

/// The 4x4 matrix whose rows follow each other in these 16 numbers.
Eigen::Matrix4d RowMajor4x4(const double* numbers);

/// The digits between `prefix` and `suffix` of a file name, as a number; none when the name is not
/// of this form.
std::optional<int64_t> NumberInName(std::string_view name, std::string_view prefix,
                                    std::string_view suffix);

/// Files named prefix, digits, and one of the suffixes in one folder.
struct NamePattern {
  std::filesystem::path folder;
  std::string prefix;
  std::vector<std::string> suffixes;
};

struct NumberedFile {
  int64_t number = 0;
  std::filesystem::path path;
};

/// All files of a pattern, ascending by their number. Fails when the folder cannot be read or two
/// files have one number.
Result<std::vector<NumberedFile>> ListNumberedFiles(const NamePattern& pattern);

}  // namespace vismap
