#include "navigation/grid_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "support/temp_folder.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// What a costmap has: 0 free, 100 occupied, -1 unknown; from the lower left corner, row by row.
struct CostMap {
  int width = 0, height = 0;
  double resolution = 0;
  std::vector<double> origin;
  std::vector<int> data;
};

/// Reads the two files as the map servers of ROS and nav2 do.
CostMap ReadAsMapServersDo(const fs::path& yaml) {
  std::map<std::string, std::string> keys;
  std::ifstream text(yaml);
  for (std::string line; std::getline(text, line);)
    keys[line.substr(0, line.find(':'))] = line.substr(line.find(':') + 2);
  EXPECT_EQ(keys.at("mode"), "trinary");
  CostMap map;
  map.resolution = std::stod(keys.at("resolution"));
  std::istringstream origin(keys.at("origin").substr(1));
  for (std::string number; std::getline(origin, number, ',');)
    map.origin.push_back(std::stod(number));
  std::ifstream image(yaml.parent_path() / keys.at("image"), std::ios::binary);
  std::string magic;
  int largest = 0;
  image >> magic >> map.width >> map.height >> largest;
  EXPECT_EQ(magic, "P5");
  EXPECT_EQ(largest, 255);
  image.get();
  std::vector<char> pixels(static_cast<size_t>(map.width) * static_cast<size_t>(map.height));
  image.read(pixels.data(), static_cast<std::streamsize>(pixels.size()));
  EXPECT_TRUE(image);
  EXPECT_EQ(image.get(), EOF);
  for (int y = map.height - 1; y >= 0; --y) {
    for (int x = 0; x < map.width; ++x) {
      const auto pixel = static_cast<uint8_t>(pixels[static_cast<size_t>(y * map.width + x)]);
      const double shade = pixel / 255.0;
      const double occupied = keys.at("negate") == "0" ? 1 - shade : shade;
      const bool above = occupied > std::stod(keys.at("occupied_thresh"));
      const bool below = occupied < std::stod(keys.at("free_thresh"));
      map.data.push_back(above ? 100 : below ? 0 : -1);
    }
  }
  return map;
}

/// Three cells wide, two high.
GroundGrid SmallGrid() {
  GroundGrid grid;
  grid.resolution_m = 0.05;
  grid.origin_W = {-1.15, 2.3000000000000003};
  grid.width = 3;
  grid.height = 2;
  grid.states = {CellState::kFree,    CellState::kOccupied, CellState::kUnknown,
                 CellState::kUnknown, CellState::kFree,     CellState::kFree};
  return grid;
}

TEST(GridFiles, MapServersReadTheSameStates) {
  const TempFolder folder;
  const auto files = WriteGridFiles(SmallGrid(), folder.path() / "hall.v2");
  ASSERT_TRUE(files) << files.error().message;
  EXPECT_EQ(files->image, folder.path() / "hall.v2.pgm");
  const CostMap map = ReadAsMapServersDo(files->yaml);
  EXPECT_EQ(map.width, 3);
  EXPECT_EQ(map.height, 2);
  EXPECT_EQ(map.resolution, 0.05);
  EXPECT_THAT(map.origin, ElementsAre(-1.15, 2.3, 0));
  EXPECT_THAT(map.data, ElementsAre(0, 100, -1, -1, 0, 0));
}

TEST(GridFiles, FolderGetsMapPgmAndYaml) {
  const TempFolder folder;
  const auto files = WriteGridFiles(SmallGrid(), folder.path());
  ASSERT_TRUE(files) << files.error().message;
  EXPECT_EQ(files->yaml, folder.path() / "map.yaml");
  EXPECT_EQ(ReadAsMapServersDo(files->yaml).data.size(), 6u);
}

TEST(GridFiles, ErrorsNameTheFile) {
  const TempFolder folder;
  const auto files = WriteGridFiles(SmallGrid(), folder.path() / "missing" / "map");
  ASSERT_FALSE(files);
  EXPECT_THAT(files.error().message, HasSubstr("missing/map.pgm"));
  EXPECT_THAT(WriteGridFiles({}, folder.path()).error().message, HasSubstr("nothing is known"));
}

}  // namespace
}  // namespace vismap
