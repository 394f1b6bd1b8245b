#include "runtime/progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

#include "runtime/clock.h"

namespace vismap {
namespace {

constexpr double kSecondsPerDrawing = 0.1;
constexpr double kSecondsPerLine = 30;

}  // namespace

Progress::Progress(std::string title, int64_t total)
    : title_(std::move(title)),
      total_(total),
      terminal_(isatty(STDERR_FILENO) == 1),
      last_(terminal_ ? 0 : MonotonicSeconds()) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\r\033[K", stderr);  // log lines follow on a clean line
}

std::string Progress::Text(int64_t done, const std::string& note) const {
  std::string text = title_ + ": " + std::to_string(done);
  if (total_ > 0) text += " of " + std::to_string(total_);
  return note.empty() ? text : text + "  " + note;
}

void Progress::Show(int64_t done, const std::string& note) {
  const double now = MonotonicSeconds();
  const bool last_drawing = terminal_ && done == total_;
  if (now - last_ < (terminal_ ? kSecondsPerDrawing : kSecondsPerLine) && !last_drawing) return;
  last_ = now;
  drawn_ = terminal_;
  std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "%s\n", Text(done, note).c_str());
  std::fflush(stderr);
}

}  // namespace vismap
