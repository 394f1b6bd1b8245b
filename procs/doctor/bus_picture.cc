#include "doctor/bus_picture.h"

#include <algorithm>
#include <vismap/frame_commit_t.hpp>

#include "wire/channel_types.h"
#include "wire/channels.h"
#include "wire/envelope.h"
#include "wire/frame_key.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

constexpr size_t kMaxNames = 1000;  // of channels, sources and processes; bounds the memory, since
                                    // any program may choose new names

template <typename Map>
bool HasRoom(const Map& map, const std::string& name) {
  return map.size() < kMaxNames || map.contains(name);
}

std::string PlaceOf(const process_status_t& status) {
  return status.host + ", pid " + std::to_string(status.pid);
}

}  // namespace

int64_t CounterOf(const process_status_t& status, const std::string& name) {
  const auto found = std::find(status.counter_names.begin(), status.counter_names.end(), name);
  return found == status.counter_names.end()
             ? 0
             : status.counter_values[static_cast<size_t>(found - status.counter_names.begin())];
}

void BusPicture::AddMessage(const std::string& on_bus, std::span<const uint8_t> data, double now,
                            int64_t utime) {
  if (!HasRoom(channels_, on_bus)) return;
  ChannelPicture& picture = channels_[on_bus];
  ++picture.messages;
  picture.bytes += static_cast<int64_t>(data.size());
  picture.last = now;
  const std::string channel = WithoutPrefix(on_bus, channel_prefix_).value_or("");
  const ChannelType* type = FindChannelType(channel);
  if (type == nullptr) return AddStranger(on_bus, data, now, utime);
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
  if (channel == kStatusChannel.name) AddStatus(data, now, utime, false);
  AddFrame(channel, data, now);
}

// A channel of another program, or one of ours with another prefix.
void BusPicture::AddStranger(const std::string& on_bus, std::span<const uint8_t> data, double now,
                             int64_t utime) {
  const std::optional<MessageHead> head = PeekHead(data);
  if (!head) return;
  for (const ChannelType& type : ChannelTypes()) {
    const std::string name = type.channel.name;
    if (head->fingerprint != type.fingerprint || !on_bus.ends_with(name)) continue;
    ChannelPicture& picture = channels_[on_bus];
    picture.type_of_ours = type.type;
    picture.other_prefix = on_bus.substr(0, on_bus.size() - name.size());
    if (name == kStatusChannel.name) AddStatus(data, now, utime, true);
  }
}

double CameraPicture::Lag() const {
  if (newest_frame < 0 || newest_commit < 0) return 0;
  return std::max(0.0, static_cast<double>(newest_frame - newest_commit) * 1e-6);
}

void BusPicture::AddFrame(const std::string& channel, std::span<const uint8_t> data, double now) {
  const bool is_commit = channel == kMapCommitChannel.name;
  FrameKey key;
  if (is_commit) {
    const auto commit = Unpack<frame_commit_t>(data, kMapCommitChannel.max_bytes);
    if (!commit || commit->utime < 0) return;
    key = KeyOf(*commit);
  } else {
    if (channel != kRgbdFrameChannel.name) return;
    const Result<FrameHeader> header = PeekFrameHeader(data, data.size());
    if (!header) return;
    key = {header->camera_id, header->utime};
  }
  constexpr size_t kMaxCameras = 100;
  if (cameras_.size() >= kMaxCameras && !cameras_.contains(Raw(key.camera_id))) return;
  CameraPicture& camera = cameras_[Raw(key.camera_id)];
  const bool complete = camera.newest_frame >= 0 && camera.newest_commit >= 0;
  (is_commit ? camera.newest_commit : camera.newest_frame) = key.utime;
  if (!complete) camera.first_lag = camera.Lag();
  if (camera.Lag() <= CameraPicture::kToldLag) {
    camera.behind_since = -1;
  } else if (camera.behind_since < 0) {
    camera.behind_since = now;
  }
}

// The picture of the process that has sent this STATUS; nullptr when there are too many.
ProcessPicture* BusPicture::PictureOf(const process_status_t& status) {
  const std::string place = PlaceOf(status);
  const std::string own_name = status.source + " (" + place + ")";
  if (const auto known = processes_.find(own_name); known != processes_.end())
    return &known->second;
  const auto holder = processes_.find(status.source);
  if (holder == processes_.end()) {
    return HasRoom(processes_, status.source) ? &processes_[status.source] : nullptr;
  }
  ProcessPicture& picture = holder->second;
  const process_status_t& last = picture.last;
  const bool same_start = PlaceOf(last) == place && last.start_utime == status.start_utime;
  if (same_start && status.seq >= last.seq) return &picture;
  if (!same_start && status.start_utime > last.start_utime) {
    // The process was restarted, and its counters start at 0 again. If the old one still runs, its
    // next STATUS shows it.
    ++picture.restarts;
    picture.first = status;
    return &picture;
  }
  // Two processes have the name.
  if (!HasRoom(processes_, own_name)) return nullptr;
  ProcessPicture& other = processes_[own_name];
  picture.places.insert({PlaceOf(last), place});
  picture.restarts = std::max(0, picture.restarts - 1);  // it was none
  return &other;
}

void BusPicture::AddStatus(std::span<const uint8_t> data, double now, int64_t utime,
                           bool other_prefix) {
  const Result<process_status_t> status = Unpack<process_status_t>(data, kStatusChannel.max_bytes);
  if (!status) return;
  if (other_prefix && status->process != "hub" && status->process != "bridge") return;
  ProcessPicture* picture = PictureOf(*status);
  if (picture == nullptr) return;
  if (picture->first.source.empty()) picture->first = *status;
  picture->last = *status;
  picture->last_heard = now;
  picture->clock_difference = static_cast<double>(status->utime - utime) * 1e-6;
}

int64_t BusPicture::messages(const std::string& channel) const {
  const auto found = channels_.find(channel_prefix_ + channel);
  return found == channels_.end() ? 0 : found->second.messages;
}

bool BusPicture::Has(const std::string& process) const {
  return std::any_of(processes_.begin(), processes_.end(), [&](const auto& entry) {
    return entry.second.last.process == process && entry.second.last.state != "stopping";
  });
}

}  // namespace vismap
