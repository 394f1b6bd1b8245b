#include "viewer/log_evidence.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/json_text.h"
#include "codecs/color_codec.h"
#include "codecs/label_codec.h"

namespace vismap {
namespace {

constexpr int kEvidenceQuality = 85;
constexpr int64_t kNeverRenew = INT64_MAX;  // earlier moments need their frames

}  // namespace

LogFrames::LogFrames(size_t max_bytes) : store_(max_bytes, kNeverRenew) {}

std::shared_ptr<EvidenceFrame> LogFrames::Make(const SegmentedFrame& frame) const {
  if (frame.frame.color.empty()) return nullptr;
  {
    const std::lock_guard lock(mutex_);
    if (!store_.Wants(frame.frame.header)) return nullptr;
  }
  return MakeEvidenceFrame(frame, EncodeJpeg(frame.frame.color, kEvidenceQuality),
                           EncodeSegmentImage(frame.image));
}

void LogFrames::Add(std::shared_ptr<EvidenceFrame> frame, int64_t frames) {
  frame->map_frames = frames;
  const std::lock_guard lock(mutex_);
  store_.Add(std::move(frame));
}

EvidenceStore LogFrames::Until(int64_t frames) const {
  const std::lock_guard lock(mutex_);
  return store_.Until(frames);
}

Result<SurfaceBlocks> LogEvidence::Blocks(int64_t frames) {
  const int64_t thinnings = recording_->thinnings();
  if (blocks_ != nullptr && blocks_frames_ == frames && blocks_thinnings_ == thinnings)
    return blocks_;
  auto blocks = std::make_shared<std::vector<SurfaceBlock>>();
  for (const auto& entry : recording_->SurfaceAt(frames)) {
    Result<BlockAtMoment> block = recording_->BlockAt(entry.first, frames);
    if (!block) return tl::unexpected(block.error());
    if (block->bytes != nullptr) blocks->push_back({entry.first, std::move(block->bytes)});
  }
  std::sort(blocks->begin(), blocks->end(),
            [](const SurfaceBlock& a, const SurfaceBlock& b) { return a.index < b.index; });
  blocks_ = std::move(blocks);
  blocks_frames_ = frames;
  blocks_thinnings_ = thinnings;
  return blocks_;
}

// All segments of the discovered object whose first one it is; else the segment alone.
Result<std::vector<uint32_t>> LogEvidence::SegmentsOf(uint32_t segment, int64_t frames) const {
  const Result<std::string> text = recording_->ObjectsTextAt(frames);
  if (!text) return tl::unexpected(text.error());
  const std::vector<uint32_t> alone{segment};
  if (text->empty()) return alone;
  const nlohmann::json json = nlohmann::json::parse(*text);
  for (const nlohmann::json& object : json.at("objects")) {
    const auto segments = object.value("segments", std::vector<uint32_t>());
    if (object.value("instance", 0u) != 0 || segments.empty() || segments[0] != segment) continue;
    std::vector<uint32_t> all = segments;
    std::sort(all.begin(), all.end());
    return all;
  }
  return alone;
}

Result<EvidenceQuestion> LogEvidence::Ask(const std::string& name, int64_t frames) {
  finder_.store() = frames_->Until(frames);
  const std::optional<ObjectName> parsed = ParseObjectName(name);
  if (!parsed) return Fail("'" + name + "' is no name of an object");
  Result<SurfaceBlocks> blocks = Blocks(frames);
  if (!blocks) return tl::unexpected(blocks.error());
  EvidenceQuestion question{std::move(*blocks), recording_->map_id(), frames, {}};
  question.of_log = true;
  if (!parsed->is_segment) {
    question.object.instance = InstanceId{parsed->number};
    return question;
  }
  Result<std::vector<uint32_t>> segments = SegmentsOf(parsed->number, frames);
  if (!segments) return tl::unexpected(segments.error());
  question.object.segments = std::move(*segments);
  return question;
}

HttpAnswer LogEvidence::List(const std::string& name, int64_t frames) {
  const Result<EvidenceQuestion> question = Ask(name, frames);
  if (!question) return ErrorAnswer(500, question.error().message);
  return EvidenceList(name, *question, &finder_);
}

HttpAnswer LogEvidence::Picture(const PictureQuestion& picture, int64_t frames) {
  if (picture.object.empty()) {
    finder_.store() = frames_->Until(frames);
    return EvidencePicture(picture, nullptr, &finder_);
  }
  const Result<EvidenceQuestion> question = Ask(picture.object, frames);
  if (!question) return ErrorAnswer(500, question.error().message);
  return EvidencePicture(picture, &*question, &finder_);
}

}  // namespace vismap
