#include "runtime/status_message.h"

#include <unistd.h>

#include <fstream>

#include "base/printable.h"
#include "runtime/clock.h"
#include "runtime/version.h"
#include "wire/fingerprint.h"

namespace vismap {

process_status_t MakeStatus(const std::string& process, int64_t start_utime) {
  process_status_t message{};
  message.utime = WallUtime();
  message.process = process;
  message.host = HostName();
  message.pid = getpid();
  message.start_utime = start_utime;
  message.version = Version();
  message.types_fingerprint = TypesFingerprint();
  AddCounter(&message, "memory_bytes", ResidentBytes());
  return message;
}

int64_t ResidentBytes() {
  int64_t all = 0, resident = 0;
  std::ifstream file("/proc/self/statm");  // in pages
  file >> all >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

void AddCounter(process_status_t* message, const std::string& name, int64_t value) {
  message->counter_names.push_back(PrintableText(name, 200));
  message->counter_values.push_back(value);
  message->n_counters = static_cast<int32_t>(message->counter_names.size());
}

std::string HostName() {
  char name[256] = {};
  gethostname(name, sizeof(name) - 1);
  return name;
}

}  // namespace vismap
