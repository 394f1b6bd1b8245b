#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace CLI {
class App;
}

namespace vismap {

/// What a process answers to its caller.
enum class ExitCode : int { kOk = 0, kFailed = 1, kUsage = 2, kUnreadable = 3 };

/// One option or positional argument, to add what holds for it. Each function returns the same
/// option.
class CommandLineOption {
 public:
  CommandLineOption& Required();
  CommandLineOption& Range(double least, double most);  ///< both bounds are allowed
  CommandLineOption& AtLeast(double least);
  CommandLineOption& Positive();
  CommandLineOption& OneOf(const std::vector<std::string>& words);
  CommandLineOption& Needs(const std::string& other);     ///< another option, defined before
  CommandLineOption& Excludes(const std::string& other);  ///< another option, defined before

 private:
  friend class CommandLine;
  struct Entry;
  explicit CommandLineOption(Entry* entry) : entry_(entry) {}
  CommandLineOption& Check(std::function<bool(double)> holds, const std::string& expected);

  Entry* entry_;
};

/// The options of a program. Each is bound to a variable that holds its default, which --help
/// shows. Parse only keeps the values; Apply writes those that were given to their variables. It
/// may be called again after a config file was read into the same variables: the command line wins.
/// A copy is the same command line. This header keeps the parser's library out of the programs.
class CommandLine {
 public:
  /// Where a value goes. A list takes A,B as well as A B.
  using Target = std::variant<std::string*, int*, int64_t*, double*, std::optional<std::string>*,
                              std::optional<int>*, std::optional<double>*,
                              std::vector<std::string>*, std::vector<double>*>;

  /// `program` = name in the help text; `version` = what --version prints; empty = there is no
  /// --version.
  CommandLine(const std::string& program, const std::string& summary,
              const std::string& version = "");

  /// `name` = "--name", or "NAME" for a positional argument.
  CommandLineOption Option(const std::string& name, Target target, const std::string& help);

  /// True when given.
  void Flag(const std::string& name, bool* target, const std::string& help);

  /// One of some words, each of which stands for a value.
  template <typename T>
  CommandLineOption Choice(const std::string& name, T* target,
                           std::vector<std::pair<std::string, T>> choices, const std::string& help);

  /// One of the names of an enum (see EnumName), in lower case.
  template <typename Enum>
  CommandLineOption Choice(const std::string& name, Enum* target, const std::string& help);

  /// A subcommand with options of its own. Exactly one subcommand must be given then; `chosen` is
  /// called by Parse when it is this one.
  CommandLine Command(const std::string& name, const std::string& help,
                      std::function<void()> chosen);

  /// Returns the exit code if the program is to end here: after --help or --version, or after wrong
  /// usage, which is printed to stderr.
  std::optional<ExitCode> Parse(int argc, char** argv);

  /// Writes the values that were given to their variables.
  void Apply() const;

 private:
  struct Parser;
  CommandLine(std::shared_ptr<Parser> parser, CLI::App* app)
      : parser_(std::move(parser)), app_(app) {}
  CommandLineOption AddChoice(const std::string& name, const std::vector<std::string>& words,
                              std::optional<size_t> preset, std::function<void(size_t)> choose,
                              const std::string& help);

  std::shared_ptr<Parser> parser_;
  CLI::App* app_;  // the program, or one of its subcommands
};

/// "DROP_NEWEST" as a word for the command line: "drop-newest".
std::string WordOf(const std::string& name);

template <typename Enum>
CommandLineOption CommandLine::Choice(const std::string& name, Enum* target,
                                      const std::string& help) {
  std::vector<std::pair<std::string, Enum>> choices;
  for (const auto& [choice, value] : NamesOf(*target)) choices.emplace_back(WordOf(choice), value);
  return Choice(name, target, std::move(choices), help);
}

template <typename T>
CommandLineOption CommandLine::Choice(const std::string& name, T* target,
                                      std::vector<std::pair<std::string, T>> choices,
                                      const std::string& help) {
  std::vector<std::string> words;
  std::optional<size_t> preset;
  for (const auto& [word, value] : choices) {
    if (value == *target) preset = words.size();
    words.push_back(word);
  }
  const auto choose = [target, choices = std::move(choices)](size_t i) {
    *target = choices[i].second;
  };
  return AddChoice(name, words, preset, choose, help);
}

}  // namespace vismap
