#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/enum_names.h"
#include "detection/dnn_options.h"
#include "freespace/octree.h"

namespace vismap {

// The options of the processes: what a config file can say about them. A program takes its struct
// as it is here. They are in this room and not in the folders of the processes, because one file
// configures all of them and every program checks all of it.

/// What a frame waits for in the depth segmenter.
enum class WaitForDetections { kRequired, kAuto, kNone };

inline constexpr auto NamesOf(WaitForDetections) {
  return std::to_array<EnumName<WaitForDetections>>({{"REQUIRED", WaitForDetections::kRequired},
                                                     {"AUTO", WaitForDetections::kAuto},
                                                     {"NONE", WaitForDetections::kNone}});
}

/// What a process does when frames arrive faster than it can handle them.
enum class Overload {
  kLossless,  ///< it handles all of them, and their publishers have to wait
  kNewest,    ///< it drops the oldest ones that wait, and stays close behind the camera
};

inline constexpr auto NamesOf(Overload) {
  return std::to_array<EnumName<Overload>>(
      {{"LOSSLESS", Overload::kLossless}, {"NEWEST", Overload::kNewest}});
}

struct DepthSegmenterOptions {
  WaitForDetections detections = WaitForDetections::kAuto;
  double detection_timeout_s = 2.0;  ///< kAuto: patience with a detector that is alive
  int max_waiting_frames = 64;       ///< beyond, the oldest is given up
  int queue_mb = 512;                ///< of waiting frames and detections; beyond, the oldest go
  double max_wait_s = 600;           ///< what has waited for longer is dropped
  Overload overload = Overload::kLossless;
};

struct MapServerOptions {
  std::string load;                 ///< map file to continue; empty = none
  std::string save_on_exit;         ///< map file to write when stopped; empty = none
  double save_period_s = 0;         ///< and also while running [s]; 0 = do not
  bool recover = false;             ///< go on from save_on_exit, if it is there, and keep a journal
  std::string map_folder = "maps";  ///< of the maps that clients save and load; empty = they do not
  int map_folder_mb = 10240;        ///< when its files have so much, no more maps are saved there
  double mesh_period_s = 1;         ///< least time between two mesh updates [s]; 0 = every frame
  double objects_period_s = 1;      ///< least time between two object lists [s]; 0 = every frame
  /// Of frames that wait for the frame before them, and for how long they do. Beyond, they are
  /// dropped, and their source may send them again.
  int queue_mb = 256;
  double max_wait_s = 30;
  Overload overload = Overload::kLossless;
  int frame_journal_mb = 0;   ///< the frames of the map are kept, at most so much; 0 = they are not
  std::string frame_journal;  ///< folder for them; empty = save_on_exit with ".frames" behind it
  bool accept_corrections = false;  ///< of poses, from any client
  /// Copies of the map are kept after so many frames each, from which a corrected map is made; all
  /// together may take so many megabytes.
  int checkpoint_frames = 100;
  int checkpoint_mb = 1024;
};

struct OctomapExporterOptions {
  double period_s = 1;  ///< least time between two octrees; 0 = only on request
  /// Of the tree on OCTOMAP. kAbsent makes it the same as that on OCTOMAP_RAW.
  UnknownPolicy unknown = UnknownPolicy::kOccupied;
  double coarse_resolution_m = 0;  ///< edge of a leaf on OCTOMAP_COARSE; 0 = there is no such tree
  double robot_radius_m = 0.2;     ///< by which the tree on OCTOMAP_INFLATED is inflated; 0 = none
  double grid_period_s = 0;        ///< least time between two grids on GRID; 0 = none is published
  /// Up to here distances are kept up to date and published on DISTANCES [m]; 0 = they are not.
  double distance_limit_m = 0;
  /// What the robot's body covers around its last positions, within this radius, is free where it
  /// was never seen [m]; 0 = nothing is assumed.
  double clear_start_m = 0;
  /// Megabytes per second for sending trees again while the map stands still; 0 = none is.
  double repeat_mb_s = 8;
  std::string output_folder;  ///< where octree.bt and octree.closed.bt go; empty = nowhere
  int max_map_mb = 1024;      ///< of the copy of the map; a larger map is not followed
};

struct ViewerOptions {
  std::string listen = "127.0.0.1:8080";  ///< port 0 = any free one
  std::string page_folder;                ///< with index.html; empty = beside the program
  /// Names of this computer that browsers may use, besides its addresses, localhost and its own
  /// name.
  std::vector<std::string> hosts;
  int max_clients = 16;       ///< pages that are connected; further ones are refused
  double budget_mb_s = 20;    ///< for the surface and pictures of all pages together
  double max_picture_hz = 5;  ///< pictures of a camera per second
  int max_map_mb = 1024;      ///< of the copy of the surface, and again of that of space
  int evidence_mb = 64;       ///< of frames kept to show objects in them; 0 = none is kept
  double evidence_hz = 2;     ///< frames per second that are looked at for this
  int log_mb = 2000;          ///< of a log's recording on disk and of its index in memory
  std::string log_folder;     ///< of this recording; empty = $TMPDIR, or /var/tmp
};

struct SensorReplayOptions {
  bool lockstep = false;  ///< at the pace of the map server instead of in real time
  double speed = 1;       ///< of real time; 0 = as fast as frames can be read
  int window_frames = 4;  ///< lockstep: frames sent ahead of the oldest that is not committed
  double resend_s = 5;    ///< lockstep: silence after which open frames are sent again
};

/// Where detections come from. kAuto: recorded when the command line names some, else a network
/// when there is a model.
enum class DetectorBackend { kAuto, kRecorded, kDnn };

inline constexpr auto NamesOf(DetectorBackend) {
  return std::to_array<EnumName<DetectorBackend>>({{"AUTO", DetectorBackend::kAuto},
                                                   {"RECORDED", DetectorBackend::kRecorded},
                                                   {"DNN", DetectorBackend::kDnn}});
}

struct DetectorOptions {
  int camera_id = -1;  ///< answer frames of this camera only; -1 = of all
  DetectorBackend backend = DetectorBackend::kAuto;
  DnnDetectorOptions dnn;
  bool every_frame = false;  ///< network: look at every frame instead of the newest only
};

struct HubOptions {
  std::string listen = "127.0.0.1:7700";  ///< port 0 = any free one
  int queue_mb = 256;           ///< may wait for a client, of lossless messages and of others
  int socket_buffer_bytes = 0;  ///< SO_RCVBUF and SO_SNDBUF of the connections; 0 = the system's
  int max_clients = 256;        ///< connections beyond are refused
  /// A client is disconnected when what waits for it is older, or when its messages take longer to
  /// arrive.
  double patience_s = 30;
  double greeting_s = 10;  ///< time in which a client must say that it speaks tcpq
  /// Names of processes (patterns) for which publishers of lossless channels wait. All other slow
  /// readers lose messages.
  std::vector<std::string> critical = {"map-server.*", "depth-segmenter.*", "detector.*",
                                       "sensor-replay.*", "bridge.*"};
  double max_wait_s = 10;  ///< publishers wait when messages wait so long for a critical process
  double max_hold_s = 60;  ///< and in total no longer than this for one name, see HoldBudgets
  double rejoin_s = 5;     ///< after the start, see RejoinBacklog; 0 = no backlog
  int total_mb = 1024;     ///< of all that waits for clients or arrives from them
  /// Patterns of channels, see QueuePolicy.
  std::vector<std::string> lossless, latest, drop_newest;
};

/// What all processes of a pipeline must agree on.
struct SharedOptions {
  std::string channel_prefix;  ///< stands before the names of our channels
};

struct BridgeOptions {
  std::string remote_url;            ///< the other bus
  std::vector<std::string> send;     ///< channels passed on to the other bus, besides STATUS
  std::vector<std::string> receive;  ///< and from there
  int queue_mb = 256;                ///< may wait in each direction, see MessageQueue
  /// Patterns of channels, see QueuePolicy.
  std::vector<std::string> lossless, latest, drop_newest;
};

/// Whose programs publish the images and poses. A preset sets the keys that are not given.
enum class AdapterPreset {
  kAuto,  ///< found from the channels of a log; a running adapter must be told
  kDimos,
  kBotcore,
  kDrake,
  kNone,  ///< all channels are given
};

inline constexpr auto NamesOf(AdapterPreset) {
  return std::to_array<EnumName<AdapterPreset>>({{"AUTO", AdapterPreset::kAuto},
                                                 {"DIMOS", AdapterPreset::kDimos},
                                                 {"BOTCORE", AdapterPreset::kBotcore},
                                                 {"DRAKE", AdapterPreset::kDrake},
                                                 {"NONE", AdapterPreset::kNone}});
}

/// Whether depth has the pixels of the colour image.
enum class DepthIsRegistered {
  kByFrameId,  ///< when both images name the same frame
  kYes,
  kNo,
};

inline constexpr auto NamesOf(DepthIsRegistered) {
  return std::to_array<EnumName<DepthIsRegistered>>({{"BY_FRAME_ID", DepthIsRegistered::kByFrameId},
                                                     {"YES", DepthIsRegistered::kYes},
                                                     {"NO", DepthIsRegistered::kNo}});
}

/// How the pose of a camera is found at the time of an image.
enum class PoseLookup {
  kInterpolate,  ///< between the samples before and after it
  kNearest,      ///< the nearer of the two
};

inline constexpr auto NamesOf(PoseLookup) {
  return std::to_array<EnumName<PoseLookup>>(
      {{"INTERPOLATE", PoseLookup::kInterpolate}, {"NEAREST", PoseLookup::kNearest}});
}

/// When an image counts as taken.
enum class ImageTime {
  kMessage,   ///< as the message says
  kReceived,  ///< when it was received, for drivers that send no time
};

inline constexpr auto NamesOf(ImageTime) {
  return std::to_array<EnumName<ImageTime>>(
      {{"MESSAGE", ImageTime::kMessage}, {"RECEIVED", ImageTime::kReceived}});
}

/// What an edge of a tree of frames is whose pose has never changed.
enum class ConstantEdges {
  kFixedWhenUnchanged,  ///< a mount, whose pose holds at any time
  kMoving,              ///< one that rests at present: its pose holds between two samples
};

inline constexpr auto NamesOf(ConstantEdges) {
  return std::to_array<EnumName<ConstantEdges>>(
      {{"FIXED_WHEN_UNCHANGED", ConstantEdges::kFixedWhenUnchanged},
       {"MOVING", ConstantEdges::kMoving}});
}

/// How one RGB-D camera of a robot is read from other programs' channels. Empty strings and lists
/// are set by the preset, see foreign/presets.h.
struct AdapterCameraOptions {
  int camera_id = 0;
  AdapterPreset preset = AdapterPreset::kAuto;
  std::string color_channel;  ///< "none" = a camera without colour; an ending * matches any ending
  std::string depth_channel;
  std::string intrinsics_channel;        ///< of the colour camera
  std::string depth_intrinsics_channel;  ///< used when depth is not registered
  std::vector<double> intrinsics;        ///< fx, fy, cx, cy [px], instead of the channel
  std::string distortion_model;          ///< of `intrinsics`, see SetDistortion
  std::vector<double> distortion;
  bool swap_red_blue = false;
  double depth_unit_m = 0.001;  ///< of depth images with integers
  /// Values of depth images that mean that nothing was measured: integers as they are sent, floats
  /// in metres. 0 and 65535, and floats that are no positive number, always mean it.
  std::vector<double> none_values = {0, 65535};
  DepthIsRegistered registered = DepthIsRegistered::kByFrameId;
  double pair_within_ms = 20;  ///< most time between a depth image and its colour image
  std::vector<std::string> pose_channels;
  std::string root;                 ///< frame that the map is in
  std::string camera_frame;         ///< optical frame of the camera; empty = as the images say
  std::string body_frame;           ///< child of poses that name none
  std::vector<std::string> mounts;  ///< "parent child x y z qw qx qy qz"
  PoseLookup lookup = PoseLookup::kInterpolate;
  ConstantEdges constant_edges = ConstantEdges::kFixedWhenUnchanged;
  double wait_ms = 200;              ///< longest wait of an image for a pose or a partner
  double max_gap_ms = 100;           ///< longest time between two poses that are interpolated
  double intrinsics_wait_ms = 1500;  ///< longest wait of an image for intrinsics
  ImageTime time = ImageTime::kMessage;
  int queue_mb = 256;  ///< of images that wait
};

/// How vismap-adapter, and logs of other robots' programs, are read and answered. The keys of a
/// camera that are members of AdapterOptions itself hold for every camera that does not have them.
struct AdapterOptions : AdapterCameraOptions {
  std::string robot_url;                     ///< bus of the robot; empty = that of vismap
  std::vector<AdapterCameraOptions> camera;  ///< empty = one camera, as AdapterOptions itself says
  /// What is made of the map for other programs; empty = nothing. See foreign/map_messages.h.
  double publish_period_s = 1;
  std::string cloud_channel;  ///< PointCloud2
  double cloud_spacing_m = 0.05;
  std::string costmap_channel;  ///< OccupancyGrid
  double costmap_resolution_m = 0.05;
  double costmap_min_z_m = 0.1;
  double costmap_max_z_m = 1;
  int costmap_unknown = 100;
  std::string detections_channel;     ///< Detection3DArray
  std::string drake_cloud_channel;    ///< lcmt_point_cloud
  std::string drake_objects_channel;  ///< lcmt_viewer_link_data
  std::string director_channel;       ///< viewer2_comms_t
};

}  // namespace vismap
