#include <mutex>
#include <new>
#include <vector>

#include "map/block.h"
#include "map/map_bytes.h"

namespace vismap {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSlabs = false;  // slabs would hide the use of voxels after their deletion
#else
constexpr bool kSlabs = true;
#endif

constexpr size_t kPerSlab = 64;

// A slot has room for voxels alone or with the count of their users.
constexpr size_t kSlot = Shared<SurfaceVoxels>::kBytes;

class Slabs {
 public:
  void* Allocate() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) AddSlab();
    void* voxels = free_.back();
    free_.pop_back();
    return voxels;
  }
  void Release(void* voxels) noexcept {
    const std::lock_guard lock(mutex_);
    free_.push_back(voxels);  // never allocates, see AddSlab
  }
  size_t free_bytes() {
    const std::lock_guard lock(mutex_);
    return free_.size() * kSlot;
  }

 private:
  void AddSlab() {
    ++slabs_;
    // Room for all voxels of all slabs, so that Release cannot throw.
    free_.reserve(slabs_ * kPerSlab);
    auto* slab = static_cast<std::byte*>(::operator new(kPerSlab* kSlot));
    for (size_t i = kPerSlab; i > 0; --i) free_.push_back(slab + (i - 1) * kSlot);
  }

  std::mutex mutex_;
  std::vector<void*> free_;
  size_t slabs_ = 0;
};

// Never destroyed, since a map of static lifetime may be destroyed last.
Slabs& TheSlabs() {
  static Slabs& slabs = *new Slabs;
  return slabs;
}

}  // namespace

size_t SpareVoxelBytes() { return kSlabs ? TheSlabs().free_bytes() : 0; }

void* SurfaceVoxels::operator new(size_t size) {
  return kSlabs && size <= kSlot ? TheSlabs().Allocate() : ::operator new(size);
}

void SurfaceVoxels::operator delete(void* voxels) noexcept {
  if (kSlabs) {
    TheSlabs().Release(voxels);
  } else {
    ::operator delete(voxels);
  }
}

}  // namespace vismap
