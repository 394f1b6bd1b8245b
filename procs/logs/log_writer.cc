#include "logs/log_writer.h"

#include <cerrno>
#include <cstring>
#include <system_error>
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
  const std::filesystem::path part = PartOf(path);
  File file(std::fopen(part.c_str(), "wb"));
  if (!file) return Fail(part.string() + ": cannot write: " + std::strerror(errno));
  return LogWriter(path, std::move(file));
}

LogWriter::~LogWriter() {
  if (!file_) return;
  std::error_code ignored;
  std::filesystem::remove(PartOf(path_), ignored);
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
  const bool written =
      std::fwrite(head.data(), 1, head.size(), file_.get()) == head.size() &&
      (data.empty() || std::fwrite(data.data(), 1, data.size(), file_.get()) == data.size());
  if (!written && error_ == 0) error_ = errno;
}

Result<void> LogWriter::Finish() {
  if (std::fflush(file_.get()) != 0 && error_ == 0) error_ = errno;
  const std::filesystem::path part = PartOf(path_);
  if (error_ != 0) return Fail(part.string() + ": cannot write: " + std::strerror(error_));
  std::error_code failed;
  std::filesystem::rename(part, path_, failed);
  if (failed)
    return Fail(path_.string() +
                ": cannot rename the finished log to this name: " + failed.message());
  file_.reset();
  return {};
}

}  // namespace vismap
