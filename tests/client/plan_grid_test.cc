#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "process/process_harness.h"

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

}  // namespace
}  // namespace vismap
