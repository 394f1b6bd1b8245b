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

/// The longest time that a test waits for an event [s]. It is far more than needed on an idle
/// machine: it only ends a test that has failed.
inline constexpr double kProcessDeadline = 120;

/// A simulated computer: a network namespace, and an address in it.
struct Host {
  std::string network_namespace;  ///< its name, needs root; "" = that of the test
  std::string address = "127.0.0.1";
};

/// A running program of vismap. Its output goes to files. The destructor kills it if it still runs.
class ChildProcess {
 public:
  /// Starts vismap-NAME of this build, or the program at another path. Its output goes to `folder`.
  ChildProcess(const std::string& name, const std::vector<std::string>& arguments,
               const std::filesystem::path& folder, const Host& host = {});
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  bool Running();
  /// Sends a signal; SIGKILL for a crash, SIGTERM for a stop.
  void Signal(int number);
  /// Exit code if it ends within `timeout` [s], 128 + signal if it was killed, nullopt if it still
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

/// A hub on a free port, processes that connect to it, and a bus for the test itself.
class ProcessBus {
 public:
  /// `hub_arguments` are additional arguments of the hub.
  explicit ProcessBus(const std::vector<std::string>& hub_arguments = {}, const Host& host = {});
  /// Joins the hub of another one, which must outlive it. Its programs and its bus use a prefix.
  ProcessBus(const ProcessBus& other, const std::string& channel_prefix);

  /// Starts a program with --lcm-url and these arguments.
  std::unique_ptr<ChildProcess> Start(const std::string& name,
                                      const std::vector<std::string>& arguments = {});
  /// Kills the hub, as in a crash.
  void StopHub();
  /// Kills the hub and starts a new one on the same port.
  void RestartHub();

  const std::string& url() const { return url_; }
  Bus& bus() { return *bus_; }
  const Peers& peers() const { return *peers_; }
  const std::filesystem::path& folder() const { return folder_.path(); }

  /// Handles messages until `condition` is true; returns false after kProcessDeadline.
  bool SpinUntil(const std::function<bool()>& condition);
  /// Waits until all these programs are ready.
  bool WaitForReady(const std::vector<std::string>& processes);

 private:
  void StartHub(const std::string& listen);
  void JoinBus();

  TempFolder folder_;
  std::vector<std::string> hub_arguments_;
  Host host_;
  std::unique_ptr<ChildProcess> hub_;
  std::string url_, channel_prefix_;
  std::unique_ptr<Bus> bus_;
  std::unique_ptr<Peers> peers_;
};

}  // namespace vismap
