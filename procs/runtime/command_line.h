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

/// The exit code of a program.
enum class ExitCode : int { kOk = 0, kFailed = 1, kUsage = 2, kUnreadable = 3 };

/// One option or positional argument, for setting its conditions. Each function returns the same
/// option.
class CommandLineOption {
 public:
  CommandLineOption& Required();
  CommandLineOption& Range(double least, double most);  ///< including both bounds
  CommandLineOption& AtLeast(double least);
  CommandLineOption& Positive();
  CommandLineOption& OneOf(const std::vector<std::string>& words);
  CommandLineOption& Needs(const std::string& other);     ///< an option that was added before
  CommandLineOption& Excludes(const std::string& other);  ///< an option that was added before

 private:
  friend class CommandLine;
  struct Entry;
  explicit CommandLineOption(Entry* entry) : entry_(entry) {}
  CommandLineOption& Check(std::function<bool(double)> holds, const std::string& expected);

  Entry* entry_;
};

/// The options of a program. Each option is bound to a variable that has the default, which --help
/// shows. Parse only stores the values of the given options; Apply writes them to the variables.
/// Call Apply again after a config file was read into the same variables, so that the command line
/// overrides the file. A copy refers to the same command line. This header hides the library of the
/// parser from the programs.
class CommandLine {
 public:
  /// The variable of an option. A list accepts both "A,B" and "A B".
  using Target = std::variant<std::string*, int*, int64_t*, double*, std::optional<std::string>*,
                              std::optional<int>*, std::optional<double>*,
                              std::vector<std::string>*, std::vector<double>*>;

  /// `program` is the name in the help text, `version` the output of --version; "" = there is no
  /// --version.
  CommandLine(const std::string& program, const std::string& summary,
              const std::string& version = "");

  /// `name` = "--name", or "NAME" for a positional argument.
  CommandLineOption Option(const std::string& name, Target target, const std::string& help);

  /// Adds a flag, which sets `target` to true.
  void Flag(const std::string& name, bool* target, const std::string& help);

  /// Adds an option whose value is one of several words, each of which stands for a value.
  template <typename T>
  CommandLineOption Choice(const std::string& name, T* target,
                           std::vector<std::pair<std::string, T>> choices, const std::string& help);

  /// Adds an option whose value is one of the names of an enum (see EnumName), in lower case.
  template <typename Enum>
  CommandLineOption Choice(const std::string& name, Enum* target, const std::string& help);

  /// Adds a subcommand with its own options. A program with subcommands needs exactly one of them;
  /// Parse calls `chosen` if it is this one.
  CommandLine Command(const std::string& name, const std::string& help,
                      std::function<void()> chosen);

  /// Returns an exit code if the program must end: after --help or --version, or after wrong usage,
  /// which it reports on stderr.
  std::optional<ExitCode> Parse(int argc, char** argv);

  /// Writes the values of the given options to their variables.
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
