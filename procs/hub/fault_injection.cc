#include "hub/fault_injection.h"

#include <algorithm>
#include <utility>

#include "base/digest.h"
#include "base/random.h"

namespace vismap {
namespace {

constexpr size_t kMaxChannels = 1024;  // bounds the memory, since clients choose the names

}  // namespace

FaultInjection::FaultInjection(FaultOptions options) : options_(std::move(options)) {}

bool FaultInjection::Drops(const std::string& channel) {
  if (options_.drop_fraction <= 0) return false;
  const std::vector<std::string>& only = options_.channels;
  if (!only.empty() && std::find(only.begin(), only.end(), channel) == only.end()) return false;
  if (counts_.size() >= kMaxChannels && !counts_.contains(channel)) return false;
  const uint64_t place = counts_[channel]++;
  const uint64_t name =
      Checksum64({reinterpret_cast<const uint8_t*>(channel.data()), channel.size()});
  const uint64_t key = Mix(Mix(static_cast<uint64_t>(options_.seed), name), place);
  return Uniform(key) < options_.drop_fraction;
}

}  // namespace vismap
