#include "wire/envelope.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vismap/detections_t.hpp>
#include <vismap/map_delta_t.hpp>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/mesh_delta_t.hpp>
#include <vismap/object_list_t.hpp>
#include <vismap/octree_t.hpp>
#include <vismap/process_status_t.hpp>
#include <vismap/rgbd_frame_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "support/mutations.h"
#include "wire/channels.h"
#include "wire/fingerprint.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

map_delta_t SmallDelta() {
  map_delta_t delta{};
  delta.utime = 7;
  delta.seq = 3;
  delta.source = "server";
  delta.map_id = "m";
  delta.payload = {1, 2, 3, 4, 5};
  delta.payload_size = 5;
  return delta;
}

void Append32(std::vector<uint8_t>* bytes, int64_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes->push_back(static_cast<uint8_t>(value >> shift));
}

TEST(Envelope, UnpackInvertsPack) {
  map_delta_t delta = SmallDelta();
  const auto back = Unpack<map_delta_t>(Pack(delta), 1000);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->payload, delta.payload);
  EXPECT_EQ(back->map_id, "m");
  EXPECT_NE(back->checksum, 0);
}

TEST(Envelope, ChecksumDetectsEveryDamagedByteAfterIt) {
  map_delta_t delta = SmallDelta();
  const std::vector<uint8_t> good = Pack(delta);
  for (size_t i = envelope::ChecksumOffset(delta.source); i < good.size(); ++i) {
    std::vector<uint8_t> bad = good;
    bad[i] ^= 0x10;
    EXPECT_FALSE(Unpack<map_delta_t>(bad, 1000)) << "byte " << i;
  }
}

TEST(Envelope, ZeroChecksumIsNotVerified) {
  map_delta_t delta = SmallDelta();
  std::vector<uint8_t> bytes = Pack(delta);
  envelope::WriteBigEndian(0, bytes.data() + envelope::ChecksumOffset(delta.source));
  EXPECT_TRUE(Unpack<map_delta_t>(bytes, 1000));
}

TEST(Envelope, UnpackRejectsTooLargeTrailingAndForeignMessages) {
  map_delta_t delta = SmallDelta();
  std::vector<uint8_t> bytes = Pack(delta);
  EXPECT_THAT(Unpack<map_delta_t>(bytes, bytes.size() - 1).error().message,
              HasSubstr("more than the allowed"));
  EXPECT_THAT(Unpack<mesh_delta_t>(bytes, 1000).error().message, HasSubstr("fingerprint"));
  bytes.push_back(0);
  EXPECT_THAT(Unpack<map_delta_t>(bytes, 1000).error().message, HasSubstr("end after"));
  EXPECT_FALSE(Unpack<map_delta_t>({}, 1000));
}

TEST(Envelope, PeekHeadNeedsOnlyTheHead) {
  map_delta_t delta = SmallDelta();
  const std::vector<uint8_t> bytes = Pack(delta);
  const auto head = PeekHead(bytes);
  ASSERT_TRUE(head);
  EXPECT_EQ(head->fingerprint, map_delta_t::getHash());
  EXPECT_EQ(head->utime, 7);
  EXPECT_EQ(head->seq, 3);
  EXPECT_EQ(head->source, "server");
  for (size_t size = 0; size < 28; ++size) EXPECT_FALSE(PeekHead(std::span(bytes).first(size)));
}

TEST(Envelope, ArrayLongerThanItsSizeFieldThrows) {
  map_delta_t delta = SmallDelta();
  delta.payload_size = 5;
  delta.map_id = std::string("a\0b", 3);  // encodes to fewer bytes than stated
  EXPECT_THROW(Pack(delta), std::logic_error);
}

TEST(Guard, ImpossibleLengthsAreRejectedWithoutAllocation) {
  for (const int64_t length :
       {-1L, -2147483648L, 2147483647L, 0x40000001L, 0x20000001L, 100000000L}) {
    std::vector<uint8_t> detections(8);
    envelope::WriteBigEndian(detections_t::getHash(), detections.data());
    detections.resize(8 + 16);  // utime, seq
    Append32(&detections, 1);   // source ""
    detections.push_back(0);
    detections.resize(detections.size() + 8 + 4 + 8 + 4 + 4);  // checksum .. image_height
    std::vector<uint8_t> list = detections;
    Append32(&list, length);  // n_detections
    list.resize(list.size() + 100);
    EXPECT_FALSE(Unpack<detections_t>(list, 1000)) << length;
    std::vector<uint8_t> runs = detections;
    Append32(&runs, 1);
    runs.resize(runs.size() + 8);  // class_id, score
    Append32(&runs, length);       // n_runs
    runs.resize(runs.size() + 100);
    EXPECT_FALSE(Unpack<detections_t>(runs, 1000)) << length;
    std::vector<uint8_t> text(8 + 16);
    envelope::WriteBigEndian(detections_t::getHash(), text.data());
    Append32(&text, length);  // length of source
    text.resize(text.size() + 100);
    EXPECT_FALSE(Unpack<detections_t>(text, 1000)) << length;
    EXPECT_FALSE(PeekHead(text)) << length;
  }
}

TEST(Guard, StringWithoutTerminatorIsRejected) {
  process_status_t status{};
  status.source = "abc";
  std::vector<uint8_t> bytes = Pack(status);
  bytes[8 + 16 + 4 + 3] = 'd';  // the terminator of source
  EXPECT_FALSE(Unpack<process_status_t>(bytes, 1000));
  bytes[8 + 16 + 4 + 3] = 0;
  bytes[8 + 16 + 4 + 1] = 0;  // a NUL inside
  EXPECT_FALSE(Unpack<process_status_t>(bytes, 1000));
}

template <typename Message>
void ExpectMutationsToBeHandled(Message message) {
  const std::vector<uint8_t> good = Pack(message);
  ForEachMutation(good, 5000,
                  [](const std::vector<uint8_t>& bytes) { (void)Unpack<Message>(bytes, 1 << 20); });
}

TEST(Guard, NoMutationCrashesADecoder) {
  object_list_t objects{};
  objects.objects.resize(3);
  for (object_t& object : objects.objects) {
    object.class_name = "chair";
    object.segments = {1, 2, 3};
    object.n_segments = 3;
  }
  objects.n_objects = 3;
  ExpectMutationsToBeHandled(objects);
  mesh_delta_t mesh{};
  mesh.blocks.resize(2);
  mesh.n_blocks = 2;
  ExpectMutationsToBeHandled(mesh);
  process_status_t status{};
  status.counter_names = {"a", "b"};
  status.counter_values = {1, 2};
  status.n_counters = 2;
  ExpectMutationsToBeHandled(status);
  ExpectMutationsToBeHandled(octree_t{});
  ExpectMutationsToBeHandled(map_request_t{});
  ExpectMutationsToBeHandled(map_reply_t{});
  ExpectMutationsToBeHandled(SmallDelta());
}

TEST(Channels, NamesContainNoRegularExpressionCharacters) {
  for (const Channel& channel :
       {kRgbdFrameChannel, kDetectionsChannel, kSegmentedFrameChannel, kMapCommitChannel,
        kMapDeltaChannel, kMeshDeltaChannel, kObjectsChannel, kOctomapChannel, kMapRequestChannel,
        kMapReplyChannel, kStatusChannel}) {
    EXPECT_THAT(std::string(channel.name), ::testing::MatchesRegex("[A-Z_]+"));
    EXPECT_LE(channel.max_bytes, kMaxMessageBytes);
  }
}

// Bytes of a process_status_t of the version before it had findings.
std::vector<uint8_t> OldStatus() {
  process_status_t status{};
  status.source = "map-server";
  status.seq = 7;
  status.state = "running";
  status.counter_names = {"frames"};
  status.counter_values = {3};
  status.n_counters = 1;
  std::vector<uint8_t> bytes = Pack(status);
  bytes.resize(bytes.size() - 4);  // the number of findings
  const std::array<uint8_t, 8> fingerprint = {0xdf, 0xd3, 0x01, 0x2f, 0xf7, 0x31, 0x1f, 0x8a};
  std::copy(fingerprint.begin(), fingerprint.end(), bytes.begin());
  return bytes;
}

TEST(OlderTypes, StatusWithoutFindingsIsRead) {
  const Result<process_status_t> status = Unpack<process_status_t>(OldStatus(), 1000);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(status->source, "map-server");
  EXPECT_EQ(status->state, "running");
  EXPECT_EQ(status->counter_values, std::vector<int64_t>{3});
  EXPECT_TRUE(status->findings.empty());
  const std::optional<MessageHead> head = PeekHead(OldStatus());
  ASSERT_TRUE(head);
  EXPECT_EQ(head->fingerprint, process_status_t::getHash());
  EXPECT_EQ(head->seq, 7);
  std::vector<uint8_t> cut = OldStatus();
  cut.resize(cut.size() - 1);
  EXPECT_FALSE(Unpack<process_status_t>(cut, 1000));
}

TEST(TypesFingerprint, IsDeterministic) { EXPECT_EQ(TypesFingerprint(), TypesFingerprint()); }

}  // namespace
}  // namespace vismap
