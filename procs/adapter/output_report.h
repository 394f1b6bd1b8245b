#pragma once

#include <exception>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "runtime/status.h"

namespace vismap {

/// What the thread that publishes the map for others tells the thread that has the STATUS. All
/// functions may be called from any thread.
class OutputReport {
 public:
  void Count(const std::string& counter);
  void SetCounter(const std::string& counter, int64_t value);
  void AddTiming(const std::string& stage, double ms);
  /// As Status::SetFindings; "" = nothing.
  void SetFinding(const std::string& subject, const std::string& sentence);
  /// The thread has ended with an exception.
  void Fail(std::exception_ptr error);

  /// Hands everything on. Throws what the thread has thrown.
  void MoveTo(Status* status);
  /// The sentences that are reported at present.
  std::vector<std::string> findings() const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, int64_t> counters_;
  std::vector<std::pair<std::string, double>> timings_;
  std::map<std::string, std::string> findings_;  // by subject
  std::exception_ptr error_;
};

}  // namespace vismap
