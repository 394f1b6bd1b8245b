#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/raw_bytes.h"
#include "base/result.h"

namespace vismap {

// LCM's tcpq protocol. All numbers have 32 bits and are big-endian. Each side first sends a
// greeting: its magic number and the version of the protocol. Then records follow. A record (1,
// name size, name, data size, data) publishes a message, in both directions. From client to hub,
// (2, size, pattern) subscribes, and (3, size, pattern) cancels a subscription.

/// The magic number in the greeting of each side.
enum class TcpqMagic : uint32_t { kHub = 0x287617fa, kClient = 0x287617fb };
inline constexpr uint32_t kTcpqVersion = 0x0100;

/// A byte string that several queues share.
using RecordBytes = std::shared_ptr<const RawBytes>;

/// One record of the protocol.
struct TcpqRecord {
  enum class Kind { kPublish = 1, kSubscribe = 2, kUnsubscribe = 3 };
  Kind kind = Kind::kPublish;
  std::string name;   ///< channel, or pattern (regular expression)
  RecordBytes bytes;  ///< of kPublish: the whole record, ready to be forwarded

  /// Of kPublish: the message in `bytes`.
  std::span<const uint8_t> data() const {
    return std::span<const uint8_t>(*bytes).subspan(12 + name.size());
  }
};

/// The bytes of a greeting.
std::vector<uint8_t> TcpqHello(TcpqMagic magic);
/// The bytes of a record of kind 2.
std::vector<uint8_t> TcpqSubscribe(const std::string& pattern);
/// The bytes of a record of kind 1 up to its data.
std::vector<uint8_t> TcpqPublishHead(const std::string& channel, size_t data_size);
/// A record of kind 1 with its message.
TcpqRecord TcpqPublish(const std::string& channel, std::span<const uint8_t> data);

/// Reads records from a socket, from any sequence of partial reads. The buffer grows with the bytes
/// that have arrived, not with the size that the sender announces.
class RecordReader {
 public:
  /// `magic` is the magic number that the other side must send.
  RecordReader(TcpqMagic magic, size_t max_message_bytes)
      : magic_(magic), max_message_bytes_(max_message_bytes) {}

  /// Call it when the greeting of the other side has been read already.
  void SkipHello() { Expect(Stage::kHead, 8); }
  bool has_greeting() const { return stage_ != Stage::kHello; }
  /// Whether a part of a record, or of the greeting, has arrived.
  bool has_part() const { return stage_ == Stage::kHello || have_ > 0; }
  size_t buffered_bytes() const { return buffer_.size(); }
  /// How much is still missing of the record, as far as it is known.
  size_t missing_bytes() const { return need_ - have_; }

  /// Reads about `max_bytes` at most from a non-blocking socket and calls `on_record` for each
  /// complete record. Begins no new record after `max_seconds`. Fails when the other side has
  /// closed the connection (message "") and when the bytes violate the protocol.
  Result<void> ReadFrom(int fd, size_t max_bytes, const std::function<void(TcpqRecord)>& on_record,
                        double max_seconds = std::numeric_limits<double>::infinity());

 private:
  enum class Stage { kHello, kHead, kName, kDataSize, kData };
  Result<size_t> ReadSome(int fd, const std::function<void(TcpqRecord)>& on_record);
  Result<void> Advance(const std::function<void(TcpqRecord)>& on_record);
  Result<void> StartName();
  Result<void> StartData();
  void Expect(Stage stage, size_t bytes);
  uint32_t Word(size_t offset) const;
  std::string Name() const;

  TcpqMagic magic_;
  size_t max_message_bytes_;
  Stage stage_ = Stage::kHello;
  RawBytes buffer_;
  size_t largest_ = 0;  // record that arrived completely
  size_t have_ = 0;     // bytes of the current record that have arrived
  size_t need_ = 8;     // bytes needed to finish the current stage
};

}  // namespace vismap
