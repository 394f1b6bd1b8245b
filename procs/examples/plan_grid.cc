// A planner for wheels to start from: takes the grid of a running vismap system, or reads one as
// map_server and nav2 do (PGM + YAML, which vismap writes), plans the path of a round robot over it
// with A*, and prints it. Unknown cells are obstacles.
//
//   ./plan_grid MAP.yaml|live START GOAL [RADIUS] [--lcm-url URL] [--channel-prefix PREFIX]
//   ./plan_grid live 1.1,1.2 4.2,3.6 0.2    # needs octomap_exporter { grid_period_s: 1 }
// START and GOAL are points x,y of the map [m]. Standard output has one line "x y" for each cell of
// the path. Exit codes: 0 there is a path, 1 there is none or no grid, 2 wrong usage, 3 unreadable
// files or no bus.
#include <vismap/navigation.h>

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

constexpr double kWaitForGrid = 10;  // [s]
constexpr double kMaxAge = 5;        // of a grid that is planned on [s]

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

Grid GridOf(const vismap::occupancy_grid_t& message) {
  Grid grid{message.width,
            message.height,
            message.resolution_m,
            {message.origin_W[0], message.origin_W[1]}};
  for (const uint8_t state : message.states)
    grid.obstacle.push_back(state == vismap::occupancy_grid_t::FREE ? 0 : 1);
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
  std::string map;  ///< a YAML file, or "live"
  std::array<double, 2> start{}, goal{};
  double radius = 0.2;
  vismap::NavigationClientOptions navigation;
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

/// A path, or why there is none.
struct Plan {
  std::vector<Cell> path;
  std::string why;
};

Plan MakePlan(const Task& task, const Grid& grid) {
  const Grid inflated = Inflate(grid, task.radius);
  for (const auto& [name, p] : {std::pair("start", task.start), std::pair("goal", task.goal)}) {
    const std::string why = WhyNot(grid, inflated, p);
    if (!why.empty()) return {{}, std::string("the ") + name + " " + why};
  }
  Plan plan{Search(inflated, grid.CellOf(task.start), grid.CellOf(task.goal)).Run(), ""};
  if (plan.path.empty()) plan.why = "there is no path; unknown cells are not driven through";
  return plan;
}

int Print(const Plan& plan, const Task& task, const Grid& grid) {
  if (plan.path.empty()) return Refuse(plan.why);
  double length = 0, clearance = 1;
  for (size_t i = 0; i < plan.path.size(); ++i) {
    const std::array<double, 2> p = grid.CentreOf(plan.path[i]);
    std::printf("%.4f %.4f\n", p[0], p[1]);
    if (i > 0) length += Straight(plan.path[i - 1], plan.path[i]) * grid.resolution;
    clearance = std::min(clearance, GapAround(grid, plan.path[i], clearance));
  }
  std::fprintf(stderr, "path of %.2f m in %zu cells; clearance %.3f m, radius %.3f m\n", length,
               plan.path.size(), clearance, task.radius);
  return 0;
}

/// Whether the robot fits in all cells of a path of another grid, which may have other bounds.
bool IsFree(const Grid& now, const Grid& planned, const std::vector<Cell>& path, double radius) {
  const Grid inflated = Inflate(now, radius);
  return std::all_of(path.begin(), path.end(), [&](Cell cell) {
    return WhyNot(now, inflated, planned.CentreOf(cell)).empty();
  });
}

int PlanLive(const Task& task) {
  vismap::NavigationClient navigation(task.navigation);
  navigation.Start();
  const vismap::WheelGrid found = navigation.WaitForGrid(kWaitForGrid, kMaxAge);
  if (!found) return Refuse(found.why);
  const Grid grid = GridOf(*found.grid);
  const Plan plan = MakePlan(task, grid);
  // The map may have changed meanwhile.
  const vismap::WheelGrid now = navigation.NewestGrid(kMaxAge);
  if (!now) return Refuse(now.why);
  if (now.grid != found.grid && !IsFree(GridOf(*now.grid), grid, plan.path, task.radius))
    return Refuse("the map has changed, and the path is not free any more");
  return Print(plan, task, grid);
}

bool ReadPoint(const char* text, std::array<double, 2>* p) {
  char end = 0;
  return std::sscanf(text, "%lf,%lf%c", &(*p)[0], &(*p)[1], &end) == 2 && std::isfinite((*p)[0]) &&
         std::isfinite((*p)[1]);
}

/// Takes the options and their values out of the words of a command line.
bool TakeOptions(std::vector<std::string>* words, vismap::NavigationClientOptions* options) {
  for (size_t i = 0; i < words->size();) {
    const std::string& word = (*words)[i];
    std::string* value = word == "--lcm-url"          ? &options->url
                         : word == "--channel-prefix" ? &options->channel_prefix
                                                      : nullptr;
    if (value == nullptr) {
      ++i;
      continue;
    }
    if (i + 1 == words->size()) return false;
    *value = (*words)[i + 1];
    words->erase(words->begin() + static_cast<std::ptrdiff_t>(i),
                 words->begin() + static_cast<std::ptrdiff_t>(i) + 2);
  }
  return true;
}

std::optional<Task> ReadTask(std::vector<std::string> words) {
  Task task;
  task.navigation.name = "plan-grid";
  task.navigation.trees = {};
  task.navigation.grid = true;
  if (!TakeOptions(&words, &task.navigation) || words.size() < 3 || words.size() > 4)
    return std::nullopt;
  task.map = words[0];
  if (!ReadPoint(words[1].c_str(), &task.start) || !ReadPoint(words[2].c_str(), &task.goal))
    return std::nullopt;
  if (words.size() == 4) task.radius = std::atof(words[3].c_str());
  if (!(task.radius >= 0 && task.radius < 5)) return std::nullopt;
  return task;
}

}  // namespace

int main(int argc, char** argv) {
  const std::optional<Task> task = ReadTask({argv + 1, argv + argc});
  if (!task) {
    std::cerr << "usage: plan_grid MAP.yaml|live X,Y X,Y [RADIUS] [--lcm-url URL] "
                 "[--channel-prefix PREFIX]; the radius is below 5 m\n";
    return 2;
  }
  try {
    if (task->map == "live") return PlanLive(*task);
    const Grid grid = ReadGrid(task->map);
    return Print(MakePlan(*task, grid), *task, grid);
  } catch (const std::exception& error) {
    std::cerr << "plan_grid: " << error.what() << "\n";
    return 3;
  }
}
