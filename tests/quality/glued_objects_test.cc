// Bad masks of the first frames join two objects; later, good masks separate them again.
#include <gtest/gtest.h>

#include <algorithm>

#include "codecs/frame_codec.h"
#include "quality/mapped_sequence.h"
#include "segmentation/mask_sets.h"
#include "simulation/room.h"

namespace vismap {
namespace {

using testing_support::ChangedDetections;
using testing_support::Continue;
using testing_support::FindInMesh;
using testing_support::Mapped;
using testing_support::Seen;

constexpr char kGluedTours[] = "synthetic:room?frames=40&width=320&tours=2";

/// In the first frames, replaces all detections of a class by one detection with all their pixels.
ChangedDetections::Change GlueClass(ClassId class_id, int64_t frames) {
  return [=](const FrameHeader& header, DetectionSet* set) {
    if (header.frame_number > frames) return;
    Detection* first = nullptr;
    for (Detection& detection : set->detections) {
      if (detection.class_id != class_id) continue;
      if (first == nullptr) {
        first = &detection;
        continue;
      }
      first->mask = UnionOf(first->mask, detection.mask);
      detection.class_id = ClassId::kUnknown;  // to be erased
    }
    std::erase_if(set->detections,
                  [](const Detection& d) { return d.class_id == ClassId::kUnknown; });
  };
}

constexpr uint16_t kOneChair = 8, kOtherChair = 9;  // in the room
constexpr ClassId kChairs{62};

TEST(GluedObjects, OfOneTourOfBadMasksAreTwoObjectsAfterALaterOneOfGoodMasks) {
  const Scene room = MakeRoom();
  const ChangedDetections bad(kGluedTours, GlueClass(kChairs, 40));
  Mapped mapped;
  Continue(kGluedTours, &bad, 40, &mapped);
  const Seen glued = FindInMesh(room, kOneChair, mapped.products.mesh);
  EXPECT_EQ(FindInMesh(room, kOtherChair, mapped.products.mesh).instance, glued.instance)
      << "40 bad frames do glue them";

  Continue(kGluedTours, &bad, 60, &mapped);
  const Seen a = FindInMesh(room, kOneChair, mapped.products.mesh);
  const Seen b = FindInMesh(room, kOtherChair, mapped.products.mesh);
  EXPECT_NE(a.instance, b.instance);
  EXPECT_TRUE(a.instance == glued.instance || b.instance == glued.instance) << "one keeps the id";
  for (const Seen& chair : {a, b}) {
    EXPECT_EQ(chair.class_id, kChairs);
    EXPECT_GT(chair.share, 0.9);
  }

  Continue(kGluedTours, &bad, 80, &mapped);
  EXPECT_EQ(FindInMesh(room, kOneChair, mapped.products.mesh).instance, a.instance) << "ids stay";
  EXPECT_EQ(FindInMesh(room, kOtherChair, mapped.products.mesh).instance, b.instance);
}

size_t Named(const Mapped& mapped) {
  return static_cast<size_t>(std::ranges::count_if(
      mapped.products.objects, [](const ObjectSummary& object) { return !object.discovered(); }));
}

/// Adds to every detection a second one with two thirds of its mask, without the upper or lower
/// part.
void DetectTwice(const FrameHeader& header, DetectionSet* set) {
  const std::vector<Detection> once = set->detections;
  for (size_t i = 0; i < once.size(); ++i) {
    Detection again = once[i];
    Mask& mask = again.mask;
    const int height = mask.inside.height(), cut = height / 3;
    const bool lower = (i + static_cast<size_t>(header.frame_number)) % 2 == 0;
    for (int v = lower ? 0 : height - cut; v < (lower ? cut : height); ++v)
      std::fill_n(mask.inside.row(v), mask.inside.width(), uint8_t{0});
    again.score += lower ? 0.05F : -0.05F;
    set->detections.push_back(std::move(again));
  }
}

TEST(GluedObjects, SeveralDetectionsOfOneThingAreOneObject) {
  const Scene room = MakeRoom();
  const ChangedDetections twice(kGluedTours, DetectTwice);
  Mapped mapped;
  Mapped plain;
  Continue(kGluedTours, &twice, 40, &mapped);
  Continue(kGluedTours, nullptr, 40, &plain);
  std::set<InstanceId> ids;
  for (const SceneObject& object : room.objects) {
    if (object.kind != ObjectKind::kKnown) continue;
    const Seen seen = FindInMesh(room, object.id, mapped.products.mesh);
    const Seen usual = FindInMesh(room, object.id, plain.products.mesh);
    EXPECT_EQ(seen.class_id, usual.class_id) << object.name;
    EXPECT_GT(seen.share, usual.share - 0.1) << object.name;
    EXPECT_TRUE(ids.insert(seen.instance).second) << object.name;
  }
  EXPECT_EQ(Named(mapped), Named(plain)) << "no object has a second id";
}

TEST(GluedObjects, NothingIsSplitByGoodMasks) {
  Mapped mapped;
  const auto dataset = OpenSequence(kGluedTours, "", {});
  const auto detections = OpenDetections(kGluedTours);
  size_t splits = 0;
  for (size_t i = 0; i < 40; ++i) {
    const auto sensor = (*dataset)->Read(i);
    const auto set = (*detections)->ForFrame(sensor->header);
    const SegmentedFrame frame = SegmentFrame(*DecodeFrame(*sensor), &*set, {});
    splits += mapped.session.Integrate(frame, mapped.session.Associate(frame)).split.size();
  }
  EXPECT_EQ(splits, 0u);
}

}  // namespace
}  // namespace vismap
