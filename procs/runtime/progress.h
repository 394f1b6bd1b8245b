#pragma once

#include <cstdint>
#include <string>

namespace vismap {

/// One line on stderr that shows how far long work has come; nothing when stderr is no terminal.
class Progress {
 public:
  /// `total` = steps of the work; 0 = unknown.
  Progress(std::string title, int64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Redraws the line, at most ten times a second. `note` stands at its end.
  void Show(int64_t done, const std::string& note = "");

 private:
  std::string title_;
  int64_t total_;
  bool terminal_;
  bool drawn_ = false;
  double last_ = 0;
};

}  // namespace vismap
