#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/bus.h"
#include "runtime/peers.h"
#include "support/temp_folder.h"

namespace vismap {

/// Longest that a test waits for anything [s]. Far more than needed on an idle machine: tests wait
/// for events, and this only ends a test that has failed.
inline constexpr double kProcessDeadline = 120;

/// A computer, as far as processes can tell: a network namespace, and an address in it.
struct Host {
  std::string network_namespace;  ///< by name, needs root; empty = that of the test
  std::string address = "127.0.0.1";
};

/// One of our programs, running. What it writes goes to files. Killed at the end if it still runs.
class ChildProcess {
 public:
  /// Starts vismap-NAME of this build, or the program of another path. `folder` = where its output
  /// goes.
  ChildProcess(const std::string& name, const std::vector<std::string>& arguments,
               const std::filesystem::path& folder, const Host& host = {});
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  bool Running();
  /// Sends a signal; SIGKILL for a crash, SIGTERM for a stop.
  void Signal(int number);
  /// Exit code when it ends within `timeout` [s]; 128 + signal when killed; none while it still
  /// runs.
  std::optional<int> WaitForExit(double timeout = kProcessDeadline);
  std::string StandardOutput() const;
  std::string StandardError() const;

 private:
  std::string name_;
  std::filesystem::path out_, err_;
  pid_t pid_ = -1;
  std::optional<int> exit_code_;
};

/// A hub of its own on a free port, processes that join it, and a bus for the test itself.
class ProcessBus {
 public:
  /// `hub_arguments` are added to those of the hub.
  explicit ProcessBus(const std::vector<std::string>& hub_arguments = {}, const Host& host = {});

  /// Starts a program with --lcm-url and the arguments.
  std::unique_ptr<ChildProcess> Start(const std::string& name,
                                      const std::vector<std::string>& arguments = {});
  /// Ends the hub as a crash does.
  void StopHub();
  /// The same, and starts another one on the same port.
  void RestartHub();

  const std::string& url() const { return url_; }
  Bus& bus() { return *bus_; }
  const Peers& peers() const { return *peers_; }
  const std::filesystem::path& folder() const { return folder_.path(); }

  /// Handles messages until `condition` holds; false when kProcessDeadline is over.
  bool SpinUntil(const std::function<bool()>& condition);
  /// Waits until all these programs have said that they are ready.
  bool WaitForReady(const std::vector<std::string>& processes);

 private:
  void StartHub(const std::string& listen);

  TempFolder folder_;
  std::vector<std::string> hub_arguments_;
  Host host_;
  std::unique_ptr<ChildProcess> hub_;
  std::string url_;
  std::unique_ptr<Bus> bus_;
  std::unique_ptr<Peers> peers_;
};

}  // namespace vismap
