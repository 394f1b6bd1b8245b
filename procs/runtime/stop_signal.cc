#include "runtime/stop_signal.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>

#include "base/require.h"

namespace vismap {
namespace {

std::atomic<StopSignal*> installed{nullptr};

void OnSignal(int number) {
  const int saved_errno = errno;
  if (StopSignal* stop = installed.load()) {
    if (stop->requested()) {
      signal(number, SIG_DFL);
      raise(number);
    }
    stop->Request();
  }
  errno = saved_errno;
}

}  // namespace

StopSignal::StopSignal() {
  Require(pipe2(pipe_, O_CLOEXEC | O_NONBLOCK) == 0, "a pipe can be made");
}

StopSignal::~StopSignal() {
  StopSignal* self = this;
  installed.compare_exchange_strong(self, nullptr);
  close(pipe_[0]);
  close(pipe_[1]);
}

void StopSignal::Request() {
  if (requested_.exchange(true)) return;
  const char byte = 1;
  // The pipe is empty before, so this cannot fail. It is never read, so that it stays readable.
  [[maybe_unused]] const ssize_t written = write(pipe_[1], &byte, 1);
}

bool StopSignal::WaitFor(double seconds) const {
  pollfd waiting{fd(), POLLIN, 0};
  poll(&waiting, 1, static_cast<int>(seconds * 1000));
  return requested();
}

void StopSignal::InstallHandlers(StopSignal* stop) {
  installed.store(stop);
  // Without SA_RESTART, so that a signal interrupts a blocking send to a hub that no longer reads.
  struct sigaction action = {};
  action.sa_handler = OnSignal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);
  signal(
      SIGXFSZ,
      SIG_IGN);  // exceeding the file size limit makes write() fail instead of ending the process
}

}  // namespace vismap
