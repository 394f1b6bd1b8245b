#include "runtime/progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

#include "runtime/clock.h"

namespace vismap {

Progress::Progress(std::string title, int64_t total)
    : title_(std::move(title)), total_(total), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\r\033[K", stderr);  // log lines follow on a clean line
}

void Progress::Show(int64_t done, const std::string& note) {
  const double now = MonotonicSeconds();
  if (!terminal_ || (now - last_ < 0.1 && done != total_)) return;
  last_ = now;
  drawn_ = true;
  const std::string of_total = total_ > 0 ? " of " + std::to_string(total_) : "";
  std::fprintf(stderr, "\r\033[K%s: %lld%s  %s", title_.c_str(), static_cast<long long>(done),
               of_total.c_str(), note.c_str());
  std::fflush(stderr);
}

}  // namespace vismap
