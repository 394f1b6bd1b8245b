#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "geometry/image.h"
#include "geometry/pose.h"
#include "mcap/foxglove_file.h"

// Not for other rooms: fields that several messages of foxglove.proto have. The templates keep its
// generated code out of this header.

namespace vismap {

/// The frame of all coordinates of the map.
inline constexpr char kWorldFrame[] = "world";

template <typename Message>
FoxgloveMessage EncodeFoxglove(const Message& message) {
  return {message.GetTypeName(), message.SerializeAsString()};
}

/// A google.protobuf.Timestamp; negative times become 0.
template <typename Timestamp>
void SetTime(int64_t utime, Timestamp* timestamp) {
  const int64_t time = utime < 0 ? 0 : utime;
  timestamp->set_seconds(time / 1'000'000);
  timestamp->set_nanos(static_cast<int32_t>(time % 1'000'000) * 1000);
}

template <typename Vector>
void SetVector(const Eigen::Vector3d& value, Vector* vector) {
  vector->set_x(value.x());
  vector->set_y(value.y());
  vector->set_z(value.z());
}

template <typename Quaternion>
void SetRotation(const Eigen::Quaterniond& value, Quaternion* rotation) {
  rotation->set_x(value.x());
  rotation->set_y(value.y());
  rotation->set_z(value.z());
  rotation->set_w(value.w());
}

template <typename PoseMessage>
void SetPose(const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation,
             PoseMessage* pose) {
  SetVector(position, pose->mutable_position());
  SetRotation(rotation, pose->mutable_orientation());
}

template <typename PoseMessage>
void SetPose(const Pose& value, PoseMessage* pose) {
  SetPose(value.translation(), Eigen::Quaterniond(value.linear()), pose);
}

template <typename Color>
void SetColor(Rgb8 value, double alpha, Color* color) {
  color->set_r(value.r / 255.0);
  color->set_g(value.g / 255.0);
  color->set_b(value.b / 255.0);
  color->set_a(alpha);
}

template <typename Message>
void AddMetadata(const std::string& key, const std::string& value, Message* message) {
  auto* pair = message->add_metadata();
  pair->set_key(key);
  pair->set_value(value);
}

/// Appends the bytes of a number, little-endian as all computers that vismap runs on.
template <typename Number>
void AppendNumber(Number value, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

}  // namespace vismap
