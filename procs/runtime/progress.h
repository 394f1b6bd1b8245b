#pragma once

#include <cstdint>
#include <string>

namespace vismap {

/// A line on stderr that shows the progress of long work. Shows nothing when stderr is not a
/// terminal.
class Progress {
 public:
  /// `total` is the number of steps; 0 = unknown.
  Progress(std::string title, int64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Redraws the line, at most ten times a second. `note` is appended to it.
  void Show(int64_t done, const std::string& note = "");

 private:
  std::string title_;
  int64_t total_;
  bool terminal_;
  bool drawn_ = false;
  double last_ = 0;
};

}  // namespace vismap
