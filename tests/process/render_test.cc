#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "process/process_harness.h"

// Pictures of vismap-map render: which options go together, and which files are written.

namespace vismap {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr char kRenderedRoom[] = "synthetic:room?frames=12&width=160";
constexpr char kRenderedVoxels[] = "grid { voxel_size_m: 0.02 }\n";

/// Mapped once for all tests below.
class RenderedRoom {
 public:
  static const RenderedRoom& Get() {
    static const RenderedRoom room;
    return room;
  }
  std::string map() const { return (folder_ / "out/map.vismap").string(); }
  std::string octree() const { return (folder_ / "out/octree.bt").string(); }
  std::string File(const std::string& name) const { return (folder_ / name).string(); }

 private:
  RenderedRoom() {
    folder_.Write("coarse.txtpb", kRenderedVoxels);
    ChildProcess mapper(
        "offline-mapper",
        {"--dataset", kRenderedRoom, "--config", File("coarse.txtpb"), "--out", File("out")},
        folder_.path());
    EXPECT_EQ(mapper.WaitForExit(), 0) << mapper.StandardError();
  }
  TempFolder folder_;
};

struct Rendered {
  int exit_code = -1;
  std::string error;
};

Rendered Render(const std::string& map, std::vector<std::string> arguments) {
  const TempFolder folder;
  arguments.insert(arguments.begin(), {"render", map});
  ChildProcess tool("map", arguments, folder.path());
  const int code = tool.WaitForExit().value_or(-1);
  return {code, tool.StandardError()};
}

TEST(RenderCommand, EveryViewAndColourWritesAPicture) {
  const RenderedRoom& room = RenderedRoom::Get();
  int number = 0;
  for (const std::vector<std::string>& options : std::vector<std::vector<std::string>>{
           {"--color", "seen"},
           {"--view", "perspective", "--color", "height", "--below", "1.2"},
           {"--view", "top", "--color", "rgb"},
           {"--view", "slice"},
           {"--view", "slice", "--axis", "x", "--at", "0.5"},
           {"--view", "octree"},
           {"--view", "octree", "--color", "class", "--below", "1", "--res", "0.1"}}) {
    const fs::path file = room.File(std::to_string(number++) + ".png");
    std::vector<std::string> arguments = options;
    arguments.insert(arguments.end(),
                     {"--width", "480", "--height", "320", "--out", file.string()});
    const Rendered rendered = Render(room.map(), arguments);
    EXPECT_EQ(rendered.exit_code, 0) << rendered.error;
    EXPECT_TRUE(fs::exists(file) && fs::file_size(file) > 4000) << file;
  }
  const std::string file = room.File("tree.png");
  EXPECT_EQ(Render(room.octree(), {"--view", "octree", "--out", file}).exit_code, 0);
  EXPECT_TRUE(fs::exists(file));
}

TEST(RenderCommand, TurntableIsAFolderAPatternOrAnAnimation) {
  const RenderedRoom& room = RenderedRoom::Get();
  const auto turn = [&](const std::string& out) {
    const Rendered rendered =
        Render(room.map(), {"--view", "octree", "--turntable", "3", "--width", "320", "--height",
                            "240", "--out", room.File(out)});
    EXPECT_EQ(rendered.exit_code, 0) << rendered.error;
  };
  turn("turn");
  turn("turn.png");
  turn("turn.webp");
  for (const char* file :
       {"turn/000.png", "turn/002.png", "turn_000.png", "turn_002.png", "turn.webp"})
    EXPECT_TRUE(fs::exists(room.File(file))) << file;
  EXPECT_FALSE(fs::exists(room.File("turn/003.png")));
}

TEST(RenderCommand, ErrorsNameTheOptionAndWhatWasFound) {
  const RenderedRoom& room = RenderedRoom::Get();
  struct Case {
    std::string map;
    std::vector<std::string> options;
    int exit_code;
    std::string error;
  };
  const std::string map = room.map();
  for (const Case& wrong : std::vector<Case>{
           {map, {"--view", "slice", "--at", "nan"}, 2, "--at"},
           {map, {"--view", "slice", "--at", "1e9"}, 2, "found 1e+09"},
           {map, {"--below", "inf"}, 2, "--below"},
           {map, {"--at", "1"}, 2, "found --view overview"},
           {map, {"--view", "slice", "--color", "rgb"}, 2, "--color"},
           {map, {"--view", "slice", "--axis", "w"}, 2, "--axis"},
           {map, {"--view", "slice", "--below", "1"}, 2, "--below"},
           {map, {"--view", "octree", "--color", "segment"}, 2, "found segment"},
           {map, {"--view", "octree", "--color", "rgb"}, 2, "found rgb"},
           {map, {"--view", "octree", "--res", "0.03"}, 2, "--res"},
           {map, {"--view", "top", "--turntable", "4"}, 2, "--turntable"},
           {map, {"--turntable", "1"}, 2, "--turntable"},
           {map, {"--width", "10"}, 2, "--width"},
           {map, {"--axis", "x"}, 2, "--axis is for --view slice"},
           {map, {"--res", "0.1"}, 2, "--res is for --view octree"},
           {room.octree(), {"--view", "octree", "--res", "0.1"}, 2, "an octree file"},
           {map, {"--below", "-100"}, 1, "nothing to draw below"},
           {map, {"--view", "slice", "--at", "500"}, 1, "nothing is known of the space"},
           {room.octree(), {}, 2, "an octree needs --view octree"},
           {room.octree(), {"--view", "octree", "--color", "rgb"}, 2, "has no colours"},
           {room.File("none.vismap"), {}, 3, "none.vismap"},
           {room.File("none.bt"), {"--view", "octree"}, 3, "none.bt"},
           {room.File("coarse.txtpb"), {}, 3, "coarse.txtpb"}}) {
    std::vector<std::string> arguments = wrong.options;
    arguments.insert(arguments.end(), {"--out", room.File("wrong.png")});
    const Rendered rendered = Render(wrong.map, arguments);
    EXPECT_EQ(rendered.exit_code, wrong.exit_code) << wrong.error;
    EXPECT_THAT(rendered.error, HasSubstr(wrong.error));
    EXPECT_FALSE(fs::exists(room.File("wrong.png")));
  }
  EXPECT_THAT(Render(map, {"--out", room.File("a.webp")}).error, HasSubstr("--turntable"));
}

}  // namespace
}  // namespace vismap
