#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "client/fake_exporter.h"
#include "process/process_harness.h"
#include "simulation/room.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

/// A map of `rows`, the first of which has the largest y: '.' free, '#' occupied, '?' unknown.
/// Cells of 0.1 m; the corner of the first cell is at (-1, 2).
class GridFolder {
 public:
  explicit GridFolder(const std::vector<std::string>& rows) {
    std::string image = "P5\n# a comment\n" + std::to_string(rows[0].size()) + " " +
                        std::to_string(rows.size()) + "\n255\n";
    for (const std::string& row : rows) {
      for (const char cell : row)
        image += static_cast<char>(cell == '.' ? 254 : cell == '#' ? 0 : 205);
    }
    folder_.Write("map.pgm", image);
    folder_.Write("map.yaml",
                  "image: map.pgm\nmode: trinary\nresolution: 0.1\norigin: [-1, 2, 0]\n"
                  "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
  }
  std::unique_ptr<ChildProcess> Plan(const std::string& start, const std::string& goal,
                                     const std::string& radius) const {
    auto program = std::make_unique<ChildProcess>(
        VISMAP_EXAMPLES_DIR "/plan_grid",
        std::vector<std::string>{(folder_ / "map.yaml").string(), start, goal, radius},
        folder_.path());
    program->WaitForExit();
    return program;
  }
  const TempFolder& folder() const { return folder_; }

 private:
  TempFolder folder_;
};

TEST(PlanGrid, GoesAroundObstaclesAndUnknownCellsInTheFewestSteps) {
  const GridFolder grid({"........",  //
                         "...##...",  //
                         "...?#...",  //
                         "...##...",  //
                         "........"});
  const auto program = grid.Plan("-0.95,2.25", "-0.25,2.25", "0");
  ASSERT_EQ(program->WaitForExit(), 0) << program->StandardError();
  std::istringstream lines(program->StandardOutput());
  std::vector<std::pair<double, double>> path;
  for (double x = 0, y = 0; lines >> x >> y;) path.emplace_back(x, y);
  ASSERT_EQ(path.size(), 8u);
  EXPECT_NEAR(path.front().first, -0.95, 1e-9);
  EXPECT_NEAR(path.back().first, -0.25, 1e-9);
  // Down or up two rows and back: 4 diagonal steps, 3 straight ones.
  EXPECT_THAT(program->StandardError(), HasSubstr("path of 0.87 m in 8 cells"));
}

TEST(PlanGrid, KeepsTheRadiusAndRefusesWithASentence) {
  const GridFolder grid({"??????????",  //
                         "?........?",  //
                         "?........?",  //
                         "?........?",  //
                         "?........?",  //
                         "??????????"});
  const auto fits = grid.Plan("-0.65,2.25", "-0.35,2.35", "0.1");
  EXPECT_EQ(fits->WaitForExit(), 0) << fits->StandardError();
  EXPECT_THAT(fits->StandardError(), HasSubstr("clearance 0.100 m, radius 0.100 m"));
  const auto refused = [&](const std::string& start, const std::string& goal,
                           const std::string& radius, const std::string& words) {
    const auto program = grid.Plan(start, goal, radius);
    EXPECT_EQ(program->WaitForExit(), 1);
    EXPECT_THAT(program->StandardError(), HasSubstr(words));
    EXPECT_EQ(program->StandardOutput(), "");
  };
  refused("-0.65,2.25", "-0.35,2.35", "0.11", "the start is nearer than the radius");
  refused("-0.65,2.25", "-0.05,2.35", "0.1", "the goal is in an occupied or unknown cell");
  refused("-0.65,2.25", "0.5,2.35", "0.1", "the goal is outside of the grid");
}

TEST(PlanGrid, DoesNotGoThroughUnknownCellsOrBetweenCorners) {
  for (const char* wall : {"..?.", "..#."}) {
    const GridFolder grid({wall, wall, wall});
    const auto program = grid.Plan("-0.95,2.05", "-0.65,2.05", "0");
    EXPECT_EQ(program->WaitForExit(), 1);
    EXPECT_THAT(program->StandardError(), HasSubstr("there is no path"));
  }
  const GridFolder corners({"..##", "..##", "##..", "##.."});
  EXPECT_EQ(corners.Plan("-0.95,2.35", "-0.65,2.05", "0")->WaitForExit(), 1);
}

TEST(PlanGrid, NamesFilesThatItCannotRead) {
  const GridFolder grid({"..", ".."});
  std::ofstream((grid.folder() / "map.pgm").string()) << "P5 9 9 255 short";
  const auto cut = grid.Plan("-0.95,2.05", "-0.95,2.05", "0");
  EXPECT_EQ(cut->WaitForExit(), 3);
  EXPECT_THAT(cut->StandardError(), HasSubstr("map.pgm ends too early"));
  std::ofstream((grid.folder() / "map.yaml").string()) << "image: map.pgm\n";
  const auto lacking = grid.Plan("-0.95,2.05", "-0.95,2.05", "0");
  EXPECT_EQ(lacking->WaitForExit(), 3);
  EXPECT_THAT(lacking->StandardError(), HasSubstr("map.yaml has no resolution"));
}

TEST(PlanGrid, PlansOnTheGridOfARunningSystemUnderAPrefix) {
  // A hub that delivers nothing of the time before a client came.
  const TempFolder folder;
  folder.Write("hub.txtpb", "hub { rejoin_s: 0 }");
  ProcessBus hub({"--config", folder / "hub.txtpb"});
  ProcessBus processes(hub, "robot1/");
  testing_support::FakeExporter exporter(&processes);
  const auto run = [&](const std::string& goal) {
    auto program = std::make_unique<ChildProcess>(
        VISMAP_EXAMPLES_DIR "/plan_grid",
        std::vector<std::string>{"live", "0.55,0.55", goal, "0.2", "--lcm-url", processes.url(),
                                 "--channel-prefix", "robot1/"},
        processes.folder());
    EXPECT_TRUE(exporter.LiveUntil([&] { return !program->Running(); }));
    return program;
  };
  const auto set_map = [&](bool open, int64_t revision) {
    exporter.SetMap(testing_support::TwoRooms(open), revision);
    exporter.grid = testing_support::GridOf(testing_support::TwoRooms(open), revision);
    exporter.SetOutput("GRID", revision);
  };
  set_map(true, 1);
  const auto open = run("3.15,0.75");
  ASSERT_EQ(open->WaitForExit(), 0) << open->StandardError();
  std::istringstream lines(open->StandardOutput());
  double x = 0, y = 0;
  while (lines >> x >> y) EXPECT_GT(std::hypot(x - 1, y - 1), 0.2) << "the pillar";
  EXPECT_NEAR(x, 3.15, 1e-9);
  set_map(false, 2);
  const auto shut = run("3.15,0.75");
  EXPECT_EQ(shut->WaitForExit(), 1);
  EXPECT_THAT(shut->StandardError(), HasSubstr("there is no path"));
  exporter.grid.reset();
  exporter.SetOutput("GRID", -1);
  exporter.status.message = "GRID: z of the map does not point upward";
  const auto none = run("3.15,0.75");
  EXPECT_EQ(none->WaitForExit(), 1);
  EXPECT_THAT(none->StandardError(), HasSubstr("z of the map does not point upward"));
}

/// The free cells of an image as vismap writes it, which has no comment; row 0 has the smallest y.
struct FreeCells {
  int width = 0, height = 0;
  std::vector<bool> free;

  explicit FreeCells(const std::filesystem::path& pgm) {
    std::ifstream file(pgm, std::ios::binary);
    std::string magic;
    int most = 0;
    file >> magic >> width >> height >> most;
    file.get();
    free.resize(static_cast<size_t>(width) * static_cast<size_t>(height));
    for (int y = height - 1; y >= 0; --y) {
      for (int x = 0; x < width; ++x) free[At(x, y)] = file.get() == 254;
    }
  }
  size_t At(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
  /// Whether all cells up to `reach` to each side are free, too.
  bool HasRoom(int x, int y, int reach) const {
    if (x < reach || y < reach || x + reach >= width || y + reach >= height) return false;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        if (!free[At(x + dx, y + dy)]) return false;
      }
    }
    return true;
  }
  /// The cells with room that can be reached from one of them, the farthest last.
  std::vector<std::pair<int, int>> ReachableFrom(std::pair<int, int> start, int reach) const {
    std::vector<std::pair<int, int>> reached{start};
    std::vector<bool> seen(free.size());
    seen[At(start.first, start.second)] = true;
    for (size_t i = 0; i < reached.size(); ++i) {
      const auto [x, y] = reached[i];
      for (const auto& [dx, dy] :
           {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
        if (!HasRoom(x + dx, y + dy, reach) || seen[At(x + dx, y + dy)]) continue;
        seen[At(x + dx, y + dy)] = true;
        reached.emplace_back(x + dx, y + dy);
      }
    }
    return reached;
  }
  /// Two cells that are connected and far from each other.
  std::pair<std::pair<int, int>, std::pair<int, int>> FarPair(int reach) const {
    std::vector<std::pair<int, int>> largest;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!HasRoom(x, y, reach)) continue;
        auto reached = ReachableFrom({x, y}, reach);
        if (reached.size() > largest.size()) largest = std::move(reached);
      }
    }
    if (largest.empty()) throw std::runtime_error("the robot fits nowhere");
    return {largest.back(), ReachableFrom(largest.back(), reach).back()};
  }
};

/// "x,y" of the centre of a cell, by the origin in the YAML file.
std::string PointIn(const std::filesystem::path& yaml, std::pair<int, int> cell) {
  std::ifstream file(yaml);
  std::string text(std::istreambuf_iterator<char>(file), {});
  double x = 0, y = 0;
  if (std::sscanf(text.c_str() + text.find("origin:"), "origin: [%lf, %lf", &x, &y) != 2)
    throw std::runtime_error("no origin in " + text);
  return std::to_string(x + (cell.first + 0.5) * 0.05) + "," +
         std::to_string(y + (cell.second + 0.5) * 0.05);
}

/// How deep a standing cylinder on the floor is inside of something, at most [m]; negative = the
/// distance to everything but the floor, at the points that are looked at.
double DepthInObstacles(const Scene& things, double x, double y, double radius, double height) {
  double deepest = -std::numeric_limits<double>::infinity();
  for (double z = 0.05; z <= height; z += 0.05) {
    for (int i = 0; i < 24; ++i) {
      const double angle = i * std::numbers::pi / 12;
      const Eigen::Vector3d p(x + radius * std::cos(angle), y + radius * std::sin(angle), z);
      deepest = std::max(deepest, -SignedDistance(things, p));
    }
  }
  return deepest;
}

TEST(PlanGrid, DrivesThroughAMappedRoomAndTouchesNothing) {
  constexpr double kRobotRadius = 0.25, kRobotHeight = 1.0;  // [m]; the height is the config's
  const TempFolder folder;
  const auto run = [&](const std::string& program, const std::vector<std::string>& arguments) {
    auto child = std::make_unique<ChildProcess>(program, arguments, folder.path());
    child->WaitForExit();
    return child;
  };
  const auto mapper = run("offline-mapper", {"--dataset", "synthetic:room?frames=40&width=320",
                                             "--detections", "none", "--out", folder.path()});
  ASSERT_EQ(mapper->WaitForExit(), 0) << mapper->StandardError();
  const auto exported = run("map", {"export", folder / "map.vismap", "--grid", folder.path()});
  ASSERT_EQ(exported->WaitForExit(), 0) << exported->StandardError();
  // A robot of 0.25 m fits where five cells of 5 cm to each side are free, and one for the cell.
  const auto [from, to] = FreeCells(folder / "map.pgm").FarPair(6);
  const std::string start = PointIn(folder / "map.yaml", from);
  const auto plan = [&](const std::string& goal) {
    return run(VISMAP_EXAMPLES_DIR "/plan_grid",
               {folder / "map.yaml", start, goal, std::to_string(kRobotRadius)});
  };
  const auto program = plan(PointIn(folder / "map.yaml", to));
  ASSERT_EQ(program->WaitForExit(), 0) << program->StandardError();
  Scene things = MakeRoom();
  std::erase_if(things.objects, [](const SceneObject& object) { return object.name == "floor"; });
  std::istringstream lines(program->StandardOutput());
  int cells = 0;
  for (double x = 0, y = 0; lines >> x >> y; ++cells)
    EXPECT_LT(DepthInObstacles(things, x, y, kRobotRadius, kRobotHeight), 0) << x << " " << y;
  EXPECT_GE(cells, 50);
  const auto table = plan("0,0");
  EXPECT_EQ(table->WaitForExit(), 1);
  EXPECT_THAT(table->StandardError(), HasSubstr("the goal is in an occupied or unknown cell"));
}

}  // namespace
}  // namespace vismap
