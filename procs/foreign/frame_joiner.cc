#include "foreign/frame_joiner.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "foreign/mount.h"
#include "foreign/presets.h"

namespace vismap {
namespace {

int64_t Microseconds(double ms) { return static_cast<int64_t>(std::llround(ms * 1000)); }

// A number in a reason, as the config has it: 20 and not 20.000000.
std::string Milliseconds(double ms) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g ms", ms);
  return text;
}

// Of an image that waits, with its entry.
size_t BytesOf(const ForeignImage& image) {
  constexpr size_t kEntryBytes = 128;
  return image.bytes.size() + image.frame_id.size() + kEntryBytes;
}
size_t BytesOf(const std::optional<ForeignImage>& image) { return image ? BytesOf(*image) : 0; }

std::string PixelsText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace

Result<ForeignImage> Corrected(ForeignImage image, bool is_color,
                               const AdapterCameraOptions& options) {
  Result<ForeignImage> corrected = Fail("");
  if (!is_color) {
    corrected = ClearNoneValues(std::move(image), options.none_values);
  } else if (options.swap_red_blue) {
    corrected = SwapRedBlue(std::move(image));
  } else {
    return image;
  }
  if (corrected) return corrected;
  return Fail(std::string(is_color ? "a colour" : "a depth") +
              " image cannot be decoded: " + corrected.error().message);
}

Result<FrameJoiner> FrameJoiner::Create(const AdapterCameraOptions& options, Sink sink,
                                        bool keep_pixels) {
  if (const auto complete = CheckComplete(options); !complete)
    return tl::unexpected(complete.error());
  ForeignCamera camera;
  if (const auto set = SetDistortion(options.distortion_model, options.distortion, &camera); !set)
    return Fail("adapter.distortion: " + set.error().message);
  FrameJoiner joiner(options, std::move(sink), keep_pixels);
  for (const std::string& text : options.mounts) {
    const Result<Mount> mount = ParseMount(text);
    joiner.tree_.AddMount(mount->parent, mount->child, mount->T_parent_child);
  }
  return joiner;
}

FrameJoiner::FrameJoiner(const AdapterCameraOptions& options, Sink sink, bool keep_pixels)
    : options_(options),
      sink_(std::move(sink)),
      keep_pixels_(keep_pixels),
      tree_({options.lookup, Microseconds(options.max_gap_ms), options.constant_edges}) {}

bool FrameJoiner::Wants(const std::string& channel) const {
  const std::vector<std::string>& poses = options_.pose_channels;
  return ChannelMatches(options_.color_channel, channel) ||
         ChannelMatches(options_.depth_channel, channel) ||
         channel == options_.intrinsics_channel || channel == options_.depth_intrinsics_channel ||
         std::find(poses.begin(), poses.end(), channel) != poses.end();
}

Result<void> FrameJoiner::Add(const std::string& channel, std::span<const uint8_t> bytes,
                              int64_t received, int64_t number) {
  if (!Wants(channel)) return {};
  constexpr size_t kMostChannels = 1000;  // that a * may stand for
  if (received_.size() < kMostChannels || received_.contains(channel)) ++received_[channel];
  Arrive(std::clamp<int64_t>(received, 0, kLatestUtime));
  const bool color = ChannelMatches(options_.color_channel, channel);
  const bool depth = ChannelMatches(options_.depth_channel, channel);
  const ForeignMessageOptions how{depth && !color ? ImageRole::kDepth : ImageRole::kColor,
                                  options_.root, options_.body_frame, options_.camera_frame,
                                  options_.color_channel != kNoChannel};
  Result<ForeignMessage> message = DecodeForeign(bytes, channel, how);
  const auto fail = [&](const Error& error) {
    Drop(channel + ": " + error.message);
    return Fail(channel + ": " + error.message);
  };
  if (!message) return fail(message.error());
  if (message->camera && channel == options_.intrinsics_channel) color_camera_ = message->camera;
  if (message->camera && channel == options_.depth_intrinsics_channel)
    depth_camera_ = message->camera;
  for (const std::string& part : message->left_out) ignored_.Add(channel + ": " + part);
  for (const EdgeSample& edge : message->edges) {
    if (const std::string why = tree_.Add(edge, now_); !why.empty()) ignored_.Add(why);
  }
  const Result<void> added = AddImages(channel, std::move(*message), received, number);
  Settle(advanced_.value_or(now_));
  return added ? Result<void>() : fail(added.error());
}

// Follows the receiver's clock. One wrong time of a log does not move it.
void FrameJoiner::Arrive(int64_t received) {
  const bool wrong = arrivals_.Add({}, received, 0, [this](const auto& arrival) {
    now_ = arrival.stepped_back ? arrival.utime : std::max(now_, arrival.utime);
    if (arrival.stepped_back) RestartWaits();
  });
  if (wrong)
    ignored_.Add(
        "the log has a message at a time that is far from those of the messages around it");
}

// What waits has come now at the latest, since the receiver's clock was set back.
void FrameJoiner::RestartWaits() {
  const auto restart = [this](auto* waiting) {
    for (auto& item : *waiting) item.received = std::min(item.received, now_);
  };
  restart(&colors_);
  restart(&depths_);
  restart(&pairs_);
  tree_.RestartWaits(now_);
}

// When a * stands for the channel in the options, makes it the only one, or fails when the images
// of the message cannot be those of the camera.
Result<void> FrameJoiner::LockChannels(const std::string& channel, const ForeignMessage& message) {
  const bool color = IsPattern(options_.color_channel) && message.color &&
                     ChannelMatches(options_.color_channel, channel);
  const bool depth = IsPattern(options_.depth_channel) && message.depth &&
                     ChannelMatches(options_.depth_channel, channel);
  const bool together = options_.color_channel == options_.depth_channel;
  if (together && color != depth) {
    return Fail(std::string("the message has no ") + (color ? "depth" : "colour") +
                " image, so the channel is not that of the camera (adapter.depth_channel; a camera "
                "without colour has adapter.color_channel: \"none\")");
  }
  for (const auto* image : {color ? &message.color : nullptr, depth ? &message.depth : nullptr}) {
    if (image == nullptr) continue;
    if (const Result<void> usable = CheckPixels(**image); !usable)
      return Fail("an image cannot be decoded: " + usable.error().message);
  }
  if (color) options_.color_channel = channel;
  if (depth) options_.depth_channel = channel;
  return {};
}

// Sets what the receiver knows about an image.
Result<void> FrameJoiner::Prepare(ForeignImage* image, bool is_color, int64_t received,
                                  int64_t number) {
  image->message = number;
  if (options_.time == ImageTime::kReceived) image->utime = received + wall_offset_;
  if (image->utime < 0 || image->utime > kLatestUtime)
    return Fail("an image has an impossible time, which is negative or far in the future");
  if (!keep_pixels_) {
    image->bytes.clear();
    image->bytes.shrink_to_fit();
    return {};
  }
  Result<ForeignImage> corrected = Corrected(std::move(*image), is_color, options_);
  if (!corrected) return tl::unexpected(corrected.error());
  *image = std::move(*corrected);
  return {};
}

Result<void> FrameJoiner::AddImages(const std::string& channel, ForeignMessage message,
                                    int64_t received, int64_t number) {
  if (options_.color_channel == kNoChannel) message.color.reset();
  if (!message.color && !message.depth) return {};
  if (const Result<void> locked = LockChannels(channel, message); !locked) return locked;
  for (auto* image : {&message.color, &message.depth}) {
    if (!*image) continue;
    if (const auto prepared = Prepare(&**image, image == &message.color, received, number);
        !prepared) {
      Drop(prepared.error().message);
      image->reset();
    }
  }
  AddInTime(std::move(message), std::clamp<int64_t>(received, now_, kLatestUtime));
  BoundBytes();
  return {};
}

// Adds the images whose times are right. Those that were held back wait from now on. `now` may be
// later than now_, which follows a pause of the log one message later.
void FrameJoiner::AddInTime(ForeignMessage message, int64_t now) {
  if (message.color && message.depth) {
    // Drivers send the last colour image that they have, which may be old.
    if (std::abs(message.color->utime - message.depth->utime) >
        Microseconds(options_.pair_within_ms))
      message.color->utime = message.depth->utime;
    const int64_t utime = message.depth->utime;
    DropForItsTime(pair_times_.Add({std::move(message.color), std::move(*message.depth), now},
                                   utime, now, [&](auto&& pair) {
                                     pair.item.received = now;
                                     AddPair(std::move(pair.item));
                                   }));
  } else if (message.color) {
    const int64_t utime = message.color->utime;
    DropForItsTime(color_times_.Add(std::move(*message.color), utime, now,
                                    [&](auto&& color) { AddColor(std::move(color.item), now); }));
  } else if (message.depth) {
    const int64_t utime = message.depth->utime;
    DropForItsTime(depth_times_.Add(std::move(*message.depth), utime, now,
                                    [&](auto&& depth) { AddDepth(std::move(depth.item), now); }));
  }
}

void FrameJoiner::DropForItsTime(bool wrong) {
  if (wrong) Drop("an image has a time that is far from those of the images around it");
}

void FrameJoiner::AddColor(ForeignImage image, int64_t received) {
  const int64_t gap = image.utime - last_color_utime_;
  if (last_color_utime_ >= 0 && gap > 0)
    least_color_gap_ = least_color_gap_ == 0 ? gap : std::min(least_color_gap_, gap);
  last_color_utime_ = image.utime;
  waiting_bytes_ += BytesOf(image);
  colors_.push_back({std::move(image), received});
}

void FrameJoiner::AddDepth(ForeignImage image, int64_t received) {
  waiting_bytes_ += BytesOf(image);
  depths_.push_back({std::move(image), received});
}

void FrameJoiner::AddPair(Pair pair) {
  waiting_bytes_ += BytesOf(pair.depth) + BytesOf(pair.color);
  pairs_.push_back(std::move(pair));
}

void FrameJoiner::BoundBytes() {
  const size_t most = static_cast<size_t>(options_.queue_mb) << 20;
  while (waiting_bytes_ > most) {
    if (!pairs_.empty()) {
      const Pair& first = pairs_.front();
      waiting_bytes_ -= BytesOf(first.depth) + BytesOf(first.color);
      pairs_.pop_front();
    } else {
      std::deque<Waiting>& images = depths_.empty() ? colors_ : depths_;
      waiting_bytes_ -= BytesOf(images.front().image);
      images.pop_front();
    }
    Drop("more images waited than adapter.queue_mb allows");
  }
}

void FrameJoiner::Advance(int64_t now) {
  now_ = std::max(now_, now);
  arrivals_.Restart(now_, 0);
  advanced_ = now_;
  Settle(now_);
}

void FrameJoiner::Settle(int64_t now) {
  while (PairFirstDepth(now) || JoinFirstPair(now)) {
  }
  DropOldColors(now);
}

void FrameJoiner::Finish() {
  color_times_.Finish([this](auto&& color) { AddColor(std::move(color.item), color.received); });
  depth_times_.Finish([this](auto&& depth) { AddDepth(std::move(depth.item), depth.received); });
  pair_times_.Finish([this](auto&& pair) { AddPair(std::move(pair.item)); });
  finished_ = true;
  Settle(now_);
}

void FrameJoiner::DropOldColors(int64_t now) {
  const int64_t wait = Microseconds(options_.wait_ms + options_.pair_within_ms);
  while (!colors_.empty() && (finished_ || now - colors_.front().received > wait)) {
    waiting_bytes_ -= BytesOf(colors_.front().image);
    colors_.pop_front();
    Drop("no depth image within " + Milliseconds(options_.pair_within_ms) +
         " of the colour image (adapter.pair_within_ms)");
  }
}

// Finds the colour image of the first depth image, or drops that. Returns false when both have to
// wait.
bool FrameJoiner::PairFirstDepth(int64_t now) {
  if (depths_.empty()) return false;
  Waiting& depth = depths_.front();
  const auto take = [&](std::optional<ForeignImage> color, int64_t received) {
    waiting_bytes_ -= BytesOf(depth.image) + BytesOf(color);
    AddPair({std::move(color), std::move(depth.image), std::max(received, depth.received)});
    depths_.pop_front();
    return true;
  };
  if (options_.color_channel == kNoChannel) return take(std::nullopt, 0);

  const auto distance = [&](const Waiting& color) {
    return std::abs(color.image.utime - depth.image.utime);
  };
  const auto nearest = std::min_element(
      colors_.begin(), colors_.end(),
      [&](const Waiting& a, const Waiting& b) { return distance(a) < distance(b); });
  const bool fits =
      nearest != colors_.end() && distance(*nearest) <= Microseconds(options_.pair_within_ms);
  const bool passed = !colors_.empty() && colors_.back().image.utime >= depth.image.utime;
  // No colour image that is still to come can be nearer.
  const bool surely = fits && least_color_gap_ > 0 && 2 * distance(*nearest) <= least_color_gap_;
  const bool last_chance = finished_ || now - depth.received > Microseconds(options_.wait_ms);
  if (fits && (passed || surely || last_chance)) {
    for (auto skipped = colors_.begin(); skipped != nearest; ++skipped) {
      waiting_bytes_ -= BytesOf(skipped->image);
      Drop("no depth image within " + Milliseconds(options_.pair_within_ms) +
           " of the colour image (adapter.pair_within_ms)");
    }
    Waiting color = std::move(*nearest);
    colors_.erase(colors_.begin(), nearest + 1);
    return take(std::move(color.image), color.received);
  }
  if (!(passed && color_times_.sure()) && !last_chance) return false;
  waiting_bytes_ -= BytesOf(depth.image);
  depths_.pop_front();
  Drop("no colour image within " + Milliseconds(options_.pair_within_ms) +
       " of the depth image (adapter.pair_within_ms, adapter.color_channel)");
  return true;
}

// Hands out the first pair as a frame, or drops it. Returns false when it has to wait.
bool FrameJoiner::JoinFirstPair(int64_t now) {
  if (pairs_.empty()) return false;
  Pair& pair = pairs_.front();
  ForeignFrame frame;
  const Missing missing = Complete(pair, now, &frame);
  const bool whole = missing.why.empty();
  const bool give_up =
      missing.never || finished_ || now - pair.received > Microseconds(missing.wait_ms);
  if (!whole && !give_up) return false;
  waiting_bytes_ -= BytesOf(pair.depth) + BytesOf(pair.color);
  last_utime_ = pair.utime();
  if (whole) {
    frame.utime = pair.utime();
    frame.received = pair.received;
    frame.color = std::move(pair.color);
    frame.depth = std::move(pair.depth);
    ++frames_;
  } else {
    Drop(missing.why);
  }
  pairs_.pop_front();
  if (whole) sink_(std::move(frame));
  return true;
}

FrameJoiner::Missing FrameJoiner::Complete(const Pair& pair, int64_t now,
                                           ForeignFrame* frame) const {
  if (last_utime_ == pair.utime()) {
    return {
        "the image has the time of the image before it; for a driver that sends no time, set "
        "adapter.time to RECEIVED",
        true};
  }
  frame->depth_registered = IsRegistered(pair);
  if (Missing missing = FindCameras(pair, frame); !missing.why.empty()) return missing;
  return FindPoses(pair, now, frame);
}

bool FrameJoiner::IsRegistered(const Pair& pair) const {
  if (!pair.color) return true;
  if (options_.registered != DepthIsRegistered::kByFrameId)
    return options_.registered == DepthIsRegistered::kYes;
  return pair.color->frame_id == pair.depth.frame_id;
}

// The intrinsics for an image, from the config or the last message.
std::optional<ForeignCamera> FrameJoiner::ColorCamera(const ForeignImage& image) const {
  if (options_.intrinsics.empty()) return color_camera_;
  ForeignCamera camera{image.width,
                       image.height,
                       options_.intrinsics[0],
                       options_.intrinsics[1],
                       options_.intrinsics[2],
                       options_.intrinsics[3]};
  if (!SetDistortion(options_.distortion_model, options_.distortion, &camera)) return std::nullopt;
  return camera;
}

FrameJoiner::Missing FrameJoiner::FindCameras(const Pair& pair, ForeignFrame* frame) const {
  const auto misfit = [](const ForeignCamera& camera, const ForeignImage& image) -> Missing {
    if (camera.width == image.width && camera.height == image.height) return {};
    return {"the intrinsics are for images of " + PixelsText(camera.width, camera.height) +
                ", the image has " + PixelsText(image.width, image.height),
            true};
  };
  const ForeignImage& main = pair.color ? *pair.color : pair.depth;
  const std::optional<ForeignCamera> camera = ColorCamera(main);
  if (!camera) {
    return {"no intrinsics came on " + options_.intrinsics_channel +
                " (adapter.intrinsics_channel; or give adapter.intrinsics)",
            false, options_.intrinsics_wait_ms};
  }
  if (Missing missing = misfit(*camera, main); !missing.why.empty()) return missing;
  frame->color_camera = frame->depth_camera = *camera;
  if (frame->depth_registered) {
    if (pair.depth.width == main.width && pair.depth.height == main.height) return {};
    return {"depth has " + PixelsText(pair.depth.width, pair.depth.height) + " pixels and colour " +
                PixelsText(main.width, main.height) +
                ", so depth is not registered to colour (adapter.registered)",
            true};
  }
  if (!depth_camera_) {
    return {
        "depth is not registered to colour, and no intrinsics of the depth camera came "
        "(adapter.depth_intrinsics_channel, adapter.registered)",
        false, options_.intrinsics_wait_ms};
  }
  frame->depth_camera = *depth_camera_;
  return misfit(*depth_camera_, pair.depth);
}

FrameJoiner::Missing FrameJoiner::FindPoses(const Pair& pair, int64_t now,
                                            ForeignFrame* frame) const {
  const ForeignImage& main = pair.color ? *pair.color : pair.depth;
  const std::string& camera = options_.camera_frame.empty() ? main.frame_id : options_.camera_frame;
  if (camera.empty()) return {"the images name no frame; set adapter.camera_frame", true};
  const auto find = [&](const std::string& target, const std::string& source,
                        Pose* pose) -> Missing {
    FrameTree::Answer answer = tree_.Find(target, source, pair.utime(), now);
    *pose = answer.pose;
    if (answer.state == FrameTree::State::kFound) return {};
    return {std::move(answer.why), answer.state == FrameTree::State::kNever, options_.wait_ms};
  };
  if (Missing missing = find(options_.root, camera, &frame->T_W_C); !missing.why.empty())
    return missing;
  if (frame->depth_registered) return {};
  return find(camera, pair.depth.frame_id, &frame->T_color_depth);
}

}  // namespace vismap
