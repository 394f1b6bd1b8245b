// A planner for wheels to start from: reads a grid as map_server and nav2 do (PGM + YAML, which
// vismap writes), plans the path of a round robot over it with A*, and prints it. Unknown cells are
// obstacles.
//
//   ./plan_grid MAP.yaml START GOAL [RADIUS]
//   ./plan_grid map.yaml 1.1,1.2 4.2,3.6 0.2
// START and GOAL are points x,y of the map [m]. Standard output has one line "x y" for each cell of
// the path. Exit codes: 0 there is a path, 1 there is none, 2 wrong usage, 3 unreadable files.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

struct Cell {
  int x = 0, y = 0;
};

/// Cells in rows of growing y, each from small to large x.
struct Grid {
  int width = 0, height = 0;
  double resolution = 0;            ///< edge of a cell [m]
  std::array<double, 2> origin{};   ///< the corner of the first cell [m]
  std::vector<uint8_t> obstacle{};  ///< 1 = occupied or unknown

  size_t At(Cell cell) const {
    return static_cast<size_t>(cell.y) * static_cast<size_t>(width) + static_cast<size_t>(cell.x);
  }
  bool Contains(Cell cell) const {
    return cell.x >= 0 && cell.y >= 0 && cell.x < width && cell.y < height;
  }
  Cell CellOf(const std::array<double, 2>& p) const {
    return {static_cast<int>(std::floor((p[0] - origin[0]) / resolution)),
            static_cast<int>(std::floor((p[1] - origin[1]) / resolution))};
  }
  std::array<double, 2> CentreOf(Cell cell) const {
    return {origin[0] + (cell.x + 0.5) * resolution, origin[1] + (cell.y + 0.5) * resolution};
  }
};

/// The values of a YAML file with one `key: value` on each line.
std::map<std::string, std::string> ReadYaml(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path.string() + " cannot be read");
  std::map<std::string, std::string> values;
  for (std::string line; std::getline(file, line);) {
    const size_t colon = line.find(':');
    if (colon == std::string::npos || line[0] == '#') continue;
    const size_t begin = line.find_first_not_of(' ', colon + 1);
    values[line.substr(0, colon)] = begin == std::string::npos ? "" : line.substr(begin);
  }
  for (const char* key : {"image", "resolution", "origin", "occupied_thresh", "free_thresh"}) {
    if (values.count(key) == 0) throw std::runtime_error(path.string() + " has no " + key);
  }
  return values;
}

struct Picture {
  int width = 0, height = 0;
  std::vector<uint8_t> grey;  ///< rows from the largest y to the smallest
};

Picture ReadPgm(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  Picture picture;
  int most = 0;
  file >> magic;
  while (file >> std::ws && file.peek() == '#')
    file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  file >> picture.width >> picture.height >> most;
  file.get();
  const bool sane = file && magic == "P5" && most == 255 && picture.width > 0 &&
                    picture.height > 0 && picture.width < 20000 && picture.height < 20000;
  if (!sane) throw std::runtime_error(path.string() + " is no binary PGM of 8 bits");
  picture.grey.resize(static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height));
  file.read(reinterpret_cast<char*>(picture.grey.data()),
            static_cast<std::streamsize>(picture.grey.size()));
  if (!file) throw std::runtime_error(path.string() + " ends too early");
  return picture;
}

/// The rules of map_server: white is free, black is occupied, and what lies between is unknown.
Grid ReadGrid(const std::filesystem::path& yaml) {
  const auto values = ReadYaml(yaml);
  const auto number = [&](const char* key) { return std::atof(values.at(key).c_str()); };
  const Picture picture = ReadPgm(yaml.parent_path() / values.at("image"));
  Grid grid{picture.width, picture.height, number("resolution")};
  double turn = 0;
  const int read = std::sscanf(values.at("origin").c_str(), "[%lf, %lf, %lf]", &grid.origin[0],
                               &grid.origin[1], &turn);
  if (read != 3 || turn != 0 || !(grid.resolution > 0))
    throw std::runtime_error(yaml.string() + ": origin must be [x, y, 0], and resolution positive");
  const bool negate = values.count("negate") > 0 && number("negate") != 0;
  grid.obstacle.resize(picture.grey.size(), 1);
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const double grey = picture.grey[grid.At({x, grid.height - 1 - y})] / 255.0;
      const double occupied = negate ? grey : 1 - grey;
      grid.obstacle[grid.At({x, y})] = occupied < number("free_thresh") ? 0 : 1;
    }
  }
  return grid;
}

/// The gap between the squares of two cells along one axis, in cells.
int Gap(int difference) { return std::max(0, std::abs(difference) - 1); }

/// The gap from the square of a cell to the nearest obstacle, or to the rim of the grid [m]; at
/// most `limit`. So a robot whose centre is anywhere in the cell is at least so far from it.
double GapAround(const Grid& grid, Cell cell, double limit) {
  const int reach = static_cast<int>(std::ceil(limit / grid.resolution)) + 1;
  double nearest2 = limit * limit / (grid.resolution * grid.resolution);
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const Cell other{cell.x + dx, cell.y + dy};
      if (grid.Contains(other) && grid.obstacle[grid.At(other)] == 0) continue;
      const double gap2 = Gap(dx) * Gap(dx) + Gap(dy) * Gap(dy);
      nearest2 = std::min(nearest2, gap2);
    }
  }
  return std::sqrt(nearest2) * grid.resolution;
}

/// The grid with obstacles grown by the radius of the robot.
Grid Inflate(const Grid& grid, double radius) {
  Grid inflated = grid;
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const Cell cell{x, y};
      if (grid.obstacle[grid.At(cell)] != 0 || GapAround(grid, cell, radius) < radius)
        inflated.obstacle[grid.At(cell)] = 1;
    }
  }
  return inflated;
}

double Straight(Cell a, Cell b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// A* over the eight neighbours of a cell. Corners of obstacles are not cut.
class Search {
 public:
  Search(const Grid& grid, Cell start, Cell goal) : grid_(grid), start_(start), goal_(goal) {
    cost_.assign(grid.obstacle.size(), std::numeric_limits<double>::infinity());
    from_.resize(grid.obstacle.size());
  }

  /// The cells from start to goal; empty when there is no path.
  std::vector<Cell> Run() {
    cost_[grid_.At(start_)] = 0;
    open_.push({Straight(start_, goal_), start_});
    while (!open_.empty()) {
      const Entry entry = open_.top();
      open_.pop();
      if (entry.cell.x == goal_.x && entry.cell.y == goal_.y) return Path();
      if (entry.total <= cost_[grid_.At(entry.cell)] + Straight(entry.cell, goal_) + 1e-9)
        Expand(entry.cell);
    }
    return {};
  }

 private:
  struct Entry {
    double total = 0;
    Cell cell;
    bool operator<(const Entry& other) const { return total > other.total; }
  };

  bool IsFree(int x, int y) const {
    return grid_.Contains({x, y}) && grid_.obstacle[grid_.At({x, y})] == 0;
  }

  void Expand(Cell cell) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (dx == 0 && dy == 0) continue;
        const Cell next{cell.x + dx, cell.y + dy};
        if (!IsFree(next.x, next.y) || !IsFree(next.x, cell.y) || !IsFree(cell.x, next.y)) continue;
        const double cost = cost_[grid_.At(cell)] + std::hypot(dx, dy);
        if (cost >= cost_[grid_.At(next)]) continue;
        cost_[grid_.At(next)] = cost;
        from_[grid_.At(next)] = cell;
        open_.push({cost + Straight(next, goal_), next});
      }
    }
  }

  std::vector<Cell> Path() const {
    std::vector<Cell> path{goal_};
    while (path.back().x != start_.x || path.back().y != start_.y)
      path.push_back(from_[grid_.At(path.back())]);
    std::reverse(path.begin(), path.end());
    return path;
  }

  const Grid& grid_;
  Cell start_, goal_;
  std::vector<double> cost_;
  std::vector<Cell> from_;
  std::priority_queue<Entry> open_;
};

struct Task {
  std::filesystem::path yaml;
  std::array<double, 2> start{}, goal{};
  double radius = 0.2;
};

int Refuse(const std::string& sentence) {
  std::cerr << "plan_grid: " << sentence << "\n";
  return 1;
}

/// "" = the robot can be there.
std::string WhyNot(const Grid& grid, const Grid& inflated, const std::array<double, 2>& p) {
  const Cell cell = grid.CellOf(p);
  if (!grid.Contains(cell)) return "is outside of the grid";
  if (grid.obstacle[grid.At(cell)] != 0) return "is in an occupied or unknown cell";
  if (inflated.obstacle[grid.At(cell)] != 0)
    return "is nearer than the radius to an occupied or unknown cell";
  return "";
}

int Plan(const Task& task, const Grid& grid) {
  const Grid inflated = Inflate(grid, task.radius);
  for (const auto& [name, p] : {std::pair("start", task.start), std::pair("goal", task.goal)}) {
    const std::string why = WhyNot(grid, inflated, p);
    if (!why.empty()) return Refuse(std::string("the ") + name + " " + why);
  }
  const std::vector<Cell> path =
      Search(inflated, grid.CellOf(task.start), grid.CellOf(task.goal)).Run();
  if (path.empty()) return Refuse("there is no path; unknown cells are not driven through");
  double length = 0, clearance = 1;
  for (size_t i = 0; i < path.size(); ++i) {
    const std::array<double, 2> p = grid.CentreOf(path[i]);
    std::printf("%.4f %.4f\n", p[0], p[1]);
    if (i > 0) length += Straight(path[i - 1], path[i]) * grid.resolution;
    clearance = std::min(clearance, GapAround(grid, path[i], clearance));
  }
  std::fprintf(stderr, "path of %.2f m in %zu cells; clearance %.3f m, radius %.3f m\n", length,
               path.size(), clearance, task.radius);
  return 0;
}

bool ReadPoint(const char* text, std::array<double, 2>* p) {
  char end = 0;
  return std::sscanf(text, "%lf,%lf%c", &(*p)[0], &(*p)[1], &end) == 2 && std::isfinite((*p)[0]) &&
         std::isfinite((*p)[1]);
}

}  // namespace

int main(int argc, char** argv) {
  Task task;
  const bool understood =
      (argc == 4 || argc == 5) && ReadPoint(argv[2], &task.start) && ReadPoint(argv[3], &task.goal);
  if (understood && argc == 5) task.radius = std::atof(argv[4]);
  if (!understood || !(task.radius >= 0 && task.radius < 5)) {
    std::cerr << "usage: plan_grid MAP.yaml X,Y X,Y [RADIUS]; the radius is below 5 m\n";
    return 2;
  }
  try {
    task.yaml = argv[1];
    return Plan(task, ReadGrid(task.yaml));
  } catch (const std::exception& error) {
    std::cerr << "plan_grid: " << error.what() << "\n";
    return 3;
  }
}
