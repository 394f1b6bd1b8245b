#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace vismap {

/// Bytes on disk in files without a name, which the system removes when the process ends, however
/// it ends. Space is given back in parts of about kPartBytes.
class SpillFile {
 public:
  static constexpr uint32_t kPartBytes = 64 << 20;
  /// Where bytes stand.
  struct Place {
    uint32_t part = 0, offset = 0, size = 0;  ///< size 0 = nothing
  };

  /// `folder` must exist; "" = $TMPDIR, or /var/tmp. Fails, naming the folder, when no file can be
  /// written there.
  static Result<SpillFile> Open(const std::string& folder);
  SpillFile(SpillFile&& other) noexcept;
  SpillFile& operator=(SpillFile&& other) noexcept;
  ~SpillFile();

  /// Fails with the system's reason when the disk is full; what was written before stays.
  Result<Place> Append(std::span<const uint8_t> bytes);
  Result<std::vector<uint8_t>> Read(Place place) const;

  /// Makes the next Append begin a new part, and returns the numbers of all parts so far,
  /// ascending.
  std::vector<uint32_t> CloseParts();
  /// Gives the space of a part back; its places are no longer valid.
  void Drop(uint32_t part);
  uint64_t bytes() const;  ///< of all parts

 private:
  struct Part {
    int fd = -1;
    uint32_t size = 0;
  };
  explicit SpillFile(std::string folder) : folder_(std::move(folder)) {}
  Result<void> BeginPart();

  std::string folder_;
  std::map<uint32_t, Part> parts_;  // by number; the last one is written to
  uint32_t next_ = 0;
  bool closed_ = true;  // the next Append begins a part
};

}  // namespace vismap
