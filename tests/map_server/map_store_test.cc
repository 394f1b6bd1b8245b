#include "map_server/map_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/map_frame.h"
#include "small_frames.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using testing::HasSubstr;
using testing_support::CoarseMap;
using testing_support::MemoryBus;
using testing_support::SmallKey;
using testing_support::SmallMessage;

class StoredMap : public testing::Test {
 protected:
  MapStore Store(double save_period_s = 0) { return {path_, save_period_s, &status_}; }
  /// Integrates a frame as the server does.
  void Integrate(int64_t utime, MapStore* store) {
    MapFrame(*Decode(SmallMessage(utime)), &session_);
    store->AddFrame(SmallKey(utime));
  }
  bool IsSaved() const { return std::filesystem::exists(path_); }

  TempFolder folder_;
  std::filesystem::path path_ = folder_ / "kept.vismap";
  std::unique_ptr<Bus> bus_ = MemoryBus();
  Status status_{bus_.get(), "server"};
  MapSession session_{CoarseMap(), {}};
};

TEST_F(StoredMap, IsLoadedAsItWasSavedUnderAnotherId) {
  MapStore store = Store();
  Integrate(1000, &store);
  const Result<std::string> saved = store.Save(session_);
  ASSERT_TRUE(saved) << saved.error().message;
  EXPECT_THAT(*saved, HasSubstr(path_.string() + ", map hash " + HashMap(session_.map())));
  const Result<MapSession> loaded = MapStore::Load(path_, CoarseMap(), "new id");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(HashMap(loaded->map()), HashMap(session_.map()));
  EXPECT_EQ(loaded->metadata().map_id, "new id");
  EXPECT_TRUE(loaded->Contains(CameraId{3}, 1000));
}

TEST_F(StoredMap, SaysWhatIsWrongWithAPath) {
  MapStore nowhere("", 0, &status_);
  const Result<std::string> saved = nowhere.Save(session_);
  ASSERT_FALSE(saved);
  EXPECT_THAT(saved.error().message, HasSubstr("no path given to save to"));
  EXPECT_TRUE(nowhere.Save(session_, path_)) << "a request names one";
  const auto load_error = [](const std::string& path, const MapSessionOptions& options) {
    const Result<MapSession> loaded = MapStore::Load(path, options, "id");
    return loaded ? "" : loaded.error().message;
  };
  EXPECT_THAT(load_error("", CoarseMap()), HasSubstr("no path given to load from"));
  EXPECT_THAT(load_error(folder_ / "missing", CoarseMap()), HasSubstr("missing"));
  EXPECT_THAT(load_error(path_, MapSessionOptions{}), HasSubstr("kept.vismap: the saved map has"));
}

TEST_F(StoredMap, IsSavedNowAndThenWhenItHasChanged) {
  MapStore never = Store(0), often = Store(1e-9);
  Integrate(1000, &never);
  never.SaveIfDue(session_);
  EXPECT_FALSE(IsSaved());
  often.SaveIfDue(session_);
  EXPECT_TRUE(IsSaved());
  std::filesystem::remove(path_);
  often.SaveIfDue(session_);
  EXPECT_FALSE(IsSaved()) << "nothing has changed";
}

TEST_F(StoredMap, IsNotSavedMoreOftenThanItsPeriod) {
  MapStore seldom = Store(1000);
  Integrate(1000, &seldom);
  seldom.SaveIfDue(session_);
  EXPECT_TRUE(IsSaved());
  std::filesystem::remove(path_);
  Integrate(2000, &seldom);
  seldom.SaveIfDue(session_);
  EXPECT_FALSE(IsSaved());
}

TEST_F(StoredMap, AfterACrashItsJournalTellsWhichFramesItLacks) {
  {
    MapStore store = Store();
    ASSERT_TRUE(store.StartJournal(session_));
    EXPECT_EQ(store.StatusMessage(), "");
    Integrate(1000, &store);
    ASSERT_TRUE(store.Save(session_));
    Integrate(2000, &store);
    Integrate(3000, &store);
    ASSERT_TRUE(store.Save(session_, folder_ / "copy.vismap")) << "empties no journal";
  }
  Result<MapSession> loaded = MapStore::Load(path_, CoarseMap(), "id");
  ASSERT_TRUE(loaded);
  MapStore again = Store();
  ASSERT_TRUE(again.StartJournal(*loaded));
  EXPECT_EQ(again.lacking_frames(), 2u);
  EXPECT_EQ(status_.counter("frames_lacking"), 2);
  EXPECT_THAT(again.StatusMessage(), HasSubstr("2 frames"));
  again.AddFrame(SmallKey(2000));
  again.AddFrame(SmallKey(3000));
  EXPECT_EQ(status_.counter("frames_lacking"), 0);
  EXPECT_EQ(again.StatusMessage(), "");
}

TEST_F(StoredMap, WithABrokenJournalIsNotContinued) {
  folder_.Write("kept.vismap.journal", "hello\n");
  MapStore store = Store();
  const Result<void> started = store.StartJournal(session_);
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("kept.vismap.journal, line 1"));
}

}  // namespace
}  // namespace vismap
