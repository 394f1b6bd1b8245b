#include "viewer/log_api.h"

#include <charconv>
#include <utility>

#include "base/class_names.h"
#include "base/printable.h"
#include "exports/explain_cell.h"
#include "requests/request_argument.h"
#include "runtime/clock.h"
#include "viewer/page_moment.h"
#include "viewer/slice_distances.h"
#include "viewer/timeline.h"

namespace vismap {
namespace {

constexpr size_t kMostSpaces = 3;  // maps of free space that are kept

// Takes frames=N out of the arguments; the newest moment without it.
Result<int64_t> TakeFrames(HttpTarget* target) {
  const auto found = target->query.find("frames");
  if (found == target->query.end()) return INT64_MAX;
  const std::string text = found->second;
  target->query.erase(found);
  int64_t frames = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), frames);
  if (error != std::errc() || end != text.data() + text.size() || frames < 0)
    return Fail("frames: expected a number of frames, found '" + PrintableText(text, 60) + "'");
  return frames;
}

}  // namespace

LogApi::LogApi(const LogSource* source, const VismapConfig& config)
    : recording_(&source->recording()),
      config_(config),
      maps_(
          recording_,
          [source](int64_t frames, const std::atomic<bool>* stop) {
            return source->MapAfter(frames, stop);
          },
          static_cast<size_t>(config.viewer.max_map_mb) << 20),
      evidence_(recording_, &source->frames()) {}

void LogApi::Get(HttpTarget target, const WebHandler::Reply& reply) {
  const Result<int64_t> frames = TakeFrames(&target);
  if (!frames) return reply(ErrorAnswer(400, frames.error().message));
  if (target.path == "/api/timeline") return reply(JsonAnswer(TimelineText(*recording_)));
  const std::optional<Moment> moment = recording_->MomentAt(*frames);
  if (!moment) return reply(ErrorAnswer(503, "no frame of the log is mapped yet; try again"));
  GetAt(target, *moment, reply);
}

void LogApi::GetAt(const HttpTarget& target, const Moment& moment, const WebHandler::Reply& reply) {
  const std::string& path = target.path;
  if (path == "/api/map")
    return reply(JsonAnswer(MapText(SummaryOf(*recording_, moment), 0, false)));
  if (path == "/api/objects") return reply(GetObjects(moment.frames));
  if (path == "/api/cell") return GetCell(target, moment.frames, reply);
  if (path == "/api/slice") return GetSlice(target, moment, reply);
  if (path == "/api/leaves") return GetLeaves(target, moment, reply);
  if (path == "/api/evidence") return GetEvidence(target, moment.frames, reply);
  if (path.starts_with("/api/frame/")) return GetFrame(target, moment.frames, reply);
  if (const auto object = ObjectOfPath(path)) return GetObjectFile(*object, moment.frames, reply);
  reply(ErrorAnswer(404, "there is no '" + PrintableText(path, 100) +
                             "' for a log; there are /api/timeline, /api/map, /api/objects, "
                             "/api/slice?axis=z&at=1.0, /api/leaves?axis=z&at=1.0, "
                             "/api/cell?at=x,y,z, /api/object/ID.ply, /api/evidence?id=ID and "
                             "/api/frame/CAMERA/UTIME.jpg, each of them with &frames=N for the map "
                             "after so many frames"));
}

HttpAnswer LogApi::GetObjects(int64_t frames) const {
  const Result<std::string> json = recording_->ObjectsJsonAt(frames);
  if (!json) return ErrorAnswer(500, json.error().message);
  if (json->empty()) return ErrorAnswer(503, "no objects are listed yet; try again");
  return JsonAnswer(*json);
}

void LogApi::GetCell(const HttpTarget& target, int64_t frames, const WebHandler::Reply& reply) {
  if (target.query.size() != 1 || !target.query.contains("at"))
    return reply(ErrorAnswer(400, "cell: say where with at=x,y,z [m]"));
  const Result<std::vector<double>> at = ReadNumbersOf("at", target.query.at("at"), 3);
  if (!at) return reply(ErrorAnswer(400, "cell: " + at.error().message));
  const Eigen::Vector3d at_W((*at)[0], (*at)[1], (*at)[2]);
  WithMap(frames, reply, [this, at_W](const MomentMaps::MapPtr& map, const auto& answer) {
    const Result<std::string> json =
        ExplainCell(map->map, map->metadata, config_.free_space, at_W, ClassName);
    answer(json ? JsonAnswer(*json) : ErrorAnswer(400, "cell: " + json.error().message));
  });
}

void LogApi::GetObjectFile(const std::string& name, int64_t frames,
                           const WebHandler::Reply& reply) {
  if (!IsObjectName(name)) return reply(WrongObjectName(name));
  WithMap(frames, reply, [this, name](const MomentMaps::MapPtr& map, const auto& answer) {
    thread_.Ask([this, map, name] { return files_.Ply(map, name, config_); }, answer);
  });
}

void LogApi::WithMap(int64_t frames, const WebHandler::Reply& reply, UseMap use) {
  if (recording_->CopyAt(frames) == nullptr)
    return reply(ErrorAnswer(503, "too few frames are mapped yet; try again"));
  const MapQuestion question{frames, MonotonicSeconds() + kLongestWait, reply, std::move(use)};
  if (Answer(question)) return;
  if (waiting_.size() >= kMostWaiting)
    return reply(ErrorAnswer(429, "too many questions wait for maps that are being computed"));
  waiting_.push_back(question);
}

bool LogApi::Answer(const MapQuestion& question) {
  const Result<MomentMaps::MapPtr> made = maps_.Get(question.frames);
  if (!made) {
    question.reply(ErrorAnswer(500, made.error().message));
    return true;
  }
  if (*made == nullptr && MonotonicSeconds() < question.give_up) return false;
  if (*made == nullptr) {
    question.reply(ErrorAnswer(503, "the map at this moment is being computed; try again"));
    return true;
  }
  question.use(*made, question.reply);
  return true;
}

void LogApi::Poll() {
  std::erase_if(waiting_, [this](const MapQuestion& question) { return Answer(question); });
  thread_.Poll();
}

void LogApi::GetSlice(const HttpTarget& target, const Moment& moment,
                      const WebHandler::Reply& reply) {
  const auto question = ReadSlice(target);
  if (!question) return reply(ErrorAnswer(400, question.error().message));
  SpacePtr space;
  const auto find = [&]() -> tl::expected<const OccupancyMap*, HttpAnswer> {
    Result<SpacePtr> found = SpaceAt(moment);
    if (!found) return tl::unexpected(ErrorAnswer(500, found.error().message));
    space = std::move(*found);
    return space.get();
  };
  const FollowerPosition position = PositionOf(moment);
  const auto found =
      slices_.Find(*question, recording_->voxel_size_m(), find, position, MonotonicSeconds());
  if (!found) return reply(found.error());
  if (AsksForDistances(target)) return GetDistances(**found, *question, moment, reply);
  reply({200, "application/octet-stream", EncodeSlice(**found, *question, position), ""});
}

void LogApi::GetDistances(const Slice& slice, const SliceQuestion& question, const Moment& moment,
                          const WebHandler::Reply& reply) {
  const Result<SpacePtr> space = SpaceAt(moment);
  if (!space) return reply(ErrorAnswer(500, space.error().message));
  thread_.Ask(
      [this, slice, question, space = *space, position = PositionOf(moment)]() -> HttpAnswer {
        const Result<SliceDistances> distances =
            slice.states.empty() ? Fail("nothing is known here")
                                 : DistancesIn(*space, slice, question, config_.octree);
        return {200, "application/octet-stream",
                EncodeSlice(slice, question, position, distances ? &*distances : nullptr,
                            distances ? "" : distances.error().message),
                ""};
      },
      reply);
}

void LogApi::GetLeaves(const HttpTarget& target, const Moment& moment,
                       const WebHandler::Reply& reply) {
  const auto question = ReadLeafQuestion(target);
  if (!question) return reply(ErrorAnswer(400, question.error().message));
  const double now = MonotonicSeconds();
  const FollowerPosition position = PositionOf(moment);
  if (leaves_.Keeps(*question, position, now)) return reply(leaves_.Cut(*question, now));
  if (!leaves_.MayCut(now)) return reply(LeafAnswers::Refusal());
  const Result<SpacePtr> space = SpaceAt(moment);
  if (!space) return reply(ErrorAnswer(500, space.error().message));
  thread_.Ask([this, question = *question, space = *space,
               utime = moment.utime] { return TreeOf(*space, question, utime, config_.octree); },
              [this, question = *question, position, reply](HttpAnswer tree) {
                if (tree.status != 200) return reply(std::move(tree));
                reply(leaves_.Take(question, position, tree.body, MonotonicSeconds()));
              });
}

void LogApi::GetEvidence(const HttpTarget& target, int64_t frames, const WebHandler::Reply& reply) {
  if (config_.viewer.evidence_mb <= 0) return reply(NoFramesKept());
  const bool only_id = target.query.size() == 1 && target.query.contains("id");
  if (!only_id || !ParseObjectName(target.query.at("id"))) return reply(NeedsObjectName());
  thread_.Ask([this, name = target.query.at("id"), frames] { return evidence_.List(name, frames); },
              reply);
}

void LogApi::GetFrame(const HttpTarget& target, int64_t frames, const WebHandler::Reply& reply) {
  if (config_.viewer.evidence_mb <= 0) return reply(NoFramesKept());
  const Result<PictureQuestion> picture = ReadPictureQuestion(target);
  if (!picture) return reply(ErrorAnswer(400, picture.error().message));
  thread_.Ask([this, picture = *picture, frames] { return evidence_.Picture(picture, frames); },
              reply);
}

Result<LogApi::SpacePtr> LogApi::SpaceAt(const Moment& moment) {
  const int64_t thinnings = recording_->thinnings();
  for (const Space& space : spaces_) {
    if (space.frames == moment.frames && space.thinnings == thinnings) return space.map;
  }
  Result<OccupancyMap> map = recording_->SpaceAt(moment.frames);
  if (!map) return tl::unexpected(map.error());
  spaces_.push_front(
      {moment.frames, thinnings, std::make_shared<const OccupancyMap>(std::move(*map))});
  if (spaces_.size() > kMostSpaces) spaces_.pop_back();
  return spaces_.front().map;
}

}  // namespace vismap
