#include "runtime/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <concepts>
#include <cstdio>
#include <deque>
#include <type_traits>

namespace vismap {
namespace {

std::string Text(double number) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.10g", number);
  return text;
}

template <std::integral Number>
std::string Text(Number number) {
  return std::to_string(number);
}

std::string Text(const std::string& text) { return text; }

template <typename T>
std::string Text(const std::optional<T>& value) {
  return value ? Text(*value) : "";
}

template <typename T>
std::string Text(const std::vector<T>& list) {
  std::string text;
  for (const T& item : list) text += (text.empty() ? "" : ",") + Text(item);
  return text;
}

template <typename T>
struct Parsed {
  using Type = T;
};
template <typename T>
struct Parsed<std::optional<T>> {
  using Type = T;
};

template <typename T>
constexpr bool kIsList = false;
template <typename T>
constexpr bool kIsList<std::vector<T>> = true;

CLI::Validator Validator(const std::function<bool(const std::string&)>& holds,
                         const std::string& expected) {
  return CLI::Validator(
      [holds, expected](std::string& input) {
        return holds(input) ? "" : "expected " + expected + ", found '" + input + "'";
      },
      "");
}

}  // namespace

struct CommandLineOption::Entry {
  CLI::App* app = nullptr;
  CLI::Option* option = nullptr;
  std::string help, bounds, preset;
  std::function<void()> apply;

  /// The help text, with what is allowed and the default.
  void Describe() const {
    std::string notes = bounds;
    if (!preset.empty()) notes += (notes.empty() ? "default " : "; default ") + preset;
    option->description(notes.empty() ? help : help + " (" + notes + ")");
  }
};

struct CommandLine::Parser {
  CLI::App app;
  std::deque<CommandLineOption::Entry> entries;

  CommandLineOption::Entry* Add(CLI::App* at, CLI::Option* option, const std::string& help,
                                const std::string& preset) {
    CommandLineOption::Entry& entry = entries.emplace_back();
    entry.app = at;
    entry.option = option;
    entry.help = help;
    entry.preset = preset;
    entry.Describe();
    return &entry;
  }
};

CommandLineOption& CommandLineOption::Required() {
  entry_->option->required();
  return *this;
}

CommandLineOption& CommandLineOption::Check(std::function<bool(double)> holds,
                                            const std::string& expected) {
  const auto is_number_that_holds = [holds = std::move(holds)](const std::string& input) {
    double number = 0;
    return CLI::detail::lexical_cast(input, number) && holds(number);
  };
  entry_->option->check(Validator(is_number_that_holds, expected));
  return *this;
}

CommandLineOption& CommandLineOption::Range(double least, double most) {
  entry_->bounds = Text(least) + " to " + Text(most);
  entry_->Describe();
  return Check([=](double x) { return x >= least && x <= most; },
               "a number from " + Text(least) + " to " + Text(most));
}

CommandLineOption& CommandLineOption::AtLeast(double least) {
  return Check([=](double x) { return x >= least; }, "a number of at least " + Text(least));
}

CommandLineOption& CommandLineOption::Positive() {
  return Check([](double x) { return x > 0; }, "a number above 0");
}

CommandLineOption& CommandLineOption::OneOf(const std::vector<std::string>& words) {
  std::string choices, sentence;
  for (size_t i = 0; i < words.size(); ++i) {
    choices += (i == 0 ? "" : "|") + words[i];
    sentence += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  }
  const auto is_one = [words](const std::string& input) {
    return std::find(words.begin(), words.end(), input) != words.end();
  };
  entry_->option->type_name(choices)->check(Validator(is_one, sentence));
  return *this;
}

CommandLineOption& CommandLineOption::Needs(const std::string& other) {
  entry_->option->needs(entry_->app->get_option(other));
  return *this;
}

CommandLineOption& CommandLineOption::Excludes(const std::string& other) {
  entry_->option->excludes(entry_->app->get_option(other));
  return *this;
}

CommandLine::CommandLine(const std::string& program, const std::string& summary,
                         const std::string& version)
    : parser_(std::make_shared<Parser>()), app_(&parser_->app) {
  app_->name(program);
  app_->description(summary);
  if (!version.empty())
    app_->set_version_flag("--version", program + " " + version, "Print the version and exit");
}

CommandLineOption CommandLine::Option(const std::string& name, Target target,
                                      const std::string& help) {
  const auto add = [&](auto* variable) {
    using Variable = std::remove_pointer_t<decltype(variable)>;
    const auto value = std::make_shared<typename Parsed<Variable>::Type>();
    CLI::Option* option = app_->add_option(name, *value);
    if constexpr (kIsList<Variable>) option->delimiter(',');
    CommandLineOption::Entry* entry = parser_->Add(app_, option, help, Text(*variable));
    entry->apply = [variable, value] { *variable = *value; };
    return CommandLineOption(entry);
  };
  return std::visit(add, target);
}

void CommandLine::Flag(const std::string& name, bool* target, const std::string& help) {
  const auto value = std::make_shared<bool>(false);
  CLI::Option* option = app_->add_flag(name, *value);
  parser_->Add(app_, option, help, "")->apply = [target, value] { *target = *value; };
}

CommandLineOption CommandLine::AddChoice(const std::string& name,
                                         const std::vector<std::string>& words,
                                         std::optional<size_t> preset,
                                         std::function<void(size_t)> choose,
                                         const std::string& help) {
  const auto value = std::make_shared<std::string>();
  CLI::Option* option = app_->add_option(name, *value);
  CommandLineOption::Entry* entry = parser_->Add(app_, option, help, preset ? words[*preset] : "");
  entry->apply = [words, value, choose = std::move(choose)] {
    const auto found = std::find(words.begin(), words.end(), *value);
    choose(static_cast<size_t>(found - words.begin()));
  };
  return CommandLineOption(entry).OneOf(words);
}

CommandLine CommandLine::Command(const std::string& name, const std::string& help,
                                 std::function<void()> chosen) {
  parser_->app.require_subcommand(1);
  CLI::App* command = app_->add_subcommand(name, help);
  command->fallthrough();  // the options of the program may come after the subcommand
  command->callback(std::move(chosen));
  return CommandLine(parser_, command);
}

std::string WordOf(const std::string& name) {
  std::string word;
  for (const char c : name)
    word += c == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return word;
}

std::optional<ExitCode> CommandLine::Parse(int argc, char** argv) {
  CLI::App& app = parser_->app;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ExitCode::kOk : ExitCode::kUsage;
  }
  return std::nullopt;
}

void CommandLine::Apply() const {
  for (const CommandLineOption::Entry& entry : parser_->entries) {
    if (entry.option->count() > 0) entry.apply();
  }
}

}  // namespace vismap
