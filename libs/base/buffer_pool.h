#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <utility>

namespace vismap {

/// Memory of at least `bytes`, aligned to 64 bytes. Large buffers come from a pool of released
/// ones: a pipeline that makes the same images for every frame soon needs no new memory of the
/// system, whose fresh pages cost more time than most computations on them. Thread-safe; throws
/// std::bad_alloc.
void* AllocateBuffer(size_t bytes);
/// Releases what AllocateBuffer returned for the same `bytes`.
void ReleaseBuffer(void* buffer, size_t bytes) noexcept;

/// Allocator of AllocateBuffer for vectors, mostly of pixels. resize() leaves new elements of a
/// type like float uninitialised instead of filling them with zeros.
template <typename T>
struct PooledAllocator {
  using value_type = T;

  PooledAllocator() = default;
  template <typename U>
  PooledAllocator(const PooledAllocator<U>&) noexcept {}

  T* allocate(size_t count) {
    if (count > std::numeric_limits<size_t>::max() / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(AllocateBuffer(count * sizeof(T)));
  }
  void deallocate(T* buffer, size_t count) noexcept { ReleaseBuffer(buffer, count * sizeof(T)); }

  template <typename U>
  void construct(U* place) noexcept(noexcept(U())) {
    ::new (static_cast<void*>(place)) U;
  }
  template <typename U, typename... Args>
  void construct(U* place, Args&&... args) {
    std::construct_at(place, std::forward<Args>(args)...);
  }

  template <typename U>
  friend bool operator==(const PooledAllocator&, const PooledAllocator<U>&) {
    return true;
  }
};

}  // namespace vismap
