#include "base/digest.h"

#include <xxhash.h>

#include <cstdio>
#include <new>

#include "base/require.h"

namespace vismap {

struct Digest::State {
  XXH3_state_t* xxh = XXH3_createState();
  ~State() { XXH3_freeState(xxh); }
};

Digest::Digest() : state_(std::make_unique<State>()) {
  Require(state_->xxh != nullptr, "no memory for a digest");
  XXH3_128bits_reset(state_->xxh);
}

Digest::~Digest() = default;

void Digest::AddBytes(const void* data, size_t size) {
  XXH3_128bits_update(state_->xxh, data, size);
}

std::string Digest::Hex() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
  char text[33];
  std::snprintf(text, sizeof(text), "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return text;
}

uint64_t Checksum64(std::span<const uint8_t> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

}  // namespace vismap
