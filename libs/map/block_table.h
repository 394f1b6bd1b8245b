#pragma once

#include <tsl/robin_map.h>

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <utility>
#include <vector>

#include "map/block.h"
#include "map/shared.h"

namespace vismap {

/// Holds a value per block. Blocks are stored in cubes of 4x4x4, and only the cubes are hashed:
/// frames use blocks in neighbourhoods, so that neighbours share the cache misses of one look-up.
/// References stay valid until their block is erased or the table is copied. Several threads may
/// read at the same time; nothing may use the table while one changes it.
///
/// A copy takes little time: both tables share the cubes until one of them looks for something to
/// change there, see Shared. One thread may use the copy while another one changes the original.
template <typename Value>
class BlockTable {
  static constexpr int32_t kSide = 4;  // blocks along the edge of a cube: one bit each in a word

  struct Cube {
    uint64_t present = 0;
    std::array<Value, kSide * kSide * kSide> values{};
  };

 public:
  /// Finds the values of many blocks, faster than Find: a block in the same cube as the last one
  /// needs no hashing. While it is in use, no block may be created or erased. One per thread.
  class Reader {
   public:
    explicit Reader(const BlockTable& table) : table_(table) {}
    /// The value of a block, or nullptr when it has none.
    const Value* Find(BlockIndex index) {
      if (const BlockIndex place = CubeOf(index); !(started_ && place == place_)) {
        const auto found = table_.cubes_.find(place);
        cube_ = found != table_.cubes_.end() ? found->second.get() : nullptr;
        place_ = place;
        started_ = true;
      }
      if (cube_ == nullptr) return nullptr;
      const int slot = SlotOf(index);
      return ((cube_->present >> slot) & 1) != 0 ? &cube_->values[At(slot)] : nullptr;
    }

   private:
    const BlockTable& table_;
    BlockIndex place_;
    const Cube* cube_ = nullptr;  // at place_; nullptr = there is none
    bool started_ = false;
  };

  BlockTable() = default;
  BlockTable(const BlockTable&) requires std::copy_constructible<Value>
  = default;
  BlockTable& operator=(const BlockTable&) requires std::copy_constructible<Value>
  = default;
  BlockTable(BlockTable&& other) noexcept
      : cubes_(std::move(other.cubes_)), size_(std::exchange(other.size_, 0)) {}
  BlockTable& operator=(BlockTable&& other) noexcept {
    cubes_ = std::move(other.cubes_);
    size_ = std::exchange(other.size_, 0);
    return *this;
  }
  ~BlockTable() = default;

  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  void Clear() {
    cubes_.clear();
    size_ = 0;
  }

  /// The value of a block, or nullptr when it has none.
  const Value* Find(BlockIndex index) const { return Reader(*this).Find(index); }
  Value* Find(BlockIndex index) {
    const auto found = cubes_.find(CubeOf(index));
    const int slot = SlotOf(index);
    if (found == cubes_.end() || ((std::as_const(found.value())->present >> slot) & 1) == 0)
      return nullptr;
    return &found.value().Own().values[At(slot)];
  }

  /// The value of a block; Value() is added when it has none.
  Value& FindOrCreate(BlockIndex index) {
    auto found = cubes_.find(CubeOf(index));
    if (found == cubes_.end()) found = cubes_.emplace(CubeOf(index), Shared<Cube>::Make()).first;
    Cube& cube = found.value().Own();
    const int slot = SlotOf(index);
    const uint64_t bit = uint64_t{1} << slot;
    size_ += (cube.present & bit) == 0;
    cube.present |= bit;
    return cube.values[At(slot)];
  }

  /// Returns whether there was a value.
  bool Erase(BlockIndex index) {
    const auto found = cubes_.find(CubeOf(index));
    if (found == cubes_.end()) return false;
    Cube& cube = found.value().Own();
    const int slot = SlotOf(index);
    const uint64_t bit = uint64_t{1} << slot;
    if ((cube.present & bit) == 0) return false;
    cube.present &= ~bit;
    cube.values[At(slot)] = Value();
    --size_;
    if (cube.present == 0) cubes_.erase(found);
    return true;
  }

  /// Calls `visit(BlockIndex, const Value&)` for each block, in an order that must not reach an
  /// output.
  template <typename Visit>
  void ForEach(const Visit& visit) const {
    for (const auto& [place, cube] : cubes_) {
      for (uint64_t left = cube->present; left != 0; left &= left - 1) {
        const int slot = std::countr_zero(left);
        visit(BlockIndex{kSide * place.x + (slot >> 4), kSide * place.y + ((slot >> 2) & 3),
                         kSide * place.z + (slot & 3)},
              cube->values[At(slot)]);
      }
    }
  }

  /// All blocks that have a value, in ascending (x, y, z) order.
  std::vector<BlockIndex> SortedIndices() const {
    std::vector<BlockIndex> indices;
    indices.reserve(size_);
    ForEach([&](BlockIndex index, const Value&) { indices.push_back(index); });
    std::sort(indices.begin(), indices.end());
    return indices;
  }

  /// Size of the table [bytes], without memory that values own elsewhere.
  size_t bytes() const {
    return cubes_.size() * sizeof(Cube) + cubes_.bucket_count() * (sizeof(BlockIndex) + 16);
  }

 private:
  static BlockIndex CubeOf(BlockIndex index) { return {index.x >> 2, index.y >> 2, index.z >> 2}; }
  // In ascending order of the blocks.
  static int SlotOf(BlockIndex index) {
    return (index.z & 3) | (index.y & 3) << 2 | (index.x & 3) << 4;
  }
  static size_t At(int slot) { return static_cast<size_t>(slot); }

  tsl::robin_map<BlockIndex, Shared<Cube>, BlockIndexHash> cubes_;
  size_t size_ = 0;
};

}  // namespace vismap
