#pragma once

#include <cstdint>
#include <string>

namespace vismap {

/// Shows the progress of long work on stderr: on a terminal in one line that is redrawn, elsewhere
/// as a new line every half minute.
class Progress {
 public:
  /// `total` is the number of steps; 0 = unknown.
  Progress(std::string title, int64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows that `done` steps are done, at a limited rate. `note` is appended.
  void Show(int64_t done, const std::string& note = "");

 private:
  std::string Text(int64_t done, const std::string& note) const;

  std::string title_;
  int64_t total_;
  bool terminal_;
  bool drawn_ = false;
  double last_;
};

}  // namespace vismap
