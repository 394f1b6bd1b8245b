#include "viewer/evidence.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include "runtime/clock.h"
#include "runtime/log.h"
#include "viewer/evidence_answers.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

constexpr int kMostOffers = 2;       // frames that wait for the worker
constexpr double kBlocksKept = 0.5;  // [s] before the surface is taken anew
constexpr double kIdle = 5;          // [s] after which it is released
constexpr std::string_view kListPath = "/api/evidence", kFramePath = "/api/frame/";

// Keeps the frame if it is wanted. An Error says why it cannot be kept.
Result<void> Keep(const segmented_frame_t& message, EvidenceStore* store) try {
  const Result<FrameHeader> header = DecodeHeader(message.frame);
  if (!header) return tl::unexpected(header.error());
  if (!store->Wants(*header)) return {};
  Result<EvidenceFramePtr> frame = MakeEvidenceFrame(message);
  if (!frame) return tl::unexpected(frame.error());
  store->Add(std::move(*frame));
  return {};
} catch (const std::exception& error) {  // such as a lack of memory
  return Fail(error.what());
}

}  // namespace

Evidence::Evidence(const ViewerOptions& options, Bus* bus, const MapCopy* surface, Status* status)
    : options_(options),
      bus_(bus),
      surface_(surface),
      status_(status),
      finder_(
          std::make_shared<EvidenceFinder>(static_cast<size_t>(options.evidence_mb) * kMegabyte)),
      worker_(bus) {
  bus_->Every(1, [this] { ReleaseBlocks(); });
}

void Evidence::Offer(std::shared_ptr<const segmented_frame_t> message) {
  const double now = MonotonicSeconds();
  if (!enabled() || now < next_offer_ || offers_ >= kMostOffers) return;
  next_offer_ = now + 1 / options_.evidence_hz;
  ++offers_;
  worker_.Start(
      [finder = finder_, message = std::move(message)] {
        const double begin = MonotonicSeconds();
        const Result<void> kept = Keep(*message, &finder->store());
        return std::tuple(kept ? "" : kept.error().message, finder->store().frames().size(),
                          finder->store().bytes(), MonotonicSeconds() - begin);
      },
      [this](const std::tuple<std::string, size_t, size_t, double>& done) {
        --offers_;
        const auto& [problem, frames, bytes, seconds] = done;
        status_->AddTiming("evidence_frame", 1000 * seconds);
        status_->SetCounter("evidence_frames", static_cast<int64_t>(frames));
        status_->SetCounter("evidence_bytes", static_cast<int64_t>(bytes));
        if (!problem.empty())
          LogWarningRateLimited("evidence", "a frame is not kept for pages: " + problem);
      });
}

void Evidence::ForgetFrames() {
  worker_.Start([finder = finder_] { return finder->store().Clear(), 0; }, [](int) {});
}

void Evidence::SetObjects(const object_list_t& objects) {
  discovered_.clear();
  for (const object_t& object : objects.objects) {
    if (object.instance != 0 || object.segments.empty() || object.removed_utime != 0) continue;
    std::vector<uint32_t> segments(object.segments.begin(), object.segments.end());
    std::sort(segments.begin(), segments.end());
    discovered_[static_cast<uint32_t>(object.segments.front())] = std::move(segments);
  }
}

bool Evidence::Answers(const std::string& path) {
  return path == kListPath || path.starts_with(kFramePath);
}

void Evidence::Get(const HttpTarget& target, const WebHandler::Reply& reply) {
  if (!enabled()) return reply(NoFramesKept());
  if (waiting_ >= kMostWaiting)
    return reply(ErrorAnswer(
        429, std::to_string(kMostWaiting) + " requests for frames wait already; try again"));
  if (target.path == kListPath) return GetList(target, reply);
  GetPicture(target, reply);
}

tl::expected<EvidenceQuestion, HttpAnswer> Evidence::Ask(const std::string& name) {
  const std::optional<ObjectName> parsed = ParseObjectName(name);
  if (!parsed) return tl::unexpected(NeedsObjectName());
  if (surface_->position().revision < 0)
    return tl::unexpected(
        ErrorAnswer(503, "nothing is known yet: no surface has come on MESH_DELTA"));
  EvidenceQuestion question{
      Blocks(), surface_->position().map_id, surface_->position().revision, {}};
  if (!parsed->is_segment) {
    question.object.instance = InstanceId{parsed->number};
  } else {
    const auto found = discovered_.find(parsed->number);
    question.object.segments =
        found == discovered_.end() ? std::vector{parsed->number} : found->second;
  }
  return question;
}

template <typename Work>
void Evidence::Start(Work work, const WebHandler::Reply& reply) {
  ++waiting_;
  worker_.Start(
      [work = std::move(work), asked = MonotonicSeconds()] {
        const double begin = MonotonicSeconds();
        HttpAnswer answer = AnswerInTurn(asked, begin, work);
        return std::pair(std::move(answer), MonotonicSeconds() - begin);
      },
      [this, reply](std::pair<HttpAnswer, double> done) {
        --waiting_;
        status_->AddTiming("evidence_answer", 1000 * done.second);
        reply(std::move(done.first));
      });
}

void Evidence::GetList(const HttpTarget& target, const WebHandler::Reply& reply) {
  const bool only_id = target.query.size() == 1 && target.query.contains("id");
  auto question = Ask(only_id ? target.query.at("id") : "");
  if (!question) return reply(question.error());
  Start([finder = finder_, name = target.query.at("id"),
         question = std::move(*question)] { return EvidenceList(name, question, finder.get()); },
        reply);
}

void Evidence::GetPicture(const HttpTarget& target, const WebHandler::Reply& reply) {
  const Result<PictureQuestion> picture = ReadPictureQuestion(target);
  if (!picture) return reply(ErrorAnswer(400, picture.error().message));
  std::optional<EvidenceQuestion> object;
  if (!picture->object.empty()) {
    auto asked = Ask(picture->object);
    if (!asked) return reply(asked.error());
    object = std::move(*asked);
  }
  Start(
      [finder = finder_, picture = *picture, object = std::move(object)] {
        return EvidencePicture(picture, object ? &*object : nullptr, finder.get());
      },
      reply);
}

// The surface as it is, or was a moment ago, for the worker.
SurfaceBlocks Evidence::Blocks() {
  const FollowerPosition& position = surface_->position();
  const double now = MonotonicSeconds();
  const bool same_map = blocks_ != nullptr && blocks_map_id_ == position.map_id;
  if (!same_map || (blocks_revision_ != position.revision && now - blocks_time_ > kBlocksKept)) {
    blocks_ = std::make_shared<const std::vector<SurfaceBlock>>(surface_->Blocks());
    blocks_map_id_ = position.map_id;
    blocks_revision_ = position.revision;
    blocks_time_ = now;
  }
  return blocks_;
}

// Blocks that have changed since then would otherwise be kept as they were.
void Evidence::ReleaseBlocks() {
  if (blocks_ != nullptr && MonotonicSeconds() - blocks_time_ > kIdle) blocks_.reset();
}

}  // namespace vismap
