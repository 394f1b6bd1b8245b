#include "allocation_meter.h"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstdint>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define VISMAP_SANITIZED 1
#endif

namespace vismap {
namespace {

std::atomic<bool> measuring{false};
std::atomic<int64_t> held{0};
std::atomic<int64_t> most_held{0};
std::atomic<size_t> largest{0};

template <typename Number>
void RaiseTo(std::atomic<Number>* maximum, Number value) {
  Number before = maximum->load(std::memory_order_relaxed);
  while (before < value && !maximum->compare_exchange_weak(before, value)) {
  }
}

void Gave(size_t size) {
  if (!measuring.load(std::memory_order_relaxed)) return;
  RaiseTo(&largest, size);
  RaiseTo(&most_held, held += static_cast<int64_t>(size));
}

void Took(size_t size) {
  if (measuring.load(std::memory_order_relaxed)) held -= static_cast<int64_t>(size);
}

}  // namespace

void AllocationMeter::Begin() {
  held = 0;
  most_held = 0;
  largest = 0;
  measuring = true;
}

AllocationFigures AllocationMeter::End() {
  measuring = false;
  return {largest, static_cast<size_t>(most_held.load())};
}

}  // namespace vismap

#ifdef VISMAP_SANITIZED

// The sanitizer replaces malloc and calls these two hooks. Debian's GCC lacks their header.
extern "C" size_t __sanitizer_get_allocated_size(const volatile void* memory);
extern "C" void __sanitizer_malloc_hook(const volatile void*, size_t size) { vismap::Gave(size); }
extern "C" void __sanitizer_free_hook(const volatile void* memory) {
  if (memory != nullptr) vismap::Took(__sanitizer_get_allocated_size(memory));
}

#else

// Definitions in the executable replace those of libc for all libraries. The originals in libc are
// available under their second names.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* memory, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
void __libc_free(void* memory);

static void* Counted(void* memory) {
  if (memory != nullptr) vismap::Gave(malloc_usable_size(memory));
  return memory;
}

void* malloc(size_t size) { return Counted(__libc_malloc(size)); }
void* calloc(size_t count, size_t size) { return Counted(__libc_calloc(count, size)); }
void* memalign(size_t alignment, size_t size) { return Counted(__libc_memalign(alignment, size)); }
void* aligned_alloc(size_t alignment, size_t size) {
  return Counted(__libc_memalign(alignment, size));
}
int posix_memalign(void** memory, size_t alignment, size_t size) {
  *memory = Counted(__libc_memalign(alignment, size));
  return *memory == nullptr ? ENOMEM : 0;
}
void* realloc(void* memory, size_t size) {
  const size_t before = memory == nullptr ? 0 : malloc_usable_size(memory);
  void* moved = __libc_realloc(memory, size);
  if (moved == nullptr && size != 0) return nullptr;
  vismap::Took(before);
  return Counted(moved);
}
void free(void* memory) {
  if (memory != nullptr) vismap::Took(malloc_usable_size(memory));
  __libc_free(memory);
}
}

#endif
