#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vismap/process_status_t.hpp>

#include "mcap/foxglove_file.h"

namespace vismap {

/// What processes say of themselves: every STATUS as JSON on /status/SOURCE, and a sentence on /log
/// whenever state, message or findings of a process have changed.
class StatusTopics {
 public:
  explicit StatusTopics(FoxgloveFile* file) : file_(*file) {}
  void Write(const process_status_t& status, int64_t log_us);

 private:
  FoxgloveFile& file_;
  std::map<std::string, std::string> last_words_;  // by source
};

}  // namespace vismap
