#include <gmock/gmock.h>

#include <chrono>
#include <thread>

#include "hostile/hostile_bus.h"
#include "mapfile/map_file.h"
#include "support/temp_folder.h"

// Files that are small and would need much memory.

namespace vismap::hostile {
namespace {

using ::testing::HasSubstr;

/// Runs a program to its end: exit code, what it wrote to stderr, and its peak memory [MB].
struct Ended {
  int code;
  std::string error;
  int64_t megabytes;
};

Ended RunToEnd(const std::string& name, const std::vector<std::string>& arguments,
               const std::filesystem::path& folder) {
  ChildProcess process(name, arguments, folder);
  int64_t megabytes = 0;
  while (process.Running()) {
    // The last value counts: the first one may be that of this process, of which it is a copy.
    if (const int64_t peak = ProcessMegabytes(process.pid()); peak >= 0) megabytes = peak;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return {process.WaitForExit().value_or(-1), process.StandardError(), megabytes};
}

TEST(HostileFile, AMapOfScatteredBlocksIsNotLoadedBeyondTheLimit) {
  const TempFolder folder;
  SemanticMap map{VoxelGridOptions{}};
  for (int i = 0; i < 400'000; ++i)
    map.voxels.FindOrCreate({i % 1000 * 4, i / 1000 * 4, 0}).all_free = true;
  const auto saved = SaveMap(map, {}, folder / "bomb.vismap");
  ASSERT_TRUE(saved);
  EXPECT_LT(saved->bytes, 3'000'000u);  // 1 GB in memory
  ASSERT_TRUE(WriteFileAtomically(folder / "small.txtpb", "integration { max_map_mb: 200 }"));
  const Ended info = RunToEnd(
      "map", {"info", folder / "bomb.vismap", "--config", folder / "small.txtpb"}, folder.path());
  EXPECT_EQ(info.code, 3);
  EXPECT_THAT(info.error, HasSubstr("needs more than the allowed 200 MB"));
  std::printf("peak memory of vismap-map: %lld MB\n", static_cast<long long>(info.megabytes));
  EXPECT_LT(info.megabytes, 500);
}

}  // namespace
}  // namespace vismap::hostile
