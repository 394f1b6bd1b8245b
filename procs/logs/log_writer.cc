#include "logs/log_writer.h"

#include <utility>
#include <vector>

#include "base/require.h"
#include "logs/log_reader.h"

namespace vismap {
namespace {

void Append(uint64_t value, int bytes, std::vector<uint8_t>* head) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
    head->push_back(static_cast<uint8_t>(value >> shift));
}

}  // namespace

Result<LogWriter> LogWriter::Create(const std::filesystem::path& path) {
  Result<PartFile> file = PartFile::Create(path);
  if (!file) return tl::unexpected(file.error());
  return LogWriter(std::move(*file));
}

void LogWriter::Add(int64_t timestamp, const std::string& channel, std::span<const uint8_t> data) {
  Require(!channel.empty() && channel.size() <= kMaxChannelName,
          "a channel name has 1 to 63 characters");
  std::vector<uint8_t> head;
  Append(kLogSyncWord, 4, &head);
  Append(static_cast<uint64_t>(events_++), 8, &head);
  Append(static_cast<uint64_t>(timestamp), 8, &head);
  Append(channel.size(), 4, &head);
  Append(data.size(), 4, &head);
  head.insert(head.end(), channel.begin(), channel.end());
  file_.Write(head);
  file_.Write(data);
}

}  // namespace vismap
