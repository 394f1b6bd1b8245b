#include "wire/fingerprint.h"

#include <vector>

#include "base/digest.h"
#include "wire/channel_types.h"

namespace vismap {

int64_t TypesFingerprint() {
  std::vector<int64_t> hashes;
  for (const ChannelType& type : ChannelTypes()) hashes.push_back(type.fingerprint);
  return static_cast<int64_t>(Checksum64(
      {reinterpret_cast<const uint8_t*>(hashes.data()), hashes.size() * sizeof(int64_t)}));
}

}  // namespace vismap
