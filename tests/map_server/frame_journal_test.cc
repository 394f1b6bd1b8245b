#include "map_server/frame_journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <numeric>

#include "base/file.h"
#include "map_server/small_frames.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using testing_support::Key;
using testing_support::SmallKey;
using testing_support::SmallMessage;

Pose At(double x) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  return pose;
}

JournaledFrame Frame(int64_t revision, double x = 0) {
  return {SmallKey(1000 * revision), revision, At(x), SmallKey(1000 * (revision - 1)),
          std::string(32, 'd')};
}

std::vector<int64_t> Revisions(const FrameJournal& journal) {
  std::vector<int64_t> revisions;
  for (const JournaledFrame& frame : journal.Frames()) revisions.push_back(frame.revision);
  return revisions;
}

class KeptFrames : public ::testing::Test {
 protected:
  std::unique_ptr<FrameJournal> Open(const FrameJournalLimits& limits = {}) const {
    auto journal = FrameJournal::Open(folder_ / "j", limits);
    EXPECT_TRUE(journal) << journal.error().message;
    return std::move(*journal);
  }
  static void Add(FrameJournal* journal, int64_t revision) {
    journal->Add(Frame(revision), SmallMessage(1000 * revision));
  }
  /// Waits until the disk has all frames.
  static void Flush(FrameJournal* journal) { EXPECT_TRUE(journal->AddPoses({})); }

  TempFolder folder_;
};

TEST_F(KeptFrames, AreThereForTheNextProcessWithTheirNewestPoses) {
  {
    const auto journal = Open();
    for (const int64_t revision : {1, 2, 3}) Add(journal.get(), revision);
    ASSERT_TRUE(journal->AddPoses({{SmallKey(2000), At(7)}, {Key(9, 9), At(1)}}));
    EXPECT_EQ(journal->Frames()[1].T_W_C.translation().x(), 7);
    Add(journal.get(), 4);
  }
  const auto journal = Open();
  EXPECT_THAT(journal->remarks(), IsEmpty());
  EXPECT_THAT(Revisions(*journal), ElementsAre(1, 2, 3, 4));
  const JournaledFrame second = journal->Frames()[1];
  EXPECT_EQ(second.key, SmallKey(2000));
  EXPECT_EQ(second.previous, SmallKey(1000));
  EXPECT_EQ(second.digest, std::string(32, 'd'));
  EXPECT_EQ(second.T_W_C.matrix(), At(7).matrix());
  const Result<segmented_frame_t> message = journal->Read(2);
  ASSERT_TRUE(message) << message.error().message;
  EXPECT_EQ(DigestInput(*message), DigestInput(SmallMessage(2000)));
  EXPECT_THAT(journal->Read(5).error().message, HasSubstr("frame 5: the journal does not have it"));
}

TEST_F(KeptFrames, OfAnotherMapReplaceThem) {
  const auto journal = Open();
  for (const int64_t revision : {1, 2}) Add(journal.get(), revision);
  journal->BeginMap();
  EXPECT_THAT(Revisions(*journal), IsEmpty());
  Add(journal.get(), 1);
  Flush(journal.get());
  EXPECT_THAT(Revisions(*Open()), ElementsAre(1));
}

TEST_F(KeptFrames, AreForgottenWhenTheMapGoesOnFromBeforeThem) {
  const auto journal = Open();
  for (const int64_t revision : {1, 2, 3}) Add(journal.get(), revision);
  journal->Add({SmallKey(777), 2, At(0), SmallKey(1000), ""}, SmallMessage(777));
  EXPECT_THAT(Revisions(*journal), ElementsAre(1, 2));
  Flush(journal.get());
  const auto again = Open();
  EXPECT_THAT(Revisions(*again), ElementsAre(1, 2));
  EXPECT_EQ(again->Frames()[1].key, SmallKey(777));
}

TEST_F(KeptFrames, AreSetAsideWithoutLoss) {
  const auto journal = Open();
  Add(journal.get(), 1);
  const auto aside = journal->BeginMapAside();
  ASSERT_TRUE(aside) << aside.error().message;
  EXPECT_THAT(Revisions(*journal), IsEmpty());
  EXPECT_THAT(Revisions(**FrameJournal::Open(*aside, {})), ElementsAre(1));
}

TEST_F(KeptFrames, TakeNoMoreThanTheirLimitAndTheOldestGoFirst) {
  const auto journal = Open();
  Add(journal.get(), 1);
  Flush(journal.get());
  const uint64_t one = journal->bytes();
  journal->BeginMap();
  const auto small = Open({.max_bytes = 8 * one, .file_bytes = 2 * one});
  for (int64_t revision = 1; revision <= 20; ++revision) Add(small.get(), revision);
  Flush(small.get());
  EXPECT_LE(small->bytes(), 9 * one);
  const std::vector<int64_t> kept = Revisions(*small);
  ASSERT_GT(kept.size(), 4u);
  EXPECT_EQ(kept.back(), 20);
  EXPECT_EQ(kept.back() - kept.front() + 1, static_cast<int64_t>(kept.size())) << "none between";
  EXPECT_TRUE(small->Read(kept.front()));
  EXPECT_FALSE(small->Read(1));
  EXPECT_EQ(Revisions(*Open()), kept);
}

TEST_F(KeptFrames, WaitForTheDiskOnlyUpToALimit) {
  const auto journal = Open({.waiting_bytes = 1});
  Add(journal.get(), 5);
  EXPECT_THAT(Revisions(*journal), IsEmpty());
  EXPECT_THAT(
      journal->trouble().value_or(""),
      AllOf(HasSubstr("incomplete from frame 5 (camera 3, utime 5000) on"), HasSubstr("too slow")));
}

TEST_F(KeptFrames, ThatTheDiskDoesNotTakeAreNamedAndLaterOnesKept) {
  const auto journal = Open();
  Add(journal.get(), 1);
  Flush(journal.get());
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  const rlimit full{journal->bytes() + 100, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
  Add(journal.get(), 2);
  EXPECT_FALSE(journal->Read(2));
  EXPECT_FALSE(journal->AddPoses({{SmallKey(1000), At(3)}}));
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, handler);
  EXPECT_EQ(journal->Frames()[0].T_W_C.matrix(), At(0).matrix()) << "the pose stays";
  EXPECT_THAT(journal->trouble().value_or(""),
              AllOf(HasSubstr("incomplete from frame 2"), HasSubstr("File too large")));
  Add(journal.get(), 3);
  EXPECT_TRUE(journal->Read(3));
  const auto again = Open();
  EXPECT_THAT(again->remarks(), IsEmpty());
  EXPECT_THAT(Revisions(*again), ElementsAre(1, 3));
}

TEST_F(KeptFrames, AreNotReadFromWhatIsNoJournal) {
  folder_.Write("j/00000001.frames", "hello");
  folder_.Write("j/notes.txt", "not ours");
  const auto journal = Open();
  EXPECT_THAT(journal->remarks(), ElementsAre(HasSubstr("is no journal of frames")));
  journal->BeginMap();
  EXPECT_TRUE(std::filesystem::exists(folder_ / "j/notes.txt"));
  folder_.Write("file", "x");
  EXPECT_FALSE(FrameJournal::Open(folder_ / "file", {}));
}

// A file with three records of frames, and where each of them ends.
struct ThreeRecords {
  ThreeRecords() {
    ends.push_back(file.size());
    for (const int64_t revision : {1, 2, 3}) {
      std::vector<uint8_t> message(100);
      std::iota(message.begin(), message.end(), static_cast<uint8_t>(revision));
      const auto record = EncodeFrameRecord(Frame(revision), message);
      file.insert(file.end(), record.begin(), record.end());
      ends.push_back(file.size());
    }
  }
  std::vector<uint8_t> file = JournalFilePrefix();
  std::vector<size_t> ends;
};

TEST(JournalRecords, OfAFileThatWasCutAnywhereAreThoseBefore) {
  const ThreeRecords three;
  for (size_t length = three.ends[0]; length <= three.file.size(); ++length) {
    const ScannedJournal scanned = ScanJournal(std::span(three.file).first(length));
    const auto whole = static_cast<size_t>(
        std::upper_bound(three.ends.begin(), three.ends.end(), length) - three.ends.begin() - 1);
    ASSERT_EQ(scanned.records.size(), whole) << length;
    if (length == three.ends[whole]) {
      ASSERT_THAT(scanned.remarks, IsEmpty());
    } else {
      ASSERT_THAT(scanned.remarks, ElementsAre(HasSubstr("is cut short or damaged"))) << length;
    }
  }
}

TEST(JournalRecords, ThatAreDamagedAreNamedAndTheOthersRead) {
  ThreeRecords three;
  for (size_t at = three.ends[1]; at < three.ends[2]; ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      three.file[at] ^= static_cast<uint8_t>(1 << bit);
      const ScannedJournal scanned = ScanJournal(three.file);
      three.file[at] ^= static_cast<uint8_t>(1 << bit);
      ASSERT_THAT(scanned.records, SizeIs(2)) << at;
      EXPECT_EQ(scanned.records[1].offset, three.ends[2]);
      EXPECT_EQ(DecodeFrameRecord(scanned.records[1].content)->frame.revision, 3);
      ASSERT_THAT(scanned.remarks,
                  ElementsAre(AllOf(HasSubstr("damaged and left out"),
                                    HasSubstr("from byte " + std::to_string(three.ends[1])))));
    }
  }
}

}  // namespace
}  // namespace vismap
