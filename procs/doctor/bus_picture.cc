#include "doctor/bus_picture.h"

#include <algorithm>

#include "wire/channel_types.h"
#include "wire/channels.h"
#include "wire/envelope.h"

namespace vismap {
namespace {

constexpr size_t kMaxNames = 1000;  // of channels, sources and processes; bounds the memory, since
                                    // any program may choose new names

template <typename Map>
bool HasRoom(const Map& map, const std::string& name) {
  return map.size() < kMaxNames || map.contains(name);
}

}  // namespace

int64_t CounterOf(const process_status_t& status, const std::string& name) {
  const auto found = std::find(status.counter_names.begin(), status.counter_names.end(), name);
  return found == status.counter_names.end()
             ? 0
             : status.counter_values[static_cast<size_t>(found - status.counter_names.begin())];
}

void BusPicture::AddMessage(const std::string& channel, std::span<const uint8_t> data, double now,
                            int64_t utime) {
  if (!HasRoom(channels_, channel)) return;
  ChannelPicture& picture = channels_[channel];
  ++picture.messages;
  picture.bytes += static_cast<int64_t>(data.size());
  picture.last = now;
  const ChannelType* type = FindChannelType(channel);
  if (type == nullptr) return;  // a channel of another program
  const std::optional<MessageHead> head = PeekHead(data);
  if (!head || head->fingerprint != type->fingerprint || data.size() > type->channel.max_bytes) {
    ++picture.foreign;
    return;
  }
  if (HasRoom(picture.last_seq, head->source)) {
    const auto [entry, first] = picture.last_seq.try_emplace(head->source, head->seq);
    if (!first) picture.gaps += std::max<int64_t>(0, head->seq - entry->second - 1);
    entry->second = head->seq;
  }
  if (channel == kStatusChannel.name) AddStatus(data, now, utime);
}

void BusPicture::AddStatus(std::span<const uint8_t> data, double now, int64_t utime) {
  const Result<process_status_t> status = Unpack<process_status_t>(data, kStatusChannel.max_bytes);
  if (!status || !HasRoom(processes_, status->source)) return;
  const auto [entry, first] = processes_.try_emplace(status->source);
  ProcessPicture& picture = entry->second;
  const std::string place = status->host + ", pid " + std::to_string(status->pid);
  if (first) {
    picture.first = *status;
  } else if (status->start_utime > picture.last.start_utime) {
    // The process was restarted, and its counters start at 0 again. If the old one still runs, its
    // next STATUS shows it.
    ++picture.restarts;
    picture.first = *status;
  } else if (status->start_utime < picture.last.start_utime) {
    picture.places.insert(picture.last.host + ", pid " + std::to_string(picture.last.pid));
    picture.places.insert(place);
  }
  picture.last = *status;
  picture.last_heard = now;
  picture.clock_difference = static_cast<double>(status->utime - utime) * 1e-6;
}

int64_t BusPicture::messages(const std::string& channel) const {
  const auto found = channels_.find(channel);
  return found == channels_.end() ? 0 : found->second.messages;
}

bool BusPicture::Has(const std::string& process) const {
  return std::any_of(processes_.begin(), processes_.end(), [&](const auto& entry) {
    return entry.second.last.process == process && entry.second.last.state != "stopping";
  });
}

}  // namespace vismap
