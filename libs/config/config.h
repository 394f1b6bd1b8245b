#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "association/associate.h"
#include "base/result.h"
#include "detection/dnn_options.h"
#include "freespace/occupancy.h"
#include "freespace/octree.h"
#include "map/voxel_map.h"
#include "mapping/integrate.h"
#include "objects/objects.h"
#include "segmentation/segmentation_options.h"

namespace vismap {

// What lives in this room: config files. The only user of options.pb.h (in .cc files). Which keys
// there are, and what they mean, stands in options.proto; defaults stand in the option structs.

/// What a frame waits for in the depth segmenter.
enum class WaitForDetections { kRequired, kAuto, kNone };

struct DepthSegmenterConfig {
  WaitForDetections detections = WaitForDetections::kAuto;
  double detection_timeout_s = 2.0;  ///< kAuto: patience with a detector that is alive [s]
  int max_waiting_frames = 64;       ///< beyond, the oldest is given up
};

struct MapServerConfig {
  std::string load;             ///< map file to continue; empty = none
  std::string save_on_exit;     ///< map file to write when stopped; empty = none
  double save_period_s = 0;     ///< and also while running [s]; 0 = do not
  bool recover = false;         ///< go on from save_on_exit, if it is there, and keep a journal
  double mesh_period_s = 1;     ///< least time between two mesh updates [s]; 0 = every frame
  double objects_period_s = 1;  ///< least time between two object lists [s]; 0 = every frame
};

struct OctomapExporterConfig {
  double period = 1;  ///< least time between two octrees [s]; 0 = only on request
  UnknownPolicy unknown = UnknownPolicy::kAbsent;
  std::string output_folder;  ///< where octree.bt and octree.closed.bt go; empty = nowhere
};

struct SensorReplayConfig {
  bool lockstep = false;    ///< at the pace of the map server instead of in real time
  double speed = 1;         ///< of real time; 0 = as fast as frames can be read
  int window = 4;           ///< lockstep: frames ahead of the oldest that is not committed
  double resend_after = 5;  ///< lockstep: silence after which open frames are sent again [s]
};

/// Where detections come from. kAuto: recorded when the command line names some, else a network
/// when there is a model.
enum class DetectorBackend { kAuto, kRecorded, kDnn };

struct DetectorConfig {
  int camera_id = -1;  ///< answer frames of this camera only; -1 = of all
  DetectorBackend backend = DetectorBackend::kAuto;
  DnnDetectorOptions dnn;
  bool every_frame = false;  ///< network: look at every frame instead of the newest only
};

struct HubConfig {
  std::string listen = "127.0.0.1:7700";  ///< port 0 = any free one
  int queue_mb = 256;                     ///< may wait for a slow client, of lossless and of others
  int socket_buffer_bytes = 0;            ///< of each connection; 0 = the system's
  int max_clients = 256;                  ///< connections beyond are refused
  double patience = 30;  ///< with a client that takes nothing and is waited for [s]
  /// Patterns of channels, see QueuePolicy.
  std::vector<std::string> lossless, latest, drop_newest;
};

struct BridgeConfig {
  std::string remote_url;                  ///< the other bus
  std::vector<std::string> send, receive;  ///< channels, besides STATUS
  int queue_mb = 256;                      ///< may wait in each direction
  /// Patterns of channels, see QueuePolicy.
  std::vector<std::string> lossless, latest, drop_newest;
};

struct OctreeConfig {
  double resolution = 0;  ///< see OctreeOptions [m]
  double free_fraction = 1.0;
};

/// Everything that can be configured, as the option structs of the rooms.
struct VismapConfig {
  VoxelGridOptions grid;
  SegmentationStageOptions segmentation;
  AssociationOptions association;  ///< its range is that of the integration
  IntegrationOptions integration;
  MeshingOptions meshing;
  ObjectOptions objects;                ///< its up_W is not used: see up_W
  std::optional<Eigen::Vector3d> up_W;  ///< upward direction, unit; nullopt = to be estimated
  OccupancyOptions free_space;
  OctreeConfig octree;
  DepthSegmenterConfig depth_segmenter;
  MapServerConfig map_server;
  OctomapExporterConfig octomap_exporter;
  SensorReplayConfig sensor_replay;
  DetectorConfig detector;
  HubConfig hub;
  BridgeConfig bridge;
};

/// Reads protobuf text. Unknown keys, wrong types, keys given twice and syntax errors fail with
/// `name`, line and column. Values are not judged: see Validate.
Result<VismapConfig> ParseConfig(const std::string& text, const std::string& name);

/// Everything that is wrong with the values, one sentence each; empty = nothing.
std::vector<std::string> Validate(const VismapConfig& config);

/// ParseConfig and Validate: fails with all problems in one sentence.
Result<VismapConfig> ParseValidConfig(const std::string& text, const std::string& name);

/// ParseValidConfig of a file.
Result<VismapConfig> LoadConfig(const std::string& path);

/// All values as text that ParseConfig reads back to the same config.
std::string PrintConfig(const VismapConfig& config);

/// The same with the meaning of every key before it as comments: the reference of the parameters,
/// and a file to start from.
std::string DescribeConfig(const VismapConfig& config);

}  // namespace vismap
