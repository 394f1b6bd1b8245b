#include "logs/foreign_dataset.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>

#include "base/enum_names.h"
#include "base/format.h"
#include "base/require.h"
#include "foreign/frame_message.h"
#include "foreign/presets.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

/// All channels of a log; its data is not read.
Result<std::set<std::string>> ReadChannels(const std::string& path) {
  Result<LogReader> reader = LogReader::Open(path);
  if (!reader) return tl::unexpected(reader.error());
  std::set<std::string> channels;
  const Result<void> read = ForEachEvent(
      *reader,
      [&](const LogEvent& event) -> Result<void> {
        channels.insert(event.channel);
        return {};
      },
      [](const LogDamage&) {});
  if (!read) return tl::unexpected(read.error());
  return channels;
}

std::string ListText(const std::set<std::string>& names) {
  constexpr size_t kMost = 30;
  std::string text;
  size_t shown = 0;
  for (const std::string& name : names) {
    if (shown++ == kMost) return text + ", ...";
    text += (text.empty() ? "" : ", ") + name;
  }
  return text.empty() ? "none" : text;
}

/// The options with the preset that fits the log, when they have none.
Result<AdapterOptions> OptionsFor(const std::string& path, AdapterOptions adapter,
                                  std::vector<std::string>* remarks) {
  const Result<std::set<std::string>> channels = ReadChannels(path);
  if (!channels) return tl::unexpected(channels.error());
  if (adapter.preset == AdapterPreset::kAuto && adapter.depth_channel.empty()) {
    adapter.preset = FindPreset(*channels);
    if (adapter.preset == AdapterPreset::kAuto) {
      return Fail(path + ": no preset fits the channels of the log (" + ListText(*channels) +
                  "); give adapter.depth_channel and the others with --config");
    }
    remarks->push_back(path + " is read with the preset " + NameOf(adapter.preset) +
                       ", which fits its channels");
  }
  adapter = WithPreset(adapter);
  if (const auto complete = CheckComplete(adapter); !complete) {
    return Fail(path + ", preset " + NameOf(adapter.preset) + ": " + complete.error().message +
                "; give it with --config FILE.txtpb");
  }
  if (std::none_of(channels->begin(), channels->end(), [&](const std::string& found) {
        return ChannelMatches(adapter.depth_channel, found);
      })) {
    return Fail(path + ": the log has no channel " + adapter.depth_channel +
                " (adapter.depth_channel); it has " + ListText(*channels));
  }
  return adapter;
}

}  // namespace

Result<bool> HasForeignImages(const std::string& path, const AdapterOptions& adapter) {
  const Result<std::set<std::string>> channels = ReadChannels(path);
  if (!channels) return tl::unexpected(channels.error());
  return !adapter.depth_channel.empty() || adapter.preset != AdapterPreset::kAuto ||
         FindPreset(*channels) != AdapterPreset::kAuto;
}

Result<std::unique_ptr<ForeignDataset>> ForeignDataset::Open(const std::string& path,
                                                             const AdapterOptions& adapter,
                                                             const DatasetOptions& options) {
  std::vector<std::string> remarks;
  const Result<AdapterOptions> complete = OptionsFor(path, adapter, &remarks);
  if (!complete) return tl::unexpected(complete.error());
  Result<LogReader> reader = LogReader::Open(path);
  if (!reader) return tl::unexpected(reader.error());
  std::unique_ptr<ForeignDataset> dataset(new ForeignDataset(std::move(*reader), *complete));
  dataset->remarks_ = std::move(remarks);
  if (const Result<void> scanned = dataset->Scan(options); !scanned)
    return tl::unexpected(scanned.error());
  return dataset;
}

// Reads the whole log once and joins its messages.
Result<void> ForeignDataset::Scan(const DatasetOptions& options) {
  Result<FrameJoiner> joiner = FrameJoiner::Create(
      adapter_, [&](ForeignFrame&& frame) { Keep(std::move(frame), options); }, false);
  if (!joiner) return Fail(reader_.path() + ": " + joiner.error().message);
  const std::set<std::string> patterns = ChannelsOf(adapter_);
  int64_t damaged = 0;
  const Result<void> read = ForEachEvent(
      reader_,
      [&](const LogEvent& event) -> Result<void> {
        if (std::none_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
              return ChannelMatches(pattern, event.channel);
            }))
          return {};
        const Result<std::vector<uint8_t>> bytes = reader_.ReadData(event);
        if (!bytes) return tl::unexpected(bytes.error());
        const bool has_images = ChannelMatches(adapter_.color_channel, event.channel) ||
                                ChannelMatches(adapter_.depth_channel, event.channel);
        if (has_images) images_.push_back(event);
        const int64_t number = has_images ? std::ssize(images_) - 1 : -1;
        (void)joiner->Add(event.channel, *bytes, event.timestamp, number);  // it counts what fails
        return {};
      },
      [&](const LogDamage&) { ++damaged; });
  if (!read) return tl::unexpected(read.error());
  joiner->Finish();
  adapter_ = joiner->options();  // with the channels that a * stood for
  const ReasonCounts& dropped = joiner->dropped();
  if (frames_.empty())
    return Fail(reader_.path() + ": " + NoUsableFramesText(dropped, dropped.total()));
  if (dropped.total() > 0) remarks_.push_back("not used: " + dropped.Text());
  if (damaged > 0)
    remarks_.push_back(reader_.path() + " has " + FormatCount(damaged, "damaged part"));
  remarks_.push_back("camera " + std::to_string(adapter_.camera_id) + ": " +
                     CameraText(frames_.front().header.camera) + ": from " +
                     (adapter_.intrinsics.empty() ? adapter_.intrinsics_channel
                                                  : std::string("adapter.intrinsics")));
  return {};
}

void ForeignDataset::Keep(ForeignFrame joined, const DatasetOptions& options) {
  const int64_t number = found_++;
  const bool chosen =
      number % options.stride == 0 &&
      (options.max_frames == 0 || frames_.size() < static_cast<size_t>(options.max_frames));
  if (!chosen) return;
  const rgbd_frame_t message = ToMessage(ForeignFrame(joined), adapter_);
  Result<FrameHeader> header = DecodeHeader(message);
  if (!header) {
    skipped_.push_back({number, header.error().message});
    return;
  }
  frames_.push_back({std::move(joined), *header});
}

std::string ForeignDataset::name() const {
  return std::filesystem::path(reader_.path()).filename().string();
}

FrameHeader ForeignDataset::Header(size_t i) const {
  Require(i < size(), "the index of a frame is below the number of frames");
  return frames_[i].header;
}

Result<ForeignMessage> ForeignDataset::MessageAt(int64_t number, ImageRole role) const {
  const LogEvent& event = images_[static_cast<size_t>(number)];
  const Result<std::vector<uint8_t>> bytes = reader_.ReadData(event);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<ForeignMessage> message =
      DecodeForeign(*bytes, event.channel, {role, adapter_.root, adapter_.body_frame, ""});
  if (!message) {
    return Fail(reader_.path() + ", " + event.channel + " at byte " + std::to_string(event.offset) +
                ": " + message.error().message);
  }
  return message;
}

// Sets the pixels of an image that was joined without them.
Result<void> ForeignDataset::ReadPixels(ForeignImage* image, bool is_color) const {
  const bool own_channel = adapter_.color_channel != adapter_.depth_channel;
  Result<ForeignMessage> message =
      MessageAt(image->message, !is_color && own_channel ? ImageRole::kDepth : ImageRole::kColor);
  if (!message) return tl::unexpected(message.error());
  std::optional<ForeignImage>& found = is_color ? message->color : message->depth;
  if (!found) return Fail(reader_.path() + ": an image changed while the log was read");
  if (is_color && adapter_.swap_red_blue) {
    Result<ForeignImage> swapped = SwapRedBlue(std::move(*found));
    if (!swapped) return tl::unexpected(swapped.error());
    found = std::move(*swapped);
  }
  image->format = found->format;
  image->bytes = std::move(found->bytes);
  return {};
}

Result<rgbd_frame_t> ForeignDataset::Message(size_t i) const {
  ForeignFrame joined = frames_[i].joined;
  if (const auto read = ReadPixels(&joined.depth, false); !read)
    return tl::unexpected(read.error());
  if (joined.color) {
    if (const auto read = ReadPixels(&*joined.color, true); !read)
      return tl::unexpected(read.error());
  }
  return ToMessage(std::move(joined), adapter_);
}

Result<SensorFrame> ForeignDataset::Read(size_t i) const {
  Require(i < size(), "the index of a frame is below the number of frames");
  const Result<rgbd_frame_t> message = Message(i);
  if (!message) return tl::unexpected(message.error());
  Result<SensorFrame> frame = Decode(*message);
  if (!frame) return Fail(reader_.path() + ": " + frame.error().message);
  return frame;
}

}  // namespace vismap
