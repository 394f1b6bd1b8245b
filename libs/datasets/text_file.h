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

/// Size of the largest list of images, poses or numbers that is read [bytes]: millions of lines.
inline constexpr uint64_t kMaxTextBytes = uint64_t{1} << 27;

/// Reads a text file. Fails, naming the file, if it cannot be read or is larger than `max_bytes`.
Result<std::string> ReadTextFile(const std::filesystem::path& path,
                                 uint64_t max_bytes = kMaxTextBytes);

/// A line of a text file, split into words at blanks and commas.
struct TextLine {
  int number = 0;  ///< counts from 1
  std::vector<std::string_view> words;
};

/// The lines of a text, without blank lines and lines that begin with '#'. The words point into
/// `text`.
std::vector<TextLine> SplitLines(std::string_view text);

/// An error about a line of a file: `PATH:LINE: expected EXPECTED, found "THE LINE"`.
tl::unexpected<Error> FailAtLine(const std::filesystem::path& path, const TextLine& line,
                                 const std::string& expected);

/// Parses a floating-point number in C syntax, independent of the locale; none if the word is not a
/// number. "inf", "nan" and "-1.#IND" of Windows are numbers that are not finite.
std::optional<double> ParseNumber(std::string_view word);

/// Parses a decimal integer; none if the word is not one.
std::optional<int64_t> ParseInteger(std::string_view word);

/// Reads a text file of exactly `count` numbers. Fails, naming file, line and word, if there is
/// anything else in it, or if the count differs.
Result<std::vector<double>> ReadNumbers(const std::filesystem::path& path, size_t count);

/// The 4x4 matrix with these 16 numbers, row by row.
Eigen::Matrix4d RowMajor4x4(const double* numbers);

/// The number between `prefix` and `suffix` in a file name; none if the name does not have this
/// form.
std::optional<int64_t> NumberInName(std::string_view name, std::string_view prefix,
                                    std::string_view suffix);

/// Describes the files of a folder whose names are the prefix, digits, and one of the suffixes.
struct NamePattern {
  std::filesystem::path folder;
  std::string prefix;
  std::vector<std::string> suffixes;
};

struct NumberedFile {
  int64_t number = 0;
  std::filesystem::path path;
};

/// All files of a pattern, ascending by number. Fails if the folder cannot be read or if two files
/// have the same number.
Result<std::vector<NumberedFile>> ListNumberedFiles(const NamePattern& pattern);

}  // namespace vismap
