#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace vismap {

// LCM's tcpq protocol. All numbers are 32 bits, big-endian. Each side first sends its magic number
// and the version of the protocol; then records follow: (1, name size, name, data size, data)
// publishes, in both directions; (2, size, pattern) subscribes and (3, size, pattern) takes that
// back, from client to hub.

/// What each side sends first.
enum class TcpqMagic : uint32_t { kHub = 0x287617fa, kClient = 0x287617fb };
inline constexpr uint32_t kTcpqVersion = 0x0100;

/// Bytes that many queues share.
using SharedBytes = std::shared_ptr<const std::vector<uint8_t>>;

/// One record, as it was received.
struct TcpqRecord {
  enum class Kind { kPublish = 1, kSubscribe = 2, kUnsubscribe = 3 };
  Kind kind = Kind::kPublish;
  std::string name;   ///< channel, or regular expression of channels
  SharedBytes bytes;  ///< of kPublish: the whole record, ready to be passed on

  /// Of kPublish: the message in `bytes`.
  std::span<const uint8_t> data() const {
    return std::span<const uint8_t>(*bytes).subspan(12 + name.size());
  }
};

/// The bytes of a greeting.
std::vector<uint8_t> TcpqHello(TcpqMagic magic);
/// The bytes of a record of kind 2 or 3, or, up to where the data begins, of kind 1.
std::vector<uint8_t> TcpqSubscribe(const std::string& pattern);
std::vector<uint8_t> TcpqPublishHead(const std::string& channel, size_t data_size);
/// A record of kind 1 with its message.
TcpqRecord TcpqPublish(const std::string& channel, std::span<const uint8_t> data);

/// Puts records together from what arrives on a socket. Memory follows what has arrived, not what a
/// sender claims.
class RecordReader {
 public:
  /// `magic` = what the other side must send first.
  RecordReader(TcpqMagic magic, size_t max_message_bytes)
      : magic_(magic), max_message_bytes_(max_message_bytes) {}

  /// The greeting of the other side was read elsewhere.
  void SkipHello() { Expect(Stage::kHead, 8); }

  /// Reads at most about `max_bytes` from a non-blocking socket and calls `on_record` for each
  /// record that is complete. Fails when the connection has ended ("" = in good order) or the bytes
  /// are not the protocol.
  Result<void> ReadFrom(int fd, size_t max_bytes, const std::function<void(TcpqRecord)>& on_record);

 private:
  enum class Stage { kHello, kHead, kName, kDataSize, kData };
  Result<void> Advance(const std::function<void(TcpqRecord)>& on_record);
  Result<void> StartName();
  Result<void> StartData();
  void Expect(Stage stage, size_t bytes);
  uint32_t Word(size_t offset) const;
  std::string Name() const;

  TcpqMagic magic_;
  size_t max_message_bytes_;
  Stage stage_ = Stage::kHello;
  std::vector<uint8_t> buffer_;
  size_t have_ = 0;
  size_t need_ = 8;
};

}  // namespace vismap
