#include "map_server/commit_journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "map_server/small_frames.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using testing_support::Key;

TEST(CommitJournal, TellsWhatWasAddedSinceTheLastSaveButOneAlsoToTheNextProcess) {
  const TempFolder folder;
  {
    Result<CommitJournal> journal = CommitJournal::Open(folder / "j");
    ASSERT_TRUE(journal);
    EXPECT_TRUE(journal->Add(Key(0, 50)));
    EXPECT_TRUE(journal->MapWasSaved(journal->Mark()));
    EXPECT_TRUE(journal->Add(Key(0, 100)));
    EXPECT_TRUE(journal->MapWasSaved(journal->Mark()));
    EXPECT_TRUE(journal->Add(Key(0, 200)));
    EXPECT_TRUE(journal->Add(Key(1, 300)));
  }
  EXPECT_EQ(*CommitJournal::Read(folder / "j"),
            (std::vector<FrameKey>{Key(0, 100), Key(0, 200), Key(1, 300)}));
  Result<CommitJournal> again = CommitJournal::Open(folder / "j");
  ASSERT_TRUE(again);
  again->Add(Key(0, 400));
  EXPECT_EQ(CommitJournal::Read(folder / "j")->size(), 4u) << "an old journal is gone on with";
}

TEST(CommitJournal, LeavesOutALastLineThatWasCutShortAndRefusesWhatIsNone) {
  const TempFolder folder;
  EXPECT_TRUE(CommitJournal::Read(folder / "missing")->empty());
  folder.Write("cut", "0 100\n0 20");
  EXPECT_EQ(*CommitJournal::Read(folder / "cut"), std::vector<FrameKey>{Key(0, 100)});
  folder.Write("other", "0 100\nhello\n");
  const Result<std::vector<FrameKey>> other = CommitJournal::Read(folder / "other");
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, ::testing::HasSubstr("other, line 2"));
  EXPECT_FALSE(CommitJournal::Open(folder / "no" / "folder"));
}

TEST(CommitJournal, OfAnotherMapHasOnlyItsFramesOnceThatIsSaved) {
  const TempFolder folder;
  Result<CommitJournal> journal = CommitJournal::Open(folder / "j");
  ASSERT_TRUE(journal);
  journal->Add(Key(0, 100));
  journal->BeginMap();
  journal->Add(Key(0, 200));
  EXPECT_TRUE(journal->MapWasSaved(journal->Mark()));
  EXPECT_EQ(*CommitJournal::Read(folder / "j"), std::vector<FrameKey>{Key(0, 200)});
}

TEST(CommitJournal, IsNoPipeAndIsNotWaitedFor) {
  const TempFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_FALSE(CommitJournal::Open(folder / "pipe"));
  EXPECT_FALSE(CommitJournal::Read(folder / "pipe"));
}

TEST(CommitJournal, WithoutAFileDoesNothing) {
  CommitJournal none;
  EXPECT_TRUE(none.Add(Key(0, 1)));
  EXPECT_TRUE(none.MapWasSaved(none.Mark()));
}

}  // namespace
}  // namespace vismap
