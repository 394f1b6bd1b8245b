#include "map_tool/evaluate_program.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "runtime/command_line.h"
#include "runtime/log.h"

namespace vismap {
namespace {

constexpr std::string_view kCommand = "evaluate";

// The place of the command; argc = there is none.
int PlaceOfCommand(int argc, char** argv) {
  int i = 1;
  while (i < argc && argv[i][0] == '-') i += std::strchr(argv[i], '=') == nullptr ? 2 : 1;
  return i < argc ? i : argc;
}

}  // namespace

bool ChoosesEvaluate(int argc, char** argv) {
  const int place = PlaceOfCommand(argc, argv);
  return place < argc && argv[place] == kCommand;
}

int RunEvaluateProgram(int argc, char** argv) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = (self.parent_path() / "vismap-evaluate").string();
  std::vector<char*> arguments(argv, argv + argc);
  arguments.erase(arguments.begin() + PlaceOfCommand(argc, argv));
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
  LogError(program + ": " + std::strerror(errno) +
           "; evaluate is a program of its own: build the target vismap-evaluate");
  return static_cast<int>(ExitCode::kFailed);
}

}  // namespace vismap
