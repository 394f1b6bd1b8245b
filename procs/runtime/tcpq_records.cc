#include "runtime/tcpq_records.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/format.h"
#include "runtime/clock.h"
#include "wire/channels.h"

namespace vismap {
namespace {

constexpr uint32_t kMaxPattern = 1024;
// The buffer grows by as much as has arrived, within these limits, so that a client that only
// claims a large message takes little memory [bytes].
constexpr size_t kLeastGrowth = size_t{64} << 10, kMostGrowth = size_t{4} << 20;

void AppendWord(std::vector<uint8_t>* bytes, size_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes->push_back(static_cast<uint8_t>(value >> shift));
}

std::vector<uint8_t> RecordHead(TcpqRecord::Kind kind, const std::string& name) {
  std::vector<uint8_t> bytes;
  AppendWord(&bytes, static_cast<size_t>(kind));
  AppendWord(&bytes, name.size());
  bytes.insert(bytes.end(), name.begin(), name.end());
  return bytes;
}

}  // namespace

std::vector<uint8_t> TcpqHello(TcpqMagic magic) {
  std::vector<uint8_t> bytes;
  AppendWord(&bytes, static_cast<size_t>(magic));
  AppendWord(&bytes, kTcpqVersion);
  return bytes;
}

std::vector<uint8_t> TcpqSubscribe(const std::string& pattern) {
  return RecordHead(TcpqRecord::Kind::kSubscribe, pattern);
}

std::vector<uint8_t> TcpqPublishHead(const std::string& channel, size_t data_size) {
  std::vector<uint8_t> bytes = RecordHead(TcpqRecord::Kind::kPublish, channel);
  AppendWord(&bytes, data_size);
  return bytes;
}

TcpqRecord TcpqPublish(const std::string& channel, std::span<const uint8_t> data) {
  RawBytes bytes;
  bytes.append(TcpqPublishHead(channel, data.size()));
  bytes.append(data);
  return {TcpqRecord::Kind::kPublish, channel, std::make_shared<const RawBytes>(std::move(bytes))};
}

uint32_t RecordReader::Word(size_t offset) const {
  uint32_t word = 0;
  std::memcpy(&word, buffer_.data() + offset, 4);
  return ntohl(word);
}

std::string RecordReader::Name() const {
  return std::string(reinterpret_cast<const char*>(buffer_.data()) + 8, Word(4));
}

void RecordReader::Expect(Stage stage, size_t bytes) {
  stage_ = stage;
  need_ = have_ + bytes;
}

Result<void> RecordReader::ReadFrom(int fd, size_t max_bytes,
                                    const std::function<void(TcpqRecord)>& on_record,
                                    double max_seconds) {
  const double end = MonotonicSeconds() + max_seconds;
  Result<size_t> got = 0;
  size_t taken = 0;
  do {
    got = ReadSome(fd, on_record);
    if (got) taken += *got;
  } while (got && *got > 0 && taken < max_bytes && (have_ > 0 || MonotonicSeconds() < end));
  // LCM's own client sends a message in five small writes and waits for the acknowledgement of
  // each, so acknowledge immediately.
  const int on = 1;
  if (taken > 0) setsockopt(fd, IPPROTO_TCP, TCP_QUICKACK, &on, sizeof(on));
  if (!got) return tl::unexpected(got.error());
  return {};
}

// Reads once from the socket. Returns the number of bytes; 0 = nothing has arrived.
Result<size_t> RecordReader::ReadSome(int fd, const std::function<void(TcpqRecord)>& on_record) {
  const size_t known = std::max(have_, largest_);
  const size_t step = std::min(need_ - have_, std::clamp(known, kLeastGrowth, kMostGrowth));
  if (buffer_.size() < have_ + step) buffer_.resize(have_ + step);
  const ssize_t got = recv(fd, buffer_.data() + have_, step, MSG_DONTWAIT);
  if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return 0;
  // It closed the connection, perhaps before it had read everything.
  if (got == 0 || (got < 0 && errno == ECONNRESET)) return Fail("");
  if (got < 0) return Fail(std::strerror(errno));
  have_ += static_cast<size_t>(got);
  while (have_ == need_) {
    const bool record_ends = stage_ == Stage::kData;
    if (const Result<void> advanced = Advance(on_record); !advanced)
      return tl::unexpected(advanced.error());
    if (record_ends) break;
  }
  return static_cast<size_t>(got);
}

Result<void> RecordReader::Advance(const std::function<void(TcpqRecord)>& on_record) {
  switch (stage_) {
    case Stage::kHello:
      if (Word(0) != static_cast<uint32_t>(magic_) || Word(4) >> 8 != kTcpqVersion >> 8) {
        return Fail("does not use LCM's tcpq protocol");
      }
      have_ = 0;
      Expect(Stage::kHead, 8);
      return {};
    case Stage::kHead:
      return StartName();
    case Stage::kName:
      if (Word(0) == static_cast<uint32_t>(TcpqRecord::Kind::kPublish)) {
        Expect(Stage::kDataSize, 4);
        return {};
      }
      on_record({static_cast<TcpqRecord::Kind>(Word(0)), Name(), nullptr});
      have_ = 0;
      Expect(Stage::kHead, 8);
      return {};
    case Stage::kDataSize:
      return StartData();
    case Stage::kData:
      break;
  }
  TcpqRecord record{TcpqRecord::Kind::kPublish, Name(), nullptr};
  buffer_.resize(have_);
  largest_ = std::max(largest_, have_);
  record.bytes = std::make_shared<const RawBytes>(std::exchange(buffer_, {}));
  on_record(std::move(record));
  have_ = 0;
  Expect(Stage::kHead, 8);
  return {};
}

Result<void> RecordReader::StartName() {
  const uint32_t kind = Word(0);
  const uint32_t size = Word(4);
  if (kind < 1 || kind > 3) return Fail("sent a record of unknown type " + std::to_string(kind));
  if (size < 1 || size > (kind == 1 ? kMaxChannelName : kMaxPattern)) {
    return Fail("sent a channel name of " + std::to_string(size) + " characters");
  }
  Expect(Stage::kName, size);
  return {};
}

Result<void> RecordReader::StartData() {
  const uint32_t size = Word(have_ - 4);
  if (size > max_message_bytes_) {
    return Fail("sent a message of " + FormatBytes(size) + " on " + Name() + "; at most " +
                FormatBytes(max_message_bytes_) + " are allowed");
  }
  Expect(Stage::kData, size);
  // Room without pages; a message as large as one before is not copied while it grows.
  buffer_.reserve(std::min(need_, largest_));
  return {};
}

}  // namespace vismap
