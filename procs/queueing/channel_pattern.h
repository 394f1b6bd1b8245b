#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"

namespace re2 {
class RE2;
}

namespace vismap {

/// A regular expression that, as in LCM's subscriptions, must match the whole name of a channel.
/// Patterns come from clients of the bus, so for every pattern the memory is bounded and the time
/// for matching is linear in the length of the name. A pattern may use the syntax of RE2, and also
/// lookaheads at its start, `(?!A)B` and `(?=A)B`, which are used to exclude channels.
class ChannelPattern {
 public:
  static constexpr size_t kMaxLength = 1024;  ///< longer patterns are rejected [characters]

  /// Fails, naming the pattern and the reason, when it is too long, is not a valid regular
  /// expression, needs too much memory, or has back references or lookaheads that are not at its
  /// start.
  static Result<ChannelPattern> Compile(const std::string& pattern);
  ~ChannelPattern();
  ChannelPattern(ChannelPattern&&) noexcept;
  ChannelPattern& operator=(ChannelPattern&&) noexcept;

  const std::string& text() const { return text_; }
  bool Matches(const std::string& channel) const;
  /// An upper bound of its memory, including what matching allocates later [bytes].
  size_t bytes() const;

 private:
  struct Lookahead {
    bool negative = false;
    std::unique_ptr<re2::RE2> start;  // must match the beginning of the name
  };

  ChannelPattern();

  std::string text_;
  bool literal_ = false;  // matches only `text_`, without an expression
  std::vector<Lookahead> lookaheads_;
  std::unique_ptr<re2::RE2> rest_;
};

}  // namespace vismap
