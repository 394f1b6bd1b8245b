#include "runtime/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "base/enum_names.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

enum class Policy { kKeepAll, kDropNewest };

constexpr auto NamesOf(Policy) {
  return std::to_array<EnumName<Policy>>(
      {{"KEEP_ALL", Policy::kKeepAll}, {"DROP_NEWEST", Policy::kDropNewest}});
}

struct Values {
  std::string text = "default";
  int count = 7;
  double ratio = 0.25;
  std::optional<int> maybe;
  std::vector<std::string> list{"a"};
  bool flag = false;
  bool lockstep = false;
  Policy policy = Policy::kKeepAll;
};

CommandLine LineFor(Values* values) {
  CommandLine line("program", "What it does.");
  line.Option("--text", &values->text, "A text");
  line.Option("--count", &values->count, "A count").Range(1, 100);
  line.Option("--ratio", &values->ratio, "A ratio").Positive();
  line.Option("--maybe", &values->maybe, "A number or none").AtLeast(0).Needs("--text");
  line.Option("--list", &values->list, "A list").Excludes("--count");
  line.Flag("--flag", &values->flag, "A flag");
  line.Choice("--mode", &values->lockstep, {{"realtime", false}, {"lockstep", true}}, "A mode");
  line.Choice("--policy", &values->policy, "A policy");
  return line;
}

std::optional<ExitCode> Parse(CommandLine line, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "program");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  return line.Parse(static_cast<int>(argv.size()), argv.data());
}

/// What is printed to stderr on wrong usage; the exit code must be that of wrong usage.
std::string ErrorOf(const std::vector<std::string>& arguments) {
  Values values;
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(Parse(LineFor(&values), arguments), ExitCode::kUsage);
  return ::testing::internal::GetCapturedStderr();
}

std::string Help() {
  Values values;
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(Parse(LineFor(&values), {"--help"}), ExitCode::kOk);
  return ::testing::internal::GetCapturedStdout();
}

TEST(CommandLine, WhatIsGivenGoesToItsVariable) {
  Values values;
  CommandLine line = LineFor(&values);
  ASSERT_EQ(Parse(line, {"--text", "new", "--ratio=2.5", "--maybe", "3", "--list", "b,c", "d",
                         "--flag", "--mode", "lockstep", "--policy", "drop-newest"}),
            std::nullopt);
  EXPECT_EQ(values.text, "default") << "Parse changes nothing";
  line.Apply();
  EXPECT_EQ(values.text, "new");
  EXPECT_EQ(values.ratio, 2.5);
  EXPECT_EQ(values.maybe, 3);
  EXPECT_THAT(values.list, ElementsAre("b", "c", "d"));
  EXPECT_TRUE(values.flag);
  EXPECT_TRUE(values.lockstep);
  EXPECT_EQ(values.policy, Policy::kDropNewest);
  EXPECT_EQ(values.count, 7) << "was not given";
}

TEST(CommandLine, GoesBeforeAFileThatIsReadInBetween) {
  Values values;
  CommandLine line = LineFor(&values);
  ASSERT_EQ(Parse(line, {"--count", "9"}), std::nullopt);
  line.Apply();
  values = {};
  values.count = 50;
  values.text = "of the file";
  line.Apply();
  EXPECT_EQ(values.count, 9);
  EXPECT_EQ(values.text, "of the file");
}

TEST(CommandLine, WrongValuesAreNamedWithWhatIsExpected) {
  EXPECT_THAT(ErrorOf({"--count", "0"}), HasSubstr("--count: expected a number from 1 to 100"));
  EXPECT_THAT(ErrorOf({"--count", "101"}), HasSubstr("found '101'"));
  EXPECT_THAT(ErrorOf({"--count", "many"}), HasSubstr("found 'many'"));
  EXPECT_THAT(ErrorOf({"--count", "2.5"}), HasSubstr("--count"));
  EXPECT_THAT(ErrorOf({"--ratio", "0"}), HasSubstr("a number above 0"));
  EXPECT_THAT(ErrorOf({"--ratio", "nan"}), HasSubstr("a number above 0"));
  EXPECT_THAT(ErrorOf({"--text", "t", "--maybe", "-1"}), HasSubstr("a number of at least 0"));
  EXPECT_THAT(ErrorOf({"--mode", "fast"}), HasSubstr("expected realtime or lockstep"));
  EXPECT_THAT(ErrorOf({"--policy", "KEEP_ALL"}), HasSubstr("expected keep-all or drop-newest"));
  EXPECT_THAT(ErrorOf({"--maybe", "3"}), HasSubstr("--text"));
  EXPECT_THAT(ErrorOf({"--list", "a", "--count", "3"}), HasSubstr("--count"));
  EXPECT_THAT(ErrorOf({"--unknown"}), HasSubstr("--unknown"));
}

TEST(CommandLine, HelpShowsWhatTheVariablesHold) {
  const std::string help = Help();
  EXPECT_THAT(help, HasSubstr("What it does."));
  EXPECT_THAT(help, HasSubstr("A text (default default)"));
  EXPECT_THAT(help, HasSubstr("A count (1 to 100; default 7)"));
  EXPECT_THAT(help, HasSubstr("A ratio (default 0.25)"));
  EXPECT_THAT(help, HasSubstr("A number or none\n"));
  EXPECT_THAT(help, HasSubstr("A mode (default realtime)"));
  EXPECT_THAT(help, HasSubstr("--policy keep-all|drop-newest"));
  EXPECT_THAT(help, Not(HasSubstr("--version"))) << "no version was given";
}

TEST(CommandLine, OneSubcommandIsChosen) {
  for (const std::string name : {"info", "hash"}) {
    std::string map, chosen;
    double timeout = 60;
    CommandLine line("program", "What it does.");
    line.Option("--timeout", &timeout, "Of all subcommands");
    for (const std::string command : {"info", "hash"}) {
      line.Command(command, "A command", [&chosen, command] { chosen = command; })
          .Option("MAP", &map, "A file")
          .Required();
    }
    ASSERT_EQ(Parse(line, {name, "room.vismap", "--timeout", "5"}), std::nullopt);
    line.Apply();
    EXPECT_EQ(chosen, name);
    EXPECT_EQ(map, "room.vismap");
    EXPECT_EQ(timeout, 5);
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(Parse(line, {name}), ExitCode::kUsage);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("MAP is required"));
  }
}

}  // namespace
}  // namespace vismap
