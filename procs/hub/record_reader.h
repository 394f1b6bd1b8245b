#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"

namespace vismap {

/// Bytes that many clients' queues share.
using SharedBytes = std::shared_ptr<const std::vector<uint8_t>>;

/// One record of LCM's tcpq protocol, as a client sends it.
struct HubRecord {
  enum class Kind { kPublish = 1, kSubscribe = 2, kUnsubscribe = 3 };
  Kind kind = Kind::kPublish;
  std::string name;   ///< channel, or regular expression of channels
  SharedBytes bytes;  ///< of kPublish: the whole record, ready to be passed on
};

/// Puts records together from what arrives on a socket. Memory follows what has arrived, not what a
/// sender claims.
class RecordReader {
 public:
  explicit RecordReader(size_t max_message_bytes) : max_message_bytes_(max_message_bytes) {}

  /// Reads at most about `max_bytes` from a non-blocking socket and calls `on_record` for each
  /// record that is complete. Fails when the connection has ended ("" = in good order) or the bytes
  /// are not the protocol.
  Result<void> ReadFrom(int fd, size_t max_bytes, const std::function<void(HubRecord)>& on_record);

 private:
  enum class Stage { kHello, kHead, kName, kDataSize, kData };
  Result<void> Advance(const std::function<void(HubRecord)>& on_record);
  Result<void> StartName();
  Result<void> StartData();
  void Expect(Stage stage, size_t bytes);
  uint32_t Word(size_t offset) const;
  std::string Name() const;

  size_t max_message_bytes_;
  Stage stage_ = Stage::kHello;
  std::vector<uint8_t> buffer_;
  size_t have_ = 0;
  size_t need_ = 8;
};

}  // namespace vismap
