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

/// A regular expression that must match the whole name of a channel, as LCM's subscriptions have
/// it. Matching takes time linear in the name, and a pattern takes a bounded amount of memory,
/// whatever it is: patterns come from anybody on the bus. Everything that RE2 knows is allowed, and
/// lookaheads at the start, `(?!A)B` and `(?=A)B`, which people write to leave channels out.
class ChannelPattern {
 public:
  static constexpr size_t kMaxLength = 1024;  ///< longer patterns are refused [characters]

  /// Fails with the pattern and the reason when it is too long, is no regular expression, needs too
  /// much memory, or has lookaheads elsewhere or back references.
  static Result<ChannelPattern> Compile(const std::string& pattern);
  ~ChannelPattern();
  ChannelPattern(ChannelPattern&&) noexcept;
  ChannelPattern& operator=(ChannelPattern&&) noexcept;

  const std::string& text() const { return text_; }
  bool Matches(const std::string& channel) const;
  /// An upper bound of the memory that it takes, also later [bytes].
  size_t bytes() const;

 private:
  struct Lookahead {
    bool negative = false;
    std::unique_ptr<re2::RE2> start;  // of the name
  };

  ChannelPattern();

  std::string text_;
  bool literal_ = false;  // matches `text_` alone: needs no expression
  std::vector<Lookahead> lookaheads_;
  std::unique_ptr<re2::RE2> rest_;
};

}  // namespace vismap
