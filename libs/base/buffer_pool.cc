#include "base/buffer_pool.h"

#include <map>
#include <mutex>
#include <vector>

namespace vismap {
namespace {

constexpr std::align_val_t kAlignment{64};
constexpr size_t kPage = 4096;
constexpr size_t kSmallestPooled = 16 * kPage;  // below it malloc keeps memory by itself
constexpr size_t kMaxPooled = size_t{256} << 20;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kPools = false;  // a pool would hide the use of released buffers
#else
constexpr bool kPools = true;
#endif

// Sizes are rounded up to pages, so that images of one size share a list.
size_t Rounded(size_t bytes) { return (bytes + kPage - 1) / kPage * kPage; }
bool IsPooled(size_t bytes) { return kPools && bytes >= kSmallestPooled; }

class Pool {
 public:
  /// nullptr when the pool has no buffer of this size.
  void* Pop(size_t bytes) {
    const std::lock_guard lock(mutex_);
    const auto found = free_.find(bytes);
    if (found == free_.end() || found->second.empty()) return nullptr;
    void* buffer = found->second.back();
    found->second.pop_back();
    held_ -= bytes;
    return buffer;
  }
  /// False when the pool is full; the caller then still owns the buffer.
  bool Push(void* buffer, size_t bytes) noexcept {
    const std::lock_guard lock(mutex_);
    if (held_ + bytes > kMaxPooled) return false;
    try {
      free_[bytes].push_back(buffer);
    } catch (const std::bad_alloc&) {
      return false;
    }
    held_ += bytes;
    return true;
  }

 private:
  std::mutex mutex_;
  std::map<size_t, std::vector<void*>> free_;  // by size
  size_t held_ = 0;
};

// Never destroyed, since an image of static lifetime may be destroyed last.
Pool& ThePool() {
  static Pool& pool = *new Pool;
  return pool;
}

}  // namespace

void* AllocateBuffer(size_t bytes) {
  if (!IsPooled(bytes)) return ::operator new(bytes, kAlignment);
  const size_t rounded = Rounded(bytes);
  void* buffer = ThePool().Pop(rounded);
  return buffer != nullptr ? buffer : ::operator new(rounded, kAlignment);
}

void ReleaseBuffer(void* buffer, size_t bytes) noexcept {
  if (IsPooled(bytes) && ThePool().Push(buffer, Rounded(bytes))) return;
  ::operator delete(buffer, kAlignment);
}

}  // namespace vismap
