#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <utility>

namespace vismap {

/// Memory of at least `bytes`, aligned to 64. Large buffers come from a pool of those given back,
/// so that a pipeline that makes the same images for every frame asks the system for none once it
/// is warm (a fresh page costs more than what is computed into it). Any thread; throws
/// std::bad_alloc.
void* TakeBuffer(size_t bytes);
/// Gives back what TakeBuffer returned for the same `bytes`.
void ReturnBuffer(void* buffer, size_t bytes) noexcept;

/// Allocator for vectors of pixels and the like, see TakeBuffer. Elements that are not given a
/// value are left as they are where their type allows it: resize() does not fill with zeros.
template <typename T>
struct PooledAllocator {
  using value_type = T;

  PooledAllocator() = default;
  template <typename U>
  PooledAllocator(const PooledAllocator<U>&) noexcept {}

  T* allocate(size_t count) {
    if (count > std::numeric_limits<size_t>::max() / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(TakeBuffer(count * sizeof(T)));
  }
  void deallocate(T* buffer, size_t count) noexcept { ReturnBuffer(buffer, count * sizeof(T)); }

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
