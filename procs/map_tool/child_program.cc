#include "map_tool/child_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <thread>

extern char** environ;

namespace vismap {
namespace {

Result<pid_t> Start(const std::string& program, const std::vector<std::string>& arguments) {
  std::vector<char*> raw{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) raw.push_back(const_cast<char*>(argument.c_str()));
  raw.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = -1;
  const int error = posix_spawn(&child, program.c_str(), &files, nullptr, raw.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0)
    return Fail(program + " cannot be started: " + std::strerror(error) +
                "; it is a program of its own: build it, or install the whole package");
  return child;
}

// The status of waitpid. Passes a stop on to the child.
int WaitFor(pid_t child, const StopSignal& stop) {
  bool told = false;
  for (;;) {
    int status = 0;
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) return -1;
    if (stop.requested() && !told) told = kill(child, SIGTERM) == 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace

Result<void> RunSibling(const std::string& name, const std::vector<std::string>& arguments,
                        const StopSignal& stop) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = (self.parent_path() / ("vismap-" + name)).string();
  const Result<pid_t> child = Start(program, arguments);
  if (!child) return tl::unexpected(child.error());
  const int status = WaitFor(*child, stop);
  if (stop.requested()) return Fail("stopped while vismap-" + name + " ran");
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  if (WIFEXITED(status))
    return Fail("vismap-" + name + " ended with exit code " + std::to_string(WEXITSTATUS(status)) +
                "; its messages are above");
  return Fail("vismap-" + name + " was ended by signal " + std::to_string(WTERMSIG(status)));
}

}  // namespace vismap
