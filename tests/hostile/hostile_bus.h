#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>
#include <vismap/frame_commit_t.hpp>
#include <vismap/process_status_t.hpp>

#include "base/file.h"
#include "process/process_harness.h"
#include "runtime/clock.h"

namespace vismap::hostile {

/// The most memory that a process has had [MB], or that it has now.
inline int64_t ProcessMegabytes(pid_t pid, const std::string& field = "VmHWM:") {
  std::ifstream file("/proc/" + std::to_string(pid) + "/status");
  for (std::string word; file >> word;) {
    int64_t kilobytes = 0;
    if (word == field && file >> kilobytes) return kilobytes / 1024;
  }
  return -1;
}

/// Expects that a process has never had more memory, and prints how much it had.
inline void ExpectPeakBelow(int64_t megabytes, const std::string& name, pid_t pid) {
  const int64_t peak = ProcessMegabytes(pid);
  std::printf("peak memory of %s: %lld MB, at most %lld MB allowed\n", name.c_str(),
              static_cast<long long>(peak), static_cast<long long>(megabytes));
  EXPECT_LT(peak, megabytes);
}

/// Processes on a bus of their own, and what a test needs to attack them.
class HostileBus : public ::testing::Test {
 protected:
  HostileBus() {
    bus().Subscribe<process_status_t>(kStatusChannel, [this](const process_status_t& status) {
      status_[status.process] = status;
    });
    bus().Subscribe<frame_commit_t>(
        kMapCommitChannel, [this](const frame_commit_t& commit) { commits_.push_back(commit); });
  }

  Bus& bus() { return processes_.bus(); }

  /// Starts a program with the text of a config file, and waits until it is ready.
  std::unique_ptr<ChildProcess> Start(const std::string& name, const std::string& config = "",
                                      std::vector<std::string> arguments = {}) {
    const std::filesystem::path path = processes_.folder() / (name + ".txtpb");
    EXPECT_TRUE(WriteFileAtomically(path, config));
    arguments.insert(arguments.end(), {"--config", path.string()});
    auto process = processes_.Start(name, arguments);
    EXPECT_TRUE(processes_.WaitForReady({name}));
    return process;
  }

  bool SpinUntil(const std::function<bool()>& condition) { return processes_.SpinUntil(condition); }
  /// Handles messages for some time [s].
  void SpinFor(double seconds) {
    for (const double end = MonotonicSeconds() + seconds; MonotonicSeconds() < end;)
      bus().Spin(0.05);
  }

  /// A counter in the latest STATUS of a program.
  int64_t Counter(const std::string& process, const std::string& name) const {
    const auto status = status_.find(process);
    if (status == status_.end()) return 0;
    const std::vector<std::string>& names = status->second.counter_names;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return 0;
    return status->second.counter_values[static_cast<size_t>(found - names.begin())];
  }
  int64_t Commits(int8_t state) const {
    return std::count_if(commits_.begin(), commits_.end(),
                         [&](const frame_commit_t& commit) { return commit.status == state; });
  }

  ProcessBus processes_;
  std::map<std::string, process_status_t> status_;  // by program
  std::vector<frame_commit_t> commits_;
};

}  // namespace vismap::hostile
