#include "hostile_messages.h"

#include <algorithm>
#include <vismap/frame_commit_t.hpp>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/navigation_status_t.hpp>
#include <vismap/pose_correction_t.hpp>
#include <vismap/process_status_t.hpp>

#include "codecs/frame_codec.h"
#include "codecs/zstd_codec.h"
#include "foreign_messages.h"
#include "freespace/occupancy_codec.h"
#include "rectify/rectifier.h"
#include "support/messages.h"
#include "support/occupancy_snapshot.h"
#include "wire/channels.h"
#include "wire/detections.h"
#include "wire/distance_follower.h"
#include "wire/envelope.h"
#include "wire/grid_message.h"
#include "wire/map_update.h"
#include "wire/mesh_follower.h"
#include "wire/object_list.h"
#include "wire/octree_message.h"
#include "wire/octree_update.h"
#include "wire/pose_correction.h"
#include "wire/rgbd_frame.h"
#include "wire/segmented_frame.h"

namespace vismap {
namespace {

using Spoil = std::function<std::vector<uint8_t>(TestRandom*)>;
using testing_support::SnapshotOf;

template <typename Value>
Result<void> Accepted(const Result<Value>& value) {
  if (!value) return tl::unexpected(value.error());
  return {};
}

/// `use(message)` is what processes do with an unpacked message.
template <typename Message, typename Use>
FuzzTarget Target(const Channel& channel, Message message, Use use) {
  message.seq = 3;
  message.source = "seed";
  FuzzTarget target;
  target.type = Message::getTypeName();
  target.channel_bytes = channel.max_bytes;
  target.good = Pack(message);
  if constexpr (Checksummed<Message>) {
    target.checksum_offset = envelope::ChecksumOffset(message.source);
  }
  target.decode = [channel, use](std::span<const uint8_t> bytes) -> Result<void> {
    const Result<Message> unpacked = Unpack<Message>(bytes, channel.max_bytes);
    if (!unpacked) return tl::unexpected(unpacked.error());
    return use(*unpacked);
  };
  return target;
}

template <typename Message>
FuzzTarget UnpackedOnly(const Channel& channel, Message message) {
  return Target(channel, std::move(message), [](const Message&) { return Result<void>(); });
}

void ChangeBytes(TestRandom* random, std::vector<uint8_t>* bytes) {
  for (uint64_t n = 1 + random->Below(4); n > 0 && !bytes->empty(); --n) {
    (*bytes)[random->Below(bytes->size())] = static_cast<uint8_t>(random->Next());
  }
}

/// Decompresses `code`, changes bytes and sometimes the length, and compresses it again.
template <typename Size>
void SpoilCompressed(TestRandom* random, std::vector<uint8_t>* code, Size* size) {
  Result<std::vector<uint8_t>> content = DecompressBytes(*code, 0, size_t{1} << 24);
  ChangeBytes(random, &*content);
  if (random->Below(8) == 0) content->resize(random->Below(2 * content->size() + 1));
  *code = CompressBytes(*content);
  *size = static_cast<Size>(code->size());
}

template <typename Message, typename Change>
Spoil Spoiling(const Message& good, Change change) {
  return [good, change](TestRandom* random) {
    Message message = good;
    change(random, &message);
    return Pack(message);
  };
}

// Memory per pixel of the images that decoders create: depth in metres; also depth in units, colour
// and the coefficients of a progressive JPEG; and labels as runs and as an image.
constexpr size_t kDepthPixel = 4;
constexpr size_t kFramePixel = 20;
constexpr size_t kLabelRunsPixel = 10;
constexpr size_t kLabelPixel = kLabelRunsPixel + 4;

// Cameras with distortion and depth beside colour: possible ones, and others.
void SpoilOptics(TestRandom* random, rgbd_frame_t* message) {
  for (camera_t* camera : {&message->color_camera, &message->depth_camera}) {
    camera->distortion = static_cast<int8_t>(random->Below(4));
    camera->coefficients.assign(random->Below(9), 0.0);
    camera->num_coefficients = static_cast<int32_t>(camera->coefficients.size());
    for (double& k : camera->coefficients)
      k = 0.1 * (static_cast<double>(random->Below(2001)) - 1000) / 1000;
    if (random->Below(4) == 0) camera->fx *= static_cast<double>(random->Below(30)) / 10;
  }
  message->depth_registered = static_cast<int8_t>(random->Below(2));
  for (const size_t shift : {3, 7, 11})
    message->T_color_depth[shift] = (static_cast<double>(random->Below(201)) - 100) / 90;
}

FuzzTarget RgbdFrameTarget() {
  const rgbd_frame_t good = Encode(SmallSensorFrame());
  FuzzTarget target = Target(kRgbdFrameChannel, good, [](const rgbd_frame_t& message) {
    const Result<SensorFrame> sensor = Decode(message);
    Rectifier rectifier;
    return sensor ? Accepted(rectifier.Decode(*sensor)) : Accepted(sensor);
  });
  target.spoil_inside = Spoiling(good, [](TestRandom* random, rgbd_frame_t* message) {
    SpoilCompressed(random, &message->depth, &message->depth_size);
    if (random->Below(2) == 0) ChangeBytes(random, &message->color);
    if (random->Below(4) == 0) message->depth_encoding = static_cast<int8_t>(random->Below(7));
    if (random->Below(4) == 0) message->color_encoding = static_cast<int8_t>(random->Below(9));
    if (random->Below(4) == 0) SpoilOptics(random, message);
  });
  target.largest_content = kDepthPixel * kMaxDecodedPixels;
  target.peak_content = kFramePixel * kMaxDecodedPixels;
  return target;
}

FuzzTarget DetectionsTarget() {
  const detections_t good = Encode(SmallDetections(), kSmallCamera.width, kSmallCamera.height);
  FuzzTarget target = Target(kDetectionsChannel, good,
                             [](const detections_t& message) { return Accepted(Decode(message)); });
  // Run lengths that still fill the image: two adjacent runs exchange pixels.
  target.spoil_inside = Spoiling(good, [](TestRandom* random, detections_t* message) {
    std::vector<int32_t>& runs = message->detections[random->Below(2)].runs;
    const size_t at = random->Below(runs.size() - 1);
    const auto moved = static_cast<int32_t>(random->Below(100)) - 50;
    runs[at] += moved;
    runs[at + 1] -= moved;
    const int32_t sides[] = {1, 48, 64, 3072, 16384, -64};
    message->image_width = random->Below(4) == 0 ? sides[random->Below(6)] : 64;
  });
  target.largest_content = kMaxDecodedPixels;
  target.peak_content = kMaxMaskPixels;
  return target;
}

FuzzTarget SegmentedFrameTarget() {
  const SensorFrame sensor = SmallSensorFrame();
  SegmentedFrame frame;
  frame.frame = *DecodeFrame(sensor);
  frame.image = {Image<SegmentIndex>(64, 48, SegmentIndex{0}), 1};
  for (int u = 0; u < 20; ++u) frame.image.index(5, u) = SegmentIndex::kNone;
  frame.segments.resize(1);
  frame.segments[0].pixels = 64 * 48 - 20;
  const segmented_frame_t good = Encode(frame, Encode(sensor));
  FuzzTarget target = Target(kSegmentedFrameChannel, good, [](const segmented_frame_t& message) {
    return Accepted(Decode(message));
  });
  target.spoil_inside = Spoiling(good, [](TestRandom* random, segmented_frame_t* message) {
    SpoilCompressed(random, &message->labels, &message->label_size);
    if (random->Below(4) == 0)
      message->frame.color_camera.width = static_cast<int32_t>(random->Below(20000)) - 100;
  });
  target.largest_content = kLabelRunsPixel * kMaxDecodedPixels;
  target.peak_content = (kFramePixel + kLabelPixel) * kMaxDecodedPixels;
  return target;
}

OccupancyMap SmallOccupancy() {
  OccupancyMap map(0.01);
  OccupancyPlanes planes;
  planes.free[1] = 0xff;
  planes.occupied[2] = 7;
  const BlockOccupancy mixed(planes);
  for (int32_t i = 0; i < 12; ++i) map.Set({i % 3, i, -i}, BlockOccupancy(CellState::kFree));
  for (int32_t i = 0; i < 5; ++i) map.Set({9, i, 0}, mixed);
  return map;
}

FuzzTarget MapDeltaTarget() {
  const map_delta_t good = Encode(MapUpdate{1, "map", 4, 3, 0, 1, SnapshotOf(SmallOccupancy())});
  FuzzTarget target = Target(kMapDeltaChannel, good, [](const map_delta_t& message) {
    const Result<MapUpdate> update = Decode(message);
    if (!update) return Accepted(update);
    OccupancyMap map(update->delta.voxel_size);
    return map.Apply(update->delta) ? Result<void>() : Fail("does not apply");
  });
  target.spoil_inside = Spoiling(good, [](TestRandom* random, map_delta_t* message) {
    SpoilCompressed(random, &message->payload, &message->payload_size);
  });
  target.largest_content = 2 * MaxOccupancyDeltaBytes(kMaxBlocksPerUpdate);
  target.peak_content = 6 * MaxOccupancyDeltaBytes(kMaxBlocksPerUpdate);
  return target;
}

FuzzTarget MeshDeltaTarget() {
  MeshUpdate update{7, "map", 3, false, 0, 1, 0.08, {4, {}}};
  for (int32_t i = 0; i < 3; ++i) {
    BlockMesh block{{i, 0, -i}, {}};
    block.mesh.vertices.resize(6);
    block.mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    update.mesh.blocks.push_back(block);
  }
  return Target(kMeshDeltaChannel, Encode(update), [](const mesh_delta_t& message) {
    MeshFollower().Apply(message);
    return Accepted(Decode(message));
  });
}

FuzzTarget ObjectsTarget() {
  ObjectList list{5, "map", 9, {}};
  for (uint32_t i = 1; i < 5; ++i) {
    ObjectSummary object;
    object.instance = InstanceId{i};
    object.class_id = ClassId{62};
    object.segments = {SegmentLabel{i}, SegmentLabel{8}};
    object.class_probability = {{ClassId{62}, 0.75}, {ClassId{63}, 0.25}};
    object.box.size = {0.5, 0.4, 0.9};
    list.objects.push_back(object);
  }
  const auto chair = [](ClassId) { return std::string("chair"); };
  return Target(kObjectsChannel, Encode(list, chair),
                [](const object_list_t& message) { return Accepted(Decode(message)); });
}

FuzzTarget OctreeTarget() {
  OctreeMessage octree;
  octree.map_id = "map";
  octree.octree = *BuildOctree(SmallOccupancy(), {});
  octree.assumed_free = {{1, 2, 3}};
  FuzzTarget target = Target(kOctomapChannel, Encode(octree),
                             [](const octree_t& message) { return Accepted(Decode(message)); });
  return target;
}

FuzzTarget OctreeDeltaTarget() {
  OctreeUpdate update;
  update.leaves.map_id = "map";
  update.leaves.delta = SnapshotOf(SmallOccupancy());
  update.shell = 1;
  const octree_delta_t good = Encode(update);
  FuzzTarget target = Target(kOctomapDeltaChannel, good, [](const octree_delta_t& message) {
    return Accepted(Decode(message));
  });
  target.spoil_inside = Spoiling(good, [](TestRandom* random, octree_delta_t* message) {
    SpoilCompressed(random, &message->payload, &message->payload_size);
  });
  target.largest_content = 2 * MaxOccupancyDeltaBytes(kMaxBlocksPerUpdate);
  target.peak_content = 6 * MaxOccupancyDeltaBytes(kMaxBlocksPerUpdate);
  return target;
}

FuzzTarget GridTarget() {
  GridMessage message{1, 2, "map", 3, {}, {}};
  message.grid.resolution_m = 0.05;
  message.grid.width = message.grid.height = 4;
  message.grid.states.assign(16, CellState::kFree);
  message.grid.distances_m.assign(16, 0.5F);
  message.grid.floor_m.assign(16, 0);
  return Target(kGridChannel, Encode(message),
                [](const occupancy_grid_t& grid) { return Accepted(Decode(grid)); });
}

FuzzTarget DistancesTarget() {
  DistanceUpdate update{{"map", 3, -1, true, 0, 1}, 1, 2, 0.05, 2, {}};
  for (int32_t i = 0; i < 4; ++i) update.blocks.emplace_back(BlockIndex{i, 0, -i}, std::nullopt);
  update.blocks[1].second.emplace();
  const distance_field_t good = Encode(update);
  FuzzTarget target = Target(kDistancesChannel, good, [](const distance_field_t& message) {
    Result<DistanceUpdate> read = Decode(message);
    if (!read) return Accepted(read);
    DistanceFollower().Apply(std::move(*read));
    return Result<void>();
  });
  target.spoil_inside = Spoiling(good, [](TestRandom* random, distance_field_t* message) {
    SpoilCompressed(random, &message->payload, &message->payload_size);
  });
  target.largest_content = 2 * MaxDistanceBytes(kMaxDistanceBlocks);
  target.peak_content = 6 * MaxDistanceBytes(kMaxDistanceBlocks);
  return target;
}

FuzzTarget CorrectionTarget() {
  const PoseCorrection correction{
      CameraId{0}, true, {{1, Pose::Identity()}, {2, Pose::Identity()}}};
  return Target(kPoseCorrectionChannel, Encode(correction),
                [](const pose_correction_t& message) { return Accepted(Decode(message)); });
}

navigation_status_t SomeNavigation() {
  navigation_status_t navigation{};
  navigation.map_id = "map";
  navigation.channels = {"OCTOMAP"};
  navigation.revisions = navigation.utimes = navigation.published_utimes = {1};
  navigation.n_outputs = 1;
  return navigation;
}

process_status_t SomeStatus() {
  process_status_t status{};
  status.process = "depth-segmenter";
  status.state = "running";
  status.counter_names = {"frames", "lost", "x"};
  status.counter_values = {5, 6, 7};
  status.n_counters = 3;
  status.timing_names = {"segmentation"};
  status.median_ms = status.max_ms = {1.5};
  status.n_timings = 1;
  return status;
}

map_reply_t SomeReply() {
  map_reply_t reply{};
  reply.requester = "map-tool";
  reply.message = "3 objects";
  reply.encoding = "json";
  reply.payload = std::vector<uint8_t>(100, '{');
  reply.payload_size = 100;
  return reply;
}

map_request_t SomeRequest() {
  map_request_t request{};
  request.verb = "octree";
  request.path = "/tmp/a";
  return request;
}

frame_commit_t SomeCommit() {
  frame_commit_t commit{};
  commit.map_id = "map";
  commit.digest = std::string(32, 'a');
  return commit;
}

std::vector<FuzzTarget> OwnFuzzTargets() {
  return {RgbdFrameTarget(),
          DetectionsTarget(),
          SegmentedFrameTarget(),
          MapDeltaTarget(),
          MeshDeltaTarget(),
          ObjectsTarget(),
          OctreeTarget(),
          OctreeDeltaTarget(),
          GridTarget(),
          DistancesTarget(),
          CorrectionTarget(),
          UnpackedOnly(kNavigationChannel, SomeNavigation()),
          UnpackedOnly(kMapCommitChannel, SomeCommit()),
          UnpackedOnly(kMapRequestChannel, SomeRequest()),
          UnpackedOnly(kMapReplyChannel, SomeReply()),
          UnpackedOnly(kStatusChannel, SomeStatus())};
}

}  // namespace

std::vector<FuzzTarget> AllFuzzTargets() {
  std::vector<FuzzTarget> targets = OwnFuzzTargets();
  for (FuzzTarget& target : ForeignFuzzTargets()) targets.push_back(std::move(target));
  return targets;
}

void WriteLength(int64_t length, size_t at, std::vector<uint8_t>* bytes) {
  for (size_t i = 0; i < 4 && at + i < bytes->size(); ++i)
    (*bytes)[at + i] = static_cast<uint8_t>(static_cast<uint64_t>(length) >> (24 - 8 * i));
}

void DropChecksum(const FuzzTarget& target, std::vector<uint8_t>* bytes) {
  if (target.checksum_offset == 0 || bytes->size() < target.checksum_offset + 8) return;
  std::fill_n(bytes->begin() + static_cast<std::ptrdiff_t>(target.checksum_offset), 8, uint8_t{0});
}

std::vector<uint8_t> Mutate(const FuzzTarget& target, TestRandom* random) {
  std::vector<uint8_t> bytes = target.good;
  switch (random->Below(target.spoil_inside ? 6 : 4)) {
    case 0:
      ChangeBytes(random, &bytes);
      break;
    case 1:
      bytes.resize(random->Below(bytes.size()));
      break;
    case 2:
      WriteLength(kHostileLengths[random->Below(std::size(kHostileLengths))],
                  8 + random->Below(bytes.size() - 8), &bytes);
      break;
    case 3: {
      const auto begin = static_cast<std::ptrdiff_t>(random->Below(bytes.size()));
      const std::vector<uint8_t> piece(bytes.begin() + begin, bytes.end());
      const auto at = static_cast<std::ptrdiff_t>(random->Below(bytes.size()));
      bytes.insert(bytes.begin() + at, piece.begin(), piece.end());
      break;
    }
    default:
      bytes = target.spoil_inside(random);
      if (random->Below(4) == 0) ChangeBytes(random, &bytes);
  }
  if (random->Below(4) != 0) DropChecksum(target, &bytes);
  return {bytes.begin(),
          bytes.end()};  // without spare capacity, so that reading past the end is detected
}

}  // namespace vismap
