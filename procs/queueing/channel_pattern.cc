#include "queueing/channel_pattern.h"

#include <re2/re2.h>

#include <optional>
#include <string_view>
#include <utility>

namespace vismap {
namespace {

constexpr int64_t kMaxMemory = 128 << 10;  // of one expression: its program and its states [bytes]

Result<std::unique_ptr<re2::RE2>> CompileExpression(const std::string& pattern) {
  re2::RE2::Options options;
  options.set_log_errors(false);
  options.set_never_capture(true);
  options.set_max_mem(kMaxMemory);
  auto expression = std::make_unique<re2::RE2>(pattern, options);
  if (!expression->ok()) return Fail(expression->error());
  return expression;
}

bool IsLiteral(std::string_view pattern) {
  return pattern.find_first_of("\\^$.|?*+()[]{}") == std::string_view::npos;
}

// The end of the group that begins at `pattern[0]`, behind its closing bracket; nullopt = it has
// none. Brackets in classes and behind backslashes do not count.
std::optional<size_t> EndOfGroup(std::string_view pattern) {
  int depth = 0;
  bool in_class = false;
  for (size_t i = 0; i < pattern.size(); ++i) {
    const char c = pattern[i];
    if (c == '\\') {
      ++i;
    } else if (in_class) {
      in_class = c != ']';
    } else if (c == '[') {
      in_class = true;
      if (i + 1 < pattern.size() && pattern[i + 1] == '^') ++i;
      if (i + 1 < pattern.size() && pattern[i + 1] == ']') ++i;  // "[]a]" has a bracket in it
    } else if (c == '(') {
      ++depth;
    } else if (c == ')' && --depth == 0) {
      return i + 1;
    }
  }
  return std::nullopt;
}

}  // namespace

ChannelPattern::ChannelPattern() = default;
ChannelPattern::~ChannelPattern() = default;
ChannelPattern::ChannelPattern(ChannelPattern&&) noexcept = default;
ChannelPattern& ChannelPattern::operator=(ChannelPattern&&) noexcept = default;

Result<ChannelPattern> ChannelPattern::Compile(const std::string& pattern) {
  const auto fail = [&](const std::string& reason) {
    return Fail("the pattern '" + pattern.substr(0, 64) + (pattern.size() > 64 ? "...'" : "'") +
                " cannot be used: " + reason);
  };
  if (pattern.size() > kMaxLength) {
    return fail("it has " + std::to_string(pattern.size()) + " characters, at most " +
                std::to_string(kMaxLength) + " are allowed");
  }
  ChannelPattern compiled;
  compiled.text_ = pattern;
  compiled.literal_ = IsLiteral(pattern);
  if (compiled.literal_) return compiled;
  std::string_view rest = pattern;
  while (rest.starts_with('^')) rest.remove_prefix(1);
  while (rest.starts_with("(?!") || rest.starts_with("(?=")) {
    const std::optional<size_t> end = EndOfGroup(rest);
    if (!end) return fail("a bracket is not closed");
    const std::string group = "(?:" + std::string(rest.substr(3, *end - 3));
    Result<std::unique_ptr<re2::RE2>> start = CompileExpression(group);
    if (!start) return fail(start.error().message);
    compiled.lookaheads_.push_back({rest[2] == '!', std::move(*start)});
    rest.remove_prefix(*end);
    while (rest.starts_with('^')) rest.remove_prefix(1);
  }
  if (!compiled.lookaheads_.empty() && EndOfGroup("(" + std::string(rest) + ")") != rest.size() + 2)
    return fail("brackets do not match");
  // A quantifier or an alternative behind a lookahead would belong to the lookahead as well.
  if (!compiled.lookaheads_.empty() && rest.find('|') != std::string_view::npos &&
      !rest.starts_with('('))
    return fail("alternatives behind a lookahead need brackets, as in (?!A)(B|C)");
  Result<std::unique_ptr<re2::RE2>> expression = CompileExpression(std::string(rest));
  if (!expression) return fail(expression.error().message);
  compiled.rest_ = std::move(*expression);
  return compiled;
}

bool ChannelPattern::Matches(const std::string& channel) const {
  if (literal_) return channel == text_;
  for (const Lookahead& lookahead : lookaheads_) {
    const bool found =
        lookahead.start->Match(channel, 0, channel.size(), re2::RE2::ANCHOR_START, nullptr, 0);
    if (found == lookahead.negative) return false;
  }
  return re2::RE2::FullMatch(channel, *rest_);
}

size_t ChannelPattern::bytes() const {
  const size_t expressions = lookaheads_.size() + (rest_ != nullptr ? 1 : 0);
  return sizeof(*this) + text_.size() + expressions * static_cast<size_t>(kMaxMemory);
}

}  // namespace vismap
