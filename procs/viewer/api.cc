#include "viewer/api.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "base/printable.h"
#include "runtime/clock.h"

namespace vismap {
namespace {

constexpr double kObjectsKept = 2;  // [s]
constexpr size_t kMostPayload = 64 << 20;

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

// 7 or s12
bool IsObjectName(const std::string& name) {
  const std::string digits = name.starts_with('s') ? name.substr(1) : name;
  return !digits.empty() && digits.size() <= 10 &&
         std::all_of(digits.begin(), digits.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

}  // namespace

void Api::Get(const HttpTarget& target, const WebHandler::Reply& reply) {
  constexpr std::string_view kObject = "/api/object/", kPly = ".ply";
  const std::string& path = target.path;
  if (path == "/api/map") return reply(JsonAnswer(MapText(board_->map, 0, false)));
  if (path == "/api/processes")
    return reply(JsonAnswer(processes_->Text(MonotonicSeconds(), WallUtime())));
  if (path == "/api/objects") return GetObjects(target, reply);
  if (path == "/api/slice") return reply(GetSlice(target));
  if (path == "/api/cell") return GetCell(target, reply);
  if (path.starts_with(kObject) && path.ends_with(kPly) &&
      path.size() > kObject.size() + kPly.size())
    return GetObjectFile(path.substr(kObject.size(), path.size() - kObject.size() - kPly.size()),
                         reply);
  reply(ErrorAnswer(404, "there is no '" + PrintableText(path, 100) +
                             "'; there are /api/map, /api/objects, /api/processes, "
                             "/api/slice?axis=z&at=1.0, /api/cell?at=x,y,z, "
                             "/api/object/ID.ply, /api/evidence?id=ID and "
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
  if (!IsObjectName(name))
    return reply(ErrorAnswer(400,
                             "an object is named by its instance, such as 7, or by a segment, "
                             "such as s12; found '" +
                                 PrintableText(name, 60) + "'"));
  questions_->Ask("mesh", "id=" + name, [reply, name](const Questions::Answered& answer) {
    reply(AnswerWith(answer, "application/octet-stream", "object-" + name + ".ply"));
  });
}

HttpAnswer Api::GetSlice(const HttpTarget& target) {
  if (const auto question = ReadSlice(target); !question)
    return ErrorAnswer(400, question.error().message);
  if (!space_->occupancy())
    return ErrorAnswer(503, "nothing is known yet: no free space has come on MAP_DELTA");
  return slices_.Get(target, *space_->occupancy(), space_->position(), MonotonicSeconds());
}

}  // namespace vismap
