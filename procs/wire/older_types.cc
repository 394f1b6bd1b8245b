#include "wire/older_types.h"

#include <algorithm>
#include <array>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/mesh_delta_t.hpp>
#include <vismap/octree_t.hpp>
#include <vismap/process_status_t.hpp>
#include <vismap/rgbd_frame_t.hpp>
#include <vismap/rgbd_frame_v1_t.hpp>
#include <vismap/segmented_frame_t.hpp>
#include <vismap/segmented_frame_v1_t.hpp>

#include "wire/envelope.h"
#include "wire/older_frame.h"
#include "wire/older_mesh.h"
#include "wire/older_octree.h"

namespace vismap {
namespace {

// process_status_t before it had findings: the current version has their number, 0, at its end.
Result<std::vector<uint8_t>> AddFindings(std::span<const uint8_t> bytes, size_t /*max_bytes*/) {
  constexpr size_t kNumberOfFindings = 4;
  std::vector<uint8_t> completed(bytes.begin(), bytes.end());
  completed.resize(bytes.size() + kNumberOfFindings);
  envelope::WriteBigEndian(process_status_t::getHash(), completed.data());
  return completed;
}

template <typename Message>
std::vector<uint8_t> Encoded(const Message& message) {
  std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

Result<std::vector<uint8_t>> ConvertSegmentedFrame(std::span<const uint8_t> bytes,
                                                   size_t max_bytes) {
  const auto older = envelope::UnpackExactly<segmented_frame_v1_t>(bytes, max_bytes);
  if (!older) return tl::unexpected(older.error());
  segmented_frame_t message{};
  message.utime = older->utime;
  message.seq = older->seq;
  message.source = older->source;
  message.frame = ToCurrentVersion(older->frame);
  message.had_detections = older->had_detections;
  message.n_segments = older->n_segments;
  message.segments = older->segments;
  message.label_encoding = older->label_encoding;
  message.label_size = older->label_size;
  message.labels = older->labels;
  return Encoded(message);
}

template <typename Older>
Result<std::vector<uint8_t>> Convert(std::span<const uint8_t> bytes, size_t max_bytes) {
  const auto older = envelope::UnpackExactly<Older>(bytes, max_bytes);
  if (!older) return tl::unexpected(older.error());
  return Encoded(ToCurrentVersion(*older));
}

std::span<const OlderType> OlderTypes() {
  static const std::array<OlderType, 7> kTypes = {
      OlderType{static_cast<int64_t>(0xdfd3012ff7311f8a), process_status_t::getHash(), AddFindings},
      OlderType{rgbd_frame_v1_t::getHash(), rgbd_frame_t::getHash(), Convert<rgbd_frame_v1_t>},
      OlderType{segmented_frame_v1_t::getHash(), segmented_frame_t::getHash(),
                ConvertSegmentedFrame},
      OlderType{octree_v1_t::getHash(), octree_t::getHash(), Convert<octree_v1_t>},
      OlderType{map_request_v1_t::getHash(), map_request_t::getHash(), Convert<map_request_v1_t>},
      OlderType{map_reply_v1_t::getHash(), map_reply_t::getHash(), Convert<map_reply_v1_t>},
      OlderType{mesh_delta_v1_t::getHash(), mesh_delta_t::getHash(), Convert<mesh_delta_v1_t>}};
  return kTypes;
}

}  // namespace

const OlderType* FindOlderType(int64_t fingerprint) {
  const std::span<const OlderType> types = OlderTypes();
  const auto found = std::find_if(types.begin(), types.end(), [&](const OlderType& type) {
    return type.fingerprint == fingerprint;
  });
  return found == types.end() ? nullptr : &*found;
}

std::optional<Result<std::vector<uint8_t>>> ConvertOlderMessage(std::span<const uint8_t> bytes,
                                                                size_t max_bytes) {
  if (bytes.size() < 8) return std::nullopt;
  const OlderType* older = FindOlderType(envelope::ReadFingerprint(bytes));
  if (older == nullptr) return std::nullopt;
  return older->convert(bytes, max_bytes);
}

}  // namespace vismap
