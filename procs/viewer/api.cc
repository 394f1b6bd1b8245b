#include "viewer/api.h"

#include <utility>

#include "base/printable.h"
#include "runtime/clock.h"
#include "viewer/leaves.h"
#include "viewer/moment_files.h"
#include "viewer/slice_distances.h"

namespace vismap {
namespace {

constexpr double kObjectsKept = 2;  // [s]
constexpr size_t kMostPayload = 64 << 20;
constexpr const char* kExporter = "octomap-exporter";
constexpr const char* kNoExporter =
    "no octomap exporter was heard in the last 3 s; start vismap-octomap-exporter";

int StatusOf(Questions::Refusal reason) {
  switch (reason) {
    case Questions::Refusal::kTooMany:
      return 429;
    case Questions::Refusal::kNoAnswer:
      return 504;
    case Questions::Refusal::kRefused:
      break;
  }
  return 400;
}

// The payload of an answer of the map server.
HttpAnswer AnswerWith(const Questions::Answered& answer, const std::string& content_type,
                      const std::string& file_name) {
  if (!answer) return ErrorAnswer(StatusOf(answer.error().reason), answer.error().sentence);
  if (answer->payload.size() > kMostPayload)
    return ErrorAnswer(413,
                       "the answer is larger than 64 MB; vismap-map export writes it to a file");
  return {200, content_type, answer->payload, file_name};
}

HttpAnswer BytesAnswer(std::vector<uint8_t> bytes) {
  return {200, "application/octet-stream", std::move(bytes), ""};
}

Result<SliceDistances> DistancesIn(const Questions::Answered& answer, const Slice& slice,
                                   const SliceQuestion& question,
                                   const FollowerPosition& position) {
  if (!answer) return Fail(answer.error().sentence);
  if (answer->map_id != position.map_id) return Fail("the octomap exporter has another map");
  return ReadDistances(answer->payload, slice, question);
}

}  // namespace

void Api::Get(const HttpTarget& target, const WebHandler::Reply& reply) {
  const std::string& path = target.path;
  if (path == "/api/map") return reply(JsonAnswer(MapText(board_->map, 0, false)));
  if (path == "/api/processes")
    return reply(JsonAnswer(processes_->Text(MonotonicSeconds(), WallUtime())));
  if (path == "/api/objects") return GetObjects(target, reply);
  if (path == "/api/slice") return GetSlice(target, reply);
  if (path == "/api/leaves") return GetLeaves(target, reply);
  if (path == "/api/cell") return GetCell(target, reply);
  if (const auto object = ObjectOfPath(path)) return GetObjectFile(*object, reply);
  reply(ErrorAnswer(404, "there is no '" + PrintableText(path, 100) +
                             "'; there are /api/map, /api/objects, /api/processes, "
                             "/api/slice?axis=z&at=1.0, /api/leaves?axis=z&at=1.0, "
                             "/api/cell?at=x,y,z, /api/object/ID.ply, /api/evidence?id=ID and "
                             "/api/frame/CAMERA/UTIME.jpg"));
}

void Api::GetObjects(const HttpTarget& target, const WebHandler::Reply& reply) {
  std::string argument;
  for (const auto& [key, value] : target.query) {
    if ((key != "id" && key != "class" && key != "region") || value.find(';') != std::string::npos)
      return reply(ErrorAnswer(400, "objects: the arguments are id, class and region"));
    argument += (argument.empty() ? "" : ";") + key + "=" + value;
  }
  const bool kept =
      objects_map_id_ == board_->map.map_id &&
      (MonotonicSeconds() < objects_until_ || objects_revision_ == board_->map.revision);
  if (argument.empty() && kept && !objects_.empty())
    return reply({200, "application/json", objects_, ""});
  questions_->Ask("objects", argument,
                  [this, reply, all = argument.empty()](const Questions::Answered& answer) {
                    if (answer && all && answer->payload.size() <= kMostPayload) {
                      objects_ = answer->payload;
                      objects_map_id_ = answer->map_id;
                      objects_revision_ = answer->revision;
                      objects_until_ = MonotonicSeconds() + kObjectsKept;
                    }
                    reply(AnswerWith(answer, "application/json", ""));
                  });
}

void Api::GetCell(const HttpTarget& target, const WebHandler::Reply& reply) {
  if (target.query.size() != 1 || !target.query.contains("at"))
    return reply(ErrorAnswer(400, "cell: say where with at=x,y,z [m]"));
  questions_->Ask("cell", "at=" + target.query.at("at"),
                  [reply](const Questions::Answered& answer) {
                    reply(AnswerWith(answer, "application/json", ""));
                  });
}

void Api::GetObjectFile(const std::string& name, const WebHandler::Reply& reply) {
  if (!IsObjectName(name)) return reply(WrongObjectName(name));
  questions_->Ask("mesh", "id=" + name, [reply, name](const Questions::Answered& answer) {
    reply(AnswerWith(answer, "application/octet-stream", "object-" + name + ".ply"));
  });
}

void Api::GetSlice(const HttpTarget& target, const WebHandler::Reply& reply) {
  const auto question = ReadSlice(target);
  if (!question) return reply(ErrorAnswer(400, question.error().message));
  if (!space_->occupancy())
    return reply(ErrorAnswer(503, "nothing is known yet: no free space has come on MAP_DELTA"));
  const FollowerPosition& position = space_->position();
  const auto found = slices_.Find(*question, *space_->occupancy(), position, MonotonicSeconds());
  if (!found) return reply(found.error());
  const Slice& slice = **found;
  if (!AsksForDistances(target)) return reply(BytesAnswer(EncodeSlice(slice, *question, position)));
  if (!processes_->IsAlive(kExporter, MonotonicSeconds()) || slice.states.empty()) {
    const std::string problem = slice.states.empty() ? "nothing is known here" : kNoExporter;
    return reply(BytesAnswer(EncodeSlice(slice, *question, position, nullptr, problem)));
  }
  questions_->Ask(DistanceRequest(slice, *question), [reply, slice, question = *question,
                                                      position](const Questions::Answered& answer) {
    const auto distances = DistancesIn(answer, slice, question, position);
    reply(BytesAnswer(EncodeSlice(slice, question, position, distances ? &*distances : nullptr,
                                  distances ? "" : distances.error().message)));
  });
}

void Api::GetLeaves(const HttpTarget& target, const WebHandler::Reply& reply) {
  const auto question = ReadLeafQuestion(target);
  if (!question) return reply(ErrorAnswer(400, question.error().message));
  const double now = MonotonicSeconds();
  if (leaves_.Keeps(*question, {board_->map.map_id, board_->map.revision}, now))
    return reply(leaves_.Cut(*question, now));
  if (!processes_->IsAlive(kExporter, now)) return reply(ErrorAnswer(503, kNoExporter));
  if (!leaves_.MayCut(now)) return reply(LeafAnswers::Refusal());
  questions_->Ask(TreeRequest(*question),
                  [this, reply, question = *question](const Questions::Answered& answer) {
                    if (!answer) return reply(AnswerWith(answer, "", ""));
                    if (answer->payload.size() > kMostPayload)
                      return reply(ErrorAnswer(413, "the octree is larger than 64 MB"));
                    reply(leaves_.Take(question, {answer->map_id, answer->revision},
                                       answer->payload, MonotonicSeconds()));
                  });
}

}  // namespace vismap
