#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>

#include "base/require.h"

namespace vismap {

/// Owns a value that copies of the pointer share until one of them changes it: then that one gets a
/// copy of the value. So a whole map is copied in the time that its tables take, and the copy stays
/// as it is while the map changes. Access through a pointer that is const never copies.
///
/// Different threads may use different pointers to one value at the same time.
template <typename T>
class Shared {
  struct Node {
    template <typename... Arguments>
    explicit Node(Arguments&&... arguments) : value(std::forward<Arguments>(arguments)...) {}
    static void* operator new(size_t size) {
      if constexpr (requires { T::operator new(size); }) {
        return T::operator new(size);
      } else {
        return ::operator new(size);
      }
    }
    static void operator delete(void* node) noexcept {
      if constexpr (requires { T::operator delete(node); }) {
        T::operator delete(node);
      } else {
        ::operator delete(node);
      }
    }

    std::atomic<uint32_t> users = 1;
    T value;
  };

 public:
  /// The memory that a value takes with its count of users [bytes].
  static constexpr size_t kBytes = sizeof(Node);

  Shared() = default;
  Shared(std::nullptr_t) {}  // NOLINT: as for other pointers
  /// Takes over the value. Make needs no copy of it.
  Shared(std::unique_ptr<T> value)  // NOLINT: as for other pointers
      : node_(value == nullptr ? nullptr : new Node(std::move(*value))) {}
  template <typename... Arguments>
  static Shared Make(Arguments&&... arguments) {
    Shared made;
    made.node_ = new Node(std::forward<Arguments>(arguments)...);
    return made;
  }

  Shared(const Shared& other) noexcept : node_(other.node_) {
    if (node_ != nullptr) node_->users.fetch_add(1, std::memory_order_relaxed);
  }
  Shared(Shared&& other) noexcept : node_(std::exchange(other.node_, nullptr)) {}
  Shared& operator=(Shared other) noexcept {
    std::swap(node_, other.node_);
    return *this;
  }
  ~Shared() { reset(); }

  void reset() {
    Node* node = std::exchange(node_, nullptr);
    if (node != nullptr && node->users.fetch_sub(1, std::memory_order_acq_rel) == 1) delete node;
  }

  explicit operator bool() const { return node_ != nullptr; }
  friend bool operator==(const Shared& pointer, std::nullptr_t) { return pointer.node_ == nullptr; }

  const T* get() const { return node_ != nullptr ? &node_->value : nullptr; }
  const T& operator*() const { return node_->value; }
  const T* operator->() const { return &node_->value; }

  /// The value to change, of this pointer alone. There must be one.
  T& Own() {
    if (node_->users.load(std::memory_order_acquire) != 1) Copy();
    return node_->value;
  }
  T& operator*() { return Own(); }
  T* operator->() { return &Own(); }

 private:
  void Copy() {
    if constexpr (std::is_copy_constructible_v<T>) {
      *this = Make(std::as_const(node_->value));
    } else {
      Require(false, "values that cannot be copied have one user");
    }
  }

  Node* node_ = nullptr;
};

}  // namespace vismap
