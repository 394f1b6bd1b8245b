#include "map_server/map_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "session/map_frame.h"
#include "small_frames.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing_support::CoarseMap;
using testing_support::MemoryBus;
using testing_support::SmallKey;
using testing_support::SmallMessage;

class StoredMap : public ::testing::Test {
 protected:
  /// A store that goes on with the map of the session.
  MapStore Store(double save_period_s = 0) {
    MapServerOptions options;
    options.save_on_exit = path_;
    options.save_period_s = save_period_s;
    options.map_folder = folder_ / "maps";
    MapStore store(options, &status_);
    store.BeginMap(session_);
    return store;
  }
  Result<RecoveredMap> Recover() { return RecoverMap(path_, CoarseMap(), "recovered"); }
  /// The frames of a saved map; -1 = it cannot be read.
  static int64_t FramesOf(const std::filesystem::path& path) {
    const Result<LoadedMap> loaded = LoadMap(path);
    return loaded ? loaded->map.revision : -1;
  }
  std::filesystem::path Beside(const std::string& ending) const { return path_.string() + ending; }
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
  const Result<MapSession> loaded = ReadSavedMap(path_, CoarseMap(), "new id");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(HashMap(loaded->map()), HashMap(session_.map()));
  EXPECT_EQ(loaded->metadata().map_id, "new id");
  EXPECT_TRUE(loaded->Contains(CameraId{3}, 1000));
}

TEST_F(StoredMap, SaysWhatIsWrongWithAPath) {
  MapStore nowhere({}, &status_);
  nowhere.BeginMap(session_);
  EXPECT_THAT(nowhere.Save(session_).error().message, HasSubstr("no name given"));
  MapStore store = Store();
  ASSERT_TRUE(store.Save(session_));
  const auto load_error = [](const std::string& path, const MapSessionOptions& options) {
    const Result<MapSession> loaded = ReadSavedMap(path, options, "id");
    return loaded ? "" : loaded.error().message;
  };
  EXPECT_THAT(load_error("", CoarseMap()), HasSubstr("no map given to load"));
  EXPECT_THAT(load_error(folder_ / "missing", CoarseMap()), HasSubstr("missing"));
  EXPECT_THAT(load_error(path_, MapSessionOptions{}), HasSubstr("kept.vismap: the saved map has"));
}

TEST_F(StoredMap, IsSavedUnderANameInTheFolderForMaps) {
  MapStore store = Store();
  Integrate(1000, &store);
  EXPECT_FALSE(store.SaveNamed(session_, "../outside"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "maps"));
  const Result<std::string> saved = store.SaveNamed(session_, "kitchen");
  ASSERT_TRUE(saved) << saved.error().message;
  EXPECT_THAT(*saved, HasSubstr((folder_ / "maps" / "kitchen.vismap").string()));
  EXPECT_EQ(store.FindNamed("kitchen").value(), folder_ / "maps" / "kitchen.vismap");
  EXPECT_FALSE(IsSaved());
}

TEST_F(StoredMap, KeepsTheFileThatWasSavedBefore) {
  MapStore store = Store();
  Integrate(1000, &store);
  ASSERT_TRUE(store.Save(session_));
  EXPECT_FALSE(std::filesystem::exists(Beside(".previous")));
  Integrate(2000, &store);
  ASSERT_TRUE(store.Save(session_));
  ASSERT_TRUE(store.Save(session_)) << "the same again replaces no older file";
  EXPECT_EQ(FramesOf(path_), 2);
  EXPECT_EQ(FramesOf(Beside(".previous")), 1);
  EXPECT_FALSE(std::filesystem::exists(Beside(".replaced"))) << "it is the same map";
}

TEST_F(StoredMap, KeepsOfTheMapsThatItReplacesTheOneWithTheMostFrames) {
  MapStore store = Store();
  const auto begin = [&](const std::string& id) {
    MapMetadata metadata;
    metadata.map_id = id;
    session_ = MapSession(CoarseMap(), metadata);
    store.BeginMap(session_);
  };
  for (const int64_t utime : {1000, 2000, 3000}) Integrate(utime, &store);
  ASSERT_TRUE(store.Save(session_));
  for (const std::string id : {"b", "c", "d"}) {
    begin(id);
    EXPECT_FALSE(store.Save(session_)) << "an empty map replaces no other";
    store.SaveIfDue(session_);
    Integrate(1000, &store);
    ASSERT_TRUE(store.Save(session_));
  }
  EXPECT_EQ(FramesOf(path_), 1);
  EXPECT_EQ(FramesOf(Beside(".replaced")), 3);
}

TEST_F(StoredMap, DoesNotReplaceWhatIsNoMap) {
  folder_.Write("kept.vismap", "a letter");
  folder_.Write("kept.vismap.previous", "another letter");
  MapStore store = Store();
  Integrate(1000, &store);
  ASSERT_TRUE(store.Save(session_));
  Integrate(2000, &store);
  ASSERT_TRUE(store.Save(session_));
  EXPECT_EQ(std::filesystem::file_size(Beside(".unusable-1")), 8u);
  EXPECT_EQ(std::filesystem::file_size(Beside(".previous.unusable-1")), 14u);
}

TEST_F(StoredMap, IsRecoveredFromTheNewestFileThatCanBeUsed) {
  EXPECT_FALSE(Recover()->session) << "there is none";
  MapStore store = Store();
  Integrate(1000, &store);
  ASSERT_TRUE(store.Save(session_));
  Integrate(2000, &store);
  ASSERT_TRUE(store.Save(session_));
  EXPECT_EQ(Recover()->session->map().revision, 2);

  const std::string whole = [&] {
    const auto bytes = ReadFileBytes(path_).value();
    return std::string(bytes.begin(), bytes.end());
  }();
  int damaged = 0;
  for (const std::string& content : {std::string(), std::string("no map"),
                                     whole.substr(0, whole.size() / 2), std::string(100, 'x')}) {
    folder_.Write("kept.vismap", content);
    const Result<RecoveredMap> recovered = Recover();
    ASSERT_TRUE(recovered) << recovered.error().message;
    EXPECT_EQ(recovered->session->map().revision, 1);
    EXPECT_EQ(recovered->path, Beside(".previous"));
    const std::string aside = Beside(".unusable-" + std::to_string(++damaged));
    ASSERT_EQ(recovered->unusable.size(), 1u);
    EXPECT_THAT(recovered->unusable[0], HasSubstr("the file is " + aside + " now"));
    EXPECT_EQ(std::filesystem::file_size(aside), content.size());
    EXPECT_FALSE(IsSaved());
  }
}

TEST_F(StoredMap, WithAnotherVoxelSizeIsSetAside) {
  MapStore store = Store();
  Integrate(1000, &store);
  ASSERT_TRUE(store.Save(session_));
  const Result<RecoveredMap> recovered = RecoverMap(path_, MapSessionOptions{}, "id");
  ASSERT_TRUE(recovered);
  EXPECT_FALSE(recovered->session);
  EXPECT_THAT(recovered->unusable.at(0), HasSubstr("the saved map has voxels of"));
  EXPECT_EQ(FramesOf(Beside(".unusable-1")), 1);
}

TEST_F(StoredMap, ThatIsAPipeOrAFolderIsNeitherReadNorMoved) {
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  EXPECT_FALSE(Recover());
  std::filesystem::remove(path_);
  std::filesystem::create_directory(path_);
  EXPECT_FALSE(Recover());
  MapStore store = Store();
  Integrate(1000, &store);
  EXPECT_FALSE(store.Save(session_));
  EXPECT_TRUE(std::filesystem::is_directory(path_));
}

TEST_F(StoredMap, TemporariesOfKilledSavesAreRemovedAtTheStart) {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  const std::string ending = ".tmp-" + std::to_string(child) + "-0";
  for (const std::string name : {"kept.vismap", "maps/kitchen.vismap", "maps/a.vismap.previous"})
    folder_.Write(name + ending, "x");
  folder_.Write("letter" + ending, "x");
  Store();
  EXPECT_FALSE(std::filesystem::exists(Beside(ending)));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "maps"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / ("letter" + ending))) << "is not ours";
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
    store.StartJournal(session_);
    EXPECT_EQ(store.StatusMessage(), "");
    Integrate(1000, &store);
    ASSERT_TRUE(store.Save(session_));
    Integrate(2000, &store);
    Integrate(3000, &store);
    ASSERT_TRUE(store.SaveNamed(session_, "copy")) << "empties no journal";
  }
  Result<MapSession> loaded = ReadSavedMap(path_, CoarseMap(), "id");
  ASSERT_TRUE(loaded);
  MapStore again = Store();
  again.StartJournal(*loaded);
  EXPECT_EQ(again.lacking_frames(), 2u);
  EXPECT_EQ(status_.counter("frames_lacking"), 2);
  EXPECT_THAT(again.StatusMessage(), HasSubstr("2 frames"));
  again.AddFrame(SmallKey(2000));
  again.AddFrame(SmallKey(3000));
  EXPECT_EQ(status_.counter("frames_lacking"), 0);
  EXPECT_EQ(again.StatusMessage(), "");
}

TEST_F(StoredMap, WhileACopyIsSavedFramesAreStillEnteredInTheJournal) {
  {
    MapStore store = Store(1e-6);
    store.StartJournal(session_);
    Integrate(1000, &store);
    const MapSnapshot copy{session_.map(), session_.metadata()};
    const auto first = store.BeginSave("");
    Integrate(2000, &store);
    const auto second = store.BeginSave("");
    ASSERT_TRUE(first && second);
    const MapSnapshot later{session_.map(), session_.metadata()};
    store.SaveIfDue(session_);
    EXPECT_FALSE(IsSaved()) << "another thread is saving";
    for (const auto& [save, map] : {std::pair(*first, &copy), std::pair(*second, &later)}) {
      const Result<std::string> saved = store.SaveCopy(save, *map);
      EXPECT_TRUE(saved);
      Integrate(1000 * (session_.map().revision + 1), &store);
      store.EndSave(save, *map, saved.has_value(), session_);
    }
    EXPECT_EQ(FramesOf(path_), 2);
    EXPECT_EQ(FramesOf(Beside(".previous")), 1);
    EXPECT_EQ(session_.map().revision, 4);
  }
  Result<MapSession> loaded = ReadSavedMap(path_, CoarseMap(), "id");
  ASSERT_TRUE(loaded);
  MapStore again = Store();
  again.StartJournal(*loaded);
  EXPECT_EQ(again.lacking_frames(), 2u);
}

TEST_F(StoredMap, ACopyOfAMapThatWasReplacedMeanwhileIsSavedAndChangesNoJournal) {
  MapStore store = Store();
  store.StartJournal(session_);
  Integrate(1000, &store);
  MapMetadata metadata;
  metadata.map_id = "replaced";
  const MapSnapshot copy{session_.map(), metadata};
  const auto save = store.BeginSave("");
  ASSERT_TRUE(save);
  EXPECT_TRUE(store.SaveCopy(*save, copy));
  store.EndSave(*save, copy, true, session_);
  EXPECT_EQ(FramesOf(path_), 1);
  EXPECT_TRUE(store.Save(session_));
  EXPECT_TRUE(std::filesystem::exists(Beside(".replaced"))) << "it is another map";
}

TEST_F(StoredMap, AJournalThatCannotBeUsedIsSetAside) {
  folder_.Write("kept.vismap.journal", "hello\n");
  MapStore store = Store();
  store.StartJournal(session_);
  EXPECT_THAT(status_.findings(), ElementsAre(HasSubstr("kept.vismap.journal, line 1")));
  EXPECT_TRUE(std::filesystem::exists(Beside(".journal.unusable-1")));
  Integrate(1000, &store);
  EXPECT_EQ(CommitJournal::Read(Beside(".journal"))->size(), 1u) << "there is a new one";
}

TEST_F(StoredMap, WithoutAJournalTheServerGoesOn) {
  ASSERT_EQ(mkfifo(Beside(".journal").c_str(), 0600), 0);
  MapStore store = Store();
  store.StartJournal(session_);
  EXPECT_THAT(status_.findings(), Contains(HasSubstr("expected a regular file")));
  Integrate(1000, &store);
  EXPECT_TRUE(store.Save(session_));
}

}  // namespace
}  // namespace vismap
