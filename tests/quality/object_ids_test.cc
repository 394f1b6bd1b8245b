// The ids of objects do not change if a map is saved, loaded and continued.
#include <gtest/gtest.h>

#include "exports/outputs.h"
#include "sequence_mapper/map_sequence.h"
#include "simulation/sequence.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

constexpr char kTourWithoutChair[] = "synthetic:room?frames=16&width=160&tours=2&remove=8@17";
const MapSessionOptions kOptions{VoxelGridOptions{0.02, 4.0}, {}, {}};

void MapFrames(int frames, MapSession* session) {
  DatasetOptions selection;
  selection.max_frames = frames;
  const auto dataset = OpenSequence(kTourWithoutChair, "", selection);
  const auto detections = OpenDetections(kTourWithoutChair);
  ASSERT_TRUE(dataset && detections);
  StageTimes times;
  const auto proceed = [](size_t) { return true; };
  ASSERT_TRUE(MapSequence({**dataset, detections->get()}, {}, proceed, session, &times));
}

std::string Objects(const MapSession& session) {
  const MapProducts products = MakeProducts(session.map(), session.metadata(), {});
  return ObjectsText(session.metadata(), products);
}

TEST(ObjectIds, SurviveSavingLoadingAndContinuing) {
  const TempFolder folder;
  MapSession whole(kOptions, {});
  MapFrames(32, &whole);
  for (const int half : {8, 20}) {  // before and after something was removed
    MapSession session(kOptions, {});
    MapFrames(half, &session);
    const std::string before = Objects(session);
    ASSERT_TRUE(SaveMap(session.map(), session.metadata(), folder / "half.vismap"));
    Result<LoadedMap> loaded = LoadMap(folder / "half.vismap");
    ASSERT_TRUE(loaded) << loaded.error().message;
    Result<MapSession> continued = MapSession::Continue(kOptions, std::move(*loaded));
    ASSERT_TRUE(continued) << continued.error().message;
    EXPECT_EQ(Objects(*continued), before);
    MapFrames(32, &*continued);
    EXPECT_EQ(Objects(*continued), Objects(whole));
    EXPECT_EQ(HashMap(continued->map()), HashMap(whole.map()));
  }
}

}  // namespace
}  // namespace vismap
