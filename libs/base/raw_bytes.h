#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <utility>

namespace vismap {

/// A byte string for messages of megabytes: unlike std::vector, resize() leaves new bytes without a
/// value, since they are overwritten immediately. Throws std::bad_alloc like std::vector.
class RawBytes {
 public:
  RawBytes() = default;
  explicit RawBytes(size_t size) { resize(size); }
  RawBytes(RawBytes&& other) noexcept { swap(other); }
  RawBytes& operator=(RawBytes&& other) noexcept {
    RawBytes moved(std::move(other));
    swap(moved);
    return *this;
  }

  uint8_t* data() { return bytes_.get(); }
  const uint8_t* data() const { return bytes_.get(); }
  size_t size() const { return size_; }
  uint8_t* begin() { return data(); }
  uint8_t* end() { return data() + size_; }
  const uint8_t* begin() const { return data(); }
  const uint8_t* end() const { return data() + size_; }

  void resize(size_t size) {
    if (size > capacity_) reserve(std::max(size, capacity_ + capacity_ / 2));
    size_ = size;
  }
  void reserve(size_t capacity) {
    if (capacity <= capacity_) return;
    void* const larger = std::realloc(bytes_.get(), capacity);
    if (larger == nullptr) throw std::bad_alloc();
    static_cast<void>(bytes_.release());  // realloc has freed or kept it
    bytes_.reset(static_cast<uint8_t*>(larger));
    capacity_ = capacity;
  }
  void append(std::span<const uint8_t> more) {
    const size_t size = size_;
    resize(size + more.size());
    if (!more.empty()) std::memcpy(data() + size, more.data(), more.size());
  }

 private:
  struct Free {
    void operator()(uint8_t* bytes) const { std::free(bytes); }
  };
  void swap(RawBytes& other) noexcept {
    std::swap(bytes_, other.bytes_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  std::unique_ptr<uint8_t[], Free> bytes_;
  size_t size_ = 0, capacity_ = 0;
};

}  // namespace vismap
