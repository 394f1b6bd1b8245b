#include "process/process_harness.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "runtime/clock.h"

namespace vismap {
namespace {

std::string ReadText(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void Redirect(int fd, const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  dup2(file, fd);
  close(file);
}

/// Moves this thread to a network namespace; sockets that it opens later belong to it.
void EnterNetwork(const std::string& name) {
  if (name.empty()) return;
  const int target = open(("/run/netns/" + name).c_str(), O_RDONLY | O_CLOEXEC);
  if (target < 0 || setns(target, CLONE_NEWNET) != 0) _exit(126);
  close(target);
}

/// Opens a bus in a network namespace; the calling thread stays in its own.
Result<std::unique_ptr<Bus>> OpenBusOn(const Host& host, const std::string& url,
                                       const std::string& channel_prefix) {
  Result<std::unique_ptr<Bus>> bus = Fail("not opened");
  std::thread([&] {
    EnterNetwork(host.network_namespace);
    bus = Bus::Open({url, "test", kProcessDeadline, nullptr, channel_prefix});
  }).join();
  return bus;
}

template <typename Condition>
bool WaitUntil(const Condition& condition, double timeout) {
  const double deadline = MonotonicSeconds() + timeout;
  while (!condition()) {
    if (MonotonicSeconds() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace

ChildProcess::ChildProcess(const std::string& name, const std::vector<std::string>& arguments,
                           const std::filesystem::path& folder, const Host& host)
    : name_(name) {
  static std::atomic<int> count{0};
  const bool ours = name.find('/') == std::string::npos;
  const std::string stem =
      std::filesystem::path(name).filename().string() + "-" + std::to_string(count++);
  out_ = folder / (stem + ".out");
  err_ = folder / (stem + ".err");
  const std::string program = ours ? std::string(VISMAP_BIN_DIR) + "/vismap-" + name : name;
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("cannot fork");
  if (pid_ > 0) return;
  Redirect(STDOUT_FILENO, out_);
  Redirect(STDERR_FILENO, err_);
  EnterNetwork(host.network_namespace);
  execv(program.c_str(), argv.data());
  _exit(127);
}

ChildProcess::~ChildProcess() {
  if (!Running()) return;
  Signal(SIGKILL);
  WaitForExit(10);
}

bool ChildProcess::Running() {
  if (exit_code_) return false;
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) return true;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return false;
}

void ChildProcess::Signal(int number) {
  if (!exit_code_) kill(pid_, number);
}

std::optional<int> ChildProcess::WaitForExit(double timeout) {
  WaitUntil([this] { return !Running(); }, timeout);
  return exit_code_;
}

std::string ChildProcess::StandardOutput() const { return ReadText(out_); }
std::string ChildProcess::StandardError() const { return ReadText(err_); }

ProcessBus::ProcessBus(const std::vector<std::string>& hub_arguments, const Host& host)
    : hub_arguments_(hub_arguments), host_(host) {
  StartHub(host.address + ":0");
  JoinBus();
}

ProcessBus::ProcessBus(const ProcessBus& other, const std::string& channel_prefix)
    : host_(other.host_), url_(other.url_), channel_prefix_(channel_prefix) {
  JoinBus();
}

void ProcessBus::JoinBus() {
  auto bus = OpenBusOn(host_, url_, channel_prefix_);
  if (!bus) throw std::runtime_error(bus.error().message);
  bus_ = std::move(*bus);
  peers_ = std::make_unique<Peers>(bus_.get());
}

void ProcessBus::StartHub(const std::string& listen) {
  std::vector<std::string> arguments = {"--listen", listen};
  arguments.insert(arguments.end(), hub_arguments_.begin(), hub_arguments_.end());
  hub_ = std::make_unique<ChildProcess>("hub", arguments, folder(), host_);
  const bool said = WaitUntil(
      [&] { return hub_->StandardOutput().find('\n') != std::string::npos || !hub_->Running(); },
      kProcessDeadline);
  const std::string output = hub_->StandardOutput();
  if (!said || output.empty())
    throw std::runtime_error("the hub did not start: " + hub_->StandardError());
  url_ = output.substr(0, output.find('\n'));
}

void ProcessBus::StopHub() {
  hub_->Signal(SIGKILL);
  hub_->WaitForExit();
}

void ProcessBus::RestartHub() {
  StopHub();
  StartHub(url_.substr(url_.find("//") + 2));
}

std::unique_ptr<ChildProcess> ProcessBus::Start(const std::string& name,
                                                const std::vector<std::string>& arguments) {
  std::vector<std::string> all = {"--lcm-url", url_};
  if (!channel_prefix_.empty()) all.insert(all.end(), {"--channel-prefix", channel_prefix_});
  all.insert(all.end(), arguments.begin(), arguments.end());
  return std::make_unique<ChildProcess>(name, all, folder(), host_);
}

bool ProcessBus::SpinUntil(const std::function<bool()>& condition) {
  const double deadline = MonotonicSeconds() + kProcessDeadline;
  while (!condition() && MonotonicSeconds() < deadline) bus_->Spin(0.05);
  return condition();
}

bool ProcessBus::WaitForReady(const std::vector<std::string>& processes) {
  return SpinUntil([&] { return peers_->NotReady(processes).empty(); });
}

}  // namespace vismap
