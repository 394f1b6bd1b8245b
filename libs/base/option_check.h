#pragma once

#include <string>
#include <vector>

namespace vismap {

/// Collects what is wrong with the values of an option struct, one sentence each.
class OptionCheck {
 public:
  /// Adds the sentence unless the condition holds.
  void Unless(bool ok, const std::string& sentence);

  /// Adds "KEY must be in [least, most]" unless the value is. NaN never is. `expression` names the
  /// value, for example "options.min_score"; its last word is the key. See VISMAP_CHECK_RANGE.
  void Range(const std::string& expression, double value, double least, double most);

  /// Adds "KEY must be at least LEAST" unless the value is. NaN never is.
  void AtLeast(const std::string& expression, double value, double least);

  /// Adds "KEY must be odd and in [least, most]" unless the value is both.
  void Odd(const std::string& expression, int value, int least, int most);

  /// Adds the problems of a part, each with `prefix` before it.
  void Add(const std::string& prefix, const std::vector<std::string>& problems);

  std::vector<std::string> problems() && { return std::move(problems_); }

 private:
  std::vector<std::string> problems_;
};

/// These write the name of a value once.
#define VISMAP_CHECK_RANGE(check, value, least, most) (check).Range(#value, value, least, most)
#define VISMAP_CHECK_ODD(check, value, least, most) (check).Odd(#value, value, least, most)
#define VISMAP_CHECK_AT_LEAST(check, value, least) (check).AtLeast(#value, value, least)

}  // namespace vismap
