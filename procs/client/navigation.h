#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/occupancy_grid_t.hpp>
#include <vismap/octree_t.hpp>

namespace vismap {

/// The trees that the octomap exporter publishes, see procs/README.md, Octrees.
enum class TreeKind {
  kClosed,    ///< OCTOMAP: unknown space is occupied. For planners
  kInflated,  ///< OCTOMAP_INFLATED: closed, and grown by the radius of the robot, for a point
  kCoarse,    ///< OCTOMAP_COARSE: closed, with larger leaves
  kRaw,       ///< OCTOMAP_RAW: unknown space has no nodes, and collision checkers take it for free
};

struct NavigationClientOptions {
  std::string url;  ///< of the bus, as in ClientOptions; empty = $LCM_DEFAULT_URL or the usual hub
  std::string name = "planner";   ///< of this program on the bus; must be unique
  double connect_timeout_s = 10;  ///< how long the constructor waits for the hub [s]
  std::vector<TreeKind> trees{TreeKind::kClosed};  ///< which trees to receive
  /// After so long without a word from the octomap exporter or the map server, which both speak
  /// once a second, trees are stale [s].
  double max_silence_s = 2.8;
  std::string channel_prefix = {};  ///< as in ClientOptions
  bool grid = false;       ///< also receive GRID, which octomap_exporter.grid_period_s turns on
  bool distances = false;  ///< also follow DISTANCES (octomap_exporter.distance_limit_m)
};

/// A tree of free space, and how far it can be trusted.
struct FreeSpace {
  /// The tree as a .bt stream of OctoMap in `data`, with its bounds, map_id, revision and policy;
  /// nullptr = there is none, and `why` says so. It is never changed: a newer tree is another
  /// object.
  std::shared_ptr<const octree_t> tree;
  /// How long ago this was known to be the newest state of the map [s]. Up to about two seconds in
  /// normal operation.
  double age_s = std::numeric_limits<double>::infinity();
  bool stale = true;  ///< it must be assumed that the tree is not the newest state of the map
  std::string why;    ///< it is stale, or there is none; one sentence. Empty otherwise

  explicit operator bool() const { return tree != nullptr; }
};

/// The distance from a point to the nearest face of a leaf.
struct SpaceDistance {
  enum class Nearest {
    kNothing,   ///< within the limit
    kObstacle,  ///< an occupied leaf
    kUnknown,   ///< space that was not seen, or outside of the tree
  };
  double distance_m = 0;           ///< exact; the limit when there is nothing within it [m]
  std::array<double, 3> away_W{};  ///< gradient: the unit vector away from that face; or zero
  Nearest nearest = Nearest::kNothing;
};

/// Distances in a tree, for planners that check them instead of collisions: a ball around a point
/// is in free space as long as its radius is less than From(point).distance_m. Of a raw tree it
/// knows whether an obstacle or unknown space is near; in a closed one both are obstacles. Making
/// it computes all distances, so not in a control loop. It never changes, and any threads may read.
class SpaceDistances {
 public:
  /// Distances are exact up to `limit_m` [m]. Throws std::invalid_argument when the tree is damaged
  /// or covers too much (more than 2^20 blocks of 8x8x8 leaves), and on a limit that is out of
  /// range.
  explicit SpaceDistances(const octree_t& tree, double limit_m = 2);
  ~SpaceDistances();
  SpaceDistances(SpaceDistances&&) noexcept;
  SpaceDistances& operator=(SpaceDistances&&) noexcept;

  SpaceDistance FromObstacle(const std::array<double, 3>& p_W) const;  ///< p_W [m]
  SpaceDistance FromUnknown(const std::array<double, 3>& p_W) const;
  SpaceDistance From(const std::array<double, 3>& p_W) const;  ///< the smaller of the two

 private:
  struct Field;
  std::unique_ptr<Field> field_;
};

/// A 2-D grid for robots on wheels, and how far it can be trusted, as FreeSpace.
struct WheelGrid {
  /// nullptr = there is none, and `why` says so. It is never changed.
  std::shared_ptr<const occupancy_grid_t> grid;
  double age_s = std::numeric_limits<double>::infinity();
  bool stale = true;
  std::string why;

  explicit operator bool() const { return grid != nullptr; }
};

/// Distances from the centres of leaves, as they come on DISTANCES. It never changes, and any
/// threads may read. A newer one shares with it what is equal.
class LeafDistances {
 public:
  struct Field;
  explicit LeafDistances(std::unique_ptr<const Field> field);  ///< NavigationClient makes them
  ~LeafDistances();

  double leaf_m() const;   ///< edge of a leaf [m]
  double limit_m() const;  ///< distances are exact up to here; what is farther away is this [m]

  /// From the centre of the leaf around a point, to the nearest face of an occupied or an unknown
  /// leaf [m]. 0 where nothing is known.
  double ToObstacle(const std::array<double, 3>& p_W) const;
  double ToUnknown(const std::array<double, 3>& p_W) const;
  /// A ball of this radius around the point itself is in free space [m]: at most 1.74 leaves less
  /// than the distance to what is nearest, and never more.
  double FreeRadius(const std::array<double, 3>& p_W) const;

 private:
  std::unique_ptr<const Field> field_;
};

/// Distances, and how far they can be trusted, as FreeSpace.
struct KnownDistances {
  std::shared_ptr<const LeafDistances> distances;  ///< nullptr = there are none
  std::string map_id;                              ///< of the map that they are of
  int64_t revision = -1;
  double age_s = std::numeric_limits<double>::infinity();
  bool stale = true;
  std::string why;

  explicit operator bool() const { return distances != nullptr; }
};

/// What to ask the octomap exporter for.
struct TreeRequest {
  struct Box {
    std::array<double, 3> min_W, max_W;  ///< corners [m]
  };
  std::optional<Box> box;   ///< nullopt = the whole map
  double resolution_m = 0;  ///< edge of a leaf, a multiple of the voxel size; 0 = the usual one
  bool raw = false;         ///< false = closed
  double inflate_m = 0;     ///< radius of the robot, for closed trees; 0 = none
  std::string without;      ///< objects that are left out, such as "id=7;class=cup"; empty = none
};

/// Free space for planners: keeps the newest trees, grid and distances of the octomap exporter,
/// knows how old they are and whether the programs that make them are alive, and asks for others.
///
///   vismap::NavigationClient navigation;
///   navigation.Start();
///   vismap::FreeSpace space = navigation.WaitFor(vismap::TreeKind::kClosed, 10);
///   if (!space || space.stale) complain(space.why);
///
/// Messages are handled by a thread of its own after Start, else by Handle. Newest never waits for
/// messages or for the decoding of them: it copies a pointer. After Start, all functions but Handle
/// may be called from any thread; before, everything from one thread.
class NavigationClient {
 public:
  /// Connects to the bus. Throws std::runtime_error as Client does.
  explicit NavigationClient(const NavigationClientOptions& options = {});
  ~NavigationClient();
  NavigationClient(const NavigationClient&) = delete;
  NavigationClient& operator=(const NavigationClient&) = delete;

  /// Starts a thread that handles messages from now on. Once only. If it fails, for example since
  /// there is no memory, everything is stale from then on, and `why` says so.
  void Start();

  /// Waits up to `timeout_s` [s] for messages and handles those that have arrived. Returns true
  /// when there was one. Without Start it must be called at least about ten times per second: a
  /// message counts as heard when it is handled. Throws std::logic_error after Start.
  bool Handle(double timeout_s);

  /// The newest tree. With `max_age_s` [s], none that is stale or older is handed out, and `why`
  /// says so. A tree that is empty, damaged, or raw on the channel of a closed one is never handed
  /// out. Throws std::invalid_argument when the kind is not among NavigationClientOptions::trees.
  FreeSpace Newest(TreeKind kind, double max_age_s = std::numeric_limits<double>::infinity()) const;

  /// Waits up to `timeout_s` [s] until Newest has a tree that is not stale, and returns it, or the
  /// last state with `why`.
  FreeSpace WaitFor(TreeKind kind, double timeout_s,
                    double max_age_s = std::numeric_limits<double>::infinity());

  /// The same for the newest grid. Throws std::invalid_argument unless the options ask for grids.
  WheelGrid NewestGrid(double max_age_s = std::numeric_limits<double>::infinity()) const;
  WheelGrid WaitForGrid(double timeout_s,
                        double max_age_s = std::numeric_limits<double>::infinity());

  /// The same for the newest distances. They are followed by what changes: when a message was
  /// missed, it asks the exporter for what it lacks.
  KnownDistances NewestDistances(double max_age_s = std::numeric_limits<double>::infinity()) const;
  KnownDistances WaitForDistances(double timeout_s,
                                  double max_age_s = std::numeric_limits<double>::infinity());

  /// Asks the octomap exporter for a tree and waits up to `timeout_s` [s]. Its reasons for a
  /// refusal are in `why`.
  FreeSpace AskTree(const TreeRequest& request, double timeout_s);

  /// Sends any request (see procs/README.md, Requests) and waits up to `timeout_s` [s] for the
  /// reply. The request is repeated when no reply comes, and carried out once. Without an answer in
  /// time, `ok` is false and `message` says what is known about the reason.
  map_reply_t Ask(map_request_t request, double timeout_s);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace vismap
