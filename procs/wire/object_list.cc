#include "wire/object_list.h"

#include <cmath>
#include <map>
#include <utility>

namespace vismap {
namespace {

object_t EncodeObject(const ObjectSummary& object, const ClassNamer& class_name) {
  object_t message{};
  message.instance = Raw(object.instance);
  message.discovered = object.discovered();
  message.class_id = Raw(object.class_id);
  message.class_name = object.class_id == ClassId::kUnknown ? "" : class_name(object.class_id);
  for (const auto& [class_id, probability] : object.class_probability) {
    message.class_ids.push_back(Raw(class_id));
    message.class_probabilities.push_back(static_cast<float>(probability));
  }
  message.n_classes = static_cast<int32_t>(message.class_ids.size());
  message.score = static_cast<float>(object.score);
  for (const SegmentLabel label : object.segments) message.segments.push_back(Raw(label));
  message.n_segments = static_cast<int32_t>(message.segments.size());
  message.points = object.points;
  message.area_m2 = object.area;
  for (int axis = 0; axis < 3; ++axis) {
    message.center_W[axis] = object.box.center_W[axis];
    message.size_m[axis] = object.box.size[axis];
  }
  const Eigen::Quaterniond& q = object.box.R_W_B;
  message.orientation[0] = q.w();
  message.orientation[1] = q.x();
  message.orientation[2] = q.y();
  message.orientation[3] = q.z();
  message.frames = static_cast<int32_t>(object.frames);
  message.first_utime = object.first_utime;
  message.last_utime = object.last_utime;
  message.removed_utime = object.removed_utime;
  return message;
}

Result<std::map<ClassId, double>> DecodeProbabilities(const object_t& message) {
  std::map<ClassId, double> probabilities;
  for (size_t i = 0; i < message.class_ids.size(); ++i) {
    const int32_t id = message.class_ids[i];
    const float probability = message.class_probabilities[i];
    if (id < 1 || id > 65535) return Fail("a class id in class_ids is outside [1, 65535]");
    if (!(probability >= 0 && probability <= 1)) return Fail("a probability is outside [0, 1]");
    probabilities[static_cast<ClassId>(id)] = static_cast<double>(probability);
  }
  return probabilities;
}

Result<ObjectSummary> DecodeObject(const object_t& message) {
  const std::string where = "object with instance " + std::to_string(message.instance) + ": ";
  if (message.instance < 0 || message.instance > UINT32_MAX)
    return Fail(where + "the instance is not in [0, 2^32)");
  if (message.class_id < 0 || message.class_id > 65535) {
    return Fail(where + "class_id is " + std::to_string(message.class_id) +
                ", expected [0, 65535]");
  }
  if (!(message.score >= 0 && message.score <= 1)) return Fail(where + "score is outside [0, 1]");
  ObjectSummary object;
  object.instance = static_cast<InstanceId>(message.instance);
  object.class_id = static_cast<ClassId>(message.class_id);
  auto probabilities = DecodeProbabilities(message);
  if (!probabilities) return Fail(where + probabilities.error().message);
  object.class_probability = std::move(*probabilities);
  object.score = message.score;
  for (const int64_t label : message.segments) {
    if (label < 1 || label > UINT32_MAX) return Fail(where + "a segment label is not in [1, 2^32)");
    object.segments.push_back(static_cast<SegmentLabel>(label));
  }
  if (!(message.area_m2 >= 0)) return Fail(where + "area_m2 is negative or not a number");
  object.points = message.points;
  object.area = message.area_m2;
  object.box.center_W = Eigen::Vector3d(message.center_W);
  object.box.size = Eigen::Vector3d(message.size_m);
  object.box.R_W_B = Eigen::Quaterniond(message.orientation[0], message.orientation[1],
                                        message.orientation[2], message.orientation[3]);
  const bool finite = object.box.center_W.allFinite() && object.box.size.allFinite() &&
                      std::abs(object.box.R_W_B.norm() - 1) < 1e-3;
  if (!finite)
    return Fail(where + "its box is not finite, or its orientation is not a unit quaternion");
  object.frames = static_cast<uint32_t>(std::max(message.frames, 0));
  object.first_utime = message.first_utime;
  object.last_utime = message.last_utime;
  object.removed_utime = message.removed_utime;
  object.state = message.removed_utime != 0 ? ObjectState::kRemoved : ObjectState::kPresent;
  return object;
}

}  // namespace

object_list_t Encode(const ObjectList& list, const ClassNamer& class_name) {
  object_list_t message{};
  message.utime = list.utime;
  message.map_id = list.map_id;
  message.revision = list.revision;
  for (const ObjectSummary& object : list.objects) {
    if (object.is_structure()) continue;
    message.objects.push_back(EncodeObject(object, class_name));
  }
  message.n_objects = static_cast<int32_t>(message.objects.size());
  return message;
}

Result<ObjectList> Decode(const object_list_t& message) {
  ObjectList list{message.utime, message.map_id, message.revision, {}};
  for (const object_t& element : message.objects) {
    Result<ObjectSummary> object = DecodeObject(element);
    if (!object)
      return Fail("object_list_t of map '" + message.map_id + "': " + object.error().message);
    list.objects.push_back(std::move(*object));
  }
  return list;
}

}  // namespace vismap
